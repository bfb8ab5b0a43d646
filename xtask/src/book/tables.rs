//! Tables of figures that the program works out.

use crate::Failure;

/// A table by its name; nothing where files that it takes aren't here.
pub fn table(name: &str) -> Result<Option<String>, Failure> {
    Err(format!("there is no table `{name}`").into())
}
