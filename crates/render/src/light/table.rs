//! The choice of an emitter.

use straal_math::table::Table1;

use super::Emitter;
use crate::shape::Geometry;

/// Picks an emitter to sample: half of the time any that shines, evenly, and half in proportion to an estimate of its
/// power. The first half bounds the damage where the estimate is wrong (a strong lamp behind a wall); black lights are
/// never picked.
#[derive(Clone, Debug)]
pub struct LightTable {
    table: Option<Table1>,
    /// The emitter, where no other shines.
    only: Option<u32>,
}

/// A chosen emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// Which.
    pub index: u32,
    /// With which probability, above 0.
    pub pmf: f32,
    /// What is left of the number that chose: uniform in [0, 1) again.
    pub rest: f32,
}

impl LightTable {
    /// A table of all emitters of a scene of the given radius in m.
    pub fn new(emitters: &[Emitter], geometry: &Geometry, scene_radius: f64) -> Self {
        let powers: Vec<f64> = emitters
            .iter()
            .map(|e| e.power(geometry, scene_radius))
            .map(|w| if w > 0.0 && w.is_finite() { w } else { 0.0 })
            .collect();
        let shining = powers.iter().filter(|&&w| w > 0.0).count() as f64;
        let total: f64 = powers.iter().sum();
        let weight = |w: &f64| if *w > 0.0 { (0.5 / shining + 0.5 * (w / total)) as f32 } else { 0.0 };
        let table = Table1::new(&powers.iter().map(weight).collect::<Vec<_>>());
        let only = powers.iter().position(|&w| w > 0.0).filter(|_| shining == 1.0).map(|i| i as u32);
        Self { table, only }
    }

    /// The pick that needs no number, where a single emitter shines; its `rest` is 0.
    #[inline]
    pub fn only(&self) -> Option<Pick> {
        self.only.map(|index| Pick { index, pmf: 1.0, rest: 0.0 })
    }

    /// Picks by `u` in [0, 1); `None` when nothing shines.
    #[inline]
    pub fn pick(&self, u: f32) -> Option<Pick> {
        let choice = self.table.as_ref()?.sample(u);
        Some(Pick { index: choice.index as u32, pmf: choice.pmf, rest: choice.rest })
    }

    /// The probability with which an emitter is picked.
    #[inline]
    pub fn pmf(&self, index: u32) -> f32 {
        self.table.as_ref().map_or(0.0, |t| t.pmf(index as usize))
    }
}
