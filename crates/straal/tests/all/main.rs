//! The integration tests of this crate, in one program: linking is what costs when there are many.

mod adaptive;
mod cameras;
mod clamp;
mod closed_form;
mod common;
mod cube_environment;
mod custom;
mod default_sampler;
mod doubts;
mod error_layer;
mod film_channels;
mod filters;
mod forecast;
mod hashes;
mod leaning_normals;
mod light_groups;
mod light_tracing;
mod open_pbr;
mod power;
mod resume;
mod same_bits;
mod spectral;
mod surfaces;
mod textures;
mod ways_of_light;
mod wide_gamut;
