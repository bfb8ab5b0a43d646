//! The sums of a job's render: shown to who keeps them, and taken up again.

use super::{Control, Job};
use crate::resolve::Error;
use crate::sums::{self, Kept, Stamp};
use std::io::{self, Write};
use straal_render::driver::Render;
use straal_render::film::{Film, Span};

/// A render between two passes, in the middle of one or at its end, for who wants to keep its sums. In the middle some tiles
/// have more samples than [`Snapshot::samples`] says; who goes on from there takes of each what it hasn't got.
pub struct Snapshot<'a> {
    pub(super) job: &'a Job,
    film: &'a Film,
    end: u32,
    /// Whether it is in the middle of a pass.
    pub is_midway: bool,
    /// Whether no pass comes after.
    pub is_last: bool,
    /// Whether all samples that were asked for are taken.
    pub is_complete: bool,
}

impl Snapshot<'_> {
    /// Samples of each pixel that are taken.
    pub fn samples(&self) -> u32 {
        self.end - self.job.first
    }

    /// Writes its sums.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let stamp = Stamp { is_midway: self.is_midway, ..self.job.stamp(self.film, self.end) };
        sums::write(&stamp, self.film, out)
    }
}

impl Job {
    /// Whether a file holds sums of this job's scene, rendered in the same way.
    pub fn is_source_of(&self, kept: &Kept) -> bool {
        kept.stamp.metadata == self.facts()
    }

    /// Shows what there is to who keeps it.
    pub(super) fn show(
        &self,
        render: &Render<'_>,
        control: &mut Control<'_>,
        [is_last, is_complete]: [bool; 2],
    ) {
        if let Some(keep) = &mut control.keep {
            let (end, is_midway) = (render.samples_done(), render.is_midway());
            keep(&Snapshot { job: self, film: render.film(), end, is_midway, is_last, is_complete });
        }
    }

    /// Goes on from sums that were kept.
    pub(super) fn take_up(&self, render: &mut Render<'_>, mut kept: Kept, end: u32) -> Result<(), Error> {
        if let Some(refusal) = self.refuses(&kept, render.film(), end) {
            return Err(refusal);
        }
        let taken_up = kept.sums(|stamp, input| render.take_up(stamp.span.end, stamp.dropped, input));
        taken_up.map_err(|e| Error::Request(e.to_string()))
    }

    /// What a file of this job's sums tells.
    fn stamp(&self, film: &Film, end: u32) -> Stamp {
        let kind = self.settings.pattern.kind();
        let text = |n: u32| n.to_string();
        let of_set =
            kind.needs_count().then(|| ("samples_in_all".to_owned(), text(self.whole.unwrap_or(end))));
        let noise = self.settings.error.then(|| self.settings.error_estimate().name().to_owned());
        let error = ("error".to_owned(), noise.unwrap_or_else(|| "none".into()));
        let from = ("first_sample".to_owned(), text(self.first));
        Stamp {
            metadata: self.facts(),
            also: of_set.into_iter().chain([error, from]).collect(),
            development: self.development(),
            size: film.size,
            span: Span { crop: film.crop, region: film.region(), first: self.first, end },
            whole: self.whole,
            error: self.settings.error.then(|| self.settings.error_estimate()),
            held: film.held(),
            is_midway: false,
            dropped: film.dropped().first,
        }
    }

    /// Why a render can't go on from a file of sums, if so; `film` is what it would be taken up on.
    fn refuses(&self, kept: &Kept, film: &Film, end: u32) -> Option<Error> {
        let name = kept.path.display();
        let differences = kept.stamp.differences(&self.stamp(film, self.first), &[]);
        if !differences.is_empty() {
            return Some(Error::Request(format!("can't go on from {name}: {}", differences.join(", "))));
        }
        if kept.stamp.span.region != film.region() || kept.stamp.held != film.held() {
            return Some(Error::Request(format!(
                "can't go on from {name}: it holds other sums than are needed"
            )));
        }
        (kept.stamp.span.end > end).then(|| {
            let (there, here) = (kept.samples(), end - self.first);
            Error::Request(format!(
                "can't go on from {name}: it has {there} samples of each pixel, more than the {here} that are wanted"
            ))
        })
    }
}
