//! Answers that several words have.

use super::Here::{self, NotYet, Write};

pub(super) const TEXTURES: Here = Write("`reflectance: { texture: { image: { file: wood.jpg } } }`");
pub(super) const CHECKER: Here = Write("`reflectance: { texture: { checker: {} } }`");
pub(super) const MEDIA: Here = NotYet("fog, smoke and other media");
pub(super) const ROUGH_GLASS: Here = Write("`dielectric: { roughness: 0.1 }`");
pub(super) const LAYERED: Here =
    Write("`open_pbr: { coat_weight: 1 }`, which has `fuzz_weight` and `thin_film_weight` as well");
pub(super) const MASKS: Here = Write("`mask: { opacity: 0.5, material: { diffuse: {} } }`");
pub(super) const BUMPS: Here = Write(
    "`normal_map: { texture: { image: { file: normals.png } } }` or `bump: { texture: stains, height: 0.01 }` in a material",
);
pub(super) const SUBSURFACE: Here = NotYet("light that travels below a surface");
pub(super) const CSG: Here = Write("`union`, `intersection` or `difference`, with a list `of` solids");
pub(super) const HAIR: Here = NotYet("what hair does with light");
pub(super) const ANIMATION: Here = NotYet("animations");
pub(super) const PLACE: Here = Write("`transform: [translate: [0, 1, 0]]`");
pub(super) const TURN: Here = Write("`transform: [rotate: { y: 30 }]`");
pub(super) const SIZE: Here = Write("`film: { size: [640, 360] }` at the top of the scene");
pub(super) const SPP: Here = Write("`sampler: { spp: 64 }` at the top of the scene");
pub(super) const GLOW: Here =
    Write("a material doesn't glow: give the shape itself an `emission`, such as `emission: [5, 5, 5]`");
pub(super) const METAL: Here =
    Write("a metal is a material of its own, `conductor: { metal: gold, roughness: 0.1 }`");
pub(super) const GLASS: Here = Write("glass is a material of its own, `dielectric: { eta: 1.5 }`");
pub(super) const LENS: Here =
    Write("`lens: { radius: 0.05, focus_distance: 3 }`, or `f_number` in place of `radius`");
pub(super) const VIEW: Here = Write("a camera stands and looks by `eye`, `look_at` and `up`");
pub(super) const VERTICAL: Here = Write("`fov: 30, fov_axis: y`, in degrees");
pub(super) const CAMERA: Here =
    Write("`camera: { perspective: { eye: [0, 1, 5], look_at: [0, 0, 0], fov: 40 } }`");
pub(super) const AREA: Here = Write(
    "a shape under `world:` glows by its `emission`, such as `- rectangle: { emission: [5, 5, 5], look_at: [0, 0, 0] }`",
);
pub(super) const TYPE: Here = Write("the kind is the key itself: `sphere: { ... }`, not `type: sphere`");
