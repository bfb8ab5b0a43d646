//! Two eyes.

use super::{Camera, FilmPoint, Needs, View, Window};
use crate::footprint::Footprint;
use straal_math::Ray;

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
    eyes: [Camera; 2],
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
        Self { eyes, layout, width }
    }

    /// The camera of the left eye.
    pub fn left(&self) -> &Camera {
        &self.eyes[0]
    }

    pub(super) fn ray(&self, at: &FilmPoint) -> Option<Ray> {
        let (eye, own) = self.eye(at)?;
        eye.ray(&own)
    }

    pub(super) fn footprint(&self, at: &FilmPoint) -> Footprint {
        self.eye(at).map_or(Footprint::NONE, |(eye, own)| eye.footprint(&own))
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

    pub(super) fn taken(&self, at: &FilmPoint) -> [f32; 3] {
        match self.layout {
            StereoLayout::Anaglyph if at.lens[0] < 0.5 => [2.0, 0.0, 0.0],
            StereoLayout::Anaglyph => [0.0, 2.0, 2.0],
            StereoLayout::Parallel | StereoLayout::Crossed => [1.0; 3],
        }
    }

    pub(super) fn needs(&self) -> Needs {
        let anaglyph = self.layout == StereoLayout::Anaglyph;
        let eye = self.eyes[0].needs();
        Needs { lens: eye.lens || anaglyph, taken: anaglyph, ..eye }
    }
}
