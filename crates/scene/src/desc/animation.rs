//! How a scene that moves is played.

use crate::describe::describe;
use crate::limit::Limit;

describe! {
    /// How a scene that moves is played. What moves is said where it stands, as `{ keyframes: { 0: 1, 24: 2 } }` in place of a value.
    pub struct Animation {
        /// How many frames there are, from 0 on.
        frames: u32 [Limit::within(1.0, 1e6)] = 1,
        /// Frames a second.
        fps: f64 [Limit::within(0.001, 1000.0)] = 24.0,
        /// How long the shutter is open, in frames: what goes from place to place meanwhile is blurred, by its `transform`, and what a camera
        /// sees while it moves. 0.5 is the usual half turn of a film camera's shutter; 0 doesn't blur.
        shutter: f64 [Limit::UNIT] = 0.0,
    }
}
