//! What a file of a BSDF or material gives to be tested.

use super::{Bsdf, BsdfKind, DispersiveDielectric, Material, Metal};
use crate::lanes::{Carried, EtaTable, SpectralTables};
use std::sync::LazyLock;
use straal_color::spectrum::refraction::{Glass, Index};
use straal_color::{Light, Space};

/// A BSDF to be put through every test of the contract.
pub(crate) struct Example {
    pub name: &'static str,
    pub bsdf: Bsdf<'static>,
    /// 1 for those without lobes; more makes the cells smaller about the mirror direction.
    pub focus: i32,
    /// The share of light that comes back in the first lane, where the model promises one for all angles.
    pub albedo: Option<f64>,
    /// Whether f stays the same when its directions are exchanged.
    pub is_reciprocal: bool,
    /// Whether no more comes out than goes in.
    pub keeps_energy: bool,
    /// How far from all the light that comes back may be, for one that promises all of it but for its tables.
    pub whole_within: Option<f64>,
    /// Whether values are right on average only.
    pub is_noisy: bool,
    /// Whether light passes through it.
    pub passes: bool,
    /// Whether energy is kept for each direction to the viewer alone, not for each direction of a light as well: what light paths see is the
    /// adjoint.
    pub of_radiance: bool,
    /// By how much more may come out than goes in: the error of fits and tables.
    pub gain: f64,
}

impl Example {
    /// One without sharp lobes that promises no albedo.
    pub const fn new(name: &'static str, bsdf: Bsdf<'static>) -> Self {
        Self {
            name,
            bsdf,
            focus: 1,
            albedo: None,
            is_reciprocal: true,
            keeps_energy: true,
            whole_within: None,
            is_noisy: false,
            passes: false,
            of_radiance: false,
            gain: 1e-3,
        }
    }

    pub const fn albedo(self, share: f64) -> Self {
        Self { albedo: Some(share), ..self }
    }

    /// One whose directions mean different things, as its page says.
    pub const fn one_way(self) -> Self {
        Self { is_reciprocal: false, ..self }
    }

    /// One that may send back more light than arrives, as its page says.
    pub const fn gives_energy(self) -> Self {
        Self { keeps_energy: false, ..self }
    }

    /// One that sends back all light, within a part of it.
    pub const fn nearly_energy(self, within: f64) -> Self {
        Self { whole_within: Some(within), ..self }
    }

    /// One whose values are right on average only.
    pub const fn noisy(self) -> Self {
        Self { is_noisy: true, ..self }
    }

    pub const fn passes(self) -> Self {
        Self { passes: true, ..self }
    }

    /// One that keeps energy for each direction to the viewer alone.
    pub const fn of_radiance(self) -> Self {
        Self { of_radiance: true, ..self }
    }

    pub const fn gain(self, gain: f64) -> Self {
        Self { gain, ..self }
    }

    pub const fn focus(self, focus: i32) -> Self {
        Self { focus, ..self }
    }
}

/// A material, and the kind of BSDF as which it is read.
pub(crate) type Reads = (Material, BsdfKind);

pub(super) const WHITE: Light = Light([1.0, 1.0, 1.0, 0.0]);

/// Gold, tinted.
pub(super) fn gold() -> Metal {
    let [eta, k] = [[0.2, 0.92, 1.1], [3.91, 2.45, 2.14]].map(Light::rgb);
    Metal { eta, k, reflectance: Light::rgb([0.9, 0.8, 0.7]) }
}

/// A conductor of index 0 reflects everything.
pub(super) fn lossless() -> Metal {
    Metal { eta: Light::ZERO, k: Light::ZERO, reflectance: WHITE }
}

/// Flint glass in air.
pub(super) fn flint(carried: Carried) -> Bsdf<'static> {
    static FLINT: LazyLock<(EtaTable, SpectralTables)> = LazyLock::new(|| {
        let mut tables = SpectralTables::default();
        tables.prepare_dispersion(Space::Srgb);
        (EtaTable::new(&Glass::named("SF11").expect("a glass").index(), &Index::Constant(1.0)), tables)
    });
    let (eta, tables) = &*FLINT;
    let lanes = if matches!(carried, Carried::Four(_)) { Light::ONE } else { WHITE };
    Bsdf::DispersiveDielectric(DispersiveDielectric {
        by: 1.0,
        eta,
        tables,
        carried: carried.packed(),
        reflectance: lanes,
        transmittance: lanes,
    })
}
