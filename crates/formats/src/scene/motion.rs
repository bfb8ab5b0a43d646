//! What moves while the shutter is open, between two places that a scene tells.

use straal_math::{Affine, DVec3};
use straal_scene::desc::{Step, Transform};
use straal_scene::value::Matrix;

/// Between two places that are turned against one another things go from one to the next of so many, each a straight way.
const TURNS: usize = 16;

/// How something goes from one place to another: a matrix for each of its times.
pub(super) fn transform(places: &[Affine]) -> Transform {
    let steps = |place: &Affine| {
        if place.is_identity() { Vec::new() } else { vec![Step::Matrix(Matrix(*place))] }
    };
    let Some((first, later)) = places.split_first() else { return Transform::default() };
    Transform { steps: steps(first), later: later.iter().map(steps).collect(), ..Transform::default() }
}

/// The places from one to another: two where nothing turns, as what is in between is then on a straight way.
pub(super) fn between(from: &Affine, to: &Affine) -> Vec<Affine> {
    let [a, b] = [from, to].map(Parts::of);
    let (Some(a), Some(b)) = (a, b) else { return vec![*from, *to] };
    let turns = a.turn.iter().zip(b.turn).map(|(x, y)| x * y).sum::<f64>().abs();
    if turns > 1.0 - 1e-12 {
        return vec![*from, *to];
    }
    let middle = (1..TURNS).map(|i| a.towards(&b, i as f64 / TURNS as f64));
    std::iter::once(*from).chain(middle).chain([*to]).collect()
}

/// A part of the way from one place to another.
pub(super) fn part(from: &Affine, to: &Affine, t: f64) -> Affine {
    match (Parts::of(from), Parts::of(to)) {
        _ if t <= 0.0 => *from,
        _ if t >= 1.0 => *to,
        (Some(a), Some(b)) => a.towards(&b, t),
        _ => Affine {
            rows: std::array::from_fn(|i| {
                std::array::from_fn(|j| from.rows[i][j] + (to.rows[i][j] - from.rows[i][j]) * t)
            }),
        },
    }
}

/// A place as a stretch, a turn and a move (Shoemake & Duff 1992).
struct Parts {
    stretch: [[f64; 3]; 3],
    /// A quaternion x, y, z, w.
    turn: [f64; 4],
    moved: DVec3,
}

impl Parts {
    /// Takes a place apart: the turn is the limit of means of a matrix and its inverse transposed (Higham 1986). None of a mirror image.
    fn of(place: &Affine) -> Option<Self> {
        let linear = |m: &Affine| Affine { rows: m.rows.map(|[a, b, c, _]| [a, b, c, 0.0]) };
        if place.determinant() <= 0.0 {
            return None;
        }
        let mut turn = linear(place);
        for _ in 0..60 {
            let inverse = turn.inverse()?;
            let next = Affine {
                rows: std::array::from_fn(|i| {
                    std::array::from_fn(|j| {
                        if j == 3 { 0.0 } else { 0.5 * (turn.rows[i][j] + inverse.rows[j][i]) }
                    })
                }),
            };
            let change = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
            let change: f64 = change.map(|(i, j)| (next.rows[i][j] - turn.rows[i][j]).abs()).sum();
            turn = next;
            if change < 1e-14 {
                break;
            }
        }
        // First the stretch, then the turn: the stretch is the turn back of all.
        let back = Affine {
            rows: std::array::from_fn(|i| [turn.rows[0][i], turn.rows[1][i], turn.rows[2][i], 0.0]),
        };
        let stretch = linear(place).then(&back);
        let [x, y, z] = place.rows.map(|row| row[3]);
        Some(Self {
            stretch: stretch.rows.map(|[a, b, c, _]| [a, b, c]),
            turn: quaternion(&turn),
            moved: DVec3::new(x, y, z),
        })
    }

    /// A part of the way to another.
    fn towards(&self, other: &Self, t: f64) -> Affine {
        let turn = super::gltf::slerp(&self.turn, &other.turn, t);
        let turn = super::gltf::rotation([turn[0], turn[1], turn[2], turn[3]]);
        let stretch = Affine {
            rows: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    if j == 3 {
                        0.0
                    } else {
                        self.stretch[i][j] + (other.stretch[i][j] - self.stretch[i][j]) * t
                    }
                })
            }),
        };
        let moved = self.moved + (other.moved - self.moved) * t;
        stretch.then(&turn).then(&Affine::translate(moved))
    }
}

/// The quaternion of a turn (Shepperd 1978): by the largest of its four numbers.
pub(super) fn quaternion(m: &Affine) -> [f64; 4] {
    let r = &m.rows;
    let squares = [
        1.0 + r[0][0] - r[1][1] - r[2][2],
        1.0 - r[0][0] + r[1][1] - r[2][2],
        1.0 - r[0][0] - r[1][1] + r[2][2],
        1.0 + r[0][0] + r[1][1] + r[2][2],
    ];
    let largest = (0..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let twice = squares[largest].sqrt();
    let over = 0.5 / twice;
    let skew = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]].map(|v| v * over);
    let both = |i: usize, j: usize| (r[i][j] + r[j][i]) * over;
    let half = 0.5 * twice;
    match largest {
        0 => [half, both(0, 1), both(0, 2), skew[0]],
        1 => [both(0, 1), half, both(1, 2), skew[1]],
        2 => [both(0, 2), both(1, 2), half, skew[2]],
        _ => [skew[0], skew[1], skew[2], half],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: &Affine, b: &Affine) -> bool {
        a.rows.as_flattened().iter().zip(b.rows.as_flattened()).all(|(x, y)| (x - y).abs() < 1e-12)
    }

    #[test]
    fn what_only_moves_goes_straight() {
        let to = Affine::scale(DVec3::new(1.0, 2.0, 3.0)).then(&Affine::translate(DVec3::X));
        assert_eq!(between(&Affine::IDENTITY, &to), [Affine::IDENTITY, to]);
        assert_eq!(transform(&[Affine::IDENTITY, to]).later.len(), 1);
    }

    #[test]
    fn what_turns_goes_around() {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, -2.0, 0.5)] {
            let turned = |degrees: f64| {
                let turn = Affine::rotate(axis, degrees).unwrap();
                Affine::scale(DVec3::splat(2.0)).then(&turn).then(&Affine::translate(DVec3::Z * degrees))
            };
            for (start, end) in [(0.0, 90.0), (20.0, 190.0), (-170.0, 5.0)] {
                let places = between(&turned(start), &turned(end));
                assert_eq!(places.len(), TURNS + 1);
                for (i, place) in places.iter().enumerate() {
                    let wanted = turned(start + (end - start) * i as f64 / TURNS as f64);
                    assert!(near(place, &wanted), "{axis:?} {i}: {place:?} is not {wanted:?}");
                }
            }
        }
    }

    #[test]
    fn mirror_images_are_told_at_both_ends_only() {
        let mirror = Affine::scale(DVec3::new(-1.0, 1.0, 1.0));
        let turned = mirror.then(&Affine::rotate(DVec3::Y, 90.0).unwrap());
        assert_eq!(between(&mirror, &turned).len(), 2);
    }
}
