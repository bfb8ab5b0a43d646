//! What a goniometer measured of a lamp: its luminous intensity by direction.

/// How two angles say a direction: the systems of planes of CIE 121 and of IES LM-75.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Planes {
    /// Half-planes about the lamp's main axis, 0 to 360 degrees around it, and in each the angle from that axis, 0 to 180: of most luminaires, which hang with the axis
    /// downwards.
    #[default]
    C,
    /// Planes about a level axis across, turned up by -90 to 90 degrees, and in each the angle to the side: of floodlights, which stand with the main axis forward.
    B,
    /// Planes about the upright axis, turned to the side, and in each the angle upwards: of head lamps.
    A,
}

/// A lamp's intensity in candela, at all pairs of a plane and an angle; what symmetry says of it has been written out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Photometry {
    /// What the angles are.
    pub system: Planes,
    /// Planes in degrees, rising. One alone stands for all around; of system C they go from 0 to 360 else.
    pub planes: Vec<f64>,
    /// Angles in each plane in degrees, rising; beyond them it is dark.
    pub angles: Vec<f64>,
    /// Intensities, plane after plane.
    pub candela: Vec<f32>,
}

impl Photometry {
    /// Whether there is a number for each pair, and the angles rise.
    pub fn is_whole(&self) -> bool {
        let rises =
            |v: &[f64]| !v.is_empty() && v.windows(2).all(|w| w[0] < w[1]) && v.iter().all(|v| v.is_finite());
        rises(&self.planes)
            && rises(&self.angles)
            && self.planes.len().checked_mul(self.angles.len()) == Some(self.candela.len())
            && self.candela.iter().all(|v| v.is_finite() && *v >= 0.0)
    }

    /// The intensity in cd at a plane and an angle in degrees, straight between those that were measured.
    pub fn at(&self, plane: f64, angle: f64) -> f64 {
        let Some((i, s)) = between(&self.planes, plane).or((self.planes.len() == 1).then_some((0, 0.0)))
        else {
            return 0.0;
        };
        let Some((j, t)) = between(&self.angles, angle).or((self.angles.len() == 1).then_some((0, 0.0)))
        else {
            return 0.0;
        };
        let n = self.angles.len();
        let value = |i: usize, j: usize| {
            let at = i.min(self.planes.len() - 1) * n + j.min(n - 1);
            self.candela.get(at).map_or(0.0, |v| f64::from(*v))
        };
        let row = |i: usize| value(i, j) * (1.0 - t) + value(i, j + 1) * t;
        row(i) * (1.0 - s) + row(i + 1) * s
    }

    /// Bytes that it takes.
    pub fn heap_bytes(&self) -> u64 {
        (8 * (self.planes.len() + self.angles.len()) + 4 * self.candela.len()) as u64
    }
}

/// Between which two of a rising list a number lies: the first of them, and the share of the second; `None` beyond its ends.
fn between(list: &[f64], v: f64) -> Option<(usize, f64)> {
    let (first, last) = (*list.first()?, *list.last()?);
    if list.len() < 2 || v.is_nan() || v < first || v > last {
        return None;
    }
    let next = list.partition_point(|x| *x <= v).clamp(1, list.len() - 1);
    let (a, b) = (list[next - 1], list[next]);
    Some((next - 1, (v - a) / (b - a)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_measured_angles_it_is_straight() {
        let lamp = Photometry {
            planes: vec![0.0, 180.0, 360.0],
            angles: vec![0.0, 30.0, 90.0],
            candela: vec![100.0, 50.0, 0.0, 100.0, 10.0, 0.0, 100.0, 50.0, 0.0],
            ..Photometry::default()
        };
        assert!(lamp.is_whole());
        assert_eq!((lamp.at(0.0, 0.0), lamp.at(0.0, 15.0), lamp.at(180.0, 60.0)), (100.0, 75.0, 5.0));
        assert_eq!((lamp.at(90.0, 30.0), lamp.at(360.0, 30.0), lamp.at(0.0, 91.0)), (30.0, 50.0, 0.0));
        let round = Photometry { planes: vec![0.0], candela: vec![4.0, 2.0, 0.0], ..lamp };
        assert_eq!((round.at(0.0, 15.0), round.at(123.0, 15.0)), (3.0, 3.0));
        assert!(!Photometry { candela: vec![1.0], ..round }.is_whole() && !Photometry::default().is_whole());
    }
}
