//! Numbers of a binary PLY file of which only a part is in memory at a time.

use std::io::{ErrorKind, Read};

use super::header::{Kind, Scalar};
use super::{Body, Bytes, integer_of, number_of};
use crate::{Place, ReadError};

/// Bytes that are in memory at a time.
const ROOM: usize = 1 << 18;

/// What follows the header.
pub(super) struct Stream<'a> {
    rest: &'a mut dyn Read,
    /// What was read of it.
    window: Vec<u8>,
    /// Which of that is next.
    at: usize,
    /// How many bytes of the file lie before it.
    before: u64,
    /// How many bytes the file has.
    size: u64,
    big: bool,
}

impl<'a> Stream<'a> {
    /// From a place in what is read on.
    pub fn new(rest: &'a mut dyn Read, (head, at): (&[u8], usize), size: u64, big: bool) -> Self {
        Self { rest, window: head.to_vec(), at, before: 0, size, big }
    }

    /// So many bytes, at the most as many as there is room for.
    fn next(&mut self, count: usize) -> Result<&[u8], ReadError> {
        if self.window.len() - self.at < count {
            self.fill(count)?;
        }
        let at = self.at;
        self.at += count;
        Ok(&self.window[at..at + count])
    }

    /// Reads on, until so many bytes are there.
    #[cold]
    fn fill(&mut self, count: usize) -> Result<(), ReadError> {
        let too_early = || ReadError::at(self.here(), "the file ends too early");
        if count as u64 > self.left() {
            return Err(too_early());
        }
        self.before += self.at as u64;
        self.window.drain(..self.at);
        self.at = 0;
        let mut filled = self.window.len();
        self.window.resize(if count > ROOM { count } else { ROOM }, 0);
        let problem = loop {
            match self.rest.read(&mut self.window[filled..]) {
                Ok(0) => break None,
                Ok(n) => filled += n,
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => break Some(e),
            }
            if filled == self.window.len() {
                break None;
            }
        };
        self.window.truncate(filled);
        match problem {
            Some(e) => Err(ReadError::file(format!("it can't be read: {e}"))),
            None if filled < count => Err(ReadError::at(self.here(), "the file ends too early")),
            None => Ok(()),
        }
    }
}

impl Bytes for Stream<'_> {
    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let mut taken = [0; N];
        taken.copy_from_slice(self.next(N)?);
        if self.big {
            taken.reverse();
        }
        Ok(taken)
    }

    fn here(&self) -> Place {
        Place::Byte(self.before as usize + self.at)
    }
}

impl Body for Stream<'_> {
    const KNOWS_WIDTHS: bool = false;

    fn again(&self) -> Option<Self> {
        None
    }

    fn place(&self) -> Place {
        self.here()
    }

    fn left(&self) -> u64 {
        self.size.saturating_sub(self.before + self.at as u64)
    }

    fn least_size(&self, kind: Kind) -> u64 {
        match kind {
            Kind::Scalar(scalar) | Kind::List { count: scalar, .. } => scalar.size() as u64,
        }
    }

    #[inline]
    fn number(&mut self, scalar: Scalar) -> Result<f32, ReadError> {
        number_of(self, scalar)
    }

    #[inline]
    fn integer(&mut self, scalar: Scalar) -> Result<i64, ReadError> {
        integer_of(self, scalar)
    }

    fn skip_scalars(&mut self, scalar: Scalar, count: usize) -> Result<(), ReadError> {
        let mut bytes = scalar.size().saturating_mul(count);
        if bytes as u64 > self.left() {
            return Err(ReadError::at(self.here(), "the file ends too early"));
        }
        while bytes > 0 {
            let part = if bytes < ROOM { bytes } else { ROOM };
            self.next(part)?;
            bytes -= part;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{read_in_passing, read_with};
    use crate::Limits;

    /// Gives few bytes at a time, of different numbers.
    struct Trickle<'a>(&'a [u8], usize);

    impl std::io::Read for Trickle<'_> {
        fn read(&mut self, to: &mut [u8]) -> std::io::Result<usize> {
            self.1 = self.1 * 7 % 23 + 1;
            let count = self.1.min(self.0.len()).min(to.len());
            to[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    /// A strip of quadrilaterals with colours and something to pass over, longer than the window.
    fn file(big: bool) -> Vec<u8> {
        let n = 9000_i32;
        let order = if big { "big" } else { "little" };
        let mut out = format!(
            "ply\nformat binary_{order}_endian 1.0\nelement vertex {}\nproperty float x\nproperty double y\nproperty float z\n\
             property uchar red\nproperty list ushort char notes\nelement face {}\nproperty list uchar int vertex_indices\n\
             element rest 1\nproperty int a\nend_header\n",
            2 * n,
            n - 1
        )
        .into_bytes();
        let mut put = |bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            if big {
                bytes.reverse();
            }
            out.extend(bytes);
        };
        for i in 0..2 * n {
            put(&((i / 2) as f32).to_le_bytes());
            put(&f64::from(i % 2).to_le_bytes());
            put(&0.25_f32.to_le_bytes());
            put(&[7]);
            let notes = (i % 5) as u16;
            put(&notes.to_le_bytes());
            (0..notes).for_each(|_| put(&[9]));
        }
        for i in 0..n - 1 {
            put(&[4]);
            [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1].iter().for_each(|v| put(&v.to_le_bytes()));
        }
        put(&[1, 2, 3, 4]);
        out
    }

    #[test]
    fn what_is_read_in_passing_is_what_is_read_at_once() {
        let limits = Limits::default();
        for big in [false, true] {
            let bytes = file(big);
            let head = &bytes[..4096];
            let mut rest = Trickle(&bytes[4096..], 3);
            let passing = read_in_passing((head, &mut rest), bytes.len() as u64, &limits, &|_| true);
            let found = passing.unwrap().expect("it is in order");
            assert_eq!(found, read_with(&bytes, &limits, &|_| true).unwrap());
            // What is cut off is told at the same place.
            for length in [5000, 200_000, bytes.len() - 5] {
                let cut = &bytes[..length];
                let mut rest = &cut[4096..];
                let passing = read_in_passing((head, &mut rest), length as u64, &limits, &|_| false);
                let whole = read_with(cut, &limits, &|_| false);
                assert_eq!(passing.unwrap_err().to_string(), whole.unwrap_err().to_string(), "{length}");
            }
        }
    }

    #[test]
    fn what_has_to_be_there_as_a_whole_is_left() {
        let limits = Limits::default();
        for text in [
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n",
            "ply\nformat binary_little_endian 1.0\nelement face 0\nproperty list uchar int vertex_indices\nelement vertex 0\nproperty float x\nend_header\n",
            "ply\nformat binary_little_endian 1.0\nelement ver",
        ] {
            let left =
                read_in_passing((text.as_bytes(), &mut &b""[..]), text.len() as u64, &limits, &|_| false);
            assert_eq!(left.unwrap(), None, "{text}");
        }
    }
}
