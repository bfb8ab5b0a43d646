//! How a bare mesh is shown.

use super::heading::STUDIO;
use super::parsers::named;
use crate::quantity;
use clap::Args;
use straal::Studio;
use straal::studio::{Background, Finish, Side, Up};

/// How a bare mesh is shown; a scene says all that itself.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = STUDIO)]
pub struct StudioArgs {
    /// Which axis of the mesh points up; guessed, and told, when absent
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, value_parser = named(Up::ALL.map(|u| (u.name(), u)).to_vec()))]
    pub up: Option<Up>,

    /// From where the mesh is seen
    ///
    /// The front is what faces +z where y is up, and what faces -y where z is; left and right are those of who looks at it.
    /// Three-quarter when absent.
    #[arg(long, value_name = "SIDE", value_parser = named(Side::ALL.map(|v| (v.name(), v)).to_vec()))]
    pub view: Option<Side>,

    /// What the mesh is made of
    ///
    /// When absent, what its file says, and clay where it says nothing.
    #[arg(long, value_name = "MATERIAL", value_parser = named(Finish::ALL.map(|f| (f.name(), f)).to_vec()))]
    pub material: Option<Finish>,

    /// Compute smooth normals, but keep edges sharp where faces meet at a larger angle than this: 0 is flat, 180 all round
    ///
    /// When absent a file's own normals are taken; where it has none they are computed with 40.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = quantity::crease)]
    pub smooth: Option<f64>,

    /// What is behind the mesh: studio, a colour such as '#4060a0' or white, or none
    ///
    /// A colour is that of the paper on floor and wall. With none there is no floor, and black behind, for laying an EXR over
    /// another picture.
    #[arg(long, value_name = "COLOUR", value_parser = quantity::background)]
    pub background: Option<Background>,
}

impl StudioArgs {
    /// What it means for a picture of some size.
    pub fn studio(&self, size: Option<[u32; 2]>) -> Studio {
        Studio {
            up: self.up,
            view: self.view.unwrap_or_default(),
            finish: self.material,
            smooth: self.smooth,
            background: self.background.unwrap_or_default(),
            size,
        }
    }

    /// The first option that was said, if any.
    pub fn first(&self) -> Option<&'static str> {
        let said = [
            (self.up.is_some(), "--up"),
            (self.view.is_some(), "--view"),
            (self.material.is_some(), "--material"),
            (self.smooth.is_some(), "--smooth"),
            (self.background.is_some(), "--background"),
        ];
        said.into_iter().find_map(|(is_said, name)| is_said.then_some(name))
    }
}
