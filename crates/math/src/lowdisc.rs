//! Named samples: every random number is a pure function of (seed, pixel, sample index, path node, purpose).
//!
//! [`SampleName`] holds what the draws of one path vertex share, hashed once; a [`Pattern`] turns it and a
//! [`Purpose`] into one, two or four numbers. Nothing counts draws, so that adding a purpose moves no other number
//! and any pixel, sample or path can be run again alone. Names and numbers are plain ones, or those of many vertices side
//! by side ([`crate::simd`]).

use crate::simd::{Float, Uint, Ulong};

mod blue;
mod halton;
mod kind;
mod padded;
mod pattern;
mod set;
mod sobol;

pub use kind::PatternKind;
pub use pattern::Pattern;
pub use set::Set;

/// What the random numbers of one vertex of one path are named by; or of many vertices, one in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleName<F: Float = f32> {
    /// A hash of seed and pixel; what [`Pattern::name`] makes of them where a pattern runs over all pixels.
    pixel: F::Ulong,
    /// The hash of the branches taken since the camera, see [`child_node`].
    node: F::Uint,
    /// The sample's index, its bits in reverse order, as the draws want it.
    reversed_index: F::Uint,
    /// How many branches were taken since the camera.
    level: F::Uint,
    /// The sample's [place](Self::place) at the node before.
    before: F::Uint,
}

impl Eq for SampleName {}

impl SampleName {
    /// The name at the camera: `pixel` is that of the whole picture, whatever is cropped or tiled; `index` is the
    /// sample's in the pixel. For patterns that fill each pixel by itself; [`Pattern::name`] serves all.
    #[inline]
    pub fn new(seed: u64, pixel: [u32; 2], index: u32) -> Self {
        Self::side_by_side(seed, pixel, index)
    }
}

impl<F: Float> SampleName<F> {
    /// As [`SampleName::new`], for a pixel and a sample in each lane.
    #[inline(always)]
    pub fn side_by_side(seed: u64, pixel: [F::Uint; 2], index: F::Uint) -> Self {
        let place = pixel[1].to_ulong() << 32 | pixel[0].to_ulong();
        let pixel = mix(place ^ mix(seed ^ 0x5851_f42d_4c95_7f2d));
        let [node, level, before] = [ROOT_NODE, 0, 0].map(F::Uint::splat);
        Self { pixel, node, reversed_index: index.reverse_bits(), level, before }
    }

    /// The names that `f` gives, a lane each.
    #[inline(always)]
    pub fn from_fn(mut f: impl FnMut(usize) -> SampleName) -> Self {
        let mut pixel = F::Ulong::splat(0).to_array();
        let mut columns = [F::Uint::splat(0).to_array(); 4];
        for i in 0..F::WIDTH {
            let SampleName { pixel: of_one, node, reversed_index, level, before } = f(i);
            pixel.as_mut()[i] = of_one;
            for (column, of_one) in columns.iter_mut().zip([node, reversed_index, level, before]) {
                column.as_mut()[i] = of_one;
            }
        }
        let [node, reversed_index, level, before] = columns.map(F::Uint::from_array);
        Self { pixel: F::Ulong::from_array(pixel), node, reversed_index, level, before }
    }

