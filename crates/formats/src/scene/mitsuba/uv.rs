//! Where a surface's texture coordinates are, as Mitsuba has them and as straal does.
//!
//! Mitsuba's coordinates of a surface go through a texture's `to_uv` and then to a picture, whose first row lies at v = 0; straal's last row
//! does. A shape whose own coordinates are others here is mapped by places in space, or has them turned over.

use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::{Mapping, MappingSpace, PolarMapping, SphericalMapping, Step, Transform, UvMapping};
use straal_scene::value::Matrix;

/// How Mitsuba's coordinates come of straal's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Uv {
    /// They are the same.
    #[default]
    Same,
    /// v is turned over: of meshes whose files have it from the first row on.
    FlipV,
    /// u is turned over: of a rectangle that is seen from its other side.
    FlipU,
    /// u is the distance from the middle, and v goes once around it from +x.
    Disc,
    /// About the shape's own y, which is Mitsuba's z, from its +z, Mitsuba's x; v is 0 at +y.
    Ball,
}

/// Two rows of a map of the plane; the last number of each is added.
type Plane = [[f64; 3]; 2];

const SAME: Plane = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
const FLIP_V: Plane = [[1.0, 0.0, 0.0], [0.0, -1.0, 1.0]];

/// First `a`, then `b`.
fn then(a: &Plane, b: &Plane) -> Plane {
    b.map(|row| {
        let of = |k: usize| row[0] * a[0][k] + row[1] * a[1][k];
        [of(0), of(1), of(2) + row[2]]
    })
}

impl Uv {
    /// What of a name tells a material for these from one for others.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Same => "",
            Self::FlipV => "v turned over",
            Self::FlipU => "u turned over",
            Self::Disc => "on a disc",
            Self::Ball => "on a ball",
        }
    }

    /// The mapping of a texture with this `to_uv`, and whether it is one that straal can say. A picture has its rows the other way round.
    pub fn mapping(self, to_uv: &Affine, is_picture: bool) -> (Mapping, bool) {
        let [x, y, _] = to_uv.rows;
        let to_uv: Plane = [[x[0], x[1], x[3]], [y[0], y[1], y[3]]];
        let from = match self {
            Self::Same => SAME,
            Self::FlipV | Self::Ball => FLIP_V,
            Self::FlipU => [[-1.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
            Self::Disc => [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
        };
        let all = then(&from, &to_uv);
        let all = if is_picture { then(&all, &FLIP_V) } else { all };
        let (uv, is_exact) = steps(&all);
        let space = MappingSpace::Object;
        let mapping = match self {
            Self::Disc => Mapping::Polar(PolarMapping { space, uv, transform: Transform::default() }),
            Self::Ball => {
                // u begins behind.
                let half_turn = Affine::scale(DVec3::new(-1.0, 1.0, -1.0));
                Mapping::Spherical(SphericalMapping { space, uv, transform: placed(&half_turn) })
            }
            _ => Mapping::Uv(uv),
        };
        (mapping, is_exact)
    }
}

/// A transform of one matrix, or of nothing.
pub(super) fn placed(m: &Affine) -> Transform {
    let steps = if m.is_identity() { Vec::new() } else { vec![Step::Matrix(Matrix(*m))] };
    Transform { steps, ..Transform::default() }
}

/// A map of the plane as a scale, then a turn, then a move; and whether it is one.
fn steps(m: &Plane) -> (UvMapping, bool) {
    let [[a, b, x], [c, d, y]] = *m;
    let [first, second] = [a * a + c * c, b * b + d * d].map(f64::sqrt);
    let translate = [x, y];
    if b == 0.0 && c == 0.0 {
        return (UvMapping { scale: [a, d], rotate: 0.0, translate }, true);
    }
    let angle = |sin: f64, cos: f64| ops::atan2_d(sin, cos).to_degrees();
    let rotate = if first > 0.0 { angle(c, a) } else { angle(-b, d) };
    let (sin, cos) = ops::sin_cos_degrees(rotate);
    let across = cos * d - sin * b;
    let lean = cos * b + sin * d;
    let scale = [first, if first > 0.0 { across } else { second }];
    let size = if first > second { first } else { second };
    (UvMapping { scale, rotate, translate }, lean.abs() <= 1e-6 * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a `UvMapping` does.
    fn apply(m: &UvMapping, [u, v]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = ops::sin_cos_degrees(m.rotate);
        let (u, v) = (u * m.scale[0], v * m.scale[1]);
        [cos * u - sin * v + m.translate[0], sin * u + cos * v + m.translate[1]]
    }

    #[test]
    fn pictures_are_turned_over_after_their_own_transform() {
        let turn = Affine::rotate(DVec3::Z, 30.0).unwrap();
        let to_uv = Affine::scale(DVec3::new(2.0, 1.5, 1.0))
            .then(&turn)
            .then(&Affine::translate(DVec3::new(0.1, 0.2, 0.0)));
        for uv in [[0.0, 0.0], [1.0, 0.0], [0.3, 0.7]] {
            let want = to_uv.point(DVec3::new(uv[0], uv[1], 0.0));
            let (Mapping::Uv(same), true) = Uv::Same.mapping(&to_uv, true) else { panic!() };
            let got = apply(&same, uv);
            assert!((got[0] - want.x).abs() < 1e-12 && (got[1] - (1.0 - want.y)).abs() < 1e-12, "{got:?}");
            let (Mapping::Uv(over), true) = Uv::FlipV.mapping(&to_uv, false) else { panic!() };
            let got = apply(&over, [uv[0], 1.0 - uv[1]]);
            assert!((got[0] - want.x).abs() < 1e-12 && (got[1] - want.y).abs() < 1e-12, "{got:?}");
            let (Mapping::Polar(disc), true) = Uv::Disc.mapping(&to_uv, false) else { panic!() };
            let got = apply(&disc.uv, [uv[1], uv[0]]);
            assert!((got[0] - want.x).abs() < 1e-12 && (got[1] - want.y).abs() < 1e-12, "{got:?}");
        }
    }

    #[test]
    fn a_picture_from_a_mesh_with_rows_from_below_is_as_it_is() {
        assert_eq!(Uv::FlipV.mapping(&Affine::IDENTITY, true).0, Mapping::default());
    }

    #[test]
    fn what_leans_is_told() {
        let turn = Affine::rotate(DVec3::Z, 30.0).unwrap();
        let leaning = turn.then(&Affine::scale(DVec3::new(2.0, 1.0, 1.0)));
        assert!(!Uv::Same.mapping(&leaning, false).1);
    }
}
