//! The lines of the lab's table, once for all its forms: what each is called, what it means, and how it is told.

use super::measure::{Payoff, Row, Tests};
use super::rays::Kind;
use super::{ByKind, Report};

/// One line: a figure of every structure.
pub struct Line {
    /// Lines with the same word belong together.
    pub section: Section,
    /// What it is, with its unit.
    pub label: &'static str,
    /// What it means.
    pub meaning: &'static str,
    cell: fn(&Row, &ByKind<f64>) -> String,
}

/// Lines that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// What the structure is made of, and what that took.
    Build,
    /// Tests of a mean ray.
    Tests,
    /// Millions of rays in a second.
    Speed,
    /// What follows for this picture.
    Picture,
    /// Whether it is right.
    Proof,
}

impl Section {
    /// Its title.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Build => "the structure",
            Self::Tests => "tests per ray",
            Self::Speed => "Mrays/s",
            Self::Picture => "this picture",
            Self::Proof => "hits",
        }
    }
}

impl Line {
    /// What a structure's column says.
    pub fn cell(&self, row: &Row, report: &Report) -> String {
        (self.cell)(row, &report.picture_rays())
    }
}

const fn line(
    section: Section,
    [label, meaning]: [&'static str; 2],
    cell: fn(&Row, &ByKind<f64>) -> String,
) -> Line {
    Line { section, label, meaning, cell }
}

/// All lines, in the order of the table.
pub const LINES: &[Line] = &[
    line(Section::Build, ["build, ms", "time to build the structures of all groups, one thread"], |r, _| {
        figures(r.build_seconds * 1e3)
    }),
    line(Section::Build, ["memory", "of the structures, without the meshes themselves"], |r, _| {
        bytes(r.bytes as f64)
    }),
    line(Section::Build, ["nodes", "inner nodes of all groups"], |r, _| whole(r.stats.nodes as u64)),
    line(Section::Build, ["leaves", "leaves or cells of all groups, the empty ones included"], |r, _| {
        whole(r.stats.leaves as u64)
    }),
    line(
        Section::Build,
        ["depth", "steps from the root to the deepest leaf, in the largest group"],
        |r, _| r.stats.depth.to_string(),
    ),
    line(
        Section::Build,
        [
            "SAH cost",
            "tests that a random line through the box of the largest group is expected to take, by the surface area heuristic",
        ],
        |r, _| figures(r.stats.sah_cost),
    ),
    line(Section::Build, ["refs per primitive", "how often a primitive stands in a leaf"], |r, _| {
        format!("{:.2}", r.references_per_primitive)
    }),
    line(
        Section::Tests,
        ["nodes", "nodes opened or cells entered, for a mean ray of the picture"],
        |r, mix| figures(r.mean_tests(mix, |t| t.nodes)),
    ),
    line(Section::Tests, ["boxes", "boxes tested; the wide tree tests up to eight at once"], |r, mix| {
        figures(r.mean_tests(mix, |t| t.boxes))
    }),
    line(Section::Tests, ["primitives", "triangles, shapes and instances tested"], |r, mix| {
        figures(r.mean_tests(mix, |t| t.primitives))
    }),
    line(
        Section::Tests,
        ["duplicates avoided", "tests of a primitive that a mailbox found done already"],
        |r, mix| figures(r.mean_tests(mix, |t| t.duplicates)),
    ),
    line(
        Section::Tests,
        ["rays asked", "of all kinds; fewer for a structure that would take too long"],
        |r, _| whole(r.rays()),
    ),
    line(Section::Speed, ["primary", "rays from the camera"], |r, _| speed(r, Kind::Primary)),
    line(Section::Speed, ["bounce", "rays from a surface, on along a path"], |r, _| speed(r, Kind::Bounce)),
    line(Section::Speed, ["shadow", "rays from a surface to a light"], |r, _| speed(r, Kind::Shadow)),
    line(Section::Speed, ["all", "the kinds mixed as in this picture"], |r, _| figures(r.mrays_per_second)),
    line(
        Section::Picture,
        [
            "search, s",
            "what the scene's own picture, in its own size and samples, would spend in search on one thread",
        ],
        |r, _| figures(r.picture_seconds),
    ),
    line(
        Section::Picture,
        [
            "pays off after",
            "pictures after which a costlier build has gained its time, against the cheapest build",
        ],
        |r, _| match r.payoff {
            Payoff::Cheapest => "cheapest".into(),
            Payoff::After(0) => "at once".into(),
            Payoff::After(n) => whole(n),
            Payoff::Never => "never".into(),
        },
    ),
    line(
        Section::Proof,
        [
            "equal to bvh",
            "t, u, v, primitive and instances of every hit to the last bit, one ray at a time and in slices",
        ],
        |r, _| match r.agreement.differing {
            0 => "yes".into(),
            n => format!("{n} DIFFER"),
        },
    ),
];

fn speed(row: &Row, kind: Kind) -> String {
    let tests: &Tests = &row.tests[kind as usize];
    if tests.rays == 0 { "none".into() } else { figures(row.mrays(kind)) }
}

/// Three figures: 0.123, 1.23, 12.3, 123, 12,300.
pub fn figures(v: f64) -> String {
    let size = v.abs();
    match size {
        _ if size == 0.0 => "0".into(),
        _ if size < 1e-3 => format!("{v:.1e}"),
        _ if size < 0.9995 => format!("{v:.3}"),
        _ if size < 9.995 => format!("{v:.2}"),
        _ if size < 99.95 => format!("{v:.1}"),
        _ => whole(v.round() as u64),
    }
}

/// An integer with commas between thousands.
pub fn whole(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(c);
    }
    out
}

/// A size in memory.
pub fn bytes(n: f64) -> String {
    let (scaled, unit) = match n {
        _ if n >= 1e9 => (n * 1e-9, "GB"),
        _ if n >= 1e6 => (n * 1e-6, "MB"),
        _ if n >= 1e3 => (n * 1e-3, "kB"),
        _ => return format!("{n} B"),
    };
    format!("{} {unit}", figures(scaled))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_figures() {
        let told: Vec<_> = [0.0, 0.00012, 0.5, 1.0, 9.999, 12.34, 99.99, 1234.4, 1e6].map(figures).into();
        assert_eq!(told, ["0", "1.2e-4", "0.500", "1.00", "10.0", "12.3", "100", "1,234", "1,000,000"]);
        assert_eq!([12, 1234, 1_234_567].map(whole), ["12", "1,234", "1,234,567"]);
        assert_eq!([12.0, 1234.0, 5.1e6].map(bytes), ["12 B", "1.23 kB", "5.10 MB"]);
    }
}
