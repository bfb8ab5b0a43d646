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
                $crate::analytic::octet::search::<K, ANY>(kernel, few, rays, out);
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled::<Self, ANY>(self, few, rays, out)
            }
        }

        #[inline]
        fn closest_in<const COUNT: bool>(
            self,
            q: &mut $crate::query::Query<'_, Self, COUNT>,
            at: &$crate::structure::Place<'_>,
            best: &mut $crate::Hit,
        ) {
            $(#[target_feature(enable = $feature)])?
            #[inline(never)] // its frame is large, and must not become part of its caller's
            fn compiled<K: $crate::kernel::Kernel, const COUNT: bool>(
                q: &mut $crate::query::Query<'_, K, COUNT>,
                at: &$crate::structure::Place<'_>,
                best: &mut $crate::Hit,
            ) {
                q.closest_in(at, best);
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled(q, at, best)
            }
        }

        #[inline]
        fn occluded_in<const COUNT: bool>(
            self,
            q: &mut $crate::query::Query<'_, Self, COUNT>,
            at: &$crate::structure::Place<'_>,
        ) -> bool {
            $(#[target_feature(enable = $feature)])?
            #[inline(never)] // its frame is large, and must not become part of its caller's
            fn compiled<K: $crate::kernel::Kernel, const COUNT: bool>(
                q: &mut $crate::query::Query<'_, K, COUNT>,
                at: &$crate::structure::Place<'_>,
            ) -> bool {
                q.occluded_in(at)
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled(q, at)
            }
        }

        #[inline]
        fn closest_each(
            self,
            scene: &$crate::Scene,
            shapes: &dyn $crate::Shapes,
            rays: &[straal_math::Ray],
            hits: &mut [$crate::Hit],
        ) {
            $(#[target_feature(enable = $feature)])?
            #[inline(never)] // its frame is large, and must not become part of its caller's
            fn compiled<K: $crate::kernel::Kernel>(
                kernel: K,
                scene: &$crate::Scene,
                shapes: &dyn $crate::Shapes,
                rays: &[straal_math::Ray],
                hits: &mut [$crate::Hit],
            ) {
                $crate::kernel::closest_one_by_one(kernel, scene, shapes, rays, hits);
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled(self, scene, shapes, rays, hits)
            }
        }

        #[inline]
        fn occluded_each(
            self,
            scene: &$crate::Scene,
            shapes: &dyn $crate::Shapes,
            rays: &[straal_math::Ray],
            blocked: &mut [bool],
        ) {
            $(#[target_feature(enable = $feature)])?
            #[inline(never)] // its frame is large, and must not become part of its caller's
            fn compiled<K: $crate::kernel::Kernel>(
                kernel: K,
                scene: &$crate::Scene,
                shapes: &dyn $crate::Shapes,
                rays: &[straal_math::Ray],
                blocked: &mut [bool],
            ) {
                $crate::kernel::occluded_one_by_one(kernel, scene, shapes, rays, blocked);
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled(self, scene, shapes, rays, blocked)
            }
        }

        fn closest_slice(
            self,
            scene: &$crate::Scene,
            group: &$crate::scene::GroupData,
            shapes: &dyn $crate::Shapes,
            rays: &[straal_math::Ray],
            hits: &mut [$crate::Hit],
        ) {
            $(#[target_feature(enable = $feature)])?
            #[inline(never)] // its frame is large, and must not become part of its caller's
            fn compiled<K: $crate::kernel::Kernel>(
                kernel: K,
                scene: &$crate::Scene,
                group: &$crate::scene::GroupData,
                shapes: &dyn $crate::Shapes,
                rays: &[straal_math::Ray],
                hits: &mut [$crate::Hit],
            ) {
                $crate::kernel::closest_rays(kernel, scene, group, shapes, rays, hits);
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled(self, scene, group, shapes, rays, hits)
            }
        }

        fn occluded_slice(
            self,
            scene: &$crate::Scene,
            group: &$crate::scene::GroupData,
            shapes: &dyn $crate::Shapes,
            rays: &[straal_math::Ray],
            blocked: &mut [bool],
        ) {
            $(#[target_feature(enable = $feature)])?
            #[inline(never)] // its frame is large, and must not become part of its caller's
            fn compiled<K: $crate::kernel::Kernel>(
                kernel: K,
                scene: &$crate::Scene,
                group: &$crate::scene::GroupData,
                shapes: &dyn $crate::Shapes,
                rays: &[straal_math::Ray],
                blocked: &mut [bool],
            ) {
                $crate::kernel::occluded_rays(kernel, scene, group, shapes, rays, blocked);
            }
            // SAFETY: `self` is the proof that the processor has the features.
            #[allow(unused_unsafe)]
            unsafe {
                compiled(self, scene, group, shapes, rays, blocked)
            }
        }
    };
}
pub(crate) use entry_points;
