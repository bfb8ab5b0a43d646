//! `straal schema`

use super::print;
use crate::exit::{Exit, Failure};

/// Prints the JSON Schema of the scene language.
pub fn run() -> Result<Exit, Failure> {
    print(&format!("{:#}\n", straal_scene::schema()))?;
    Ok(Exit::Fine)
}
