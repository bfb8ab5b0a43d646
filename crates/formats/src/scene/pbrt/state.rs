//! The graphics state: what directives change, and what comes back at the end of a block.

use std::rc::Rc;

use straal_color::Space;
use straal_math::{Affine, DVec3};
use straal_scene::desc::{Step, Transform};
use straal_scene::value::Matrix;
use straal_scene::{Span, Spanned};

use super::lights::AreaLight;
use super::params::Param;

/// The current transform when the shutter opens, and when it closes.
pub(super) type Transforms = [Affine; 2];

/// Parameters that `Attribute` says for all of a kind.
#[derive(Clone, Default)]
pub(super) struct Attributes {
    pub shape: Option<Rc<Vec<Param>>>,
    pub light: Option<Rc<Vec<Param>>>,
    pub material: Option<Rc<Vec<Param>>>,
    pub medium: Option<Rc<Vec<Param>>>,
    pub texture: Option<Rc<Vec<Param>>>,
}

/// What a shape is made of.
#[derive(Clone)]
pub(super) enum Surface {
    /// pbrt's own where nothing is said: diffuse, 0.5.
    Plain,
    /// One of the scene's materials, as straal's scene calls it.
    Named(Rc<Spanned<String>>),
    /// None at all: a boundary of media.
    Nothing,
}

/// All that is the same until a directive changes it.
#[derive(Clone)]
pub(super) struct State {
    pub transforms: Transforms,
    /// Which of the two are changed.
    pub active: [bool; 2],
    pub reversed: bool,
    pub surface: Surface,
    pub area_light: Option<Rc<AreaLight>>,
    /// Whether shapes bound a medium.
    pub has_media: bool,
    pub space: Space,
    pub attributes: Attributes,
}

impl Default for State {
    fn default() -> Self {
        Self {
            transforms: [Affine::IDENTITY; 2],
            active: [true; 2],
            reversed: false,
            surface: Surface::Plain,
            area_light: None,
            has_media: false,
            space: Space::Srgb,
            attributes: Attributes::default(),
        }
    }
}

/// Why a state was put by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Why {
    Attributes,
    Object,
    Import,
}

/// A state that comes back.
pub(super) struct Saved {
    pub why: Why,
    /// Where it was put by.
    pub span: Span,
    pub state: State,
}

impl State {
    /// Applies a map before all that were applied so far.
    pub fn concat(&mut self, map: &Affine) {
        for (transform, _) in self.transforms.iter_mut().zip(self.active).filter(|(_, active)| *active) {
            *transform = map.then(transform);
        }
    }

    /// Puts a map in place of what there is.
    pub fn set(&mut self, map: &Affine) {
        for (transform, _) in self.transforms.iter_mut().zip(self.active).filter(|(_, active)| *active) {
            *transform = *map;
        }
    }

    /// The current transform, at the beginning of its motion.
    pub const fn transform(&self) -> &Affine {
        &self.transforms[0]
    }

    /// Whether it moves.
    pub fn moves(&self) -> bool {
        self.transforms[0] != self.transforms[1]
    }
}

/// A map as a description says it.
pub(super) fn as_transform(map: &Affine, span: Span) -> Transform {
    let steps = if map.is_identity() { Vec::new() } else { vec![Step::Matrix(Matrix(*map))] };
    Transform::of(steps, span)
}

/// By how much a map makes lengths longer, on the whole.
pub(super) fn scale_of(map: &Affine) -> f64 {
    straal_math::ops::pow_d(map.determinant().abs(), 1.0 / 3.0)
}

/// A matrix of sixteen numbers, column by column; `None` when it is none that keeps parallels.
pub(super) fn matrix(m: &[f64; 16]) -> Option<Affine> {
    let w = m[15];
    if [m[3], m[7], m[11]] != [0.0; 3] || w == 0.0 {
        return None;
    }
    let cell = |i: usize, j: usize| m[4 * j + i] / w;
    Some(Affine { rows: std::array::from_fn(|i| std::array::from_fn(|j| cell(i, j))) })
}

/// The transform from the world to a camera at `eye` that looks along its +z, with x to the right in the picture; `None` where it has no direction.
pub(super) fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Option<Affine> {
    let forward = (target - eye).try_normalize()?;
    let right = up.try_normalize()?.cross(forward);
    if right.length() < 1e-9 {
        return None;
    }
    let right = right.try_normalize()?;
    let up = forward.cross(right);
    let row = |v: DVec3| [v.x, v.y, v.z, -v.dot(eye)];
    Some(Affine { rows: [row(right), row(up), row(forward)] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_of_pbrt_looks_along_z_with_x_to_the_right() {
        let m = look_at(DVec3::new(0.0, 0.0, -5.0), DVec3::ZERO, DVec3::Y).unwrap();
        assert_eq!(m.point(DVec3::ZERO), DVec3::new(0.0, 0.0, 5.0));
        assert_eq!(m.point(DVec3::new(2.0, 1.0, 0.0)), DVec3::new(2.0, 1.0, 5.0));
        assert!(look_at(DVec3::ZERO, DVec3::Y, DVec3::Y).is_none());
    }

    #[test]
    fn matrices_are_told_by_columns() {
        let mut m = [0.0; 16];
        (m[0], m[5], m[10], m[15]) = (1.0, 1.0, 1.0, 1.0);
        (m[12], m[13], m[14]) = (7.0, 8.0, 9.0);
        assert_eq!(matrix(&m).unwrap(), Affine::translate(DVec3::new(7.0, 8.0, 9.0)));
        m[3] = 0.1;
        assert_eq!(matrix(&m), None);
    }

    #[test]
    fn the_last_transform_comes_first() {
        let mut state = State::default();
        state.concat(&Affine::translate(DVec3::X));
        state.concat(&Affine::scale(DVec3::splat(2.0)));
        assert_eq!(state.transform().point(DVec3::X), DVec3::new(3.0, 0.0, 0.0));
        state.active = [true, false];
        state.concat(&Affine::translate(DVec3::Y));
        assert!(state.moves());
    }
}
