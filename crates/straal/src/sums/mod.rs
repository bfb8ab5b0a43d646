//! Files of exact sums: a render that was cut off is taken up again, and parts that were rendered apart are put together,
//! to the bits of the whole.
//!
//! Such a file is, in this order, all numbers little-endian:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `straalSU` |
//! | 4 | the version of this format, 1 |
//! | 4 | bytes of the header, H |
//! | H | the header: lines of text in UTF-8, each a key and what it says; see [`Stamp`] |
//! | 32 | BLAKE3 of all before |
//! | ... | for each pixel of the region, row by row from the top, the numbers that the header's line `record` lists |
//! | 32 | BLAKE3 of all before |

mod file;
mod merge;
mod stamp;

pub(crate) use file::write;
pub use file::{Kept, SumsError, is_named};
pub use merge::{Allowed, Merged, merge};
pub use stamp::Stamp;
