//! What follows from the list of textures in [`super`].

/// From a list of textures: the enum [`TextureKind`](super::TextureKind) (the scene's `desc::Texture` has the same names), how each is
/// made of what a scene says, the one place where its functions are sent to the kind's own ([`Pattern`](super::Pattern)), and what
/// the tests try.
macro_rules! textures {
    ($( $(#[doc = $doc:literal])+ $Kind:ident($Type:ty), )+) => {
        /// What a texture has where.
        #[derive(Clone, Debug)]
        pub enum TextureKind {
            $( $(#[doc = $doc])+ $Kind($Type), )+
            /// That of a user of the library.
            Custom(Arc<dyn CustomTexture>),
        }

        impl TextureKind {
            /// Of what a scene says, whose parts `make` makes.
            pub(crate) fn of(said: &desc::Texture, make: &mut dyn Maker) -> Self {
                match said { $( desc::Texture::$Kind(d) => Self::$Kind(<$Type>::of(d, make)), )+ }
            }

            /// Light at a point, or a share of it.
            pub fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, of: Use) -> Light {
                match self {
                    $( Self::$Kind(t) => t.light(at, reading, of), )+
                    Self::Custom(t) => of.read(t.rgb(at), reading),
                }
            }

            /// A number at a point.
            pub fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
                match self {
                    $( Self::$Kind(t) => t.number(at, reading), )+
                    Self::Custom(t) => t.number(at),
                }
            }

            /// The largest number or lane that it has anywhere; of a user's it isn't known, and taken as 1.
            pub(crate) fn most(&self) -> f32 {
                match self {
                    $( Self::$Kind(t) => t.most(), )+
                    Self::Custom(_) => 1.0,
                }
            }
        }

        /// What the tests try of every kind, by its name.
        #[cfg(test)]
        fn registry() -> Vec<(&'static str, Vec<TextureKind>)> {
            vec![$( (stringify!($Kind), <$Type as Pattern>::examples().into_iter().map(TextureKind::$Kind).collect()), )+]
        }
    };
}

pub(super) use textures;
