//! What follows from the lists of kinds in [`super`].

/// From a list of BSDFs: the enum [`Bsdf`](super::Bsdf), the name of its kinds [`BsdfKind`](super::BsdfKind), the one place where
/// its functions are sent to the kind's own ([`Scatter`](super::Scatter)), and the registry of what the tests try.
macro_rules! bsdfs {
    ($( $(#[doc = $doc:literal])+ $Kind:ident($Type:ty), )+) => {
        /// How a point of a surface scatters. Where it shines is another's business.
        #[derive(Clone, Copy, Debug)]
        pub enum Bsdf<'w> {
            $( $(#[doc = $doc])+ $Kind($Type), )+
        }

        /// Which kind a BSDF is of: vertices of one kind are shaded together.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum BsdfKind {
            $( $(#[doc = $doc])+ $Kind, )+
        }

        impl BsdfKind {
            /// Hands the kind's own type to who works with any; that of all where a type of its own would gain nothing.
            #[inline]
            pub(crate) fn hand_to<'w>(self, worker: impl WithKind<'w>) {
                match self {
                    $( Self::$Kind if const { <$Type as Scatter>::SIDE_BY_SIDE } => worker.with::<$Type>(), )+
                    _ => worker.with::<Bsdf<'w>>(),
                }
            }

            /// All kinds, each at the place of its number.
            pub const ALL: &'static [Self] = &[$(Self::$Kind),+];
            /// How many.
            pub const COUNT: usize = Self::ALL.len();
        }

        $(
            impl<'w> OfKind<'w> for $Type {
                #[inline(always)]
                fn of<'a>(bsdf: &'a Bsdf<'w>) -> Option<&'a Self> {
                    if let Bsdf::$Kind(b) = bsdf { Some(b) } else { None }
                }
            }
        )+

        /// As its kind does.
        impl<'w> Scatter for Bsdf<'w> {
            #[inline]
            fn loses_below(&self) -> bool {
                match self { $( Self::$Kind(_) => <$Type as Scatter>::LOSES_BELOW, )+ }
            }

            #[inline]
            fn is_delta(&self) -> bool {
                match self { $( Self::$Kind(b) => b.is_delta(), )+ }
            }

            #[inline]
            fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Light, f32) {
                match self { $( Self::$Kind(b) => b.eval_pdf(wo, wi, transport), )+ }
            }

            #[inline]
            fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
                match self { $( Self::$Kind(b) => b.sample(wo, u_lobe, u, transport), )+ }
            }

            fn albedo(&self) -> Light {
                match self { $( Self::$Kind(b) => b.albedo(), )+ }
            }

            #[cfg(test)]
            fn examples() -> Vec<testing::Example> {
                let mut all = Vec::new();
                $( all.extend(<$Type as Scatter>::examples()); )+
                all
            }
        }

        impl<'w> Bsdf<'w> {
            /// Which kind it is of.
            #[inline(always)]
            pub fn kind(&self) -> BsdfKind {
                match self { $( Self::$Kind(_) => BsdfKind::$Kind, )+ }
            }

            /// f(wo, wi) |cos wi| and the density with which [`Self::sample`] draws `wi`, per solid angle; both without
            /// delta lobes.
            #[inline]
            pub fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Light, f32) {
                Scatter::eval_pdf(self, wo, wi, transport)
            }

            /// Draws a direction by numbers in [0, 1): `u_lobe` chooses a lobe, `u` where in it.
            #[inline]
            pub fn sample(
                &self,
                wo: Vec3,
                u_lobe: f32,
                u: [f32; 2],
                transport: Transport,
            ) -> Option<BsdfSample> {
                Scatter::sample(self, wo, u_lobe, u, transport)
            }

            /// Whether [`Self::sample`] reads the number that chooses a lobe.
            #[inline]
            pub fn chooses_lobe(&self) -> bool {
                match self { $( Self::$Kind(_) => <$Type as Scatter>::CHOOSES_LOBE, )+ }
            }

            /// Whether it has nothing but delta lobes: `eval` and `pdf` are 0 everywhere, asking lights is in vain.
            #[inline]
            pub fn is_delta(&self) -> bool {
                Scatter::is_delta(self)
            }

            /// Whether light from behind may come through by a lobe that isn't delta.
            #[inline]
            pub fn transmits(&self) -> bool {
                match self { $( Self::$Kind(b) => Scatter::transmits(b), )+ }
            }

            /// The share of ambient light that it sends back: a textbook's, see [`crate::light::ambient`].
            pub fn ambient(&self) -> Light {
                match self { $( Self::$Kind(b) => b.ambient(), )+ }
            }

            /// The colour of the surface, as denoisers and people want it: the share of light that comes back from the
            /// front, 1 for glass.
            pub fn albedo(&self) -> Light {
                Scatter::albedo(self)
            }
        }

        /// What the tests try of every kind.
        #[cfg(test)]
        impl<'w> Bsdf<'w> {
            fn registry() -> Vec<testing::Example> {
                <Self as Scatter>::examples()
            }
        }
    };
}

