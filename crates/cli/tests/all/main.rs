//! The integration tests of this crate, in one program: linking is what costs when there are many.

mod accel;
mod book;
mod common;
mod complaints;
mod convert;
mod denoise;
mod develop;
mod diff;
mod files;
mod frames;
mod interrupt;
mod keeping;
mod memory;
mod pictures;
mod places;
mod render;
mod sampler;
mod studio;
mod words;
