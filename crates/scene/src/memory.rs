//! Memory as it is asked for: how much something needs, and how much there is.

use std::fmt;

/// Something needs more memory than may be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shortage {
    /// What needs it, as the beginning of a sentence.
    pub what: String,
    /// Bytes that it needs.
    pub needs: u64,
    /// Of these, what takes the most, and how much.
    pub most: Option<(&'static str, u64)>,
    /// Bytes that may be used.
    pub limit: u64,
    /// What would make it need less.
    pub help: &'static str,
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} needs {} of memory", self.what, tell_bytes(self.needs))?;
        if let Some((part, bytes)) = self.most {
            write!(f, ", {} of it for {part}", tell_bytes(bytes))?;
        }
        write!(f, ", and {} may be used", tell_bytes(self.limit))
    }
}

impl std::error::Error for Shortage {}

impl Shortage {
    /// What would be right.
    pub fn help(&self) -> String {
        format!("{}; --memory says how much may be used, and is what is free when absent", self.help)
    }
}

/// An amount of memory as people read it, in powers of 1000.
pub fn tell_bytes(bytes: u64) -> String {
    let amount = bytes as f64;
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.1} kB", amount / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", amount / 1e6),
        _ => format!("{:.2} GB", amount / 1e9),
    }
}

/// What a load holds, and the most that it held at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ledger {
    /// Bytes that may be used, where that is known.
    pub limit: Option<u64>,
    held: u64,
    most: u64,
}

impl Ledger {
    /// An empty one.
    pub const fn new(limit: Option<u64>) -> Self {
        Self { limit, held: PROGRAM, most: PROGRAM }
    }

    /// Takes note of what is kept.
    pub fn keep(&mut self, bytes: u64) {
        self.held = self.held.saturating_add(bytes);
        self.pass(0);
    }

    /// Takes note of what is given back before long.
    pub fn pass(&mut self, bytes: u64) {
        self.most = self.most.max(self.held.saturating_add(bytes));
    }

    /// The most bytes at a time.
    pub const fn most(&self) -> u64 {
        self.most
    }

    /// Why so many bytes more can't be had, if so.
    pub fn refuse(&self, bytes: u64, what: impl FnOnce() -> String, help: &'static str) -> Option<Shortage> {
        let limit = self.limit?;
        let needs = self.held.saturating_add(bytes);
        (needs > limit).then(|| Shortage { what: what(), needs, most: None, limit, help })
    }
}

/// Bytes that the program takes by itself: its code, its tables, the stacks of its threads.
pub const PROGRAM: u64 = 15_000_000;
