//! The vector types of an instruction set, made from the functions on its registers.

/// An array with an expression for each of 1, 2 or 4 registers.
macro_rules! each {
    (1, $i:ident => $e:expr) => {
        [{
            const $i: usize = 0;
            $e
        }]
    };
    (2, $i:ident => $e:expr) => {
        [
            {
                const $i: usize = 0;
                $e
            },
            {
                const $i: usize = 1;
                $e
            },
        ]
    };
    (4, $i:ident => $e:expr) => {
        [
            {
                const $i: usize = 0;
                $e
            },
            {
                const $i: usize = 1;
                $e
            },
            {
                const $i: usize = 2;
                $e
            },
            {
                const $i: usize = 3;
                $e
            },
        ]
    };
}

/// Methods that do the same with each register, by functions of the module `raw` where the macro is used.
macro_rules! by_register {
    ($n:tt: $($name:ident($($arg:ident),*) => $raw:ident;)*) => {
        $(
            #[inline(always)]
            fn $name(self $(, $arg: Self)*) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(each!($n, I => raw::$raw(self.0[I] $(, $arg.0[I])*))) }
            }
        )*
    };
}

/// Shifts of each register by one number for all lanes.
macro_rules! shifts {
    ($n:tt: $($name:ident => $raw:ident;)*) => {
        $(
            #[inline(always)]
            fn $name(self, by: u32) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(each!($n, I => raw::$raw(self.0[I], by))) }
            }
        )*
    };
}

/// Comparisons, by functions of whole vectors.
macro_rules! comparisons {
    ($($name:ident => $raw:ident;)*) => {
        $(
            #[inline(always)]
            fn $name(self, o: Self) -> Lanes {
                // SAFETY: see the head of `arch`.
                unsafe { Lanes(raw::$raw(self.0, o.0)) }
            }
        )*
    };
}

/// An operator between vectors, and between a vector and a number.
macro_rules! operators {
    ($t:ident, $scalar:ty, $n:tt: $($trait:ident $name:ident $raw:ident;)*) => {
        $(
            impl std::ops::$trait for $t {
                type Output = Self;
                #[inline(always)]
                fn $name(self, o: Self) -> Self {
                    // SAFETY: see the head of `arch`.
                    unsafe { Self(each!($n, I => raw::$raw(self.0[I], o.0[I]))) }
                }
            }
            impl std::ops::$trait<$scalar> for $t {
                type Output = Self;
                #[inline(always)]
                fn $name(self, o: $scalar) -> Self {
                    std::ops::$trait::$name(self, Self::splat(o))
                }
            }
        )*
    };
}

/// Operators that write to their left side.
macro_rules! assigning {
    ($t:ident: $($trait:ident $name:ident $op:tt;)*) => {
        $(
            impl std::ops::$trait for $t {
                #[inline(always)]
                fn $name(&mut self, o: Self) {
                    *self = *self $op o;
                }
            }
        )*
    };
}

/// What is alike in all types of numbers.
macro_rules! vector {
    ($t:ident, $scalar:ty, $width:tt, $n:tt, $splat:ident) => {
        const WIDTH: usize = $width;
        type Mask = Lanes;
        type Array = [$scalar; $width];

        #[inline(always)]
        fn splat(x: $scalar) -> Self {
            // SAFETY: see the head of `arch`.
            unsafe {
                let all = raw::$splat(x);
                Self([all; $n])
            }
        }
        #[inline(always)]
        fn from_array(lanes: Self::Array) -> Self {
            // SAFETY: see the head of `arch`.
            unsafe { Self(std::mem::transmute::<Self::Array, [_; $n]>(lanes)) }
        }
        #[inline(always)]
        fn to_array(self) -> Self::Array {
            // SAFETY: see the head of `arch`.
            unsafe { std::mem::transmute::<[_; $n], Self::Array>(self.0) }
        }
    };
}

/// A choice between vectors.
macro_rules! select {
    ($raw:ident) => {
        #[inline(always)]
        fn select(mask: Lanes, yes: Self, no: Self) -> Self {
            // SAFETY: see the head of `arch`.
            unsafe { Self(raw::$raw(mask.0, yes.0, no.0)) }
        }
    };
}

