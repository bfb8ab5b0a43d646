//! A film made of parts.

use super::super::splat::Splats;
use super::super::{ErrorEstimate, Film, Keep, Region};
use super::record::{Part, Record, for_each_record, parts, take};
use super::{Held, Span};
use std::io::{self, Read};

/// A film made of parts: of samples, or of the picture.
pub struct Joined {
    film: Film,
    region: Region,
    /// By pixel of the region: the group of spans of one crop, from 1, that it is taken from.
    owner: Vec<u32>,
    end: u32,
    gaps: bool,
}

/// The powers of two from `first` on, below `end`: batches end there.
fn notes(first: u32, end: u32) -> usize {
    (0..31).filter(|k| (first..end).contains(&(1 << k))).count()
}

impl Joined {
    /// An empty film for the part `crop` of a picture of some size, of which more was rendered where `region` is larger.
    pub fn new(
        size: [u32; 2],
        [crop, region]: [Region; 2],
        held: &Held,
        error: Option<ErrorEstimate>,
    ) -> Self {
        let keep = Keep { squares: held.squares, layers: held.guides };
        let mut film = Film::over(size, [crop, region], keep);
        film.mean_squares.clone_from(&held.mean_squares);
        film.hold_bands(held.bands, &held.light_groups);
        if held.splats {
            for tile in &mut film.tiles {
                tile.splats = Some(Splats::alone(tile.region, held.bands_of_each()));
            }
        }
        if let Some(weight) = held.weight {
            film.control(weight);
        }
        if held.light_splats {
            film.hold_light_splats();
        }
        if held.halves {
            film.adapt(error == Some(ErrorEstimate::Batches));
        }
        if held.batches {
            film.hold_batches();
        }
        if let Some(timed) = held.costs {
            film.count_costs(timed);
        }
        film.error = error;
        Self { film, region, owner: vec![0; region.area()], end: 0, gaps: false }
    }

    /// Adds what a film of the same kind has written. Spans of one crop are a group, numbered from 1, and come in the order
    /// of their samples.
    pub fn add(
        &mut self,
        span: &Span,
        group: u32,
        input: &mut dyn Read,
        dropped: Option<([u32; 2], u32)>,
    ) -> io::Result<()> {
        let held = self.film.held();
        let notes = notes(span.first, span.end);
        let plus = |old: i128, new: i128| old.wrapping_add(new);
        for y in span.region.min[1]..span.region.max[1] {
            for_each_record(input, &held, span.first, span.region, |x, bytes| {
                let pixel = [x, y];
                if !self.region.contains(pixel) {
                    return;
                }
                let place = (y - self.region.min[1]) as usize * self.region.width() as usize
                    + (x - self.region.min[0]) as usize;
                // What lies beyond a crop is in its neighbour as well, and the same there.
                let is_own = self.owner[place] == 0 || self.owner[place] == group;
                let mut sums = self.film.record(pixel, &held);
                let before = sums.pixel.value;
                let (mut other, mut bytes) = (Record::empty(&held), bytes);
                for part in parts(&held, span.first) {
                    let is_added = match part {
                        Part::Own => is_own,
                        Part::Splat => span.crop.contains(pixel),
                        Part::BatchSums | Part::Ends => false,
                    };
                    let to = if is_added { &mut sums } else { &mut other };
                    to.visit(part, &held, &mut |number| take(number, &mut bytes, plus));
                }
                if is_own {
                    self.owner[place] = group;
                    if span.first == 0 {
                        sums.batch_sums = other.batch_sums;
                    } else if held.batches {
                        sums.batch_sums.follow(&before, &other.ends, notes);
                    }
                }
                self.film.put(pixel, sums);
            })?;
        }
        self.film.note_dropped(dropped);
        self.end = self.end.max(span.end);
        Ok(())
    }

    /// Takes note that samples are missing in between: batches tell nothing then.
    pub fn has_gaps(&mut self) {
        self.gaps = true;
    }

    /// The film of all parts.
    pub fn into_film(mut self) -> Film {
        if self.gaps {
            self.film.tiles.iter_mut().for_each(|tile| tile.batch_sums = Vec::new());
            self.film.tell_spread();
        }
        self.film
    }
}
