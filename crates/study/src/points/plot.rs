//! Points and their spectrum as a drawing.

use super::{Figures, Map, Request};
use std::fmt::Write;

/// Side of the points' panel, width and height of the spectrum's, and the space around them, in pixels.
const SIDE: f64 = 360.0;
const WIDTH: f64 = 360.0;
const GAP: f64 = 44.0;

/// The drawing: points on the left, their radially averaged power spectrum on the right.
pub fn svg(request: &Request, map: Map, figures: &Figures) -> String {
    let (width, height) = (SIDE + WIDTH + 3.0 * GAP, SIDE + 2.0 * GAP);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    let Request { kind, count, .. } = request;
    let _ = writeln!(
        out,
        "<text x=\"{GAP}\" y=\"28\">{kind}, {count} points: L2-star discrepancy {:.5} (independent points: {:.5})</text>",
        figures.discrepancy, figures.discrepancy_of_random
    );
    let frame = |x: f64| {
        format!(
            "<rect x=\"{x}\" y=\"{GAP}\" width=\"{SIDE}\" height=\"{SIDE}\" fill=\"none\" stroke=\"#999\"/>\n"
        )
    };
    out += &frame(GAP);
    let radius = if *count > 1024 { 1.0 } else { 2.0 };
    for point in request.points([0, 0]) {
        let [x, y] = map.place(point);
        let (x, y) = (GAP + SIDE * x, GAP + SIDE * (1.0 - y));
        let _ = writeln!(out, "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"#1b4f8f\"/>");
    }
    let left = SIDE + 2.0 * GAP;
    out += &frame(left);
    out += &spectrum(&figures.power, left);
    out += "</svg>\n";
    out
}

/// Power 0 to 2 upwards, frequency to the right, each with its scale; 1 is what independent points have.
fn spectrum(power: &[f64], left: f64) -> String {
    let top = power.len().saturating_sub(1).max(1) as f64;
    let at = |k: usize, p: f64| {
        let p = if p < 2.0 { p } else { 2.0 };
        (left + WIDTH * k as f64 / top, GAP + SIDE * (1.0 - p / 2.0))
    };
    let line: Vec<String> = power
        .iter()
        .enumerate()
        .skip(1)
        .map(|(k, &p)| {
            let (x, y) = at(k, p);
            format!("{x:.1},{y:.1}")
        })
        .collect();
    let mut out = String::new();
    for power in [0.0, 1.0, 2.0] {
        let (x, y) = at(0, power);
        let _ = writeln!(
            out,
            "<line x1=\"{x}\" y1=\"{y}\" x2=\"{}\" y2=\"{y}\" stroke=\"#ccc\"/>\n\
             <text x=\"{}\" y=\"{}\" text-anchor=\"end\">{power}</text>",
            left + WIDTH,
            left - 6.0,
            y + 4.0
        );
    }
    for share in [0.0, 0.5, 1.0] {
        let (x, y) = (left + WIDTH * share, GAP + SIDE);
        let _ = writeln!(
            out,
            "<path d=\"M{x} {y}v4\" stroke=\"#999\"/>\n<text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            y + 17.0,
            top * share
        );
    }
    let _ = writeln!(
        out,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#b3341e\" stroke-width=\"1.5\"/>\n\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">power by cycles a side; 1 is that of independent points</text>",
        line.join(" "),
        left + 0.5 * WIDTH,
        GAP + SIDE + 34.0
    );
    out
}
