//! What follows from the list of integrators in [`super`].

/// From a list of integrators: the enum [`AnyIntegrator`](super::AnyIntegrator) of those that a scene may ask for (`desc::Integrator`
/// has the same names), how each is made of what it says, and the one place where a driver that is compiled for each gets its own.
macro_rules! integrators {
    ($( $(#[doc = $doc:literal])+ $Kind:ident($Type:ty), )+) => {
        /// An integrator that a scene asks for.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum AnyIntegrator {
            $( $(#[doc = $doc])+ $Kind($Type), )+
        }

        impl AnyIntegrator {
            /// Of what a scene says.
            pub fn of(said: &desc::Integrator) -> Self {
                match said { $( desc::Integrator::$Kind { .. } => Self::$Kind(<$Type>::of(said)), )+ }
            }

            /// The name that a scene has for it.
            pub fn name(&self) -> &'static str {
                match self { $( Self::$Kind(_) => <$Type>::NAME, )+ }
            }

            /// See [`Integrator::SPLATS`].
            pub const fn splats(&self) -> bool {
                match self { $( Self::$Kind(_) => <$Type as Integrator>::SPLATS, )+ }
            }

            /// See [`Integrator::LIGHT_GROUPS`].
            pub const fn tells_light_groups(&self) -> bool {
                match self { $( Self::$Kind(_) => <$Type as Integrator>::LIGHT_GROUPS, )+ }
            }

            /// See [`Integrator::limit`].
            pub fn limit(&self) -> f32 {
                match self { $( Self::$Kind(i) => i.limit(), )+ }
            }

            /// See [`Integrator::misfit`].
            pub fn misfit(&self, world: &World) -> Option<String> {
                match self { $( Self::$Kind(i) => i.misfit(world), )+ }
            }

            /// See [`Integrator::limit_depth`].
            pub fn limit_depth(&mut self, edges: u32) {
                match self { $( Self::$Kind(i) => i.limit_depth(edges), )+ }
            }

            /// See [`Integrator::facts`].
            pub fn facts(&self) -> Vec<(&'static str, String)> {
                match self { $( Self::$Kind(i) => i.facts(), )+ }
            }

            /// Hands the integrator itself to who works with any.
            pub fn hand_to<W: WithIntegrator>(self, worker: W) -> W::Out {
                match self { $( Self::$Kind(i) => worker.with(i), )+ }
            }
        }
    };
}

pub(super) use integrators;
