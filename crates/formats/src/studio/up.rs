//! Which way is up.

use std::fmt;

use straal_math::DVec3;
use straal_scene::MeshAsset;

/// The axis of a mesh that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// +x
    X,
    /// +y
    Y,
    /// +z
    Z,
    /// -x
    NegX,
    /// -y
    NegY,
    /// -z
    NegZ,
}

impl Up {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::NegX, Self::NegY, Self::NegZ];

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::NegX => "-x",
            Self::NegY => "-y",
            Self::NegZ => "-z",
        }
    }

    pub(super) const fn axis(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
            Self::NegX => DVec3::new(-1.0, 0.0, 0.0),
            Self::NegY => DVec3::new(0.0, -1.0, 0.0),
            Self::NegZ => DVec3::new(0.0, 0.0, -1.0),
        }
    }

    /// The turn that makes it y: an axis and degrees. What is x stays x where it can: where z is up the front is -y, as programs in
    /// which z is up have it; where y or x is, it is +z.
    pub(super) const fn turn(self) -> Option<(DVec3, f64)> {
        match self {
            Self::Y => None,
            Self::X => Some((DVec3::Z, 90.0)),
            Self::Z => Some((DVec3::X, -90.0)),
            Self::NegX => Some((DVec3::Z, -90.0)),
            Self::NegY => Some((DVec3::Z, 180.0)),
            Self::NegZ => Some((DVec3::X, 90.0)),
        }
    }
}

impl fmt::Display for Up {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What is up, where nobody said it, and what speaks for it. Files of both kinds are y up more often than not; z has to be
/// argued for.
///
/// Things stand on a flat bottom and are not flat on top, and a terrain is wide along two axes and faces the third.
pub fn guess(asset: &MeshAsset) -> (Up, &'static str) {
    let Some((min, max)) = super::bounds(asset) else { return (Up::Y, "") };
    let extent = max - min;
    // Areas that face along y and z, by half as the triangles count.
    let (mut area, mut facing) = (0.0, DVec3::ZERO);
    let [mut bottom, mut top] = [[0.0; 3]; 2];
    let mut corners = super::points(asset);
    while let (Some(a), Some(b), Some(c)) = (corners.next(), corners.next(), corners.next()) {
        let n = (b - a).cross(c - a);
        let size = n.length();
        area += size;
        facing += n.abs();
        for k in 1..3 {
            // Flat, and wholly within a fiftieth of the extent from the end.
            if n[k].abs() < 0.98 * size {
                continue;
            }
            let thin = 0.02 * extent[k];
            let is_low = a.max(b).max(c)[k] - min[k] <= thin;
            let is_high = max[k] - a.min(b).min(c)[k] <= thin;
            match (is_low, is_high) {
                (true, false) => bottom[k] += n[k].abs(),
                (false, true) => top[k] += n[k].abs(),
                // Within neither, or of a sheet, which has no thickness.
                _ => {}
            }
        }
    }
    if area == 0.0 {
        return (Up::Y, "");
    }
    // What is wholly flat is a picture on a wall rather than a map.
    let is_thin = |of: f64| (0.002 * of..0.35 * of).contains(&extent.z);
    let is_relief = is_thin(extent.x) && is_thin(extent.y) && facing.z > 0.7 * area;
    if is_relief {
        return (Up::Z, ": it is flat along z");
    }
    // The share of the box's side that is flat at the bottom and not at the top; areas are twice what they should be.
    let stands = |k: usize| {
        let side = extent[(k + 1) % 3] * extent[(k + 2) % 3];
        if side > 0.0 { 0.5 * (bottom[k] - top[k]) / side } else { 0.0 }
    };
    if stands(2) > 0.2 && stands(2) > stands(1) + 0.2 {
        return (Up::Z, ": it stands on a flat side along z");
    }
    (Up::Y, "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use straal_math::Affine;
    use straal_scene::Mesh;

    fn asset(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> MeshAsset {
        let mesh = Mesh { positions: positions.to_vec(), triangles: triangles.to_vec(), ..Mesh::default() };
        MeshAsset { mesh: Arc::new(mesh), ..MeshAsset::default() }
    }

    #[test]
    fn what_is_up_is_turned_to_y() {
        for up in Up::ALL {
            let turned = up.turn().map_or(Affine::IDENTITY, |(axis, d)| Affine::rotate(axis, d).unwrap());
            assert!((turned.vector(up.axis()) - DVec3::Y).length() < 1e-12, "{up}");
            assert!((turned.determinant() - 1.0).abs() < 1e-12);
        }
        let z = Affine::rotate(DVec3::X, -90.0).unwrap();
        assert!(
            (z.vector(DVec3::new(0.0, -1.0, 0.0)) - DVec3::Z).length() < 1e-12,
            "the front of z up is -y"
        );
    }

    #[test]
    fn a_pyramid_stands_on_its_base() {
        let base = [[0, 1, 2], [0, 2, 3], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let z = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [0.5, 0.5, 1.0]];
        assert_eq!(guess(&asset(&z, &base)).0, Up::Z);
        let y = z.map(|[a, b, c]| [a, c, b]);
        assert_eq!(guess(&asset(&y, &base)).0, Up::Y);
    }

    #[test]
    fn a_sheet_lies_and_a_triangle_alone_says_nothing() {
        let sheet = [[0., 0., 0.], [1., 0., 0.01], [1., 1., 0.], [0., 1., 0.01]];
        assert_eq!(guess(&asset(&sheet, &[[0, 1, 2], [0, 2, 3]])).0, Up::Z);
        let poster = sheet.map(|[a, b, _]| [a, b, 0.0]);
        assert_eq!(guess(&asset(&poster, &[[0, 1, 2], [0, 2, 3]])).0, Up::Y);
        let floor = sheet.map(|[a, b, c]| [a, c, b]);
        assert_eq!(guess(&asset(&floor, &[[0, 1, 2], [0, 2, 3]])).0, Up::Y);
        let line = [[0., 0., 0.], [1., 0., 0.], [2., 0., 0.]];
        assert_eq!(guess(&asset(&line, &[[0, 1, 2]])).0, Up::Y);
        assert_eq!(guess(&asset(&[[f32::NAN; 3]], &[[0, 0, 0]])).0, Up::Y);
    }
}
