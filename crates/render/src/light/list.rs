//! What follows from the list of emitters in [`super`].

/// From a list of emitters: the enum [`Emitter`](super::Emitter), the one place where its functions are sent to the kind's own
/// ([`Shine`](super::Shine)), and what the tests try. `of Kind` names what of a scene's lights (`desc::Light`) the kind is made from.
macro_rules! emitters {
    ($( $(#[doc = $doc:literal])+ $Kind:ident($Type:ty) $(of $Described:ident)?, )+) => {
        /// One thing that shines. (`Light` is the four numbers that it sends.)
        #[derive(Clone, Debug)]
        pub enum Emitter {
            $( $(#[doc = $doc])+ $Kind($Type), )+
        }

        impl Emitter {
            /// Of a light that a scene describes; `centre` of the description is the world's origin.
            pub(crate) fn of(light: &desc::Light, paint: &mut Paint<'_>, centre: DVec3) -> Self {
                match light {
                    $( $( desc::Light::$Described(l) => <$Type>::of(l, paint, centre), )? )+
                }
            }

            /// A direction from a place towards the light; `u` uniform in the unit square. Surroundings leave out what is
            /// behind the surface.
            #[inline]
            pub fn sample<L: Lanes>(
                &self,
                geometry: &Geometry,
                at: &Receiver,
                u: [f32; 2],
                reading: &Reading<'_, L>,
            ) -> Option<LightSample> {
                match self { $( Self::$Kind(l) => Shine::sample(l, geometry, (at, u), reading), )+ }
            }

            /// A ray that leaves it, into a scene that the ball holds; `u` uniform in the unit cube of four dimensions. `None` where nothing
            /// comes of it.
            pub fn emit<L: Lanes>(
                &self,
                geometry: &Geometry,
                ball: &Ball,
                u: [f32; 4],
                reading: &Reading<'_, L>,
            ) -> Option<Emitted> {
                match self { $( Self::$Kind(l) => Shine::emit(l, geometry, ball, u, reading), )+ }
            }

            /// [`Emitter::sample`] for many places side by side.
            #[inline(always)]
            pub(crate) fn sample_many<F: Float, L: Lanes>(
                &self,
                geometry: &Geometry,
                at: &Receiver<F>,
                u: [F; 2],
                readings: &Readings<'_, L>,
            ) -> LightSample<F> {
                match self { $( Self::$Kind(l) => Shine::sample_many(l, geometry, (at, u), readings), )+ }
            }

            /// [`Emitter::radiance_from`] for many directions side by side.
            #[inline(always)]
            pub(crate) fn radiance_from_many<F: Float, L: Lanes>(
                &self,
                wi: Vec3<F>,
                readings: &Readings<'_, L>,
            ) -> Light<F> {
                match self { $( Self::$Kind(l) => Shine::radiance_from_many(l, wi, readings), )+ }
            }

            /// [`Emitter::radiance_pdf_from`] for many directions side by side.
            #[inline(always)]
            pub(crate) fn radiance_pdf_from_many<F: Float, L: Lanes>(
                &self,
                at: &Receiver<F>,
                wi: Vec3<F>,
                readings: &Readings<'_, L>,
            ) -> (Light<F>, F) {
                match self { $( Self::$Kind(l) => Shine::radiance_pdf_from_many(l, at, wi, readings), )+ }
            }

            /// The radiance that a point of an emitting surface sends in the unit direction `wo`; 0 for all other lights.
            #[inline]
            pub fn radiance_at<L: Lanes>(&self, hit: &SurfacePoint, wo: Vec3, reading: &Reading<'_, L>) -> Light {
                match self { $( Self::$Kind(l) => Shine::radiance_at(l, hit, wo, reading), )+ }
            }

            /// The density by solid angle with which [`Emitter::sample`] at a place gives the direction to `hit`, a point of
            /// this emitting surface (on triangle `primitive`, when that is a mesh); 0 for all other lights.
            #[inline]
            pub fn pdf_at(&self, geometry: &Geometry, at: &Receiver, primitive: u32, hit: &SurfacePoint) -> f32 {
                match self { $( Self::$Kind(l) => Shine::pdf_at(l, geometry, at, (primitive, hit)), )+ }
            }

            /// The radiance that arrives from the unit direction `wi`, from beyond everything; 0 but for environments.
            #[inline]
            pub fn radiance_from<L: Lanes>(&self, wi: Vec3, reading: &Reading<'_, L>) -> Light {
                match self { $( Self::$Kind(l) => Shine::radiance_pdf_from(l, &Receiver::anywhere(Vec3::ZERO), wi, reading).0, )+ }
            }

            /// The density by solid angle with which [`Emitter::sample`] gives `wi` to a surface of normal `n`, zero where it
            /// isn't known; 0 but for environments.
            #[inline]
            pub fn pdf_from(&self, at: &Receiver, wi: Vec3) -> f32 {
                match self { $( Self::$Kind(l) => Shine::pdf_from(l, at, wi), )+ }
            }

            /// [`Emitter::radiance_from`] and [`Emitter::pdf_from`] at once.
            #[inline]
            pub fn radiance_pdf_from<L: Lanes>(
                &self,
                at: &Receiver,
                wi: Vec3,
                reading: &Reading<'_, L>,
            ) -> (Light, f32) {
                match self { $( Self::$Kind(l) => Shine::radiance_pdf_from(l, at, wi, reading), )+ }
            }

            /// Whether the light is all around: what a ray that hits nothing sees.
            pub fn is_environment(&self) -> bool {
                match self {
                    $( Self::$Kind(_) => matches!(<$Type as Shine>::EXTENT, Extent::Around | Extent::Disc), )+
                }
            }

            /// Whether the light is all around and shines from one part of it as a lamp does.
            pub fn is_disc(&self) -> bool {
                match self { $( Self::$Kind(_) => <$Type as Shine>::EXTENT == Extent::Disc, )+ }
            }

            /// Whether the light comes from nowhere, see [`AmbientLight`].
            pub fn is_ambient(&self) -> bool {
                match self { $( Self::$Kind(_) => <$Type as Shine>::EXTENT == Extent::Nowhere, )+ }
            }

            /// Whether the light has no extent, so that only sampling finds it.
            pub fn is_delta(&self) -> bool {
                match self { $( Self::$Kind(_) => <$Type as Shine>::EXTENT == Extent::None, )+ }
            }

            /// Whether its light comes from infinitely far away: neither from a surface nor from a point.
            pub fn is_from_afar(&self) -> bool {
                match self {
                    $( Self::$Kind(l) => match <$Type as Shine>::EXTENT {
                        Extent::Around | Extent::Disc => true,
                        Extent::None => l.starts_at().is_none(),
                        Extent::Surface | Extent::Nowhere => false,
                    }, )+
                }
            }

            /// An estimate of the power in W that the light sends into a scene of the given radius, by its strongest
            /// lane. 0 for a light that can't be sampled.
            pub fn power(&self, geometry: &Geometry, scene_radius: f64) -> f64 {
                self.power_over(geometry, std::f64::consts::PI * scene_radius * scene_radius)
            }

            /// The same by the area of the scene's disc.
            fn power_over(&self, geometry: &Geometry, disc: f64) -> f64 {
                match self { $( Self::$Kind(l) => Shine::power(l, geometry, disc), )+ }
            }

            /// What is known of it for [`Reach::estimate`]; `None` for a light that isn't sampled.
            fn reach(&self, geometry: &Geometry) -> Option<Reach> {
                match self { $( Self::$Kind(l) => Shine::reach(l, geometry), )+ }
            }
        }

        /// What the tests try of every kind, by its name.
        #[cfg(test)]
        fn registry() -> Vec<(&'static str, Vec<tests::Example>)> {
            vec![$( (stringify!($Kind), <$Type as Shine>::examples()), )+]
        }
    };
}

pub(super) use emitters;
