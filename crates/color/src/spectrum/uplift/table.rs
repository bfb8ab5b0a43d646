//! Smooth spectra of many colours at once, such as the pixels of pictures: by a table of coefficients, after Jakob and Hanika
//! (2019).
//!
//! There is a table for each channel that may be the strongest, over the other two as parts of it and over its own strength
//! from 1/2 to 1. Between nodes coefficients are interpolated by cubics. Darker colours are those of strength 1/2, scaled: so
//! are the spectra, which then stay smooth and need no nodes.

use super::nodes::{place_of_share, share};
use super::wide::{self, WideTable};
use super::{Smooth, Uplift, place};
use std::sync::LazyLock;
use straal_math::ops;

/// Nodes by each of the weaker channels, and by the strongest.
const SIDE: usize = 48;
const LEVELS: usize = 16;
const NODES: usize = 3 * LEVELS * SIDE * SIDE;

/// The strength of the first level.
const HALF: f32 = 0.5;

/// The table that `cargo xtask uplift-table` writes: for each strongest channel, level, and node of the second and of the
/// first of the channels that follow it in the circle, three coefficients as little-endian single floats; then the table of
/// wide colours.
static BYTES: &[u8] = include_bytes!("../../../data/uplift.bin");

static EMBEDDED: LazyLock<UpliftTable> = LazyLock::new(|| UpliftTable::read(BYTES));

/// Coefficients of smooth reflectances by colour.
#[derive(Clone, Debug, PartialEq)]
pub struct UpliftTable {
    nodes: Vec<[f32; 3]>,
    wide: WideTable,
}

/// A smooth spectrum: a reflectance times a factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lifted {
    coefficients: [f32; 3],
    base: f32,
    scale: f32,
}

impl Lifted {
    /// At a nanometre, from 0 for the first.
    #[inline]
    pub fn at(&self, bin: usize) -> f32 {
        let [a, b, c] = self.coefficients;
        let t = place(bin) as f32;
        let x = (a * t + b) * t + c;
        self.base + self.scale * (0.5 + 0.5 * x / (1.0 + x * x).sqrt())
    }
}

/// The strength of a level: dense towards 1, where coefficients grow without bound.
fn strength(level: usize) -> f64 {
    let rest = 1.0 - level as f64 / (LEVELS - 1) as f64;
    1.0 - f64::from(HALF) * rest * rest
}

/// The colour of a node, by its place in the table.
fn colour(node: usize) -> [f64; 3] {
    let (first, rest) = (node % SIDE, node / SIDE);
    let (second, rest) = (rest % SIDE, rest / SIDE);
    let (level, strongest) = (rest % LEVELS, rest / LEVELS);
    let most = strength(level);
    let mut rgb = [most; 3];
    rgb[(strongest + 1) % 3] = most * share(first, SIDE);
    rgb[(strongest + 2) % 3] = most * share(second, SIDE);
    rgb
}

/// Coefficients of a node. Greys have one alone; that of white is large, not infinite.
fn coefficients(uplift: &Uplift, node: usize) -> [f32; 3] {
    match uplift.fit(colour(node)) {
        Smooth::Sigmoid(c) => c.map(|v| v as f32),
        Smooth::Grey(v) => {
            let v = if v < 1.0 - 1e-6 { v } else { 1.0 - 1e-6 };
            [0.0, 0.0, ((v - 0.5) / (v * (1.0 - v)).sqrt()) as f32]
        }
    }
}

