//! What explains: pictures and figures of what straal does, and why.
//!
//! It stands beside the front door, `straal`, and uses it; nothing that renders uses this crate.
//!
//! - [`lab`] compares search structures on the rays of a scene;
//! - [`points`] judges and draws sampling patterns;
//! - [`cost`] shows where the searches of a render were expensive, in the colours of [`false_colour`];
//! - [`tree`] tells what stands in a scene, and what its transforms do;
//! - [`gamma_chart`] is the picture by which a screen's gamma is found.
#![forbid(unsafe_code)]

pub mod cost;
pub mod false_colour;
pub mod gamma_chart;
pub mod lab;
pub mod points;
pub mod tree;

pub use false_colour::SaveError;
