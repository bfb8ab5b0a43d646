//! The samples of a tile, one after the other.

use crate::film::{FilmTile, Region, Sampled};
use crate::settings::Settings;
use std::ops::Range;
use straal_math::lowdisc::{PatternKind, SampleName};

/// Which sample of which pixel.
pub(super) type Name = ([u32; 2], u32);

/// The name of a path that starts at a light, of which a pass has as many as the picture has pixels: by its index among those of all passes, so that
/// all of them are points of one pattern. Patterns that know the size of their set are one for each pixel.
pub(super) fn light_path(settings: &Settings, pixel: [u32; 2], index: u32) -> SampleName {
    match settings.pattern.kind() {
        PatternKind::Sobol | PatternKind::Halton | PatternKind::Random => {
            let [width, height] = settings.size.map(u64::from);
            let in_pass = u64::from(pixel[1]) * width + u64::from(pixel[0]);
            let all = u64::from(index) * width * height + in_pass;
            // A place that no pixel has.
            settings.pattern.name(settings.seed, [u32::MAX, (all >> 32) as u32], all as u32)
        }
        _ => settings.pattern.name(settings.seed, pixel, index),
    }
}

/// The samples that a tile wants, pixel by pixel and row by row: neighbours' rays go the same way.
pub(super) struct Stream {
    region: Region,
    sampled: Sampled,
    indices: Range<u32>,
    pixel: [u32; 2],
    index: u32,
}

impl Stream {
    /// Nothing.
    pub fn empty() -> Self {
        Self {
            region: Region { min: [0; 2], max: [0; 2] },
            sampled: Sampled::default(),
            indices: 0..0,
            pixel: [0; 2],
            index: 0,
        }
    }

    /// Those of the given indices that the tile still wants.
    pub fn of(tile: &FilmTile, indices: Range<u32>) -> Self {
        // A tile that was taken up from the middle of a pass may have some of them.
        let indices = indices.start.max(tile.next_sample())..indices.end;
        let region = tile.region;
        Self { region, sampled: tile.sampled(), pixel: region.min, index: indices.start, indices }
    }
}

impl Iterator for Stream {
    type Item = Name;

    #[inline]
    fn next(&mut self) -> Option<Name> {
        if self.indices.is_empty() || self.region.area() == 0 {
            return None;
        }
        while self.pixel[1] < self.region.max[1] {
            let pixel = self.pixel;
            if self.index < self.indices.end && self.sampled.is_open(pixel) {
                let index = self.index;
                self.index += 1;
                if self.sampled.contains(pixel, index) {
                    return Some((pixel, index));
                }
                continue;
            }
            self.index = self.indices.start;
            self.pixel[0] += 1;
            if self.pixel[0] == self.region.max[0] {
                self.pixel = [self.region.min[0], pixel[1] + 1];
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Film;

    #[test]
    fn every_sample_comes_once_in_order() {
        let region = Region { min: [3, 5], max: [6, 7] };
        let film = Film::new([16, 16], region);
        let names: Vec<Name> = Stream::of(&film.tiles[0], 2..4).collect();
        let want: Vec<Name> =
            (5..7).flat_map(|y| (3..6).flat_map(move |x| [([x, y], 2), ([x, y], 3)])).collect();
        assert_eq!(names, want);
        assert_eq!(Stream::of(&film.tiles[0], 4..4).count(), 0);
        assert_eq!(Stream::empty().count(), 0);
    }
}
