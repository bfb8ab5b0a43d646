//! The stack of a search: what is still to be visited.

use crate::node::{Child, WIDTH};
use std::mem::MaybeUninit;

/// Subtrees to be visited, each with the key of its entry (see [`super::Children::keys`]). A child that ends the search
/// lies at the bottom.
///
/// It costs nothing to make: initialising kilobytes for each ray would show. Up to `N` - 8 items leave room for the eight of
/// a node behind the last. A stack of [`ALL`] is never full, since trees are built so; a smaller one has to be relieved
/// ([`Descent::spill`]).
#[repr(align(64))]
pub(crate) struct Descent<const N: usize> {
    /// The first `len` items of both arrays are initialised.
    len: usize,
    keys: [MaybeUninit<u32>; N],
    children: [MaybeUninit<Child>; N],
}

/// Size of a stack that holds whatever a search can leave to be visited.
pub(crate) const ALL: usize = crate::node::STACK + WIDTH;

/// Items that were taken from a stack to make room, the bottom one first.
pub(crate) type Spilled = Vec<(u32, Child)>;

impl<const N: usize> Descent<N> {
    /// Items up to this are followed by room for a vector.
    const ROOMY: usize = N - WIDTH;

    #[inline(always)]
    pub fn new() -> Self {
        let [out] = Self::many();
        out
    }

    /// Several, made where they stay: moving them would copy all their room.
    #[inline(always)]
    pub fn many<const M: usize>() -> [Self; M] {
        let mut out = MaybeUninit::<[Self; M]>::uninit();
        let first = out.as_mut_ptr().cast::<Self>();
        for i in 0..M {
            // SAFETY: `i` is below `M`. Of a stack, `len` alone needs initialising. (Made as a literal, the whole would be a
            // constant, which the compiler copies by zeroing all of it.)
            unsafe { (&raw mut (*first.add(i)).len).write(0) };
        }
        // SAFETY: as said.
        let mut out = unsafe { out.assume_init() };
        out.iter_mut().for_each(Self::reset);
        out
    }

    /// Nothing to visit but the end.
    #[inline(always)]
    pub fn reset(&mut self) {
        self.len = 0;
        self.push(0, Child::DONE);
    }

    #[inline(always)]
    pub fn push(&mut self, key: u32, child: Child) {
        if self.len < N {
            self.keys[self.len].write(key);
            self.children[self.len].write(child);
            self.len += 1;
        }
    }

    /// The index of the last item, if there is one.
    #[inline(always)]
    fn top(&self) -> Option<usize> {
        let top = self.len.wrapping_sub(1);
        (top < N).then_some(top)
    }

    /// What was pushed last.
    #[inline(always)]
    pub fn pop(&mut self) -> Child {
        let Some(top) = self.top() else { return Child::DONE };
        self.len = top;
        // SAFETY: items below the old `len` are initialised.
        unsafe { self.children[top].assume_init() }
    }

    /// What was pushed last, if it is entered no later than `limit`, else what is below, and so on.
    #[inline(always)]
    pub fn pop_within(&mut self, limit: u32) -> Child {
        while let Some(top) = self.top() {
            self.len = top;
            // SAFETY: items below the old `len` are initialised.
            let (key, child) = unsafe { (self.keys[top].assume_init(), self.children[top].assume_init()) };
            if key <= limit {
                return child;
            }
        }
        Child::DONE
    }

    /// Drops what is entered later than `limit`.
    #[inline(always)]
    pub fn keep_within(&mut self, limit: u32) {
        let Some(top) = self.top() else { return };
        let mut kept = 0;
        for i in 0..=top {
            let (key, child) = (self.keys[i], self.children[i]);
            self.keys[kept] = key;
            self.children[kept] = child;
            // SAFETY: items below `len` are initialised.
            kept += usize::from(unsafe { key.assume_init() } <= limit);
        }
        self.len = kept;
    }

