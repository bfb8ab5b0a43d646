//! Structures cut through at a height, to be drawn.

use straal_math::{Bounds, DVec3, ops};

/// A cell or a box where the plane z = constant cuts it.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The corners, counter-clockwise about z; never fewer than three.
    pub outline: Vec<[f64; 2]>,
    /// Steps from the root.
    pub depth: u32,
    /// Primitives that it lists; `None` for an inner node.
    pub primitives: Option<usize>,
}

/// A convex shape that can be cut through.
pub(crate) trait Slice {
    /// Corners of the cut at a height, counter-clockwise; fewer than three where it is missed.
    fn slice(&self, z: f64) -> Vec<[f64; 2]>;
}

impl Slice for Bounds {
    fn slice(&self, z: f64) -> Vec<[f64; 2]> {
        let (min, max) = (self.min.as_dvec3(), self.max.as_dvec3());
        if self.is_empty() || z < min.z || z > max.z {
            return Vec::new();
        }
        vec![[min.x, min.y], [max.x, min.y], [max.x, max.y], [min.x, max.y]]
    }
}

/// Where edges cross a height, in order around their middle.
pub(crate) fn ring<'a>(edges: impl Iterator<Item = &'a [DVec3; 2]>, z: f64) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = edges
        .filter(|[a, b]| (a.z >= z) != (b.z >= z))
        .map(|&[a, b]| {
            let p = a + (b - a) * ((z - a.z) / (b.z - a.z));
            [p.x, p.y]
        })
        .collect();
    let n = points.len() as f64;
    let middle = points.iter().fold([0.0; 2], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n]);
    let angle = |p: &[f64; 2]| ops::atan2_d(p[1] - middle[1], p[0] - middle[0]);
    points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    // Each edge belongs to two faces, and so comes twice.
    points.dedup_by(|a, b| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-9);
    points
}

#[cfg(test)]
mod tests {
    use super::Slice;
    use crate::*;
    use std::sync::Arc;
    use straal_math::Vec3;

    /// Upright triangles in two rows.
    fn input() -> Input {
        let at = |i: u32| Vec3::new((i % 8) as f32, (i / 8) as f32, -1.0);
        let positions: Arc<[Vec3]> = (0..16)
            .flat_map(|i| [at(i), at(i) + Vec3::new(0.4, 0.3, 0.0), at(i) + Vec3::new(0.2, 0.1, 2.0)])
            .collect();
        let indices = (0..16).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let geometry = Geometry { kind: GeometryKind::Triangles { positions, indices }, mask: u32::MAX };
        Input {
            groups: vec![Group { geometries: vec![0], instances: vec![] }],
            geometries: vec![geometry],
            motions: Vec::new(),
        }
    }

    fn area(outline: &[[f64; 2]]) -> f64 {
        let next = outline.iter().cycle().skip(1);
        outline.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
    }

    /// Cells that don't overlap fill the box around everything, or for an octree more than that.
    #[test]
    fn cells_fill_space() {
        for structure in Structure::ALL {
            let scene = Scene::build(input(), &(), &Options { structure, ..Options::default() }).unwrap();
            let whole = area(&scene.bounds().slice(0.1));
            let all = scene.section(0.1);
            assert!(all.iter().all(|s| s.outline.len() >= 3 && area(&s.outline) > 0.0), "{structure:?}");
            let sum: f64 = all.iter().filter(|s| s.primitives.is_some()).map(|s| area(&s.outline)).sum();
            match structure {
                Structure::Grid(_) | Structure::Kd(_) | Structure::Bsp(_) => {
                    assert!((sum / whole - 1.0).abs() < 1e-6, "{structure:?}: {sum} of {whole}");
                }
                Structure::Octree(_) => assert!(sum >= whole, "{structure:?}"),
                Structure::Bvh2(_) => assert!(sum > 0.0 && sum < whole, "{structure:?}"),
                _ => assert!(all.is_empty()),
            }
        }
    }
}
