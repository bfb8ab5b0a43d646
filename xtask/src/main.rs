//! The command `straal`.
fn main() {}