impl UpliftTable {
    /// The table of this library.
    pub fn embedded() -> &'static Self {
        &EMBEDDED
    }

    /// Bytes that the table of this library takes once it is used: in memory, and as it is kept in the program.
    pub const fn embedded_bytes() -> usize {
        2 * BYTES.len()
    }

    /// The bytes of the table, worked out anew: the same on every machine.
    pub fn made(uplift: &Uplift) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(12 * NODES + wide::BYTES);
        bytes.extend((0..NODES).flat_map(|node| coefficients(uplift, node)).flat_map(f32::to_le_bytes));
        bytes.append(&mut WideTable::made(uplift));
        bytes
    }

    fn read(bytes: &[u8]) -> Self {
        let (bytes, wide) = bytes.split_at(bytes.len().min(NODES * 12));
        let numbers = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b));
        let numbers: Vec<f32> = numbers.collect();
        let mut nodes = numbers.as_chunks::<3>().0.to_vec();
        nodes.resize(NODES, [0.0; 3]);
        Self { nodes, wide: WideTable::read(wide) }
    }

    /// Spectra of light that sRGB doesn't hold.
    pub fn wide(&self) -> &WideTable {
        &self.wide
    }

    /// The reflectance of linear sRGB, each channel brought to what is from 0 to 1.
    pub fn reflectance(&self, rgb: [f32; 3]) -> Lifted {
        let rgb = rgb.map(|v| if v > 0.0 { if v < 1.0 { v } else { 1.0 } } else { 0.0 });
        let least = rgb.iter().copied().fold(1.0, ops::min);
        if least <= HALF {
            return self.lift(rgb, 1.0);
        }
        // As far from white as the weakest channel is, over one half.
        let share = (1.0 - least) / HALF;
        if share == 0.0 {
            return Lifted { coefficients: [0.0; 3], base: 1.0, scale: 0.0 };
        }
        let lifted = self.lift(rgb.map(|v| ops::clamp(1.0 - (1.0 - v) / share, 0.0, 1.0)), 1.0);
        Lifted { base: 1.0 - share, scale: share * lifted.scale, ..lifted }
    }

    /// The spectrum of light of linear sRGB, to be multiplied by that of white; channels below 0 count as 0. It is the
    /// reflectance of a surface half as bright as the strongest channel, scaled.
    pub fn light(&self, rgb: [f32; 3]) -> Lifted {
        self.lift(rgb.map(|v| if v > 0.0 { v } else { 0.0 }), HALF)
    }

    /// The spectrum whose strength in the table is that of its strongest channel, or `most`.
    #[inline]
    fn lift(&self, rgb: [f32; 3], most: f32) -> Lifted {
        let strongest = if rgb[0] >= rgb[1] && rgb[0] >= rgb[2] {
            0
        } else if rgb[1] >= rgb[2] {
            1
        } else {
            2
        };
        let z = rgb[strongest];
        let (x, y) = (rgb[(strongest + 1) % 3], rgb[(strongest + 2) % 3]);
        if x == z && y == z {
            // The same at all wavelengths, to the last bit.
            return Lifted { coefficients: [0.0; 3], base: 0.0, scale: 2.0 * z };
        }
        let level = if z < most { z } else { most };
        let scale = if level > HALF { 1.0 } else { z / HALF };
        let (across, down) = (
            Stencil::new(place_of_share(x / z, SIDE), SIDE),
            Stencil::new(place_of_share(y / z, SIDE), SIDE),
        );
        let plane = |level: usize, weight: f32, sum: &mut [f32; 3]| {
            for (j, v) in down.weights.into_iter().enumerate() {
                let row = ((strongest * LEVELS + level) * SIDE + down.first + j) * SIDE + across.first;
                for (node, u) in self.nodes[row..row + 4].iter().zip(across.weights) {
                    for (sum, c) in sum.iter_mut().zip(node) {
                        *sum += weight * v * u * c;
                    }
                }
            }
        };
        let mut coefficients = [0.0; 3];
        if level <= HALF {
            plane(0, 1.0, &mut coefficients);
        } else {
            let up = Stencil::new((1.0 - ((1.0 - level) / HALF).sqrt()) * (LEVELS - 1) as f32, LEVELS);
            for (k, weight) in up.weights.into_iter().enumerate() {
                plane(up.first + k, weight, &mut coefficients);
            }
        }
        Lifted { coefficients, base: 0.0, scale }
    }
}

/// Four neighbouring nodes, and what each counts.
struct Stencil {
    first: usize,
    weights: [f32; 4],
}

impl Stencil {
    /// Around a place among so many nodes.
    #[inline]
    fn new(place: f32, nodes: usize) -> Self {
        let first = (place as usize).saturating_sub(1).min(nodes - 4);
        Self { first, weights: lagrange(place - first as f32) }
    }
}

