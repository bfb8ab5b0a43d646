//! Stacks of fixed size that cost nothing to make: initialising kilobytes for each ray would show.

use std::mem::MaybeUninit;

/// `LANES` stacks of at most `N` items each; what is pushed beyond is dropped (trees are built never to need it).
pub(crate) struct Stacks<T: Copy, const N: usize, const LANES: usize> {
    items: [MaybeUninit<[T; N]>; LANES],
    /// Of each stack, the first `len` items are initialised, and `len` is at most `N`.
    len: [usize; LANES],
    /// Which of `items` and `len` each stack has.
    order: [usize; LANES],
}

impl<T: Copy, const N: usize, const LANES: usize> Stacks<T, N, LANES> {
    #[inline(always)]
    pub fn new() -> Self {
        let mut out = MaybeUninit::<Self>::uninit();
        // SAFETY: `len` and `order` are inside the allocation, and `items` needs no initialising. (Made as a literal, the whole would
        // be a constant, which the compiler copies by zeroing all of it.)
        unsafe {
            (&raw mut (*out.as_mut_ptr()).len).write([0; LANES]);
            (&raw mut (*out.as_mut_ptr()).order).write(std::array::from_fn(|i| i));
            out.assume_init()
        }
    }

    #[inline(always)]
    pub fn push(&mut self, lane: usize, item: T) {
        let lane = self.order[lane];
        let len = &mut self.len[lane];
        if *len < N {
            // SAFETY: `len` is below `N`, so the place is inside the array.
            unsafe { self.items[lane].as_mut_ptr().cast::<T>().add(*len).write(item) };
            *len += 1;
        }
    }

    #[inline(always)]
    pub fn pop(&mut self, lane: usize) -> Option<T> {
        let lane = self.order[lane];
        let len = &mut self.len[lane];
        *len = len.checked_sub(1)?;
        // SAFETY: the item was below the old `len`, so it is inside the array and initialised.
        Some(unsafe { self.items[lane].as_ptr().cast::<T>().add(*len).read() })
    }

    #[inline(always)]
    pub fn clear(&mut self, lane: usize) {
        self.len[self.order[lane]] = 0;
    }

    /// Exchanges two stacks.
    #[inline(always)]
    pub fn swap(&mut self, a: usize, b: usize) {
        let (to, from) = (self.order[a], self.order[b]);
        (self.order[a], self.order[b]) = (from, to);
    }
}
