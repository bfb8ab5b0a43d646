//! What follows from the list of shapes in [`super`].

/// From a list of shapes: the enum [`Shape`](super::Shape), the one place where what is asked of a
/// [`Geometry`](super::Geometry) is sent to the kind's own answer ([`Form`](super::Form)), and what the tests try.
macro_rules! shapes {
    ($( $(#[doc = $doc:literal])+ $Kind:ident($Held:ty), )+) => {
        /// One shape. Large ones are boxed, so that a sphere takes 40 bytes.
        #[derive(Clone, Debug)]
        pub enum Shape {
            $( $(#[doc = $doc])+ $Kind($Held), )+
            /// A shape of the library's user: index into [`Geometry::custom`].
            Custom(u32),
        }

        impl Geometry {
            /// A box that holds the shape; `None` when it is unbounded.
            pub fn bounds(&self, shape: u32) -> Option<Bounds> {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::bounds(s), )+
                    Shape::Custom(i) => self.custom[*i as usize].bounds(),
                }
            }

            /// The nearest hit in the ray's interval.
            #[inline]
            pub fn intersect(&self, shape: u32, ray: &Ray) -> Option<ShapeHit> {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::intersect(s, ray), )+
                    Shape::Custom(i) => self.custom[*i as usize].intersect(ray),
                }
            }

            /// The formula by which the shape is intersected, many at a time; `None` for one without.
            #[inline]
            pub fn analytic(&self, shape: u32) -> Option<Analytic> {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::analytic(s), )+
                    Shape::Custom(_) => None,
                }
            }

            /// The surface where [`Geometry::intersect`] found `hit` on this very ray.
            #[inline]
            pub fn surface(&self, shape: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::surface(s, ray, hit), )+
                    Shape::Custom(i) => self.custom[*i as usize].surface(ray, hit),
                }
            }

            /// Where on the shape rays have arrived, side by side: the points of [`Geometry::surface`] by the points at the hits' distances
            /// along the rays. `None` where the shape's surface is computed one by one.
            #[inline(always)]
            pub(crate) fn end<F: Float>(&self, shape: u32, near: DVec3<F::Double>) -> Option<End<F>> {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::end(s, near), )+
                    Shape::Custom(_) => None,
                }
            }

            /// How a point that [`Geometry::surface`] gave moves with its texture coordinates.
            pub fn tangents(&self, shape: u32, at: &SurfacePoint) -> Tangents {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::tangents(s, at), )+
                    Shape::Custom(i) => self.custom[*i as usize].tangents(at),
                }
            }

            /// Surface area (one side); `None` when the shape can't be sampled: planes and custom shapes.
            pub fn area(&self, shape: u32) -> Option<f32> {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::area(s), )+
                    Shape::Custom(_) => None,
                }
            }

            /// A point of the shape; `u` uniform in the unit square.
            #[inline]
            pub fn sample_area(&self, shape: u32, u: [f32; 2]) -> Option<AreaSample> {
                let sample = match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::sample_area(s, u), )+
                    Shape::Custom(_) => None,
                };
                sample.filter(|s| s.pdf_area > 0.0 && s.pdf_area.is_finite())
            }

            /// A direction from `p` towards the shape; `u` uniform in the unit square.
            #[inline]
            pub fn sample_from(&self, shape: u32, p: Vec3, u: [f32; 2]) -> Option<DirSample> {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::sample_from(s, p, u), )+
                    Shape::Custom(_) => None,
                }
            }

            /// [`Geometry::sample_from`] for a surface at `p` of a unit normal, zero where light from all around counts alike: shapes may draw more of what falls
            /// on it steeply.
            #[inline]
            pub fn sample_lit(&self, shape: u32, at: (Vec3, Vec3), u: [f32; 2]) -> Option<DirSample> {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::sample_lit(s, at, u), )+
                    Shape::Custom(_) => None,
                }
            }

            /// [`Geometry::sample_lit`] for many side by side.
            #[inline(always)]
            pub(crate) fn sample_lit_many<F: Float>(&self, shape: u32, at: (Vec3<F>, Vec3<F>), u: [F; 2]) -> DirSamples<F> {
                // Compiled once, not for each way to read colours.
                F::vectorize(
                    #[inline(always)]
                    || match &self.shapes[shape as usize] {
                        $( Shape::$Kind(s) => <$Kind as Form>::sample_lit_many(s, at, u), )+
                        Shape::Custom(_) => DirSamples::one_by_one(F::Mask::splat(false), |_| None),
                    },
                )
            }

            /// The density of [`Geometry::sample_lit`], as [`Geometry::pdf_from`].
            pub fn pdf_lit(&self, shape: u32, at: (Vec3, Vec3), hit: &SurfacePoint) -> f32 {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::pdf_lit(s, at, hit), )+
                    Shape::Custom(_) => 0.0,
                }
            }

            /// The density with which [`Geometry::sample_from`] at `p` gives the direction to `hit`, a point of the shape
            /// that is seen from `p`.
            pub fn pdf_from(&self, shape: u32, p: Vec3, hit: &SurfacePoint) -> f32 {
                match &self.shapes[shape as usize] {
                    $( Shape::$Kind(s) => <$Kind as Form>::pdf_from(s, p, hit), )+
                    Shape::Custom(_) => 0.0,
                }
            }
        }

        /// What the tests try of every kind, by its name.
        #[cfg(test)]
        fn registry(stand: &tests::Setting) -> Vec<(&'static str, Vec<tests::Example>)> {
            vec![$( (stringify!($Kind), <$Kind as Form>::examples(stand)), )+]
        }
    };
}

pub(super) use shapes;
