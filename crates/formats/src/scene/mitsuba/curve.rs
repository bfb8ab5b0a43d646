//! Files of curves: a point and a radius on each line, and an empty line between curves.

use straal_math::{Affine, DVec3};
use straal_scene::desc::{CurveBasis, CurveForm, Curves, Material, MaterialRef, Node, Relief, TwoFaces};
use straal_scene::limit::Limit;
use straal_scene::{Diagnostic, suggest};

use super::bsdf;
use super::translate::Translator;
use super::tree::Object;
use super::uv::Uv;
use super::xml::numbers;
use crate::files;

/// The most points of a file.
const MOST: usize = 100_000_000;

/// Points, where curves begin among them, and radii.
#[derive(Debug, Default, PartialEq)]
struct Read {
    points: Vec<DVec3>,
    starts: Vec<u32>,
    radii: Vec<f64>,
}

impl<'o> Translator<'o, '_, '_> {
    /// Curves of a file. Their radii stay as they are wherever they are put.
    pub fn curves(&mut self, o: &'o Object) -> Option<Node> {
        self.only(
            o,
            &[
                "filename",
                "to_world",
                "silhouette_sampling_weight",
                "radius",
                "angle_threshold",
                "reduction",
                "*",
            ],
        );
        let is_linear = o.plugin.as_str() != "bsplinecurve";
        // Of version 0.5: points alone, and one radius for all.
        let radius =
            (o.plugin.as_str() == "hair").then(|| self.within(o, "radius", 0.025, Limit::NON_NEGATIVE));
        let Some(file) = self.text(o, "filename") else {
            self.fail(o.plugin.span, "these curves have no `filename`");
            return None;
        };
        let found = self.file(o, &file)?;
        let bytes = match files::read(&found.path, self.means.limits.max_bytes.min(1 << 32)) {
            Ok(bytes) => bytes,
            Err(refusal) => {
                self.refuse(&file, &refusal);
                return None;
            }
        };
        let read = match read(&bytes, if is_linear { 2 } else { 4 }, radius) {
            Ok(read) => read,
            Err(problem) => {
                let message = format!("cannot read `{}`: {problem}", suggest::brief(&file));
                self.push(Diagnostic::error(file.span, message));
                return None;
            }
        };
        self.read.push((found.path, found.name, blake3::hash(&bytes).into()));
        let to_world = self.world_of(o);
        let mut surface = self.surface(o, &Affine::IDENTITY, Uv::Same, false);
        // What is seen from within isn't there, as in Mitsuba: tubes are open.
        surface.material = surface.material.take().map(|front| {
            let back = Box::new(MaterialRef::Inline(Box::new(bsdf::nothing())));
            let both = TwoFaces { front: Box::new(front), back, relief: Relief::default() };
            MaterialRef::Inline(Box::new(Material::TwoFaces(both)))
        });
        Some(Node::Curves(Curves {
            points: read.points.iter().map(|p| to_world.point(*p)).collect(),
            starts: read.starts,
            basis: if is_linear { CurveBasis::Linear } else { CurveBasis::BSpline },
            radii: read.radii,
            form: CurveForm::Round,
            normals: Vec::new(),
            surface,
        }))
    }
}

/// Reads curves of so many points at least; with a radius, lines have points alone.
fn read(bytes: &[u8], least: usize, radius: Option<f64>) -> Result<Read, String> {
    if bytes.starts_with(b"BINARY_HAIR") {
        return Err("hair in its binary form isn't supported".to_owned());
    }
    let text = std::str::from_utf8(bytes).map_err(|_| "this is not a text: it must be UTF-8".to_owned())?;
    let mut out = Read::default();
    let mut is_open = false;
    let whole = |out: &Read, line: usize| {
        let start = out.starts.last().map_or(0, |s| *s as usize);
        let count = out.points.len() - start;
        if count < least {
            return Err(format!("the curve before line {line} has {count} points, and needs {least}"));
        }
        Ok(())
    };
    for (i, line) in text.lines().enumerate() {
        if line.trim().is_empty() {
            if std::mem::take(&mut is_open) {
                whole(&out, i + 1)?;
            }
            continue;
        }
        let (x, y, z, radius) = match (numbers(line).as_deref(), radius) {
            (Some(&[x, y, z, radius]), None) => (x, y, z, radius),
            (Some(&[x, y, z]), Some(radius)) => (x, y, z, radius),
            _ => {
                let wanted = if radius.is_some() { "a point: three" } else { "a point and a radius: four" };
                return Err(format!("line {} is not {wanted} numbers", i + 1));
            }
        };
        if radius < 0.0 || out.points.len() == MOST {
            let what = if radius < 0.0 { "a radius is below 0" } else { "there are too many points" };
            return Err(format!("line {}: {what}", i + 1));
        }
        if !is_open {
            out.starts.push(out.points.len() as u32);
            is_open = true;
        }
        out.points.push(DVec3::new(x, y, z));
        out.radii.push(radius);
    }
    if out.points.is_empty() {
        return Err("there is no curve in it".to_owned());
    }
    if is_open {
        whole(&out, text.lines().count() + 1)?;
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_lines_are_between_curves() {
        let got = read(b"\n0 0 0 .1\n1 0 0 .2\n\n \n0 1 0 .3\r\n1 1 0 .4\n", 2, None).unwrap();
        assert_eq!((got.starts, got.radii), (vec![0, 2], vec![0.1, 0.2, 0.3, 0.4]));
        assert_eq!(got.points[3], DVec3::new(1.0, 1.0, 0.0));
        for (text, wanted) in [
            ("0 0 0 1\n\n0 0 0 1\n1 1 1 1", "the curve before line 2 has 1 points"),
            ("0 0 0\n", "line 1 is not"),
            ("0 0 0 -1\n", "below 0"),
            ("", "no curve"),
        ] {
            let told = read(text.as_bytes(), 2, None).unwrap_err();
            assert!(told.contains(wanted), "{told}");
        }
    }
}