/// The five types of a family of `$width` lanes: `$n` registers of 32-bit lanes, `$d` of 64-bit lanes. `raw` is a module in scope with
/// types and functions of registers, and of whole vectors (arrays of registers) where lanes of different sizes meet.
macro_rules! vector_types {
    ($width:tt lanes, $n:tt registers, $d:tt double, features $features:literal) => {
        /// Numbers in single precision.
        #[derive(Clone, Copy)]
        pub struct Floats([raw::F32; $n]);
        /// Whole numbers of 32 bits.
        #[derive(Clone, Copy)]
        pub struct Uints([raw::U32; $n]);
        /// Numbers in double precision.
        #[derive(Clone, Copy)]
        pub struct Doubles([raw::F64; $d]);
        /// Whole numbers of 64 bits.
        #[derive(Clone, Copy)]
        pub struct Ulongs([raw::U64; $d]);
        /// Yes or no.
        #[derive(Clone, Copy)]
        pub struct Lanes(raw::M);

        /// Runs a kernel with this family.
        #[target_feature(enable = $features)]
        #[inline(never)] // its frame is large, and must not become part of its caller's
        pub fn enter<K: $crate::simd::Kernel>(kernel: K) -> K::Output {
            kernel.run::<Floats>()
        }

        impl Sealed for Floats {}
        impl Sealed for Uints {}
        impl Sealed for Doubles {}
        impl Sealed for Ulongs {}
        impl Sealed for Lanes {}
        impl Arithmetic<f32> for Floats {}
        impl Arithmetic<f64> for Doubles {}
        impl Bits<u32> for Uints {}
        impl Bits<u64> for Ulongs {}

        operators!(Floats, f32, $n: Add add add_f32; Sub sub sub_f32; Mul mul mul_f32; Div div div_f32;);
        operators!(Doubles, f64, $d: Add add add_f64; Sub sub sub_f64; Mul mul mul_f64; Div div div_f64;);
        operators!(Uints, u32, $n: BitAnd bitand and_u32; BitOr bitor or_u32; BitXor bitxor xor_u32;);
        operators!(Ulongs, u64, $d: BitAnd bitand and_u64; BitOr bitor or_u64; BitXor bitxor xor_u64;);
        assigning!(Floats: AddAssign add_assign +; SubAssign sub_assign -; MulAssign mul_assign *;);
        assigning!(Doubles: AddAssign add_assign +; SubAssign sub_assign -; MulAssign mul_assign *;);

        impl std::ops::Neg for Floats {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::from_bits(self.to_bits() ^ 1 << 31)
            }
        }
        impl std::ops::Neg for Doubles {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::from_bits(self.to_bits() ^ 1 << 63)
            }
        }
        impl std::ops::Not for Uints {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                self ^ u32::MAX
            }
        }
        impl std::ops::Not for Ulongs {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                self ^ u64::MAX
            }
        }
        impl std::ops::Shl<u32> for Uints {
            type Output = Self;
            shifts!($n: shl => shl_u32;);
        }
        impl std::ops::Shr<u32> for Uints {
            type Output = Self;
            shifts!($n: shr => shr_u32;);
        }
        impl std::ops::Shl<u32> for Ulongs {
            type Output = Self;
            shifts!($d: shl => shl_u64;);
        }
        impl std::ops::Shr<u32> for Ulongs {
            type Output = Self;
            shifts!($d: shr => shr_u64;);
        }

        impl Float for Floats {
            type Uint = Uints;
            type Ulong = Ulongs;
            type Double = Doubles;
            // SAFETY: see the head of `arch`.
            const ZERO: Self = unsafe { Self(std::mem::transmute::<[f32; $width], [_; $n]>([0.0; $width])) };
            // SAFETY: see the head of `arch`.
            const ONE: Self = unsafe { Self(std::mem::transmute::<[f32; $width], [_; $n]>([1.0; $width])) };
            vector!(Floats, f32, $width, $n, splat_f32);
            by_register!($n:
                sqrt() => sqrt_f32;
                min(o) => min_f32;
                max(o) => max_f32;
                mul_add(a, b) => mul_add_f32;
                floor() => floor_f32;
                trunc() => trunc_f32;
            );
            comparisons!(lt => lt_f32; le => le_f32; eq => eq_f32;);
            select!(select_f32);

            #[inline(always)]
            fn gather(table: &[f32], index: Uints) -> Self {
                let Ok(last) = i32::try_from(table.len() as i64 - 1) else {
                    let index = index.to_array();
                    return Self::from_fn(|i| crate::simd::plain::at(table, index[i]));
                };
                if last < 0 {
                    return Self::ZERO;
                }
                let index = index.min(Uints::splat(last as u32));
                // SAFETY: see the head of `arch`. The indices are within the table.
                unsafe { Self::from_bits(Uints(raw::gather(table.as_ptr().cast(), index.0))) }
            }
            #[inline(always)]
            fn from_rows(mut row: impl FnMut(usize) -> [f32; 4]) -> [Self; 4] {
                let mut rows = [[0.0; 4]; $width];
                let mut i = 0;
                while i < $width {
                    rows[i] = row(i);
                    i += 1;
                }
                // SAFETY: see the head of `arch`.
                let [a, b, c, d] = unsafe { raw::columns(&rows) };
                [Self(a), Self(b), Self(c), Self(d)]
            }
            #[inline(always)]
            fn to_rows([a, b, c, d]: [Self; 4], mut row: impl FnMut(usize, [f32; 4])) {
                // SAFETY: see the head of `arch`.
                let rows = unsafe { raw::rows([a.0, b.0, c.0, d.0]) };
                let mut i = 0;
                while i < $width {
                    row(i, rows[i]);
                    i += 1;
                }
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self::from_bits(self.to_bits() & i32::MAX as u32)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                Self::from_bits(self.to_bits() & i32::MAX as u32 | sign.to_bits() & 1 << 31)
            }
            #[inline(always)]
            fn to_bits(self) -> Uints {
                // SAFETY: see the head of `arch`.
                unsafe { Uints(each!($n, I => raw::bits_f32(self.0[I]))) }
            }
            #[inline(always)]
            fn from_bits(bits: Uints) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(each!($n, I => raw::f32_of_bits(bits.0[I]))) }
            }
            #[inline(always)]
            fn to_uint(self) -> Uints {
                // SAFETY: see the head of `arch`.
                unsafe { Uints(each!($n, I => raw::f32_to_u32(self.0[I]))) }
            }
            #[inline(always)]
            fn to_int(self) -> Uints {
                // SAFETY: see the head of `arch`.
                unsafe { Uints(each!($n, I => raw::f32_to_i32(self.0[I]))) }
            }
            #[inline(always)]
            fn from_uint(x: Uints) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(each!($n, I => raw::u32_to_f32(x.0[I]))) }
            }
            #[inline(always)]
            fn from_int(x: Uints) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(each!($n, I => raw::i32_to_f32(x.0[I]))) }
            }
            #[inline(always)]
            fn to_double(self) -> Doubles {
                // SAFETY: see the head of `arch`.
                unsafe { Doubles(raw::widen_f32(self.0)) }
            }
            #[inline(always)]
            fn from_double(x: Doubles) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(raw::narrow_f64(x.0)) }
            }
            #[inline(always)]
            fn vectorize<R>(f: impl FnOnce() -> R) -> R {
                #[target_feature(enable = $features)]
                #[inline(never)] // that is what it is for
                fn compiled<R>(f: impl FnOnce() -> R) -> R {
                    f()
                }
                // SAFETY: see the head of `arch`.
                unsafe { compiled(f) }
            }
        }

        impl Double for Doubles {
            type Ulong = Ulongs;
            // SAFETY: see the head of `arch`.
            const ZERO: Self = unsafe { Self(std::mem::transmute::<[f64; $width], [_; $d]>([0.0; $width])) };
            // SAFETY: see the head of `arch`.
            const ONE: Self = unsafe { Self(std::mem::transmute::<[f64; $width], [_; $d]>([1.0; $width])) };
            vector!(Doubles, f64, $width, $d, splat_f64);
            by_register!($d:
                sqrt() => sqrt_f64;
                min(o) => min_f64;
                max(o) => max_f64;
            );
            comparisons!(lt => lt_f64; le => le_f64; eq => eq_f64;);
            select!(select_f64);

            #[inline(always)]
            fn abs(self) -> Self {
                Self::from_bits(self.to_bits() & i64::MAX as u64)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                Self::from_bits(self.to_bits() & i64::MAX as u64 | sign.to_bits() & 1 << 63)
            }
            #[inline(always)]
            fn is_sign_negative(self) -> Lanes {
                self.to_bits().high().lt_signed(Uints::splat(0))
            }
            #[inline(always)]
            fn to_bits(self) -> Ulongs {
                // SAFETY: see the head of `arch`.
                unsafe { Ulongs(each!($d, I => raw::bits_f64(self.0[I]))) }
            }
            #[inline(always)]
            fn from_bits(bits: Ulongs) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(each!($d, I => raw::f64_of_bits(bits.0[I]))) }
            }
        }

        impl Uint for Uints {
            type Ulong = Ulongs;
            vector!(Uints, u32, $width, $n, splat_u32);
            by_register!($n:
                wrapping_add(o) => add_u32;
                wrapping_sub(o) => sub_u32;
                wrapping_mul(o) => mul_u32;
                min(o) => min_u32;
                max(o) => max_u32;
                shl_each(by) => shl_each_u32;
                shr_each(by) => shr_each_u32;
                reverse_bits() => reverse_bits_u32;
            );
            shifts!($n: shr_signed => shr_signed_u32;);
            comparisons!(eq => eq_u32; lt => lt_u32; lt_signed => lt_i32;);
            select!(select_u32);

            #[inline(always)]
            fn gather(table: &[u32], index: Uints) -> Self {
                let Ok(last) = i32::try_from(table.len() as i64 - 1) else {
                    let index = index.to_array();
                    return Self::from_fn(|i| crate::simd::plain::at(table, index[i]));
                };
                if last < 0 {
                    return Self::splat(0);
                }
                let index = index.min(Uints::splat(last as u32));
                // SAFETY: see the head of `arch`. The indices are within the table.
                unsafe { Self(raw::gather(table.as_ptr(), index.0)) }
            }
            #[inline(always)]
            fn look_up(self, table: &[u32; 8]) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(raw::look_up(self.0, table)) }
            }
            #[inline(always)]
            fn to_ulong(self) -> Ulongs {
                // SAFETY: see the head of `arch`.
                unsafe { Ulongs(raw::widen_u32(self.0)) }
            }
        }

        impl Ulong for Ulongs {
            type Uint = Uints;
            vector!(Ulongs, u64, $width, $d, splat_u64);
            by_register!($d:
                wrapping_add(o) => add_u64;
                wrapping_sub(o) => sub_u64;
                wrapping_mul(o) => mul_u64;
            );
            comparisons!(eq => eq_u64;);
            select!(select_u64);

            #[inline(always)]
            fn low(self) -> Uints {
                // SAFETY: see the head of `arch`.
                unsafe { Uints(raw::narrow_u64(self.0)) }
            }
        }

        impl Mask for Lanes {
            #[inline(always)]
            fn splat(yes: bool) -> Self {
                Self::from_bits(if yes { u32::MAX } else { 0 })
            }
            #[inline(always)]
            fn from_bits(bits: u32) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(raw::mask_of_bits(bits)) }
            }
            #[inline(always)]
            fn to_bits(self) -> u32 {
                // SAFETY: see the head of `arch`.
                unsafe { raw::bits_of_mask(self.0) }
            }
            #[inline(always)]
            fn any(self) -> bool {
                self.to_bits() != 0
            }
            #[inline(always)]
            fn all(self) -> bool {
                self.to_bits() == u32::MAX >> (32 - $width)
            }
        }
        impl std::ops::BitAnd for Lanes {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, o: Self) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(raw::and_mask(self.0, o.0)) }
            }
        }
        impl std::ops::BitOr for Lanes {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, o: Self) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(raw::or_mask(self.0, o.0)) }
            }
        }
        impl std::ops::BitXor for Lanes {
            type Output = Self;
            #[inline(always)]
            fn bitxor(self, o: Self) -> Self {
                // SAFETY: see the head of `arch`.
                unsafe { Self(raw::xor_mask(self.0, o.0)) }
            }
        }
        impl std::ops::Not for Lanes {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                self ^ Self::splat(true)
            }
        }

        impl std::fmt::Debug for Floats {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.to_array().fmt(f)
            }
        }
        impl std::fmt::Debug for Doubles {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.to_array().fmt(f)
            }
        }
        impl std::fmt::Debug for Uints {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.to_array().fmt(f)
            }
        }
        impl std::fmt::Debug for Ulongs {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.to_array().fmt(f)
            }
        }
        impl std::fmt::Debug for Lanes {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "{:#b}", self.to_bits())
            }
        }
    };
}

pub(super) use {assigning, by_register, comparisons, each, operators, select, shifts, vector, vector_types};
