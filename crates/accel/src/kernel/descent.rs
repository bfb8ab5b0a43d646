//! The stack of a search: what is still to be visited.

use crate::bvh::{Child, STACK, WIDTH};
use std::mem::MaybeUninit;

/// Subtrees to be visited, each with the key of its entry (see [`super::Children::keys`]). A child that ends the search
/// lies at the bottom.
///
/// It costs nothing to make: initialising kilobytes for each ray would show. Trees are built never to need more than
/// [`STACK`] items; a search that did would end.
#[repr(align(64))]
pub(crate) struct Descent {
    /// The first `len` items of both arrays are initialised.
    len: usize,
    keys: [MaybeUninit<u32>; CAPACITY],
    children: [MaybeUninit<Child>; CAPACITY],
    _room: [MaybeUninit<u8>; ROOM],
}

/// Room for a vector behind the last item.
const CAPACITY: usize = STACK + WIDTH;

/// What a stack's size is filled up with. Were it near a multiple of 4096, all stacks of rays in flight would share a few
/// sets of the first-level cache; with this it is 3 lines past one.
const ROOM: usize = {
    let size = 2 * CAPACITY * size_of::<u32>() + size_of::<usize>();
    (3 * 64 + 4096 - size % 4096) % 4096
};

impl Descent {
    #[inline(always)]
    pub fn new() -> Self {
        let [out] = Self::many();
        out
    }

    /// Several, made where they stay: moving them would copy all their room.
    #[inline(always)]
    pub fn many<const N: usize>() -> [Self; N] {
        let mut out = MaybeUninit::<[Self; N]>::uninit();
        let first = out.as_mut_ptr().cast::<Self>();
        for i in 0..N {
            // SAFETY: `i` is below `N`. Of a stack, `len` alone needs initialising. (Made as a literal, the whole would be a
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
        if self.len < STACK {
            self.keys[self.len].write(key);
            self.children[self.len].write(child);
            self.len += 1;
        }
    }

    /// The index of the last item; `None` where there is none, or no room behind it.
    #[inline(always)]
    fn top(&self) -> Option<usize> {
        let top = self.len.wrapping_sub(1);
        (top < STACK).then_some(top)
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

    /// One step down: if `any` is 1, pushes the first `others` of eight items and gives `first`; if it is 0, gives what
    /// was on top. Without a branch: whether a node has anything to visit is hard to guess.
    ///
    /// # Safety
    /// `any` is 0 or 1. `store` is given room for eight keys and eight children, and must initialise the first `others` of
    /// each, which are at most seven, and none when `any` is 0.
    #[inline(always)]
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    pub unsafe fn descend(
        &mut self,
        any: usize,
        first: Child,
        others: usize,
        store: impl FnOnce(*mut u32, *mut u32),
    ) -> Child {
        let Some(top) = self.top() else { return Child::DONE };
        // SAFETY: items below `len` are initialised; `top` is below `STACK`, so that there is room for eight behind it.
        unsafe {
            let last = self.children.as_mut_ptr().add(top);
            let key = self.keys.as_mut_ptr().add(top);
            let waiting = (*last).assume_init();
            store(key.add(1).cast(), last.add(1).cast());
            self.len = top + others + any;
            waiting.or_else(first, any)
        }
    }
}
