//! Drawings for the book, as SVG: ink on white, so that they can be read on a dark page too.

use std::fmt::Write;
use straal_math::ops;

/// A place in pixels from the top left.
pub type At = [f32; 2];

/// Colours: ink, what is less important, light and rays, what stands out, a third thing.
pub const INK: &str = "#1d2329";
pub const FAINT: &str = "#aab2ba";
pub const RAY: &str = "#0b63b8";
pub const HOT: &str = "#c8372d";
pub const GREEN: &str = "#2a7a43";
/// Fills: of things, of what stands out, of light.
pub const STUFF: &str = "#e4e8ec";
pub const GLOW: &str = "#ffe9a8";
pub const BLUSH: &str = "#f6d5d1";

/// A drawing that grows.
pub struct Drawing {
    size: [u32; 2],
    body: String,
}

impl Drawing {
    /// An empty sheet of so many pixels.
    pub fn new(width: u32, height: u32) -> Self {
        Self { size: [width, height], body: String::new() }
    }

    /// Lines from place to place.
    pub fn path(&mut self, points: &[At], colour: &str, width: f32) {
        let _ = writeln!(
            self.body,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"/>",
            listed(points)
        );
    }

    /// A dashed line.
    pub fn dashes(&mut self, points: &[At], colour: &str) {
        let _ = writeln!(
            self.body,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\" stroke-dasharray=\"5 4\"/>",
            listed(points)
        );
    }

    /// A filled outline; either colour may be `none`.
    pub fn area(&mut self, points: &[At], fill: &str, stroke: &str) {
        let _ = writeln!(
            self.body,
            "<polygon points=\"{}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"1.2\" stroke-linejoin=\"round\"/>",
            listed(points)
        );
    }

    /// A box from its top left and bottom right.
    pub fn boxed(&mut self, [x0, y0]: At, [x1, y1]: At, fill: &str, stroke: &str) {
        self.area(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1]], fill, stroke);
    }

    /// A circle.
    pub fn circle(&mut self, at: At, radius: f32, fill: &str, stroke: &str) {
        let _ = writeln!(
            self.body,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"1.2\"/>",
            at[0], at[1]
        );
    }

    /// A point.
    pub fn dot(&mut self, at: At, colour: &str) {
        self.circle(at, 3.2, colour, "none");
    }

    /// A line with a head at its end.
    pub fn arrow(&mut self, from: At, to: At, colour: &str) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = (dx * dx + dy * dy).sqrt();
        let (dx, dy) = (dx / length, dy / length);
        let back = [to[0] - 9.0 * dx, to[1] - 9.0 * dy];
        self.path(&[from, back], colour, 1.6);
        self.area(
            &[to, [back[0] - 3.6 * dy, back[1] + 3.6 * dx], [back[0] + 3.6 * dy, back[1] - 3.6 * dx]],
            colour,
            "none",
        );
    }

    /// Part of a circle, angles in degrees counter-clockwise from the right.
    pub fn arc(&mut self, at: At, radius: f32, [from, to]: [f32; 2], colour: &str) {
        let points: Vec<At> =
            (0..=24_u8).map(|i| on_circle(at, radius, from + (to - from) * f32::from(i) / 24.0)).collect();
        self.path(&points, colour, 1.2);
    }

    /// Words beginning at a place.
    pub fn text(&mut self, at: At, words: &str) {
        self.words(at, words, "start", INK);
    }

    /// Words about a place.
    pub fn label(&mut self, at: At, words: &str) {
        self.words(at, words, "middle", INK);
    }

    /// Words in a colour: `start`, `middle` or `end` is at the place.
    pub fn words(&mut self, at: At, words: &str, anchor: &str, colour: &str) {
        let words = words.replace('&', "&amp;").replace('<', "&lt;");
        let _ = writeln!(
            self.body,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{words}</text>",
            at[0], at[1]
        );
    }

    /// The SVG.
    pub fn finish(self) -> String {
        let [w, h] = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" \
             font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" font-size=\"14\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"white\"/>\n{}</svg>\n",
            self.body
        )
    }
}

fn listed(points: &[At]) -> String {
    let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
    points.join(" ")
}

/// A place on a circle, by degrees counter-clockwise from the right.
pub fn on_circle(at: At, radius: f32, degrees: f32) -> At {
    let (sin, cos) = ops::sin_cos(degrees.to_radians());
    [at[0] + radius * cos, at[1] - radius * sin]
}

/// A part of the sheet with its own coordinates, x to the right and y up.
#[derive(Clone, Copy)]
pub struct Panel {
    /// Left, top, right, bottom in pixels.
    pub area: [f32; 4],
    /// Least x, least y, greatest x, greatest y.
    pub world: [f32; 4],
}

impl Panel {
    /// Where a point is on the sheet.
    pub fn at(&self, [x, y]: [f32; 2]) -> At {
        let ([l, t, r, b], [x0, y0, x1, y1]) = (self.area, self.world);
        [l + (x - x0) / (x1 - x0) * (r - l), b - (y - y0) / (y1 - y0) * (b - t)]
    }

    /// A curve through x from end to end.
    pub fn curve(&self, of: impl Fn(f32) -> f32) -> Vec<At> {
        let [x0, _, x1, _] = self.world;
        (0..=180_u8)
            .map(|i| {
                let x = x0 + (x1 - x0) * f32::from(i) / 180.0;
                self.at([x, of(x)])
            })
            .collect()
    }

    /// A frame with ticks and their numbers, and what they are.
    pub fn axes(&self, d: &mut Drawing, xs: &[f32], ys: &[f32], [x_name, y_name]: [&str; 2]) {
        let ([l, t, r, b], [x0, y0, ..]) = (self.area, self.world);
        for &x in xs {
            let [px, _] = self.at([x, y0]);
            d.path(&[[px, t], [px, b]], STUFF, 1.0);
            d.label([px, b + 18.0], &format!("{x}"));
        }
        for &y in ys {
            let [_, py] = self.at([x0, y]);
            d.path(&[[l, py], [r, py]], STUFF, 1.0);
            d.words([l - 7.0, py + 5.0], &format!("{y}"), "end", INK);
        }
        d.boxed([l, t], [r, b], "none", FAINT);
        d.label([0.5 * (l + r), b + 38.0], x_name);
        d.text([l, t - 8.0], y_name);
    }
}