/// From a list of materials: the enum [`Material`](super::Material) (the scene's `desc::Material` has the same names), how each is
/// made of what the scene says and read at a point ([`Recipe`](super::Recipe)), and what the tests try.
macro_rules! materials {
    ($( $(#[doc = $doc:literal])+ $Kind:ident($Recipe:ty), )+) => {
        /// What a surface is made of.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Material {
            $( $(#[doc = $doc])+ $Kind($Recipe), )+
            /// A material of the library's user, by its place in [`Materials`].
            Custom(u32),
        }

        /// Black.
        impl Default for Material {
            fn default() -> Self {
                Self::Custom(u32::MAX)
            }
        }

        impl Material {
            /// Of what the scene says.
            pub(crate) fn of(described: &desc::Material, paint: &mut Paint<'_>) -> Self {
                match described { $( desc::Material::$Kind(d) => Self::$Kind(<$Recipe>::of(d, paint)), )+ }
            }

            /// What it must know of a point; of a user's, his material says it.
            fn wants(&self) -> Wants {
                match self {
                    $( Self::$Kind(m) => m.wants(), )+
                    Self::Custom(_) => Wants::default(),
                }
            }

            /// See [`Recipe::link`].
            pub(crate) fn link(&mut self, parts: &[u32]) {
                match self {
                    $( Self::$Kind(m) => m.link(parts), )+
                    Self::Custom(_) => {}
                }
            }

            /// The materials that it is made of.
            fn parts(&self) -> &[u32] {
                match self {
                    $( Self::$Kind(m) => m.parts(), )+
                    Self::Custom(_) => &[],
                }
            }

            /// Which of them it is at a point.
            #[inline]
            fn choice<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, in_front: bool) -> Choice {
                match self {
                    $( Self::$Kind(m) => m.choice(at, reading, in_front), )+
                    Self::Custom(_) => Choice::Itself,
                }
            }

            /// The share of light that doesn't pass through as if nothing were there, if that isn't all.
            fn opacity(&self) -> Option<Value<f32>> {
                match self {
                    $( Self::$Kind(m) => m.opacity(), )+
                    Self::Custom(_) => None,
                }
            }

            /// What it is filled with, if light goes through it into a medium.
            fn interior(&self) -> Option<&Interior> {
                match self {
                    $( Self::$Kind(m) => m.interior(), )+
                    Self::Custom(_) => None,
                }
            }

            /// What it sends out itself, if it shines.
            pub fn emission(&self) -> Option<Emission> {
                match self {
                    $( Self::$Kind(m) => m.emission(), )+
                    Self::Custom(_) => None,
                }
            }

            /// What of its emission gets out through its layers, by the cosine of the direction.
            pub fn lets_out<L: Lanes>(&self, cos: f32, at: &ShadingPoint, reading: &Reading<'_, L>) -> Light {
                match self {
                    $( Self::$Kind(m) => m.lets_out(cos, at, reading), )+
                    Self::Custom(_) => Light::ONE,
                }
            }

            /// Whether light passes through it.
            pub fn is_clear(&self) -> bool {
                match self {
                    $( Self::$Kind(m) => Recipe::is_clear(m), )+
                    Self::Custom(_) => false,
                }
            }

            /// How it scatters at a point; `None` of a user's.
            #[inline]
            fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Option<Bsdf<'w>> {
                Some(match self {
                    $( Self::$Kind(m) => m.bsdf(at, reading), )+
                    Self::Custom(_) => return None,
                })
            }
        }

        /// What the tests try of every kind, by its name.
        #[cfg(test)]
        fn recipes() -> Vec<(&'static str, Vec<testing::Reads>)> {
            vec![$( (
                stringify!($Kind),
                <$Recipe as Recipe>::examples().into_iter().map(|(m, kind)| (Material::$Kind(m), kind)).collect(),
            ), )+]
        }
    };
}

pub(super) use {bsdfs, materials};
