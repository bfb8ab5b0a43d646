//! What the search structure left out because it can never be hit, in the words of the description.

use crate::world::Dropped;
use std::collections::BTreeMap;
use straal_accel::{self as accel, DroppedFrom};
use straal_scene::Span;
use straal_scene::desc::Node;

/// What is told of all that was left out, a line for each file, kind of shape and object. `nodes` are those of the
/// geometries, `left_out` those that never became any, `objects` the names of the groups.
pub(super) fn tell(
    dropped: &[accel::Dropped],
    nodes: &[Option<&Node>],
    left_out: &[&Node],
    objects: &BTreeMap<u32, &str>,
) -> Vec<Dropped> {
    let mut sums: BTreeMap<Source, (Span, [usize; 2])> = BTreeMap::new();
    for node in left_out {
        let (source, span) = source(Some(node));
        sums.entry(source).or_insert((span, [0, 0])).1[0] += 1;
    }
    for d in dropped {
        let node = match d.from {
            DroppedFrom::Geometry(geometry) => nodes.get(geometry as usize).copied().flatten(),
            DroppedFrom::Instance { .. } => None,
        };
        let (source, span) = match d.from {
            DroppedFrom::Geometry(_) => source(node),
            DroppedFrom::Instance { group } => {
                (Source::Instance(objects.get(&group).copied().unwrap_or_default().to_owned()), Span::NONE)
            }
        };
        let (_, [not_finite, empty]) = sums.entry(source).or_insert((span, [0, 0]));
        *not_finite += d.not_finite;
        // Patches that meet in a point, as in the lid of the teapot, give triangles without area by rights.
        *empty += if matches!(node, Some(Node::Bezier(_))) { 0 } else { d.empty };
    }
    let each = sums.into_iter().flat_map(|(source, (span, [not_finite, empty]))| {
        let told = |count: usize, is_finite: bool| {
            (count > 0).then(|| Dropped { count, message: source.tell(count, is_finite), span })
        };
        [told(not_finite, false), told(empty, true)]
    });
    each.flatten().collect()
}

/// What left-out primitives come from.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Source {
    File(String),
    Mesh,
    Shape(&'static str),
    Instance(String),
}

fn source(node: Option<&Node>) -> (Source, Span) {
    match node {
        Some(Node::Mesh(m)) => match &m.file {
            Some(asset) => (Source::File(asset.file.value.clone()), asset.file.span),
            None => (Source::Mesh, m.surface.transform.span),
        },
        Some(node) => (Source::Shape(node.kind()), node.surface().map_or(Span::NONE, |s| s.transform.span)),
        None => (Source::Shape("custom shape"), Span::NONE),
    }
}

impl Source {
    fn tell(&self, count: usize, is_finite: bool) -> String {
        let (s, is) = if count == 1 { ("", "is") } else { ("s", "are") };
        let things = match self {
            Self::File(file) => format!("in `{file}`: {count} triangle{s}"),
            Self::Mesh => format!("in a `mesh`: {count} triangle{s}"),
            Self::Shape(kind) => format!("{count} shape{s} `{kind}`"),
            Self::Instance(object) => format!("{count} instance{s} of `{object}`"),
        };
        let lacking = match (self, is_finite) {
            (_, false) => "with coordinates beyond single precision",
            (Self::File(_) | Self::Mesh, true) => "without area",
            (_, true) => "without extent",
        };
        format!("{things} {lacking} {is} left out")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_left_out_is_told_in_one_line_for_each_source() {
        let lost = |from, not_finite, empty| accel::Dropped { from, not_finite, empty };
        let dropped = [
            lost(DroppedFrom::Geometry(0), 0, 2),
            lost(DroppedFrom::Geometry(9), 0, 1),
            lost(DroppedFrom::Instance { group: 3 }, 1, 0),
            lost(DroppedFrom::Instance { group: 3 }, 1, 0),
        ];
        let told = tell(&dropped, &[], &[], &BTreeMap::from([(3, "pot"), (1, "pan")]));
        let told: Vec<_> = told.iter().map(|d| (d.count, d.message.as_str())).collect();
        assert_eq!(
            told,
            [
                (3, "3 shapes `custom shape` without extent are left out"),
                (2, "2 instances of `pot` with coordinates beyond single precision are left out")
            ]
        );
        assert_eq!(
            Source::File("a.ply".into()).tell(1, true),
            "in `a.ply`: 1 triangle without area is left out"
        );
    }
}
