//! Two eyes.

use super::perspective::{lens, one_eye};
use super::{Camera, Facts, FilmPoint, Needs, Sees, Setup, View, Window};
use crate::footprint::Footprint;
use straal_math::Ray;
use straal_scene::desc;

/// Where two eyes are and what they look at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eyes {
    /// Distance between them.
    pub separation: f64,
    /// Distance along the view of the plane that both see at the same place of the picture.
    pub convergence: f64,
}

impl Eyes {
    /// The view and the window of an eye, 0 the left one, that stands beside the middle. Views stay parallel and windows
    /// are moved: eyes that turn towards each other would see things at different heights.
    pub fn eye(&self, eye: usize, view: &View, window: &Window) -> (View, Window) {
        let aside = if eye == 0 { -0.5 * self.separation } else { 0.5 * self.separation };
        let middle = [window.middle[0] - aside / self.convergence, window.middle[1]];
        (View { eye: view.eye + view.right * aside, ..*view }, Window { middle, ..*window })
    }
}

/// How two pictures become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StereoLayout {
    /// The left eye's in the left half.
    Parallel,
    /// The right eye's in the left half.
    Crossed,
    /// Red from the left eye, green and blue from the right.
    ///
    /// Each sample looks through one of the eyes, half of them through each: which one is decided by the first number for
    /// the lens, whose halves are spread over the samples as evenly as lenses are. The film takes twice the red of one
    /// and twice the green and blue of the other. Guide layers are the mean of both eyes.
    Anaglyph,
}

/// Two cameras side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Stereo {
    /// The left and the right one.
    eyes: Box<[Camera; 2]>,
    layout: StereoLayout,
    /// Width of the picture of one eye in pixels.
    width: u32,
}

impl Stereo {
    /// Size of the picture of each eye in one of `size`; what is left over beside two halves stays black.
    pub fn picture(layout: StereoLayout, size: [u32; 2]) -> [u32; 2] {
        match layout {
            StereoLayout::Parallel | StereoLayout::Crossed => [size[0] / 2, size[1]],
            StereoLayout::Anaglyph => size,
        }
    }

    /// The left and the right eye, whose pictures are `width` pixels wide.
    pub fn new(eyes: [Camera; 2], layout: StereoLayout, width: u32) -> Self {
        Self { eyes: Box::new(eyes), layout, width }
    }

    /// The eye that sees a point, and the point in its own picture.
    #[inline]
    fn eye(&self, at: &FilmPoint) -> Option<(&Camera, FilmPoint)> {
        let (half, crossed) = match self.layout {
            StereoLayout::Anaglyph => {
                let eye = usize::from(at.lens[0] >= 0.5);
                // What is left of the number is as good as before, for the lens.
                let lens = [2.0 * at.lens[0] - eye as f32, at.lens[1]];
                return Some((&self.eyes[eye], FilmPoint { lens, ..*at }));
            }
            StereoLayout::Parallel => (at.pixel[0] / self.width, 0),
            StereoLayout::Crossed => (at.pixel[0] / self.width, 1),
        };
        let first = half * self.width;
        let [x, y] = at.position;
        let own =
            FilmPoint { pixel: [at.pixel[0] - first, at.pixel[1]], position: [x - first as f32, y], ..*at };
        Some((self.eyes.get((half ^ crossed) as usize).filter(|_| half < 2)?, own))
    }

    /// Of what a scene says of a pair of eyes.
    pub(super) fn of(c: &desc::Perspective, pair: &desc::Stereo, setup: &Setup<'_>) -> Camera {
        let layout = match pair.layout {
            desc::StereoLayout::Parallel => StereoLayout::Parallel,
            desc::StereoLayout::Crossed => StereoLayout::Crossed,
            // One eye by itself has the whole picture, as each has in an anaglyph.
            desc::StereoLayout::Anaglyph | desc::StereoLayout::Left | desc::StereoLayout::Right => {
                StereoLayout::Anaglyph
            }
        };
        let (film, own) = (Self::picture(layout, setup.film), Self::picture(layout, setup.size));
        let window = Window::new(c.tan_x(film, own), own).shifted(c.shift);
        let lens = lens(c, &Setup { film, size: own, ..*setup });
        let convergence = pair.convergence.unwrap_or_else(|| c.observer.distance());
        let eyes = Eyes { separation: pair.separation, convergence };
        let eye = |i: usize| {
            let (view, window) = eyes.eye(i, &setup.view, &window);
            one_eye(&view, &window, lens.clone())
        };
        match pair.layout {
            desc::StereoLayout::Left => eye(0),
            desc::StereoLayout::Right => eye(1),
            _ => Camera::Stereo(Self::new([eye(0), eye(1)], layout, own[0].max(1))),
        }
    }
}

impl Sees for Stereo {
    fn ray(&self, at: &FilmPoint) -> Option<Ray> {
        let (eye, own) = self.eye(at)?;
        eye.ray(&own)
    }

    fn footprint(&self, at: &FilmPoint) -> Footprint {
        self.eye(at).map_or(Footprint::NONE, |(eye, own)| eye.footprint(&own))
    }

    fn glasses(&self, at: &FilmPoint) -> [f32; 3] {
        match self.layout {
            StereoLayout::Anaglyph if at.lens[0] < 0.5 => [2.0, 0.0, 0.0],
            StereoLayout::Anaglyph => [0.0, 2.0, 2.0],
            StereoLayout::Parallel | StereoLayout::Crossed => [1.0; 3],
        }
    }

    fn needs(&self) -> Needs {
        let anaglyph = self.layout == StereoLayout::Anaglyph;
        let eye = self.eyes[0].needs();
        Needs { lens: eye.lens || anaglyph, glasses: anaglyph, ..eye }
    }

    fn facts(&self) -> Facts {
        Facts { kind: "stereo", ..self.eyes[0].facts() }
    }

    #[cfg(test)]
    fn examples(view: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)> {
        let stereo = |layout| {
            let own = Window::new(0.5, Self::picture(layout, size)).shifted([0.1, -0.2]);
            let eyes = [0, 1].map(|i| {
                let (view, window) = Eyes { separation: 0.3, convergence: 4.0 }.eye(i, view, &own);
                Camera::Perspective(super::Perspective::new(&view, &window))
            });
            Camera::Stereo(Self::new(eyes, layout, own.size[0]))
        };
        vec![
            ("parallel", stereo(StereoLayout::Parallel)),
            ("crossed", stereo(StereoLayout::Crossed)),
            ("anaglyph", stereo(StereoLayout::Anaglyph)),
        ]
    }
}
