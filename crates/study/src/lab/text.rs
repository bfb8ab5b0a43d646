//! The lab's report for a terminal.

use super::moving::{Moving, Verdict};
use super::rays::Kind;
use super::table::{self, LINES, figures, whole};
use super::volumes::{Inequality, Volumes};
use super::{Report, Row};

/// Columns of a terminal that a table may take before it is cut into several.
const WIDTH: usize = 118;

/// The whole report.
pub fn report(r: &Report) -> String {
    [rays(r), table(r), notes(r), volumes(&r.volumes), moving(&r.moving)].join("\n")
}

/// What was replayed.
pub fn rays(r: &Report) -> String {
    let [w, h] = r.recorded_size;
    let kinds: Vec<String> =
        Kind::ALL.iter().zip(r.rays).map(|(k, n)| format!("{} {}", whole(n as u64), k.name())).collect();
    format!(
        "{} primitives; rays of a picture of {w} x {h} pixels, {} a pixel: {}; one thread, {}\n",
        whole(r.primitives as u64),
        r.recorded_spp,
        kinds.join(", "),
        r.isa
    )
}

/// The table of structures, a column each.
pub fn table(r: &Report) -> String {
    let label = LINES.iter().map(|l| l.label.len()).max().unwrap_or(0) + 2;
    let column = |row: &Row| {
        let cells = LINES.iter().map(|l| l.cell(row, r));
        cells.chain(heading(&row.name)).map(|s| s.chars().count()).max().unwrap_or(0) + 2
    };
    let mut blocks: Vec<Vec<(&Row, usize)>> = Vec::new();
    let mut room = 0;
    for row in &r.rows {
        let width = column(row);
        if width > room || blocks.is_empty() {
            blocks.push(Vec::new());
            room = WIDTH - label;
        }
        room = room.saturating_sub(width);
        if let Some(block) = blocks.last_mut() {
            block.push((row, width));
        }
    }
    let tables: Vec<String> = blocks.iter().map(|block| one_table(r, block, label)).collect();
    tables.join("\n")
}

/// A structure's name, its parameters below it.
fn heading(name: &str) -> Vec<String> {
    name.split([':', ',']).map(|part| part.trim().to_owned()).collect()
}

fn one_table(r: &Report, block: &[(&Row, usize)], label: usize) -> String {
    let mut text = String::new();
    let lines = block.iter().map(|(row, _)| heading(&row.name).len()).max().unwrap_or(0);
    for i in 0..lines {
        text += &" ".repeat(label);
        for (row, width) in block {
            let part = heading(&row.name).get(i).cloned().unwrap_or_default();
            text += &format!("{part:>width$}");
        }
        text += "\n";
    }
    let mut section = None;
    for line in LINES {
        if section != Some(line.section) {
            text += &format!("{}\n", line.section.title());
            section = Some(line.section);
        }
        text += &format!("{:<label$}", format!("  {}", line.label));
        for (row, width) in block {
            text += &format!("{:>width$}", line.cell(row, r));
        }
        text += "\n";
    }
    text
}

/// What was left out, what was asked with fewer rays, and where hits differ.
pub fn notes(r: &Report) -> String {
    let mut text = String::new();
    for note in &r.left_out {
        text += &format!("left out: {note}\n");
    }
    for row in &r.rows {
        if let Some(n) = row.strides.iter().max().filter(|n| **n > 1) {
            text += &format!("{}: asked with 1 ray in {n} only, since each takes so many tests\n", row.name);
        }
    }
    for row in r.rows.iter().filter(|row| !row.agreement.is_whole()) {
        let a = &row.agreement;
        text += &format!(
            "{}: {} of {} answers differ from those of {}\n",
            row.name, a.differing, a.compared, r.rows[0].name
        );
        text.extend(a.first.iter().map(|d| format!("  {}\n", d.tell())));
    }
    if r.hits_equal() {
        let compared: usize = r.rows.iter().map(|row| row.agreement.compared).sum();
        text += &format!("all {} answers are equal to the last bit\n", whole(compared as u64));
    }
    text
}

/// Both sides of an inequality.
pub fn sides(i: &Inequality) -> String {
    format!("{} {} {}", figures(i.with_volume()), if i.pays() { "<" } else { ">=" }, figures(i.group()))
}

/// What follows from the inequality.
pub fn pays(i: &Inequality) -> &'static str {
    if i.pays() { "pays" } else { "no" }
}

/// The bounding-volume inequality, object by object.
pub fn volumes(v: &Volumes) -> String {
    let mut text = "does a box around it pay?  cost_BV + p cost_group < cost_group, with p the rays that cross the box\n".to_owned();
    let name = v.rows.iter().map(|w| w.name.chars().count()).max().unwrap_or(0).max(6) + 2;
    text += &format!(
        "{:<name$}{:>11}{:>8}  {:<25}{:<27}{}\n",
        "object", "primitives", "p", "tests, one by one", "ns, one by one", "ns, in a tree of its own"
    );
    for w in &v.rows {
        text += &format!("{:<name$}{:>11}", w.name, whole(w.primitives));
        match &w.bounded {
            None => text += "       -  nothing bounds it: no box holds it\n",
            Some(b) => {
                let side = |i: &Inequality| format!("{} {}", sides(i), pays(i));
                text += &format!(
                    "{:>8.3}  {:<25}{:<27}{}\n",
                    b.crossing,
                    side(&b.tests),
                    side(&b.time),
                    side(&b.tree_time)
                );
            }
        }
    }
    if v.left_out > 0 {
        text += &format!("and {} objects with fewer primitives\n", v.left_out);
    }
    text
}

/// One tree or two.
pub fn moving(m: &Result<Moving, String>) -> String {
    let m = match m {
        Ok(m) => m,
        Err(why) => return format!("if an object moves: {why}\n"),
    };
    let mut text = format!(
        "if {} ({} primitives) moves beside the other {}:\n",
        m.object,
        whole(m.primitives),
        whole(m.others)
    );
    for (what, way) in [
        ("one tree over everything, built each frame", m.whole),
        ("two trees kept, their top built each frame", m.apart),
    ] {
        text += &format!(
            "  {what:<44} build {:>9} ms + {:>6} ns a ray = {:>9} s for this picture\n",
            figures(way.build_seconds * 1e3),
            figures(way.seconds_per_ray * 1e9),
            figures(way.frame(m.picture_rays))
        );
    }
    text += &format!("  {}\n", verdict(m));
    if m.differing > 0 {
        text += &format!("  {} rays find another t, which is a mistake of straal\n", m.differing);
    }
    text
}

/// What to do, in words.
pub fn verdict(m: &Moving) -> String {
    let picture = figures(m.picture_rays);
    match m.verdict() {
        Verdict::Always => "keep them apart, whatever the number of rays".into(),
        Verdict::Never => "build one tree over everything, whatever the number of rays".into(),
        Verdict::Below(n) => {
            format!(
                "with fewer than {} rays a frame, keep them apart; this picture has {picture}",
                figures(n)
            )
        }
        Verdict::Above(n) => {
            format!("with more than {} rays a frame, keep them apart; this picture has {picture}", figures(n))
        }
    }
}

/// One line of meaning for each line of the table.
pub fn meanings() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    LINES.iter().map(|l: &table::Line| (l.section.title(), l.label, l.meaning))
}
