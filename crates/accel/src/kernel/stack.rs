//! A stack of fixed size that costs nothing to make: initialising kilobytes for each ray would show.

use std::mem::MaybeUninit;

/// At most `N` items; what is pushed beyond is dropped (trees are built never to need it).
pub(crate) struct Stack<T: Copy, const N: usize> {
    /// The first `len` items are initialised, and `len` is at most `N`.
    items: [MaybeUninit<T>; N],
    len: usize,
}

impl<T: Copy, const N: usize> Stack<T, N> {
    #[inline(always)]
    pub fn new() -> Self {
        let mut out = MaybeUninit::<Self>::uninit();
        // SAFETY: `len` is inside the allocation, and `items` needs no initialising. (Made as a literal, the whole would be a
        // constant, which the compiler copies by zeroing all of it.)
        unsafe {
            (&raw mut (*out.as_mut_ptr()).len).write(0);
            out.assume_init()
        }
    }

    #[inline(always)]
    pub fn push(&mut self, item: T) {
        if let Some(place) = self.items.get_mut(self.len) {
            place.write(item);
            self.len += 1;
        }
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: the item was below the old `len`, so it is inside the array and initialised.
        Some(unsafe { self.items[self.len].assume_init() })
    }
}
