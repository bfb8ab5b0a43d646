//! Samples under way: a ring, in the order in which they were started.

use super::stream::Name;
use crate::film::SampleSums;
use crate::film::channel::Seen;

/// A sample whose light is being gathered.
#[derive(Clone, Copy)]
pub(super) struct Pending<L> {
    /// Its pixel and index.
    pub name: Name,
    /// The place of its tile in the order of the pass.
    pub tile: u32,
    /// By what the film takes it.
    pub lanes: L,
    /// What the filter multiplies its light by.
    pub weight: f32,
    /// Where it lies from its pixel's centre.
    pub offset: [f32; 2],
    /// How much of red, green and blue the film takes, see [`crate::camera::Camera::glasses`].
    pub glasses: [f32; 3],
}

/// A worker's samples. One is finished when none of its paths is in flight; the film takes them in the order in which they were
/// started, since the noise of a pixel may be told by the order of its samples.
pub(super) struct Samples<L> {
    /// By place in the ring.
    pub pending: Vec<Option<Pending<L>>>,
    /// The light of each so far.
    pub sums: SampleSums,
    /// What the camera's ray of each met first; empty where nobody asks.
    pub seen: Vec<Seen>,
    /// Paths of each that are in flight.
    in_flight: Vec<u32>,
    /// Number of the first that isn't finished, counted from the worker's start.
    first: usize,
    /// One past the number of the last.
    end: usize,
}

impl<L: Copy> Samples<L> {
    /// Room for so many, or a few more; `sees` says whether anybody asks for what camera rays meet, the last by how many
    /// groups of lights their light is told apart, and how much of it counts.
    pub fn new(room: usize, sees: bool, (groups, limit): (usize, f32)) -> Self {
        let room = room.max(1).next_power_of_two();
        Self {
            pending: vec![None; room],
            sums: SampleSums::new(room, groups, limit),
            seen: vec![Seen::default(); if sees { room } else { 0 }],
            in_flight: vec![0; room],
            first: 0,
            end: 0,
        }
    }

    /// How many there is room for in all.
    pub fn room(&self) -> usize {
        self.pending.len()
    }

    /// How many more there is room for.
    pub fn room_left(&self) -> usize {
        self.room() - (self.end - self.first)
    }

    pub fn is_full(&self) -> bool {
        self.room_left() == 0
    }

    pub fn is_empty(&self) -> bool {
        self.end == self.first
    }

    /// Takes one more, and tells its place.
    pub fn begin(&mut self, sample: Pending<L>) -> u32 {
        let place = self.end & (self.room() - 1);
        self.end += 1;
        self.pending[place] = Some(sample);
        self.sums.clear(place);
        if let Some(seen) = self.seen.get_mut(place) {
            *seen = Seen::default();
        }
        self.in_flight[place] = 0;
        place as u32
    }

    /// A path of a sample sets out.
    #[inline(always)]
    pub fn depart(&mut self, place: u32) {
        self.in_flight[place as usize] += 1;
    }

    /// A path of a sample has arrived.
    #[inline(always)]
    pub fn arrive(&mut self, place: u32) {
        self.in_flight[place as usize] -= 1;
    }

    /// The first sample and its place, if it is finished.
    pub fn finished(&self) -> Option<(usize, Pending<L>)> {
        let place = self.first & (self.room() - 1);
        if self.is_empty() || self.in_flight[place] > 0 {
            return None;
        }
        self.pending[place].map(|sample| (place, sample))
    }

    /// The number of the first, counted from the worker's start.
    pub fn number_of_first(&self) -> usize {
        self.first
    }

    /// A sample by its number, and its place: as long as none has come in its stead.
    pub fn numbered(&self, number: usize) -> Option<(usize, Pending<L>)> {
        let place = number & (self.room() - 1);
        self.pending[place].map(|sample| (place, sample))
    }

    /// Makes room for another in place of the first.
    pub fn leave(&mut self) {
        self.first += 1;
    }
}
