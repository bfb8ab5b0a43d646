//! A stack of fixed size that costs nothing to make: initialising kilobytes for each ray would show.

use std::mem::MaybeUninit;

/// A stack of at most `N` items; what is pushed beyond is dropped (trees are built never to need it).
pub(crate) struct Stack<T: Copy, const N: usize> {
    items: MaybeUninit<[T; N]>,
    /// The first `len` items are initialised, and `len` is at most `N`.
    len: usize,
}

impl<T: Copy, const N: usize> Stack<T, N> {
    #[inline(always)]
    pub const fn new() -> Self {
        Self { items: MaybeUninit::uninit(), len: 0 }
    }

    #[inline(always)]
    pub fn push(&mut self, item: T) {
        if self.len < N {
            // SAFETY: `len` is below `N`, so the place is inside the array.
            unsafe { self.items.as_mut_ptr().cast::<T>().add(self.len).write(item) };
            self.len += 1;
        }
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: the item was below the old `len`, so it is inside the array and initialised.
        Some(unsafe { self.items.as_ptr().cast::<T>().add(self.len).read() })
    }
}