    /// The name of one lane.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> SampleName {
        SampleName {
            pixel: self.pixel.lane(i),
            node: self.node.lane(i),
            reversed_index: self.reversed_index.lane(i),
            level: self.level.lane(i),
            before: self.before.lane(i),
        }
    }

    /// Gives `f` the name of each lane.
    #[inline(always)]
    pub fn for_each(&self, mut f: impl FnMut(usize, SampleName)) {
        let pixel = self.pixel.to_array();
        let columns = [self.node, self.reversed_index, self.level, self.before].map(Uint::to_array);
        for i in 0..F::WIDTH {
            let [node, reversed_index, level, before] = columns.map(|column| column.as_ref()[i]);
            f(i, SampleName { pixel: pixel.as_ref()[i], node, reversed_index, level, before });
        }
    }

    /// The same sample one branch further, at [`child_node`].
    #[inline(always)]
    pub fn child(self, branch: u32) -> Self {
        self.onward(child_node(self.node, branch), self.place())
    }

    /// The same from what [`Self::node`] tells of the child, and [`Self::place`] of this name.
    #[inline(always)]
    pub fn onward(self, node: F::Uint, place: F::Uint) -> Self {
        Self { node, level: self.level.wrapping_add(F::Uint::splat(1)), before: place, ..self }
    }

    /// The same node of another sample of the pixel.
    #[inline(always)]
    pub fn at_index(self, index: F::Uint) -> Self {
        Self { reversed_index: index.reverse_bits(), ..self }
    }

    /// The node's hash.
    #[inline(always)]
    pub fn node(self) -> F::Uint {
        self.node
    }

    /// The index of the sample in its pixel.
    #[inline(always)]
    pub fn index(self) -> F::Uint {
        self.reversed_index.reverse_bits()
    }

    /// The sample's place in the order in which this node's directions and points on lights are drawn, of patterns that have one.
    ///
    /// What a direction finds depends on where it leads and on what is drawn there, four numbers together. So every second node has its
    /// samples in the order of the one before, turned so that the two pairs are well spread over all four dimensions as well as each over its own. Other nodes
    /// shuffle their samples anew.
    #[inline(always)]
    pub fn place(self) -> F::Uint {
        let one = F::Uint::splat(1);
        let shuffled = sobol::shuffle(self.stream(Purpose::Direction), self.reversed_index);
        F::Uint::select((self.level & one).eq(one), sobol::turned(self.before), shuffled)
    }

    /// The place in the order of a purpose.
    #[inline(always)]
    fn place_for(self, purpose: Purpose) -> F::Uint {
        match purpose {
            Purpose::Direction | Purpose::LightPoint => self.place(),
            _ => sobol::shuffle(self.stream(purpose), self.reversed_index),
        }
    }

    /// 64 bits that depend on all but the index.
    #[inline(always)]
    fn stream(self, purpose: Purpose) -> F::Ulong {
        mix(self.pixel ^ (self.node.to_ulong() << 32 | purpose as u64))
    }
}

/// The node of the camera's own edge.
pub const ROOT_NODE: u32 = 0;

/// The node reached from `node` by its branch number `branch` (a path that doesn't split takes branch 0 each time).
#[inline(always)]
pub fn child_node<U: Uint>(node: U, branch: u32) -> U {
    // Two rounds of an xorshift-multiply permutation (constants: Wellons 2018, "lowbias32").
    let x = node.wrapping_add(U::splat(branch.wrapping_mul(0x85eb_ca6b).wrapping_add(0x9e37_79b9)));
    let x = (x ^ (x >> 16)).wrapping_mul(U::splat(0x7feb_352d));
    let x = (x ^ (x >> 15)).wrapping_mul(U::splat(0x846c_a68b));
    x ^ (x >> 16)
}

/// What a random number is for. The values are part of the name: they never change meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Purpose {
    /// Place on the film (first two) and on the lens (last two).
    Film = 0,
    /// Moment within the shutter.
    Time = 1,
    /// The hero wavelength.
    Wavelength = 2,
    /// Which light is asked.
    LightChoice = 3,
    /// Where on that light; with three numbers, the last may choose the light.
    LightPoint = 4,
    /// Which lobe of a BSDF scatters.
    Lobe = 5,
    /// Where that lobe scatters to; with three numbers, the last may choose the lobe.
    Direction = 6,
    /// Whether the path goes on.
    Roulette = 7,
    /// Distance to the next event in a medium.
    Distance = 8,
    /// Whether a partly transparent surface is there.
    Opacity = 9,
    /// Anything of a user's own integrator.
    Custom = 10,
    /// Which of the materials that another is made of it is.
    Material = 11,
    /// Which corner of a triangle lends its colour.
    Corner = 12,
    /// Which texel of a texture is read.
    Texel = 13,
}

impl Purpose {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Film,
        Self::Time,
        Self::Wavelength,
        Self::LightChoice,
        Self::LightPoint,
        Self::Lobe,
        Self::Direction,
        Self::Roulette,
        Self::Distance,
        Self::Opacity,
        Self::Custom,
        Self::Material,
        Self::Corner,
        Self::Texel,
    ];
}

/// The upper 24 bits as a number in [0, 1).
#[inline(always)]
fn to_unit<F: Float>(bits: F::Uint) -> F {
    F::from_int(bits >> 8) * (1.0 / 16_777_216.0)
}

/// A permutation of 64 bits in which each bit of the input flips each bit of the output in half of the cases
/// (constants: Stafford 2011, variant 13).
#[inline(always)]
fn mix<L: Ulong>(x: L) -> L {
    let x = (x ^ (x >> 30)).wrapping_mul(L::splat(0xbf58_476d_1ce4_e5b9));
    let x = (x ^ (x >> 27)).wrapping_mul(L::splat(0x94d0_49bb_1331_11eb));
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests;
