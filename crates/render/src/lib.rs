//! World, materials, lights, cameras, samplers, film, integrators and the tile driver.
//!
//! It runs one way: [`compile`] makes a [`world::World`] of a description, read-only while rays fly; a
//! [`driver::Render`] sends pools of paths through it, sorted into queues that an [`integrator::Integrator`] advances one edge at a
//! time, and their light is summed on a [`film::Film`]. Nothing here knows of files, clocks or screens.
#![forbid(unsafe_code)]

pub mod camera;
pub mod compile;
pub mod driver;
pub mod film;
pub mod filter;
pub mod footprint;
pub mod integrator;
pub mod lanes;
pub mod light;
pub mod material;
mod paint;
pub mod probe;
pub mod relief;
pub mod settings;
pub mod shape;
pub mod stopwatch;
pub mod surface;
#[doc(hidden)]
pub mod testing;
pub mod texture;
pub mod world;
