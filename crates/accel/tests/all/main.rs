//! The integration tests of this crate, in one program: linking is what costs when there are many.

mod awkward_rays;
mod beams;
mod classics;
mod common;
mod extremes;
mod frames;
mod million;
mod same_hit;
#[path = "../../../../tests/shared.rs"]
mod shared;
mod space;
