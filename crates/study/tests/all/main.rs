//! The integration tests of this crate, in one program: linking is what costs when there are many.

mod lab;
