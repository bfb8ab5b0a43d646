//! The lab's report for scripts.

use super::moving::{Moving, Verdict};
use super::rays::Kind;
use super::same::Difference;
use super::volumes::{Inequality, Weighing};
use super::{ByKind, Payoff, Report, Row};
use serde_json::{Map, Value as Json, json};
use straal_accel::Stats;

/// Everything, under names that stay.
pub fn report(r: &Report) -> Json {
    let mix = r.picture_rays();
    json!({
        "hits_equal": r.hits_equal(),
        "baseline": r.rows.first().map(|row| &row.name),
        "structures": r.rows.iter().map(|row| structure(row, &mix)).collect::<Vec<_>>(),
        "left_out": r.left_out,
        "primitives": r.primitives,
        "isa": r.isa.name(),
        "threads": 1,
        "recorded": {
            "size": r.recorded_size,
            "spp": r.recorded_spp,
            "rays": by_kind(&r.rays),
        },
        "picture": {
            "size": r.picture_size,
            "spp": r.picture_spp,
            "rays": by_kind(&mix),
            "rays_per_sample": by_kind(&r.rays_per_sample),
        },
        "bounding_volumes": {
            "objects": r.volumes.rows.iter().map(weighing).collect::<Vec<_>>(),
            "left_out": r.volumes.left_out,
        },
        "moving": match &r.moving {
            Ok(m) => moving(m),
            Err(why) => json!({ "why_not": why }),
        },
    })
}

fn by_kind<T: Copy + Into<Json>>(values: &ByKind<T>) -> Json {
    let each = Kind::ALL.iter().zip(values).map(|(k, v)| (k.name().to_owned(), (*v).into()));
    Json::Object(each.collect::<Map<_, _>>())
}

fn structure(row: &Row, mix: &ByKind<f64>) -> Json {
    let tests = |of: fn(&super::Tests) -> u64| row.mean_tests(mix, of);
    let asked = row.tests.map(|t| t.rays);
    json!({
        "name": row.name,
        "build_seconds": row.build_seconds,
        "bytes": row.bytes,
        "nodes": row.stats.nodes,
        "leaves": row.stats.leaves,
        "depth": row.stats.depth,
        "sah_cost": row.stats.sah_cost,
        "references": row.stats.references,
        "references_per_primitive": row.references_per_primitive,
        "groups": row.groups.iter().map(stats).collect::<Vec<_>>(),
        "node_tests_per_ray": tests(|t| t.nodes),
        "box_tests_per_ray": tests(|t| t.boxes),
        "primitive_tests_per_ray": tests(|t| t.primitives),
        "duplicates_avoided_per_ray": tests(|t| t.duplicates),
        "rays_asked": by_kind(&asked),
        "mrays_per_second": row.mrays_per_second,
        "mrays_per_second_by_kind": by_kind(&Kind::ALL.map(|k| row.mrays(k))),
        "picture_seconds": row.picture_seconds,
        "pays_off_after": match row.payoff {
            Payoff::Cheapest => json!(0),
            Payoff::After(n) => json!(n),
            Payoff::Never => json!("never"),
        },
        "hits_equal": row.agreement.is_whole(),
        "answers_compared": row.agreement.compared,
        "answers_differing": row.agreement.differing,
        "differences": row.agreement.first.iter().map(difference).collect::<Vec<_>>(),
    })
}

fn stats(s: &Stats) -> Json {
    json!({
        "nodes": s.nodes,
        "leaves": s.leaves,
        "references": s.references,
        "depth": s.depth,
        "sah_cost": s.sah_cost,
    })
}

fn difference(d: &Difference) -> Json {
    json!({
        "kind": d.kind.name(),
        "ray": d.ray,
        "expected": d.expected.tell(),
        "found": d.found.tell(),
    })
}

fn weighing(w: &Weighing) -> Json {
    let side = |i: &Inequality| {
        json!({
            "volume": i.volume,
            "group": i.group(),
            "with_volume": i.with_volume(),
            "pays": i.pays(),
        })
    };
    json!({
        "name": w.name,
        "primitives": w.primitives,
        "bounded": w.bounded.is_some(),
        "crossing": w.bounded.map(|b| b.crossing),
        "tests": w.bounded.map(|b| side(&b.tests)),
        "nanoseconds": w.bounded.map(|b| side(&b.time)),
        "nanoseconds_in_its_tree": w.bounded.map(|b| side(&b.tree_time)),
    })
}

fn moving(m: &Moving) -> Json {
    let way = |w: &super::moving::Way| {
        json!({
            "build_seconds": w.build_seconds,
            "seconds_per_ray": w.seconds_per_ray,
            "picture_seconds": w.frame(m.picture_rays),
        })
    };
    let (advice, rays) = match m.verdict() {
        Verdict::Always => ("apart", None),
        Verdict::Below(n) => ("apart_below", Some(n)),
        Verdict::Above(n) => ("apart_above", Some(n)),
        Verdict::Never => ("whole", None),
    };
    json!({
        "object": m.object,
        "primitives": m.primitives,
        "others": m.others,
        "whole": way(&m.whole),
        "apart": way(&m.apart),
        "advice": advice,
        "rays_per_frame": rays,
        "hits_equal": m.differing == 0,
    })
}
