//! World, shapes, lights, materials, cameras, samplers, film, integrators and the tile driver.
#![forbid(unsafe_code)]

pub mod light;
pub mod material;
pub mod shape;
#[doc(hidden)]
pub mod testing;
