//! Cameras, and the view of a file that has none.

use straal_math::{Affine, DVec3};
use straal_scene::desc::{Camera, FovAxis, Keyframe, Keyframes, Observer, Orthographic, Perspective};
use straal_scene::{Diagnostic, Span, Spanned, suggest};

use super::document::{Fault, Result, number, required, text};
use super::json::Json;
use super::tree::Tree;
use super::{Translation, Within, degrees};
use crate::studio::{self, Side};

/// Pixels of a picture, whatever its shape.
const AREA: f64 = 360_000.0;

impl<'a> Translation<'a, '_> {
    /// The camera of the scene: the first, or the one that is asked for; where there is none, one that shows all.
    pub fn view(&mut self, tree: &Tree<'a>, later: &[Tree<'a>], centre: DVec3) -> Result<()> {
        let cameras: Vec<(usize, &Json)> =
            tree.shown.iter().filter_map(|&node| Some((node, tree.nodes[node].get("camera")?))).collect();
        let wanted = self.means.define.get("camera").cloned();
        let mut chosen = cameras.first().copied();
        if let Some(wanted) = &wanted {
            let names: Vec<String> =
                cameras.iter().map(|(node, at)| self.camera_name(tree, *node, at)).collect();
            let found = names.iter().position(|name| name == wanted);
            let found = found.or_else(|| wanted.parse().ok().filter(|i| *i < cameras.len()));
            let Some(found) = found else {
                let has = if names.is_empty() {
                    "it has none".to_owned()
                } else {
                    format!("it has {}", names.join(", "))
                };
                let message = format!("`{}` has no camera `{}`: {has}", self.name, suggest::brief(wanted));
                self.means.d.push(Diagnostic::error(Span::NONE, message));
                return Ok(());
            };
            chosen = Some(cameras[found]);
        } else if cameras.len() > 1 {
            let names: Vec<String> =
                cameras.iter().map(|(node, at)| self.camera_name(tree, *node, at)).collect();
            let message = format!(
                "`{}` has {} cameras: {}; it is seen through the first",
                self.name,
                names.len(),
                names.join(", ")
            );
            self.means.d.push(Diagnostic::note(Span::NONE, message).help("`-D camera=NAME` says another"));
        }
        if let Some((node, at)) = chosen {
            let (_, said) = self.document.item("cameras", at)?;
            let place = |tree: &Tree<'_>| stand(tree.globals[node].unwrap_or(Affine::IDENTITY), centre);
            if let Some(mut observer) = place(tree) {
                observer.moving_to = moving(&observer, later.iter().filter_map(place));
                let (camera, size) = camera(said, observer)?;
                self.scene.camera = camera;
                self.scene.film.size = size;
                return Ok(());
            }
            self.warn(&tree.nodes[node], "the camera is left out: its node's scale leaves no direction");
        }
        let size = self.means.size.unwrap_or(studio::SIZE);
        self.scene.film.size = size;
        // What is flat and upright, like a page, is seen from the front.
        let [min, max] = self.extent().unwrap_or([DVec3::ZERO, DVec3::ONE]);
        let [x, y, z] = (max - min).to_array();
        let side = if z < 0.25 * if x > y { x } else { y } { Side::Front } else { Side::ThreeQuarter };
        self.is_fitted = true;
        self.scene.camera = studio::fitting(&self.corners, side, size);
        Ok(())
    }

    /// What a camera is called: as itself or its node is, or by its number.
    fn camera_name(&self, tree: &Tree<'_>, node: usize, at: &Json) -> String {
        let said = self.document.item("cameras", at).ok().map(|(_, said)| said);
        let named = [Some(&tree.nodes[node]), said].into_iter().flatten();
        let name = named.filter_map(|of| of.get("name")?.text()).find(|name| !name.is_empty());
        name.map_or_else(|| format!("nodes[{node}]"), |name| suggest::brief(name).to_string())
    }

    /// The box around all that is seen.
    pub fn extent(&self) -> Option<[DVec3; 2]> {
        let first = *self.corners.first()?;
        Some(self.corners.iter().fold([first; 2], |[min, max], p| [min.min(*p), max.max(*p)]))
    }
}

/// Where a camera's node stands, looking along its -z with its y up, at what is as far as the scene's middle.
fn stand(place: Affine, centre: DVec3) -> Option<Observer> {
    let eye = place.point(DVec3::ZERO);
    let (view, up) = (place.vector(-DVec3::Z).try_normalize()?, place.vector(DVec3::Y).try_normalize()?);
    let far = (centre - eye).dot(view);
    let far = if far > 1e-3 { far } else { 1.0 };
    let look_at = eye + view * far;
    Affine::look_at(eye, look_at, up)?;
    Some(Observer { eye, look_at, up, ..Observer::default() })
}

/// Where a camera goes while the shutter is open, if it moves.
fn moving(from: &Observer, later: impl Iterator<Item = Observer>) -> Option<Keyframes> {
    let keyframe = |o: Observer| Keyframe {
        eye: Some(o.eye),
        look_at: Some(o.look_at),
        up: Some(o.up),
        ..Keyframe::default()
    };
    let there: Vec<Observer> = later.collect();
    let moves = there.iter().any(|o| (o.eye, o.look_at, o.up) != (from.eye, from.look_at, from.up));
    let keyframes = there.into_iter().map(|o| Spanned::new(keyframe(o), Span::NONE)).collect();
    moves.then_some(Keyframes { keyframes })
}

/// A camera and the size of its picture.
fn camera(said: &Json, observer: Observer) -> Result<(Camera, [u32; 2])> {
    let kind = required(said, "type")?;
    match text(kind)? {
        "perspective" => {
            let of = required(said, "perspective")?;
            let at = required(of, "yfov")?;
            let fov = degrees(number(at)?);
            if !(fov > 0.0 && fov < 180.0) {
                return Err(Fault::of(at, "the angle must be between 0 and pi"));
            }
            let size = match of.get("aspectRatio") {
                Some(at) => shape(positive(at)?),
                None => studio::SIZE,
            };
            let camera =
                Perspective { fov: Some(fov), fov_axis: FovAxis::Y, observer, ..Perspective::default() };
            Ok((Camera::Perspective(camera), size))
        }
        "orthographic" => {
            let of = required(said, "orthographic")?;
            let [x, y] = ["xmag", "ymag"].map(|key| positive(required(of, key)?));
            let (x, y) = (x?, y?);
            Ok((Camera::Orthographic(Orthographic { width: 2.0 * x, observer }), shape(x / y)))
        }
        _ => Err(Fault::of(kind, "a camera is `perspective` or `orthographic`")),
    }
}

/// A number above 0; a mirror image isn't made by the size of the view.
fn positive(at: &Json) -> Result<f64> {
    let v = number(at)?.abs();
    if v > 0.0 { Ok(v) } else { Err(Fault::of(at, "a number above 0 was expected")) }
}

/// The size of a picture of that width over height.
fn shape(aspect: f64) -> [u32; 2] {
    let aspect = aspect.within(1.0 / 64.0, 64.0);
    let height = (AREA / aspect).sqrt().round();
    [(height * aspect).round() as u32, height as u32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_have_their_shape() {
        assert_eq!(shape(1.0), [600, 600]);
        assert_eq!(shape(16.0 / 9.0), [800, 450]);
        assert_eq!(shape(1e9)[1], 75);
    }
}
