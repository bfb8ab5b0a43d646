//! Patches, height fields and curves as meshes.

use straal_math::DVec3;
use straal_scene::Assets;
use straal_scene::bitmap::Number;
use straal_scene::desc::{Bezier, BezierPatches, CurveBasis, Curves, HeightField};

use super::shapes::{Builder, double, frame};

/// Straight pieces of a piece of a curve.
const ALONG: u32 = 8;
/// Sides of a curve's tube.
const SIDES: u32 = 8;

impl Builder {
    /// Bezier patches that the scene writes out, cut as the scene says.
    pub fn bezier(&mut self, s: &Bezier) -> Option<()> {
        if s.source() != BezierPatches::Inline {
            return None;
        }
        for ids in &s.patches {
            let mut points = [DVec3::ZERO; 16];
            for (to, id) in points.iter_mut().zip(ids) {
                *to = *s.points.get(*id as usize)?;
            }
            let row = |u: f64, j: usize| curve([0, 1, 2, 3].map(|i| points[4 * j + i]), u);
            let at = |u: f64, v: f64| {
                let rows = [0, 1, 2, 3].map(|j| row(u, j));
                let (p, dv) = curve(rows.map(|(p, _)| p), v);
                let (du, _) = curve(rows.map(|(_, d)| d), v);
                (p, du.cross(dv))
            };
            let middle = at(0.5, 0.5).1;
            self.grid([s.resolution; 2], |u, v| {
                let (p, n) = at(u, v);
                // Where an edge has shrunk to a point, that of the surface close by.
                let inside = |x: f64| x + (0.5 - x) * 1e-3;
                let near = [n, at(inside(u), inside(v)).1, middle, DVec3::Y];
                Some((p, near.into_iter().find(|n| n.try_normalize().is_some())?))
            })?;
        }
        (!self.0.triangles.is_empty()).then_some(())
    }

    /// A sheet of squares, of a picture's pixels or numbers.
    pub fn height_field(&mut self, s: &HeightField, assets: &Assets) -> Option<()> {
        let [low, high] = s.between;
        let bitmap = s.file.as_ref().map(|file| assets.bitmap(file.handle));
        let [width, depth] = match bitmap {
            Some(bitmap) => [bitmap.texels.width(), bitmap.texels.height()],
            None => [s.heights.first().map_or(0, Vec::len), s.heights.len()],
        };
        if width < 2 || depth < 2 {
            return None;
        }
        let share = |i: usize, j: usize| match bitmap {
            None => s.heights.get(j).and_then(|row| row.get(i)).copied().unwrap_or(0.0),
            Some(bitmap) => {
                let format = bitmap.texels.format();
                let most = match format.number {
                    Number::Byte => 255.0,
                    Number::Short => 65535.0,
                    Number::Half | Number::Single => 1.0,
                };
                let [r, g, b, _] = bitmap.texels.numbers(i, j).map(f64::from);
                let y = if format.channels < 4 { r } else { 0.2126 * r + 0.7152 * g + 0.0722 * b };
                y / most
            }
        };
        let place = |i: usize, j: usize| {
            let part = |i: usize, n: usize| i as f64 / (n - 1) as f64 - 0.5;
            let y = low + (high - low) * share(i, j);
            DVec3::new(part(i, width) * s.size[0], y, part(j, depth) * s.size[1])
        };
        let first = self.0.positions.len() as u32;
        for j in 0..depth {
            for i in 0..width {
                let last = |i: usize, n: usize| if i + 1 < n { i + 1 } else { i };
                let along = place(last(i, width), j) - place(i.saturating_sub(1), j);
                let down = place(i, last(j, depth)) - place(i, j.saturating_sub(1));
                let n = down.cross(along).try_normalize().unwrap_or(DVec3::Y);
                self.0.positions.push(place(i, j).to_array().map(|v| v as f32));
                self.0.normals.push(n.to_array().map(|v| v as f32));
                let part = |i: usize, n: usize| i as f32 / (n - 1) as f32;
                self.0.uvs.push([part(i, width), 1.0 - part(j, depth)]);
            }
        }
        for j in 0..depth as u32 - 1 {
            for i in 0..width as u32 - 1 {
                let a = first + j * width as u32 + i;
                let (b, c) = (a + 1, a + width as u32);
                self.0.triangles.extend([[a, c, b], [b, c, c + 1]]);
            }
        }
        Some(())
    }

