//! The weights that come with this crate.

use crate::{Network, Signal, WeightsError};

/// A set of weights of Open Image Denoise 2.5.1, by what its network sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Weights {
    /// Light with noisy albedo and normals.
    Guided,
    /// The same by half of the arithmetic.
    GuidedFast,
    /// Light with albedo and normals that have no noise.
    CleanGuided,
    /// Light alone, by half of the arithmetic.
    Light,
}

impl Weights {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Guided, Self::GuidedFast, Self::CleanGuided, Self::Light];

    /// Its name in Open Image Denoise, which is the name of its file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Guided => "rt_hdr_alb_nrm",
            Self::GuidedFast => "rt_hdr_alb_nrm_small",
            Self::CleanGuided => "rt_hdr_calb_cnrm",
            Self::Light => "rt_hdr_small",
        }
    }

    /// The archive as Intel publishes it.
    pub const fn archive(self) -> &'static [u8] {
        match self {
            Self::Guided => include_bytes!("../data/rt_hdr_alb_nrm.tza"),
            Self::GuidedFast => include_bytes!("../data/rt_hdr_alb_nrm_small.tza"),
            Self::CleanGuided => include_bytes!("../data/rt_hdr_calb_cnrm.tza"),
            Self::Light => include_bytes!("../data/rt_hdr_small.tza"),
        }
    }

    /// A network with these weights, made anew.
    pub fn network(self) -> Result<Network, WeightsError> {
        Network::from_archive(self.archive(), Signal::Light)
    }
}
