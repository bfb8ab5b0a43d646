//! Signed distances on a grid, in Mitsuba's files of volumes: `VOL`, version 3.

use straal_math::{Affine, DVec3};
use straal_scene::desc::{Distance, DistanceField, GridDistance, Node};
use straal_scene::{Diagnostic, suggest};

use super::translate::Translator;
use super::tree::Object;
use super::uv::Uv;
use crate::files;

/// The most points along an axis.
const MOST: u32 = 1024;

impl<'o> Translator<'o, '_, '_> {
    /// A solid of distances, which fill the unit cube.
    pub fn distances(&mut self, o: &'o Object) -> Option<Node> {
        self.only(o, &["filename", "normals", "to_world", "silhouette_sampling_weight", "watertight", "*"]);
        let Some(file) = self.text(o, "filename") else {
            self.fail(o.plugin.span, "this grid has no `filename`");
            return None;
        };
        let found = self.file(o, &file)?;
        let bytes = match files::read(&found.path, self.means.limits.max_bytes.min(1 << 33)) {
            Ok(bytes) => bytes,
            Err(refusal) => {
                self.refuse(&file, &refusal);
                return None;
            }
        };
        let (size, values) = match read(&bytes) {
            Ok(read) => read,
            Err(problem) => {
                let message = format!("cannot read `{}`: {problem}", suggest::brief(&file));
                self.push(Diagnostic::error(file.span, message));
                return None;
            }
        };
        self.read.push((found.path, found.name, blake3::hash(&bytes).into()));
        let at = self.placed(o, &Affine::IDENTITY);
        let surface = self.surface(o, &at, Uv::Same, false);
        let grid = GridDistance { min: DVec3::ZERO, max: DVec3::splat(1.0), size, values };
        Some(Node::DistanceField(DistanceField { of: Distance::Grid(grid), surface }))
    }
}

/// Points along each axis, and the distance at each.
fn read(bytes: &[u8]) -> Result<([u32; 3], Vec<f64>), String> {
    let number =
        |at: usize| -> Option<u32> { Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?)) };
    if !bytes.starts_with(b"VOL\x03") {
        return Err("it is no volume of Mitsuba of version 3".to_owned());
    }
    let head: Option<Vec<u32>> = (0..5).map(|i| number(4 + 4 * i)).collect();
    let Some([1, x, y, z, channels]) = head.as_deref() else {
        return Err("its numbers must be floats".to_owned());
    };
    let size = [*x, *y, *z];
    if *channels != 1 || size.iter().any(|n| !(2..=MOST).contains(n)) {
        return Err(format!(
            "it has {channels} numbers at {x} x {y} x {z} points: one, at 2 to {MOST} along each axis, is read"
        ));
    }
    let count = size.iter().map(|n| *n as usize).product::<usize>();
    // Behind the numbers of the header the box that it fills, which doesn't count here.
    let rest = bytes.get(4 + 20 + 24..).unwrap_or(&[]);
    let Some(rest) = rest.get(..4 * count) else {
        return Err(format!("it ends too early: {count} distances are promised"));
    };
    let values: Vec<f64> =
        rest.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect();
    if values.iter().any(|v| !v.is_finite()) {
        return Err("a distance is no finite number".to_owned());
    }
    Ok((size, values))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(size: [u32; 3], count: usize) -> Vec<u8> {
        let mut out = b"VOL\x03".to_vec();
        out.extend([1, size[0], size[1], size[2], 1].iter().flat_map(|n: &u32| n.to_le_bytes()));
        out.extend([0_u8; 24]);
        out.extend((0..count).flat_map(|i| (i as f32 - 3.5).to_le_bytes()));
        out
    }

    #[test]
    fn a_grid_and_what_is_none() {
        let (size, values) = read(&file([2, 2, 2], 8)).unwrap();
        assert_eq!((size, values[7]), ([2, 2, 2], 3.5));
        assert!(read(&file([2, 2, 2], 7)).unwrap_err().contains("too early"));
        assert!(read(&file([u32::MAX; 3], 8)).unwrap_err().contains("2 to 1024"));
        assert!(read(b"PNG").is_err());
    }
}
