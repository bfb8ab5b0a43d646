//! Affine maps that change with time.

use crate::{Affine, Transform};

/// Where something is while a shutter is open: maps at even times from 0 to 1, between which numbers are mixed. So a point goes along straight
/// lines from one to the next, and what holds it at these times holds it between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    keys: Vec<Affine>,
    /// At the times of the keys; what stands in where a mixture is singular.
    transforms: Vec<Transform>,
}

impl Motion {
    /// By two maps or more; `None` when there are fewer or any of them has no inverse.
    pub fn new(keys: Vec<Affine>) -> Option<Self> {
        let transforms = keys.iter().map(Transform::new).collect::<Option<Vec<_>>>()?;
        (keys.len() > 1).then_some(Self { keys, transforms })
    }

    /// The maps, from time 0 to time 1.
    pub fn transforms(&self) -> &[Transform] {
        &self.transforms
    }

    /// Where it is at a time from 0 to 1.
    pub fn at(&self, time: f32) -> Transform {
        let last = self.keys.len() - 1;
        let along = f64::from(time) * last as f64;
        // Beyond the ends and where it is no number, the first or the last.
        let before = (along as usize).min(last - 1);
        let part = along - before as f64;
        let part = if part > 1.0 { 1.0 } else { part };
        if part <= 0.0 || part.is_nan() {
            return self.transforms[before];
        }
        let (a, b) = (&self.keys[before].rows, &self.keys[before + 1].rows);
        let mixed = |i: usize, j: usize| a[i][j] + (b[i][j] - a[i][j]) * part;
        let rows = std::array::from_fn(|i| std::array::from_fn(|j| mixed(i, j)));
        Transform::new(&Affine { rows }).unwrap_or(self.transforms[before])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DVec3, Vec3};

    #[test]
    fn it_is_at_its_keys_and_on_lines_between() {
        let keys = [0.0, 1.0, 4.0].map(|x| Affine::translate(DVec3::new(x, 2.0, 0.0)));
        let motion = Motion::new(keys.to_vec()).unwrap();
        let at = |time| motion.at(time).point(Vec3::ZERO);
        for (time, x) in
            [(-1.0, 0.0), (0.0, 0.0), (0.25, 0.5), (0.5, 1.0), (0.75, 2.5), (1.0, 4.0), (2.0, 4.0)]
        {
            assert_eq!(at(time), Vec3::new(x, 2.0, 0.0), "{time}");
        }
        assert_eq!(at(f32::NAN), Vec3::new(0.0, 2.0, 0.0));
        let inverse = motion.at(0.75).inverse_point(Vec3::new(2.5, 2.0, 0.0));
        assert_eq!(inverse, Vec3::ZERO);
    }

    #[test]
    fn what_has_no_inverse_is_no_motion() {
        let flat = Affine::scale(DVec3::new(1.0, 0.0, 1.0));
        assert!(Motion::new(vec![Affine::IDENTITY, flat]).is_none());
        assert!(Motion::new(vec![Affine::IDENTITY]).is_none());
        // From one to its mirror image all is flat halfway: it stays where it was.
        let turned = Affine::scale(DVec3::new(-1.0, -1.0, 1.0));
        let motion = Motion::new(vec![Affine::IDENTITY, turned]).unwrap();
        assert_eq!(motion.at(0.5), Transform::IDENTITY);
    }
}
