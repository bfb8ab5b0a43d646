//! Statistical tests that samplers of directions meet: does what is drawn have the density that is told? And what benches ask.
//!
//! For the tests of this crate and of its users; nothing that renders depends on it.

mod blocks;
mod chi_square;
mod gamma;
mod sphere;
#[cfg(test)]
mod warps;

pub use blocks::Shaded;
pub use chi_square::{ChiSquare, Outcome};
pub use gamma::{chi_square_p, gamma_q, ln_gamma};
pub use sphere::SphereGrid;

/// The level at which each of `tests` independent tests is to be judged for all of them together to fail with
/// probability `level` when there is nothing to find (Šidák 1967).
pub fn sidak(level: f64, tests: usize) -> f64 {
    1.0 - straal_math::ops::pow_d(1.0 - level, 1.0 / tests.max(1) as f64)
}

/// How a path reads colours in RGB, where no world is at hand.
pub fn in_rgb() -> crate::texture::Reading<'static, crate::lanes::Rgb> {
    static EMPTY: std::sync::LazyLock<crate::lanes::SpectralTables> =
        std::sync::LazyLock::new(Default::default);
    crate::texture::Reading {
        tables: &EMPTY,
        lanes: crate::lanes::Rgb::default(),
        textures: &[],
        meshes: &[],
    }
}
