//! What follows from the list of cameras in [`super`].

/// From a list of cameras: the enum [`Camera`](super::Camera), the one place where its functions are sent to the kind's own
/// ([`Sees`](super::Sees)), and what the tests try. `of Kind` names what of a scene's cameras (`desc::Camera`) the kind is made from.
macro_rules! cameras {
    ($( $(#[doc = $doc:literal])+ $Kind:ident $(of $Described:ident)?, )+) => {
        /// A camera of a picture of known size.
        #[derive(Clone, Debug, PartialEq)]
        #[allow(clippy::large_enum_variant)] // a world has one
        pub enum Camera {
            $( $(#[doc = $doc])+ $Kind($Kind), )+
        }

        impl Camera {
            /// Of what a scene says, standing still.
            pub(crate) fn of(camera: &desc::Camera, setup: &Setup<'_>) -> Self {
                match camera {
                    $( $( desc::Camera::$Described(c) => $Kind::of(c, setup), )? )+
                }
            }

            /// The ray through a point of the film; `None` where nothing is seen.
            #[inline]
            pub fn ray(&self, at: &FilmPoint) -> Option<Ray> {
                match self { $( Self::$Kind(c) => c.ray(at), )+ }
            }

            /// The rays through points of the film, side by side.
            #[inline(always)]
            pub fn rays<F: Float>(&self, at: &FilmPoints<F>) -> CameraRays<F> {
                match self { $( Self::$Kind(c) => c.rays(at), )+ }
            }

            /// Whether [`Camera::shows`] is of use: a pinhole, a thin lens, a camera at infinity.
            pub fn can_show(&self) -> bool {
                match self { $( Self::$Kind(_) => <$Kind as Sees>::SHOWS, )+ }
            }

            /// Where a thing is seen through a place on the lens that a point of the unit square says; `None` where it is behind the camera, and for
            /// cameras that don't know.
            pub fn shows(&self, what: Sought, lens: [f32; 2]) -> Option<Shown> {
                match self { $( Self::$Kind(c) => c.shows(what, lens), )+ }
            }

            /// How the ray changes from the pixel to its neighbours, moment and place on the lens staying the same;
            /// [`Footprint::NONE`] where nothing is seen.
            pub fn footprint(&self, at: &FilmPoint) -> Footprint {
                match self { $( Self::$Kind(c) => c.footprint(at), )+ }
            }

            /// How much of a sample's red, green and blue the film takes. All of it, unless glasses are worn: this is said
            /// where light has become RGB, so that along the ray it stays four numbers of any meaning.
            pub fn glasses(&self, at: &FilmPoint) -> [f32; 3] {
                match self { $( Self::$Kind(c) => c.glasses(at), )+ }
            }

            /// Pixels to which a length on a plane at distance 1 is magnified, for cameras that magnify by distance alone.
            pub fn focal_pixels(&self) -> Option<f64> {
                match self { $( Self::$Kind(c) => c.focal_pixels(), )+ }
            }

            /// What of a sample's numbers it makes use of.
            pub fn needs(&self) -> Needs {
                match self { $( Self::$Kind(c) => c.needs(), )+ }
            }

            /// What follows from its settings; of two eyes, that of the left.
            pub fn facts(&self) -> Facts {
                match self { $( Self::$Kind(c) => c.facts(), )+ }
            }
        }

        /// What the tests try of every kind, by its name: cameras for pictures of this size that stand there.
        #[cfg(test)]
        fn registry(view: &View, size: [u32; 2]) -> Vec<(&'static str, Vec<(&'static str, Camera)>)> {
            vec![$( (stringify!($Kind), $Kind::examples(view, size)), )+]
        }
    };
}

pub(super) use cameras;
