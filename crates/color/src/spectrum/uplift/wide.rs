//! Smooth spectra of light that sRGB doesn't hold, such as pixels of pictures in wider spaces.
//!
//! Light has no limit, so that of its colour only the chromaticity matters: there is a table for each channel of ACEScg that
//! may be the strongest, over the other two as parts of it. Each node has a spectrum of its own, found as [`Uplift::reach_light`]
//! finds it. Spectra of one cell's corners are mixed in proportion to how near they are, and colours follow suit, since light
//! adds up: a mixture has the very colour that was asked for, however coarse the table. Only nodes at the edge of ACEScg, some
//! of which are no colours of light, are themselves off.

use super::nodes::{place_of_share, share};
use super::{Smooth, Uplift, place};
use crate::{Matrix3, Space};

/// Nodes by each of the weaker channels.
const SIDE: usize = 32;

/// Nodes in all.
const NODES: usize = 3 * SIDE * SIDE;

/// Bytes of the table: four little-endian single floats a node.
pub(super) const BYTES: usize = 16 * NODES;

/// A spectrum, to be multiplied by that of white: three coefficients, highest power first, and a factor.
type Node = [f32; 4];

/// Spectra of light by colour.
#[derive(Clone, Debug, PartialEq)]
pub struct WideTable {
    nodes: Vec<Node>,
    /// From linear sRGB to ACEScg.
    there: Matrix3,
}

/// The spectrum of light of a wide colour: a mixture of four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WideLight {
    parts: [Node; 4],
}

impl WideLight {
    /// At a nanometre, from 0 for the first.
    #[inline]
    pub fn at(&self, bin: usize) -> f32 {
        let t = place(bin) as f32;
        let mut sum = 0.0;
        for [a, b, c, factor] in self.parts {
            let x = (a * t + b) * t + c;
            sum += factor * (0.5 + 0.5 * x / (1.0 + x * x).sqrt());
        }
        sum
    }
}

/// The colour of a node in ACEScg, by its place in the table.
fn colour(node: usize) -> [f64; 3] {
    let (first, second, strongest) = (node % SIDE, node / SIDE % SIDE, node / (SIDE * SIDE));
    let mut rgb = [1.0; 3];
    rgb[(strongest + 1) % 3] = share(first, SIDE);
    rgb[(strongest + 2) % 3] = share(second, SIDE);
    rgb
}

/// The spectrum of a node.
pub(super) fn node(uplift: &Uplift, node: usize) -> Node {
    let rgb = Space::AcesCg.to(Space::Srgb).apply(colour(node));
    let (smooth, scale) = uplift.reach_light(rgb).unwrap_or_else(|nearest| nearest);
    match smooth {
        Smooth::Sigmoid([a, b, c]) => [a, b, c, scale].map(|v| v as f32),
        Smooth::Grey(v) => [0.0, 0.0, 0.0, (2.0 * v * scale) as f32],
    }
}

impl WideTable {
    /// The bytes of the table, worked out anew.
    pub(super) fn made(uplift: &Uplift) -> Vec<u8> {
        (0..NODES).flat_map(|k| node(uplift, k)).flat_map(f32::to_le_bytes).collect()
    }

    pub(super) fn read(bytes: &[u8]) -> Self {
        let numbers = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b));
        let numbers: Vec<f32> = numbers.collect();
        let mut nodes = numbers.as_chunks::<4>().0.to_vec();
        nodes.resize(NODES, [0.0; 4]);
        Self { nodes, there: Space::Srgb.to(Space::AcesCg) }
    }

    /// The spectrum of light of linear sRGB, of which channels may be below 0; what ACEScg doesn't hold is brought to its edge.
    pub fn light(&self, rgb: [f32; 3]) -> WideLight {
        let rgb = self.there.apply_f32(rgb).map(|v| if v > 0.0 { v } else { 0.0 });
        let strongest = if rgb[0] >= rgb[1] && rgb[0] >= rgb[2] {
            0
        } else if rgb[1] >= rgb[2] {
            1
        } else {
            2
        };
        let z = rgb[strongest];
        if z <= 0.0 {
            return WideLight { parts: [[0.0; 4]; 4] };
        }
        let (left, x) = cell(rgb[(strongest + 1) % 3] / z);
        let (low, y) = cell(rgb[(strongest + 2) % 3] / z);
        let part = |across: usize, down: usize, weight: f32| {
            let [a, b, c, factor] = self.nodes[(strongest * SIDE + low + down) * SIDE + left + across];
            [a, b, c, factor * weight * z]
        };
        WideLight {
            parts: [
                part(0, 0, (1.0 - x) * (1.0 - y)),
                part(1, 0, x * (1.0 - y)),
                part(0, 1, (1.0 - x) * y),
                part(1, 1, x * y),
            ],
        }
    }
}

