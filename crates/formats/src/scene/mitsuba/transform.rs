//! `<transform>`: steps, each applied after those before it.

use roxmltree::Node;
use straal_math::{Affine, DVec3};

use super::xml::{Reader, numbers};
use straal_scene::Diagnostic;

impl Reader<'_, '_> {
    /// All steps as one map; a step that is wrong is told and left out.
    pub(super) fn transform(&mut self, element: Node<'_, '_>) -> Affine {
        let mut all = Affine::IDENTITY;
        for step in element.children().filter(Node::is_element) {
            if let Some(step) = self.step(step) {
                all = all.then(&step);
            }
        }
        if !all.is_finite() {
            self.fail(element, "the numbers of this transform are beyond what can be computed with");
            return Affine::IDENTITY;
        }
        all
    }

    fn step(&mut self, element: Node<'_, '_>) -> Option<Affine> {
        match element.tag_name().name() {
            "translate" => {
                self.only(element, &["value", "x", "y", "z"]);
                Some(Affine::translate(self.three(element, 0.0)?))
            }
            "scale" => {
                self.only(element, &["value", "x", "y", "z"]);
                Some(Affine::scale(self.three(element, 1.0)?))
            }
            "rotate" => {
                self.only(element, &["value", "x", "y", "z", "angle"]);
                let axis = self.three(element, 0.0)?;
                let angle = self.number(element, "angle")?;
                let turn = Affine::rotate(axis, angle);
                if turn.is_none() {
                    self.fail(element, "this rotation has no axis: `x`, `y` and `z` are all 0");
                }
                turn
            }
            "lookat" | "lookAt" => {
                self.only(element, &["origin", "target", "up"]);
                let origin = self.vector(element, "origin")?;
                let target = self.vector(element, "target")?;
                let up = if element.has_attribute("up") { self.vector(element, "up")? } else { DVec3::ZERO };
                let found = look_at(origin, target, up);
                if found.is_none() {
                    self.fail(element, "this `lookat` has no direction: `origin` and `target` are the same, or `up` is along the view");
                }
                found
            }
            "matrix" => {
                self.only(element, &["value"]);
                let text = self.attribute(element, "value")?;
                let all = numbers(&text);
                let rows = match all.as_deref() {
                    Some(&[a, b, c, d, e, f, g, h, i]) => [[a, b, c, 0.0], [d, e, f, 0.0], [g, h, i, 0.0]],
                    Some(&[a, b, c, d, e, f, g, h, i, j, k, l, 0.0, 0.0, 0.0, 1.0]) => {
                        [[a, b, c, d], [e, f, g, h], [i, j, k, l]]
                    }
                    Some(m) if m.len() == 16 => {
                        let message = "this matrix isn't affine: its last row must be 0 0 0 1";
                        self.fail_at(element, "value", message);
                        return None;
                    }
                    _ => {
                        self.fail_at(element, "value", "a matrix has 16 or 9 numbers");
                        return None;
                    }
                };
                Some(Affine { rows })
            }
            other => {
                let known = ["translate", "scale", "rotate", "lookat", "matrix"];
                let message =
                    format!("`<{}>` is no step of a transform", straal_scene::suggest::brief(other));
                let help = straal_scene::suggest::did_you_mean(other, known);
                let span = self.span(element);
                self.push(Diagnostic::error(span, message).maybe_help(help));
                None
            }
        }
    }
}

/// +z looks from the origin to the target, +y is up and +x to the left. An `up` of zeros is any.
fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> Option<Affine> {
    let ahead = (target - origin).try_normalize()?;
    let up = if up == DVec3::ZERO { if ahead.y.abs() < 0.9 { DVec3::Y } else { DVec3::X } } else { up };
    let left = up.try_normalize()?.cross(ahead);
    let left = if left.length() < 1e-9 { return None } else { left.try_normalize()? };
    let up = ahead.cross(left);
    Some(Affine {
        rows: [
            [left.x, up.x, ahead.x, origin.x],
            [left.y, up.y, ahead.y, origin.y],
            [left.z, up.z, ahead.z, origin.z],
        ],
    })
}
