//! The camera, as a node that looks along its -z with its y up.

use serde_json::json;
use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::{Camera, FovAxis, Observer, Perspective};

use super::Out;

/// glTF wants a distance before which nothing is seen: so much of that to what is looked at.
const NEAR: f64 = 1e-3;

impl Out<'_> {
    /// The node of the camera, if glTF has one like it.
    pub fn camera(&mut self) -> Option<usize> {
        let [width, height] = self.scene.film.size.map(f64::from);
        let aspect = width / height;
        let (camera, observer) = match &self.scene.camera {
            Camera::Perspective(p) => {
                for (is_said, what) in [
                    (p.lens.is_some(), "the camera's lens is left out: all is sharp"),
                    (p.stereo.is_some(), "one eye is written in place of two"),
                    (p.shift != [0.0; 2], "the shift of the camera's picture is left out"),
                ] {
                    if is_said {
                        self.tell(what);
                    }
                }
                let near = NEAR * p.observer.distance();
                let yfov = upright(p, self.scene.film.size);
                let said = json!({ "yfov": yfov, "aspectRatio": aspect, "znear": near });
                (json!({ "type": "perspective", "perspective": said }), &p.observer)
            }
            Camera::Orthographic(o) => {
                let x = 0.5 * o.width;
                // Nothing is cut off that stands within a thousand times what is looked at.
                let far = o.observer.distance() / NEAR;
                let said = json!({ "xmag": x, "ymag": x / aspect, "znear": 0.0, "zfar": far });
                (json!({ "type": "orthographic", "orthographic": said }), &o.observer)
            }
            _ => {
                self.tell("the camera is left out: glTF has perspective and orthographic ones");
                return None;
            }
        };
        let track = self.frames.and_then(super::Frames::of_camera);
        for (is_said, what) in [
            (observer.mirror, "the camera's picture isn't mirrored"),
            (
                observer.moving_to.is_some() && track.is_none(),
                "what moves stands where it is when the shutter opens",
            ),
        ] {
            if is_said {
                self.tell(what);
            }
        }
        let place = stand(observer)?;
        let camera = self.cameras.add(camera);
        let (mut node, parts) = self.standing(&place, track);
        node.insert("name".to_owned(), json!("camera"));
        node.insert("camera".to_owned(), json!(camera));
        let index = self.nodes.add(node.into());
        self.moves(index, &parts);
        Some(index)
    }
}

/// Where a camera stands.
pub(super) fn stand(observer: &Observer) -> Option<Affine> {
    let Observer { eye, look_at, up, roll, .. } = *observer;
    let stands = Affine::look_at(eye, look_at, up)?;
    if roll == 0.0 {
        return Some(stands);
    }
    // Clockwise for who looks along -z.
    Some(Affine::rotate(DVec3::Z, -roll)?.then(&stands))
}

/// The angle from the lower to the upper edge of the picture, in radians.
fn upright(p: &Perspective, size: [u32; 2]) -> f64 {
    let is_plain = p.focal_length.is_none() && p.view_distance.is_none() && p.zoom == 1.0;
    if let (Some(fov), FovAxis::Y, true) = (p.fov, &p.fov_axis, is_plain) {
        return fov.to_radians();
    }
    let [width, height] = size.map(f64::from);
    2.0 * ops::atan2_d(p.tan_x(size, size) * height / width, 1.0)
}
