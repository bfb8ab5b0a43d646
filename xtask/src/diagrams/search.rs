//! Drawings.
use super::Diagram;
pub const ALL: &[Diagram] = &[];
