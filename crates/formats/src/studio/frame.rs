//! Where the camera of a studio stands.

use straal_math::{DVec3, ops};
use straal_scene::desc::{Camera, FovAxis, Observer, Perspective};

/// From where a mesh is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// From the front, the right and a little above.
    #[default]
    ThreeQuarter,
    /// From the front.
    Front,
    /// From behind.
    Back,
    /// From the left of who looks at the front.
    Left,
    /// From the right of who looks at the front.
    Right,
    /// From above, the front below in the picture.
    Top,
}

impl Side {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Front, Self::Back, Self::Left, Self::Right, Self::Top, Self::ThreeQuarter];

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Back => "back",
            Self::Left => "left",
            Self::Right => "right",
            Self::Top => "top",
            Self::ThreeQuarter => "three-quarter",
        }
    }

    /// How far around the camera stands, in degrees: 0 is the front, 90 the right.
    pub const fn azimuth(self) -> f64 {
        match self {
            Self::Front | Self::Top => 0.0,
            Self::Right => 90.0,
            Self::Back => 180.0,
            Self::Left => -90.0,
            Self::ThreeQuarter => 28.0,
        }
    }

    /// How high it stands, in degrees. Seen a little from above, the floor is a floor.
    const fn elevation(self) -> f64 {
        match self {
            Self::Front | Self::Back | Self::Left | Self::Right => 7.0,
            Self::Top => 90.0,
            Self::ThreeQuarter => 18.0,
        }
    }
}

/// Height of the view in degrees: that of a portrait lens, which doesn't make noses large.
const FOV: f64 = 24.0;

/// How much of the picture's width and height the mesh may fill.
const FILL: f64 = 0.8;

/// The nearest camera on that side that has all points in view, and those that are outermost equally far from the edges.
pub fn camera(points: impl Iterator<Item = DVec3>, view: Side, size: [u32; 2]) -> Camera {
    let (sa, ca) = ops::sin_cos_degrees(view.azimuth());
    let (se, ce) = ops::sin_cos_degrees(view.elevation());
    // Right, up and back, as the camera has them.
    let (u, v, w) =
        (DVec3::new(ca, 0.0, -sa), DVec3::new(-sa * se, ce, -ca * se), DVec3::new(sa * ce, se, ca * ce));
    let (s, c) = ops::sin_cos_degrees(0.5 * FOV);
    let y = FILL * s / c;
    let x = y * f64::from(size[0]) / f64::from(size[1]);
    // A point is in view of a camera at a u + b v + d w where |p.u - a| <= x (d - p.w), and so with v: the least and the greatest
    // of p.u -+ x p.w tell what d must be, and their mean is a.
    let mut ends = [[f64::NEG_INFINITY; 2]; 2];
    let mut near = f64::NEG_INFINITY;
    for p in points {
        for (end, (along, tan)) in ends.iter_mut().zip([(p.dot(u), x), (p.dot(v), y)]) {
            for (most, at) in end.iter_mut().zip([along, -along]) {
                let reach = at + tan * p.dot(w);
                *most = if reach > *most { reach } else { *most };
            }
        }
        near = if p.dot(w) > near { p.dot(w) } else { near };
    }
    let middle = |end: [f64; 2]| 0.5 * (end[0] - end[1]);
    // A needle that points at the camera is all in one place of the picture, but not nearer than a tenth.
    let mut distance = near + 0.1;
    for (end, tan) in ends.iter().zip([x, y]) {
        let needed = 0.5 * (end[0] + end[1]) / tan;
        distance = if needed > distance { needed } else { distance };
    }
    let at = u * middle(ends[0]) + v * middle(ends[1]);
    let (eye, look_at) = (at + w * distance, at);
    // Seven digits are enough to stand somewhere, and can be read.
    let round = |p: DVec3| DVec3::from_array(p.to_array().map(|v| (v * 1e7).round() / 1e7 + 0.0));
    let observer = Observer { eye: round(eye), look_at: round(look_at), up: round(v), ..Observer::default() };
    let observer = if view == Side::Top { observer } else { Observer { up: DVec3::Y, ..observer } };
    Camera::Perspective(Perspective {
        fov: Some(FOV),
        fov_axis: FovAxis::Y,
        observer,
        ..Perspective::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_math::Affine;

    #[test]
    fn all_points_are_in_view_and_centred() {
        let clouds: [&[[f64; 3]]; 4] = [
            &[[0.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
            &[[-0.7, 0.0, -0.7], [0.7, 0.0, 0.7], [-0.7, 0.0, 0.7], [0.7, 0.0, -0.7]],
            &[[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]],
            &[[-1.0, 0.1, 0.0], [1.0, 0.0, 0.0], [0.3, 0.4, 0.2]],
        ];
        for cloud in clouds {
            for view in Side::ALL {
                for size in [[800, 450], [300, 900], [900, 100]] {
                    let points = || cloud.iter().map(|p| DVec3::from_array(*p));
                    let Camera::Perspective(c) = camera(points(), view, size) else { unreachable!() };
                    let o = &c.observer;
                    let to_camera = Affine::look_at(o.eye, o.look_at, o.up).unwrap().inverse().unwrap();
                    let (s, c) = ops::sin_cos_degrees(0.5 * FOV);
                    let (y, x) = (s / c, s / c * f64::from(size[0]) / f64::from(size[1]));
                    let seen: Vec<[f64; 2]> = points()
                        .map(|p| to_camera.point(p))
                        .inspect(|q| assert!(q.z < 0.0))
                        .map(|q| [q.x / -q.z / x, q.y / -q.z / y])
                        .collect();
                    for k in 0..2 {
                        let most =
                            seen.iter().map(|q| q[k]).fold(-9.0, |a: f64, b| if b > a { b } else { a });
                        let least =
                            seen.iter().map(|q| q[k]).fold(9.0, |a: f64, b| if b < a { b } else { a });
                        assert!(least > -0.8001 && most < 0.8001, "{view:?} {size:?}: {least} {most}");
                    }
                }
            }
        }
    }
}
