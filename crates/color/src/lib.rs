//! Light as four lanes, RGB spaces, tone curves and gamma.
#![forbid(unsafe_code)]

pub mod light;

pub use light::Light;
