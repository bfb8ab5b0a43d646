//! The functions through which a search enters code compiled for an instruction set.

/// The entry points of a kernel, compiled with the given features. Everything inside is inlined into them.
macro_rules! entry_points {
    ($($feature:literal)?) => {
        #[inline]
        fn meet(
            self,
            ray: &$crate::local::LocalRay,
            block: $crate::analytic::block::Block<'_>,
            limit: f32,
        ) -> $crate::analytic::block::Found {
            $(#[target_feature(enable = $feature)])?
            fn compiled<K: $crate::kernel::Kernel>(
                kernel: K,
                ray: &$crate::local::LocalRay,
                block: $crate::analytic::block::Block<'_>,
                limit: f32,
            ) -> $crate::analytic::block::Found {
                block.meet(kernel, ray, limit)
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled(self, ray, block, limit)
            }
        }

        #[inline]
        fn octets<const ANY: bool>(
            self,
            few: &$crate::analytic::block::Blocks,
            rays: &[straal_math::Ray],
            out: &mut $crate::analytic::octet::Octets,
        ) {
            $(#[target_feature(enable = $feature)])?
            #[inline(never)] // its frame is large, and must not become part of its caller's
            fn compiled<K: $crate::kernel::Kernel, const ANY: bool>(
                kernel: K,
                few: &$crate::analytic::block::Blocks,
                rays: &[straal_math::Ray],
                out: &mut $crate::analytic::octet::Octets,
            ) {
                $crate::analytic::octet::search::<K, ANY>(kernel, kernel.simd(), few, rays, out);
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled::<Self, ANY>(self, few, rays, out)
            }
        }

        #[inline]
        fn run<T: $crate::kernel::Task>(self, task: T) -> T::Answer {
            $(#[target_feature(enable = $feature)])?
            #[inline(never)] // its frame may be large, and must not become part of its caller's
            fn compiled<T: $crate::kernel::Task>(task: T) -> T::Answer {
                task.run()
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled(task)
            }
        }
    };
}
pub(crate) use entry_points;
