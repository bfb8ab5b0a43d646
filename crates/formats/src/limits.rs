//! How much a file may ask for.

use crate::ReadError;

/// Bounds on what a reader accepts. They keep a file that is wrong, or meant to harm, from taking the machine down;
/// the defaults are far above any real asset. Besides them, no reader allocates for data that the file only
/// promises: a header that claims four billion vertices in a file of 200 bytes fails at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The largest file, in bytes.
    pub max_bytes: u64,
    /// The most vertices of a mesh.
    pub max_vertices: u64,
    /// The most triangles of a mesh.
    pub max_triangles: u64,
    /// The most pixels of a picture.
    pub max_pixels: u64,
    /// The most numbers of a picture: pixels times channels, of all layers together.
    pub max_samples: u64,
    /// The most bytes that decoding one picture may take at a time.
    pub max_decoded: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_bytes: 1 << 36,
            max_vertices: 400_000_000,
            max_triangles: 400_000_000,
            max_pixels: 1 << 28,
            max_samples: 1 << 32,
            max_decoded: 1 << 35,
        }
    }
}

impl Limits {
    /// Refuses a file that is too large.
    pub(crate) fn check_bytes(&self, bytes: &[u8]) -> Result<(), ReadError> {
        check("bytes", bytes.len() as u64, self.max_bytes)
    }

    /// Refuses a picture that takes too much memory.
    pub(crate) fn check_decoded(&self, bytes: u64) -> Result<(), ReadError> {
        if bytes > self.max_decoded {
            let gigabytes = |bytes: u64| bytes as f64 / 1e9;
            return Err(ReadError::file(format!(
                "the picture is too large: it would take {:.2} GB, the limit is {:.2} GB",
                gigabytes(bytes),
                gigabytes(self.max_decoded)
            )));
        }
        Ok(())
    }

    /// Refuses a picture that has no pixel or too many, and gives the number of its pixels.
    pub(crate) fn check_size(&self, width: u64, height: u64) -> Result<usize, ReadError> {
        let pixels = width.saturating_mul(height);
        if pixels == 0 {
            return Err(ReadError::file(format!("the picture is empty: {width} x {height} pixels")));
        }
        if pixels > self.max_pixels {
            return Err(ReadError::file(format!(
                "the picture is too large: {width} x {height} pixels, the limit is {} in all",
                self.max_pixels
            )));
        }
        usize::try_from(pixels).map_err(|_| ReadError::file("the picture is too large for this machine"))
    }
}

/// Refuses `count` things when there are more than `max`.
pub(crate) fn check(things: &str, count: u64, max: u64) -> Result<(), ReadError> {
    if count > max {
        return Err(ReadError::file(format!("too many {things}: {count}, the limit is {max}")));
    }
    Ok(())
}