/// The node below a share, and how far the share is from its share to that of the next.
#[inline]
fn cell(of: f32) -> (usize, f32) {
    let below = (place_of_share(of, SIDE) as usize).min(SIDE - 2);
    let (from, to) = (share(below, SIDE) as f32, share(below + 1, SIDE) as f32);
    (below, (of - from) / (to - from))
}

#[cfg(test)]
mod tests {
    use super::super::UpliftTable;
    use super::*;
    use crate::spectrum::COUNT;
    use straal_math::ops;

    /// How far light of a colour of some space is from it in linear sRGB, over its strongest channel.
    fn error(uplift: &Uplift, space: Space, rgb: [f64; 3]) -> f64 {
        let want = space.to(Space::Srgb).apply(rgb);
        let light = UpliftTable::embedded().wide().light(want.map(|v| v as f32));
        let got = uplift.rgb_of_reflectance(&std::array::from_fn(|i| f64::from(light.at(i))));
        let most = want.iter().fold(0.0, |a: f64, &v| if v > a { v } else { a });
        let differences = got.iter().zip(want).map(|(a, b)| (a - b).abs() as f32);
        f64::from(differences.fold(0.0, ops::max)) / most
    }

    #[test]
    fn wide_colours_come_back() {
        let uplift = Uplift::new();
        let mut state = 3_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1_u64 << 24) as f64
        };
        // Purest colours of the spaces are at the very limit of what light can be, or beyond; others are met.
        for (space, purest, within) in
            [(Space::DisplayP3, 0.0, 4e-3), (Space::Rec2020, 0.0, 6e-3), (Space::AcesCg, 0.05, 1e-3)]
        {
            for k in 0..3000 {
                let mut rgb = [random(), random(), random()];
                if k % 2 == 0 {
                    rgb[k / 2 % 3] = 0.0;
                }
                let rgb = rgb.map(|v| 30.0 * (purest + (1.0 - purest) * v));
                let error = error(&uplift, space, rgb);
                assert!(error < within, "{space:?} {rgb:?}: {error}");
            }
        }
    }

    #[test]
    fn what_is_no_light_is_black_or_near() {
        let table = UpliftTable::embedded().wide();
        for rgb in [[0.0; 3], [-1.0; 3], [f32::NAN; 3], [-0.5, -1e-3, -2.0]] {
            assert!((0..COUNT).all(|i| table.light(rgb).at(i) == 0.0), "{rgb:?}");
        }
        // Purer than any light.
        let light = table.light([-10.0, 1.0, -10.0]);
        assert!((0..COUNT).all(|i| light.at(i) >= 0.0 && light.at(i).is_finite()));
        let huge = table.light([1e30, -1e29, 1e28]);
        assert!((0..COUNT).all(|i| huge.at(i).is_finite()));
    }

    /// Where sRGB ends, its own table and this one give nearly the same spectrum.
    #[test]
    fn spectra_do_not_jump_where_srgb_ends() {
        let table = UpliftTable::embedded();
        for rgb in [[0.0, 0.7, 0.3], [0.9, 0.0, 0.4], [0.6, 0.5, 0.0], [0.0, 0.2, 0.9]] {
            let (inside, outside) = (table.light(rgb), table.wide().light(rgb));
            let bins: Vec<[f32; 2]> = (0..COUNT).map(|i| [inside.at(i), outside.at(i)]).collect();
            let apart = bins.iter().map(|[a, b]| (a - b).abs()).sum::<f32>();
            let all = bins.iter().map(|[a, _]| a).sum::<f32>();
            assert!(apart < 0.08 * all, "{rgb:?}: {}", apart / all);
        }
    }
}