    /// Tubes of eight sides along curves.
    pub fn curves(&mut self, s: &Curves) -> Option<()> {
        for run in s.runs() {
            let points = s.points.get(run.clone())?;
            let radius = |share: f64| match s.radii.as_slice() {
                [all] => *all,
                [from, to] if s.points.len() != 2 => from + (to - from) * share,
                radii => {
                    let at = share * (points.len().saturating_sub(1)) as f64;
                    let (i, rest) = (at as usize, at - at.floor());
                    let of = |i: usize| radii.get(run.start + i).copied();
                    let first = of(i).unwrap_or(0.0);
                    first + (of(i + 1).unwrap_or(first) - first) * rest
                }
            };
            let pieces = s.pieces(points.len()).filter(|n| *n > 0)?;
            let path = path(points, &s.basis, pieces);
            self.tube_along(&path, radius)?;
        }
        (!self.0.triangles.is_empty()).then_some(())
    }

    /// A tube along a line of straight pieces, whose radius is told by the share of the way.
    fn tube_along(&mut self, path: &[DVec3], radius: impl Fn(f64) -> f64) -> Option<()> {
        let first = self.0.positions.len() as u32;
        let last = path.len().checked_sub(1).filter(|last| *last > 0)?;
        let mut across: Option<DVec3> = None;
        let mut direction = DVec3::Y;
        for (i, p) in path.iter().enumerate() {
            let ahead = path[if i < last { i + 1 } else { i }] - path[i.saturating_sub(1)];
            direction = ahead.try_normalize().unwrap_or(direction);
            // As little turned as can be from the place before.
            let kept = across.and_then(|a| (a - direction * direction.dot(a)).try_normalize());
            let a = kept.or_else(|| frame(direction).map(|[a, ..]| a))?;
            across = Some(a);
            let b = direction.cross(a);
            let v = i as f64 / last as f64;
            for k in 0..=SIDES {
                let u = f64::from(k) / f64::from(SIDES);
                let (sin, cos) = straal_math::ops::sin_cos_degrees(360.0 * u);
                let n = a * cos + b * sin;
                self.0.positions.push((*p + n * radius(v)).to_array().map(|v| v as f32));
                self.0.normals.push(n.to_array().map(|v| v as f32));
                self.0.uvs.push([u as f32, v as f32]);
            }
        }
        for j in 0..last as u32 {
            for k in 0..SIDES {
                let a = first + j * (SIDES + 1) + k;
                let (b, c, d) = (a + 1, a + SIDES + 2, a + SIDES + 1);
                for t in [[a, b, c], [a, c, d]] {
                    // Tips come to a point.
                    let [p, q, r] = t.map(|i| double(self.0.positions[i as usize]));
                    if (q - p).cross(r - p).length() > 0.0 {
                        self.0.triangles.push(t);
                    }
                }
            }
        }
        Some(())
    }
}

/// A cubic Bezier curve and its derivative.
fn curve([a, b, c, d]: [DVec3; 4], t: f64) -> (DVec3, DVec3) {
    let s = 1.0 - t;
    let p = a * (s * s * s) + b * (3.0 * s * s * t) + c * (3.0 * s * t * t) + d * (t * t * t);
    let slope = (b - a) * (3.0 * s * s) + (c - b) * (6.0 * s * t) + (d - c) * (3.0 * t * t);
    (p, slope)
}

/// Points along a curve of so many pieces.
fn path(points: &[DVec3], basis: &CurveBasis, pieces: usize) -> Vec<DVec3> {
    if *basis == CurveBasis::Linear {
        return points.to_vec();
    }
    let mut out = Vec::new();
    for piece in 0..pieces {
        let of = |first: usize| [0, 1, 2, 3].map(|i| points.get(first + i).copied().unwrap_or(DVec3::ZERO));
        let hull = match basis {
            CurveBasis::BSpline => {
                let [a, b, c, d] = of(piece);
                // The same piece as a Bezier curve.
                let (first, last) = ((a + b * 4.0 + c) / 6.0, (b + c * 4.0 + d) / 6.0);
                [first, (b * 2.0 + c) / 3.0, (b + c * 2.0) / 3.0, last]
            }
            _ => of(3 * piece),
        };
        let from = u32::from(piece > 0);
        out.extend((from..=ALONG).map(|i| curve(hull, f64::from(i) / f64::from(ALONG)).0));
    }
    out
}