    /// Whether there is no room for a vector behind the last item.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.len > Self::ROOMY
    }

    /// Takes out all but the end and the last few.
    #[cold]
    #[inline(never)]
    pub fn spill(&mut self, to: &mut Spilled) {
        let kept = if self.len <= WIDTH { self.len } else { WIDTH };
        let from = self.len - kept;
        // SAFETY: items below `len` are initialised.
        let item = |i: usize| unsafe { (self.keys[i].assume_init(), self.children[i].assume_init()) };
        to.extend((1..from).map(item));
        let last: [_; WIDTH] = std::array::from_fn(|i| item(if i < kept { from + i } else { 0 }));
        self.reset();
        last[..kept].iter().for_each(|&(key, child)| self.push(key, child));
    }

    /// Puts back what was taken out last, once all else was visited; false where nothing was.
    #[inline(always)]
    pub fn refill(&mut self, from: &mut Spilled) -> bool {
        if from.is_empty() {
            return false;
        }
        self.refill_some(from);
        true
    }

    #[cold]
    #[inline(never)]
    fn refill_some(&mut self, from: &mut Spilled) {
        let some = if from.len() < WIDTH { from.len() } else { WIDTH };
        self.reset();
        for (key, child) in from.drain(from.len() - some..) {
            self.push(key, child);
        }
    }

    /// Pushes the first `count` of eight items.
    ///
    /// # Safety
    /// As with [`Descent::step`].
    #[inline(always)]
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    pub unsafe fn push_several(&mut self, count: usize, store: impl FnOnce(*mut u32, *mut u32)) {
        if self.is_full() {
            return;
        }
        // SAFETY: `len` is at most `N` - 8, so that there is room for eight.
        unsafe {
            store(
                self.keys.as_mut_ptr().add(self.len).cast(),
                self.children.as_mut_ptr().add(self.len).cast(),
            );
        }
        self.len += count;
    }

    /// One step down: pushes the first `count` of eight items and takes what is on top; `None`, with nothing done, where there
    /// is no room or nothing at all. There is no other branch: whether a node has anything to visit is hard to guess.
    ///
    /// # Safety
    /// `store` is given room for eight keys and eight children, and must initialise the first `count` of each, at most
    /// eight.
    #[inline(always)]
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    pub unsafe fn step(&mut self, count: usize, store: impl FnOnce(*mut u32, *mut u32)) -> Option<Child> {
        let top = self.len.wrapping_sub(1);
        if top >= Self::ROOMY {
            return None;
        }
        // SAFETY: items below `len` are initialised, and there are such; `len` is at most `N` - 8, so that there is room for
        // eight.
        unsafe {
            let key = self.keys.as_mut_ptr().add(top + 1);
            let child = self.children.as_mut_ptr().add(top + 1);
            store(key.cast(), child.cast());
            self.len = top + count;
            Some((*self.children.as_ptr().add(top + count)).assume_init())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_spilled_comes_back_in_order() {
        let mut stack = Descent::<24>::new();
        let mut spilled = Spilled::new();
        for i in 0..1000 {
            if stack.is_full() {
                stack.spill(&mut spilled);
            }
            stack.push(i, Child::node(i));
        }
        for i in (0..1000).rev() {
            let mut child = stack.pop();
            if child == Child::DONE {
                assert!(stack.refill(&mut spilled));
                child = stack.pop();
            }
            assert_eq!(child, Child::node(i));
        }
        assert_eq!(stack.pop(), Child::DONE);
        assert!(!stack.refill(&mut spilled));
    }

    #[test]
    fn a_stack_that_is_not_full_takes_all_of_a_node() {
        for before in 0..100 {
            let mut stack = Descent::<24>::new();
            let mut spilled = Spilled::new();
            for i in 0..before {
                if stack.is_full() {
                    stack.spill(&mut spilled);
                }
                stack.push(i, Child::node(i));
            }
            if !stack.is_full() {
                (0..8).for_each(|i| stack.push(i, Child::node(before + i)));
                for i in (0..8).rev() {
                    assert_eq!(stack.pop(), Child::node(before + i));
                }
            }
        }
    }

    #[test]
    fn what_lies_beyond_the_limit_is_dropped() {
        let mut stack = Descent::<24>::new();
        for (key, i) in [(5, 0), (9, 1), (3, 2), (7, 3)] {
            stack.push(key, Child::node(i));
        }
        stack.keep_within(6);
        assert_eq!([stack.pop(), stack.pop()], [Child::node(2), Child::node(0)]);
        assert_eq!(stack.pop(), Child::DONE);
    }
}