/// Weights of values at 0, 1, 2 and 3 for the cubic through them at a place.
#[inline]
fn lagrange(t: f32) -> [f32; 4] {
    let (a, b, c) = (t - 1.0, t - 2.0, t - 3.0);
    [a * b * c * (-1.0 / 6.0), t * b * c * 0.5, t * a * c * -0.5, t * a * b * (1.0 / 6.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::COUNT;
    use crate::srgb;

    fn bins(lifted: Lifted) -> [f64; COUNT] {
        std::array::from_fn(|i| f64::from(lifted.at(i)))
    }

    #[test]
    fn the_table_is_small_and_as_it_is_made() {
        let bytes = NODES * 12 + wide::BYTES;
        assert!(BYTES.len() == bytes && BYTES.len() <= 2_000_000, "{} bytes", BYTES.len());
        let uplift = Uplift::new();
        for node in (0..NODES).step_by(997) {
            let own = UpliftTable::embedded().nodes[node];
            assert_eq!(own.map(f32::to_bits), coefficients(&uplift, node).map(f32::to_bits), "node {node}");
        }
        let (own, _) = BYTES[NODES * 12..].as_chunks::<16>();
        for node in (0..own.len()).step_by(97) {
            let made = wide::node(&uplift, node).map(f32::to_le_bytes);
            assert_eq!(own[node], *made.as_flattened(), "wide node {node}");
        }
    }

    /// The greatest difference in sRGB between a colour and that of the spectrum which the table gives it.
    #[test]
    fn colours_come_back() {
        let (uplift, table) = (Uplift::new(), UpliftTable::embedded());
        let mut state = 7_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1_u64 << 24) as f32
        };
        let mut worst = (0.0, [0.0; 3]);
        for k in 0..20_000 {
            // Codes of sRGB, a third of them with a channel that is 0 or full.
            let mut rgb = [random(), random(), random()].map(srgb::decode);
            if k % 3 == 0 {
                rgb[k / 3 % 3] = if k % 2 == 0 { 0.0 } else { 1.0 };
            }
            let lifted = bins(table.reflectance(rgb));
            assert!(lifted.iter().all(|v| (0.0..=1.0).contains(v)), "{rgb:?}");
            let back = uplift.rgb_of_reflectance(&lifted);
            for c in 0..3 {
                let error = (srgb::encode(back[c] as f32) - srgb::encode(rgb[c])).abs();
                if error > worst.0 {
                    worst = (error, rgb);
                }
            }
            // Light of ten times that is ten times as bright.
            let light = bins(table.light(rgb.map(|v| 10.0 * v)));
            let back = uplift.rgb_of_reflectance(&light).map(|v| v as f32 / 10.0);
            for c in 0..3 {
                let error = (srgb::encode(back[c]) - srgb::encode(rgb[c])).abs();
                worst = if error > worst.0 { (error, rgb) } else { worst };
            }
        }
        assert!(worst.0 < 1e-3, "{} at {:?}", worst.0, worst.1);
    }

    #[test]
    fn greys_are_even_and_black_is_black() {
        let table = UpliftTable::embedded();
        for v in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let grey = table.reflectance([v; 3]);
            assert!((0..COUNT).all(|i| grey.at(i) == v), "{v}: {grey:?}");
        }
        assert!(table.light([0.0, -1.0, f32::NAN]).at(100) == 0.0);
        assert!(table.light([1e30, 1e-30, 5.0]).at(300).is_finite());
        // Neighbouring colours have neighbouring spectra, also where another channel becomes the strongest.
        for (a, b) in [([0.7, 0.69999, 0.2], [0.69999, 0.7, 0.2]), ([0.50001, 0.1, 0.3], [0.49999, 0.1, 0.3])]
        {
            let (a, b) = (bins(table.reflectance(a)), bins(table.reflectance(b)));
            let apart = a.iter().zip(b).map(|(a, b)| ops::max((a - b).abs() as f32, 0.0)).fold(0.0, ops::max);
            assert!(apart < 1e-3, "{apart}");
        }
    }
}
