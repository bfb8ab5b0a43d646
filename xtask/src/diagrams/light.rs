//! Light, colours and surfaces.

use super::Diagram;
use crate::draw::*;
use straal_color::spectrum::refraction::Metal;
use straal_color::spectrum::{FIRST, Illuminant, Observer, Quantity, illuminant, metamer, uplift};
use straal_color::{Space, srgb};
use straal_math::ops;

/// What is drawn here.
pub const ALL: &[Diagram] = &[
    ("chromaticities", chromaticities),
    ("lobes", lobes),
    ("highlight", highlight),
    ("penumbra", penumbra),
    ("leaving", leaving),
    ("solid-angle", solid_angle),
    ("mirrored", mirrored),
    ("microfacets", microfacets),
    ("paths", paths),
    ("refraction", refraction),
    ("spectra", spectra),
    ("environment-draws", environment_draws),
];

/// The CIE's chromaticities, the spectral colours around them, and what RGB spaces hold.
fn chromaticities() -> String {
    let mut d = Drawing::new(620, 470);
    let panel = Panel { area: [60.0, 34.0, 420.0, 418.0], world: [-0.05, -0.1, 0.8, 1.03] };
    panel.axes(&mut d, &[0.0, 0.2, 0.4, 0.6], &[0.0, 0.2, 0.4, 0.6, 0.8, 1.0], ["x", "y"]);
    let functions = Observer::Cie1931.functions();
    let of = |nm: usize| {
        let [x, y, z] = functions[nm - FIRST];
        panel.at([(x / (x + y + z)) as f32, (y / (x + y + z)) as f32])
    };
    let locus: Vec<At> = (390..=700).step_by(2).map(of).collect();
    d.area(&locus, "#f4f5f6", INK);
    for nm in [460, 480, 500, 520, 540, 560, 580, 600, 620] {
        d.dot(of(nm), INK);
        let [x, y] = of(nm);
        let left = nm <= 500;
        d.words(
            [if left { x - 8.0 } else { x + 8.0 }, y + if nm == 520 { -6.0 } else { 4.0 }],
            &format!("{nm}"),
            if left { "end" } else { "start" },
            INK,
        );
    }
    let colours = [INK, HOT, GREEN, RAY, "#8a5a00"];
    for (i, (space, colour)) in Space::ALL.into_iter().zip(colours).enumerate() {
        let rgb = space.rgb();
        let corner = rgb.primaries.map(|c| panel.at([c.x as f32, c.y as f32]));
        d.area(&corner, "none", colour);
        let y = 60.0 + 26.0 * i as f32;
        d.path(&[[445.0, y], [475.0, y]], colour, 2.5);
        d.text([483.0, y + 5.0], space.name());
    }
    let white = Space::Srgb.rgb().white;
    let at = panel.at([white.x as f32, white.y as f32]);
    d.circle(at, 4.0, "white", INK);
    d.text([at[0] + 8.0, at[1] + 5.0], "D65");
    d.text([445.0, 215.0], "round the edge: pure");
    d.text([445.0, 233.0], "colours by wavelength,");
    d.text([445.0, 251.0], "in nm");
    d.finish()
}

/// GGX as the page on glossy reflection has it.
fn ggx(cos: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let t = (a2 - 1.0) * cos * cos + 1.0;
    a2 / (std::f32::consts::PI * t * t)
}

/// Where light from one direction goes: diffuse, glossy, mirror.
fn lobes() -> String {
    let mut d = Drawing::new(700, 240);
    for (i, (name, alpha)) in [("diffuse", 1.0), ("glossy", 0.3), ("mirror", 0.0_f32)].into_iter().enumerate()
    {
        let at = [120.0 + 230.0 * i as f32, 190.0];
        let incoming = 130.0;
        d.boxed([at[0] - 105.0, at[1]], [at[0] + 105.0, at[1] + 14.0], STUFF, "none");
        d.path(&[[at[0] - 105.0, at[1]], [at[0] + 105.0, at[1]]], INK, 1.5);
        let radius = |degrees: f32| match i {
            0 => 95.0 * ops::sin(degrees.to_radians()),
            _ => {
                // The half vector's angle from the normal.
                let half = 0.5 * (degrees + incoming) - 90.0;
                130.0 * ggx(ops::cos(half.to_radians()), alpha) / ggx(1.0, alpha)
                    * ops::sin(degrees.to_radians())
                    / ops::sin(50.0_f32.to_radians())
            }
        };
        if i == 2 {
            d.arrow(at, on_circle(at, 140.0, 50.0), HOT);
        } else {
            let outline: Vec<At> = (0..=90_u8)
                .map(|k| {
                    let degrees = 2.0 * f32::from(k);
                    on_circle(at, radius(degrees), degrees)
                })
                .collect();
            d.area(&outline, BLUSH, HOT);
            for k in 1..12_u8 {
                let degrees = 15.0 * f32::from(k);
                let r = radius(degrees);
                if r > 22.0 {
                    d.arrow(at, on_circle(at, r, degrees), HOT);
                }
            }
        }
        d.arrow(on_circle(at, 140.0, incoming), at, RAY);
        d.dashes(&[at, [at[0], at[1] - 120.0]], FAINT);
        d.words([at[0] + 6.0, at[1] - 112.0], "n", "start", INK);
        d.label([at[0], 228.0], name);
    }
    d.words([24.0, 60.0], "ωi", "start", RAY);
    d.finish()
}

/// A lamp in a polished and in a rough surface: which facets send its light to the eye.
fn highlight() -> String {
    let mut d = Drawing::new(700, 270);
    for (left, name, rough) in
        [(10.0, "polished: the lamp's mirror image", false), (360.0, "rough: a soft patch", true)]
    {
        let ground = 200.0;
        let (lamp, eye) = ([left + 70.0, 50.0], [left + 290.0, 60.0]);
        d.boxed([left + 10.0, ground], [left + 320.0, ground + 14.0], STUFF, "none");
        d.path(&[[left + 10.0, ground], [left + 320.0, ground]], INK, 1.5);
        let mirror = |lamp_x: f32| {
            let (a, b) = (ground - lamp[1], ground - eye[1]);
            lamp_x + (eye[0] - lamp_x) * a / (a + b)
        };
        let (from, to) = (mirror(lamp[0] - 16.0), mirror(lamp[0] + 16.0));
        if rough {
            for k in 0..=6_u8 {
                let x = from - 34.0 + f32::from(k) / 6.0 * (to - from + 68.0);
                d.path(&[lamp, [x, ground], eye], "#f0b4a8", 1.0);
            }
            // How much comes from each place.
            let outline: Vec<At> = (0..=60_u8)
                .map(|k| {
                    let x = from - 80.0 + f32::from(k) / 60.0 * (to - from + 160.0);
                    let away = (x - 0.5 * (from + to)) / 42.0;
                    [x, ground + 14.0 + 26.0 * ops::exp(-away * away)]
                })
                .collect();
            d.area(&outline, BLUSH, HOT);
        } else {
            for x in [lamp[0] - 16.0, lamp[0] + 16.0] {
                d.path(&[[x, lamp[1]], [mirror(x), ground], eye], HOT, 1.3);
            }
            d.boxed([from, ground + 14.0], [to, ground + 40.0], BLUSH, HOT);
        }
        d.boxed([lamp[0] - 16.0, lamp[1] - 10.0], [lamp[0] + 16.0, lamp[1]], GLOW, INK);
        d.label([lamp[0], lamp[1] - 18.0], "lamp");
        d.dot(eye, INK);
        d.label([eye[0], eye[1] - 10.0], "eye");
        d.label([left + 165.0, 262.0], name);
    }
    d.finish()
}

/// A lamp with a size, something before it, and the half shadow.
fn penumbra() -> String {
    let mut d = Drawing::new(700, 290);
    let lamp = [[170.0, 34.0], [270.0, 34.0]];
    let block = [[200.0, 120.0], [330.0, 120.0]];
    let ground = 250.0;
    let hit = |a: At, b: At| {
        let t = (ground - a[1]) / (b[1] - a[1]);
        a[0] + t * (b[0] - a[0])
    };
    let full = [hit(lamp[0], block[0]), hit(lamp[1], block[1])];
    let half = [hit(lamp[1], block[0]), hit(lamp[0], block[1])];
    d.boxed([20.0, ground], [680.0, ground + 12.0], GLOW, "none");
    d.boxed([half[0], ground], [half[1], ground + 12.0], FAINT, "none");
    d.boxed([full[0], ground], [full[1], ground + 12.0], INK, "none");
    for (a, b) in [(lamp[0], block[0]), (lamp[1], block[1])] {
        d.path(&[a, [hit(a, b), ground]], INK, 1.0);
    }
    for (a, b) in [(lamp[1], block[0]), (lamp[0], block[1])] {
        d.dashes(&[a, [hit(a, b), ground]], FAINT);
    }
    d.boxed([lamp[0][0], 24.0], lamp[1], GLOW, INK);
    d.boxed(block[0], [block[1][0], 130.0], STUFF, INK);
    d.text([284.0, 34.0], "lamp");
    d.label([0.5 * (full[0] + full[1]), 282.0], "dark");
    d.label([0.5 * (full[1] + half[1]), 282.0], "half shadow");
    let point = [0.5 * (full[1] + half[1]), ground];
    for (to, blocked) in [([190.0, 34.0], true), ([252.0, 34.0], false)] {
        if blocked {
            let t = (point[1] - 130.0) / (point[1] - to[1]);
            let stop = [point[0] + t * (to[0] - point[0]), 130.0];
            d.arrow(point, stop, HOT);
        } else {
            d.arrow(point, to, RAY);
        }
    }
    d.dot(point, INK);
    d.words([470.0, 150.0], "one shadow ray gets to the lamp,", "start", RAY);
    d.words([470.0, 170.0], "another is stopped", "start", HOT);
    d.finish()
}

/// Where a ray leaves from: a fixed distance, or the bound of the error.
fn leaving() -> String {
    let mut d = Drawing::new(700, 230);
    let surface = |left: f32| -> Vec<At> {
        (0..=30_u8)
            .map(|k| {
                let x = f32::from(k) * 10.0;
                [left + x, 150.0 - 22.0 * ops::sin(x / 300.0 * std::f32::consts::PI)]
            })
            .collect()
    };
    for (left, bound) in [(20.0, false), (370.0, true)] {
        let line = surface(left);
        let mut ground = line.clone();
        ground.extend([[left + 300.0, 190.0], [left, 190.0]]);
        d.area(&ground, STUFF, "none");
        d.path(&line, INK, 2.0);
        // The point as it was rounded, a little inside.
        let at = [left + 150.0, 134.0];
        if bound {
            d.boxed([at[0] - 12.0, at[1] - 12.0], [at[0] + 12.0, at[1] + 12.0], "#fdf3dc", "#8a5a00");
            let start = [at[0], at[1] - 12.0];
            d.dot(at, HOT);
            d.arrow(start, [at[0] + 110.0, 60.0], RAY);
            d.dot(start, RAY);
            d.words([at[0] - 20.0, at[1] - 18.0], "bound of the error", "end", "#8a5a00");
        } else {
            d.arrow(at, [at[0] + 34.0, at[1] - 23.0], HOT);
            d.dashes(&[[at[0] + 34.0, at[1] - 23.0], [at[0] + 110.0, 60.0]], FAINT);
            d.dot(at, HOT);
            d.words([at[0] - 8.0, at[1] - 16.0], "the point, rounded", "end", HOT);
        }
    }
    d.label([170.0, 216.0], "from the rounded point: may hit its own surface");
    d.label([520.0, 216.0], "from just outside of the bound: can't");
    d.finish()
}

/// A piece of a lamp, seen from a point.
fn solid_angle() -> String {
    let mut d = Drawing::new(660, 300);
    let point = [110.0, 245.0];
    d.boxed([20.0, 245.0], [560.0, 258.0], STUFF, "none");
    d.path(&[[20.0, 245.0], [560.0, 245.0]], INK, 1.5);
    let middle = [450.0, 85.0];
    // Along the lamp, which is tilted, and its normal.
    let (along, normal) = ([0.42, 0.91], [-0.91, 0.42]);
    let end = |s: f32| [middle[0] + s * along[0], middle[1] + s * along[1]];
    let cone = |s: f32| {
        let to = end(s);
        let (dx, dy) = (to[0] - point[0], to[1] - point[1]);
        let length = (dx * dx + dy * dy).sqrt();
        [point[0] + 85.0 * dx / length, point[1] + 85.0 * dy / length]
    };
    d.area(&[point, end(-42.0), end(42.0)], "#fff6da", "none");
    d.path(&[point, end(-42.0)], FAINT, 1.0);
    d.path(&[point, end(42.0)], FAINT, 1.0);
    d.path(&[end(-75.0), end(75.0)], FAINT, 3.0);
    d.path(&[end(-42.0), end(42.0)], "#c78a00", 5.0);
    d.path(&[cone(-42.0), cone(42.0)], HOT, 3.5);
    d.words([cone(0.0)[0] - 14.0, cone(0.0)[1] - 26.0], "dω", "middle", HOT);
    d.arrow(middle, [middle[0] + 95.0 * normal[0], middle[1] + 95.0 * normal[1]], GREEN);
    d.arrow(point, middle, RAY);
    d.dashes(&[middle, [middle[0] - 0.905 * 95.0, middle[1] + 0.425 * 95.0]], RAY);
    d.words([265.0, 160.0], "d", "middle", RAY);
    d.text([middle[0] + 26.0, middle[1] + 2.0], "dA, a piece of the lamp");
    d.words([middle[0] - 60.0, middle[1] + 100.0], "the lamp's normal", "start", GREEN);
    d.arrow(point, [point[0], 150.0], GREEN);
    d.words([point[0] - 8.0, 158.0], "n", "end", GREEN);
    d.dot(point, INK);
    d.text([40.0, 286.0], "dω = cos θl dA / d²: half as far is four times as large; tilted is smaller");
    d.finish()
}

/// The share of light that a conductor reflects (Born and Wolf), for unpolarised light.
fn conductor(cos: f32, n: f32, k: f32) -> f32 {
    let (c2, s2) = (cos * cos, 1.0 - cos * cos);
    let (n2, k2) = (n * n, k * k);
    let t0 = n2 - k2 - s2;
    let a2b2 = (t0 * t0 + 4.0 * n2 * k2).sqrt();
    let a = ops::max(0.5 * (a2b2 + t0), 0.0).sqrt();
    let rs = (a2b2 + c2 - 2.0 * a * cos) / (a2b2 + c2 + 2.0 * a * cos);
    let rp = rs * (c2 * a2b2 + s2 * s2 - 2.0 * a * cos * s2) / (c2 * a2b2 + s2 * s2 + 2.0 * a * cos * s2);
    0.5 * (rs + rp)
}

/// The law of reflection, and how much metals reflect by angle.
fn mirrored() -> String {
    let mut d = Drawing::new(720, 300);
    let at = [150.0, 210.0];
    d.boxed([20.0, 210.0], [280.0, 224.0], STUFF, "none");
    d.path(&[[20.0, 210.0], [280.0, 210.0]], INK, 1.5);
    d.arrow(at, [at[0], 70.0], GREEN);
    d.words([at[0] + 7.0, 82.0], "n", "start", GREEN);
    d.arrow(at, on_circle(at, 150.0, 135.0), RAY);
    d.arrow(at, on_circle(at, 150.0, 45.0), HOT);
    d.words([28.0, 92.0], "ωo, to the eye", "start", RAY);
    d.words([272.0, 92.0], "ωi, to the light", "end", HOT);
    d.arc(at, 44.0, [90.0, 135.0], INK);
    d.arc(at, 44.0, [45.0, 90.0], INK);
    d.label([130.0, 156.0], "θ");
    d.label([170.0, 156.0], "θ");
    d.label([150.0, 252.0], "the same angle on both sides");
    let panel = Panel { area: [370.0, 36.0, 600.0, 246.0], world: [0.0, 0.0, 90.0, 1.0] };
    panel.axes(
        &mut d,
        &[0.0, 30.0, 60.0, 90.0],
        &[0.0, 0.5, 1.0],
        ["angle θ, in degrees", "share that is reflected, at 450 nm"],
    );
    for (i, (name, colour)) in
        [("silver", FAINT), ("aluminium", RAY), ("copper", HOT), ("gold", "#c78a00")].into_iter().enumerate()
    {
        let Some([n, k]) = Metal::named(name).map(Metal::index) else { continue };
        let (n, k) = (n.at(450.0, Quantity::Index) as f32, k.at(450.0, Quantity::Index) as f32);
        d.path(&panel.curve(|x: f32| conductor(ops::cos(x.to_radians()), n, k)), colour, 2.0);
        let y = 60.0 + 24.0 * i as f32;
        d.path(&[[614.0, y], [636.0, y]], colour, 2.5);
        d.text([642.0, y + 5.0], name);
    }
    d.finish()
}

/// Facets that are turned halfway, and how many there are for each roughness.
fn microfacets() -> String {
    let mut d = Drawing::new(720, 300);
    let heights = [150.0, 172.0, 166.0, 140.0, 134.0, 165.0, 150.0, 144.0, 178.0, 146.0, 140.0_f32];
    let points: Vec<At> =
        heights.iter().enumerate().map(|(i, &y)| [20.0 + 30.0 * i as f32, y + 30.0]).collect();
    let mut ground = points.clone();
    ground.extend([[320.0, 230.0], [20.0, 230.0]]);
    d.area(&ground, STUFF, "none");
    d.path(&points, INK, 2.0);
    let (o, i) = (62.0_f32, 140.0_f32);
    let half = 0.5 * (o + i);
    for w in points.windows(2) {
        let middle = [0.5 * (w[0][0] + w[1][0]), 0.5 * (w[0][1] + w[1][1])];
        let normal = ops::atan2(w[1][0] - w[0][0], w[1][1] - w[0][1]).to_degrees();
        // Facets turned nearly halfway between both directions reflect from one to the other.
        if (normal - half).abs() < 14.0 {
            d.path(w, HOT, 4.0);
            d.arrow(middle, on_circle(middle, 48.0, normal), GREEN);
        }
    }
    let at = [125.0, 167.0];
    d.arrow(on_circle(at, 140.0, i), at, RAY);
    d.arrow(at, on_circle(at, 140.0, o), RAY);
    d.words([20.0, 62.0], "light", "start", RAY);
    d.words([200.0, 46.0], "eye", "start", RAY);
    d.words([110.0, 118.0], "m", "end", GREEN);
    d.label([170.0, 254.0], "only facets with normal m, halfway,");
    d.label([170.0, 273.0], "send light from one to the other");
    let panel = Panel { area: [400.0, 36.0, 600.0, 240.0], world: [0.0, 0.0, 60.0, 1.0] };
    panel.axes(
        &mut d,
        &[0.0, 20.0, 40.0, 60.0],
        &[0.0, 1.0],
        ["angle of a facet, in degrees", "D(m), as a part of its peak"],
    );
    for (k, (alpha, colour)) in [(0.1, RAY), (0.25, GREEN), (0.5, HOT)].into_iter().enumerate() {
        d.path(&panel.curve(|x: f32| ggx(ops::cos(x.to_radians()), alpha) / ggx(1.0, alpha)), colour, 2.0);
        let y = 60.0 + 24.0 * k as f32;
        d.path(&[[614.0, y], [636.0, y]], colour, 2.5);
        d.text([642.0, y + 5.0], &format!("α = {alpha}"));
    }
    d.finish()
}

/// A path from the eye, with its shadow rays to the lamp.
fn paths() -> String {
    let mut d = Drawing::new(640, 330);
    d.boxed([120.0, 24.0], [560.0, 280.0], "#fbfbfc", INK);
    d.boxed([300.0, 24.0], [400.0, 32.0], GLOW, INK);
    d.label([350.0, 18.0], "lamp");
    d.boxed([245.0, 256.0], [295.0, 280.0], STUFF, INK);
    let eye = [30.0, 160.0];
    let vertices = [[430.0, 280.0], [560.0, 150.0], [160.0, 280.0]];
    let lamp = [[345.0, 32.0], [380.0, 32.0], [330.0, 32.0]];
    let mut from = eye;
    for (i, v) in vertices.into_iter().enumerate() {
        d.arrow(from, v, RAY);
        let middle = [0.5 * (from[0] + v[0]), 0.5 * (from[1] + v[1])];
        d.words([middle[0] + 4.0, middle[1] - 9.0], &format!("{}", i + 1), "middle", RAY);
        from = v;
    }
    for (v, l) in vertices.into_iter().zip(lamp) {
        d.dashes(&[v, l], "#c78a00");
        d.dot(v, INK);
    }
    d.dot(eye, INK);
    d.label([eye[0] + 4.0, eye[1] + 22.0], "eye");
    d.path(&[[150.0, 306.0], [185.0, 306.0]], RAY, 2.0);
    d.text([193.0, 311.0], "path, edge by edge");
    d.dashes(&[[350.0, 306.0], [385.0, 306.0]], "#c78a00");
    d.text([393.0, 311.0], "shadow rays to the lamp");
    d.finish()
}

/// Fresnel for a clear boundary; `eta` is the index of the far side over that of the near one.
fn fresnel(cos: f32, eta: f32) -> f32 {
    let s2 = (1.0 - cos * cos) / (eta * eta);
    if s2 >= 1.0 {
        return 1.0;
    }
    let ct = (1.0 - s2).sqrt();
    let p = (eta * cos - ct) / (eta * cos + ct);
    let s = (cos - eta * ct) / (cos + eta * ct);
    0.5 * (p * p + s * s)
}

/// Snell's law, and the share that is reflected by angle, from both sides.
fn refraction() -> String {
    let mut d = Drawing::new(720, 310);
    let at = [160.0, 140.0];
    d.boxed([20.0, 140.0], [300.0, 260.0], "#dcecf9", "none");
    d.path(&[[20.0, 140.0], [300.0, 140.0]], INK, 1.5);
    d.dashes(&[[160.0, 20.0], [160.0, 255.0]], FAINT);
    let angle = 50.0_f32;
    let inside = ops::asin(ops::sin(angle.to_radians()) / 1.5).to_degrees();
    d.arrow(on_circle(at, 125.0, 90.0 + angle), at, RAY);
    d.arrow(at, on_circle(at, 105.0, 90.0 - angle), FAINT);
    d.arrow(at, on_circle(at, 118.0, 270.0 + inside), RAY);
    d.arc(at, 46.0, [90.0, 90.0 + angle], INK);
    d.arc(at, 46.0, [270.0, 270.0 + inside], INK);
    d.label([138.0, 88.0], "θo");
    d.label([173.0, 206.0], "θt");
    d.text([26.0, 158.0], "glass, η = 1.5");
    d.text([26.0, 132.0], "air");
    d.text([218.0, 62.0], "5 %");
    d.text([238.0, 236.0], "95 %");
    d.label([160.0, 286.0], "bent towards the normal");
    let panel = Panel { area: [385.0, 36.0, 590.0, 250.0], world: [0.0, 0.0, 90.0, 1.0] };
    panel.axes(
        &mut d,
        &[0.0, 30.0, 60.0, 90.0],
        &[0.0, 0.5, 1.0],
        ["angle from the normal, in degrees", "share that is reflected"],
    );
    for (i, (name, eta, colour)) in
        [("from air", 1.5, RAY), ("from glass", 1.0 / 1.5, HOT)].into_iter().enumerate()
    {
        d.path(&panel.curve(|x: f32| fresnel(ops::cos(x.to_radians()), eta)), colour, 2.0);
        let y = 60.0 + 24.0 * i as f32;
        d.path(&[[604.0, y], [626.0, y]], colour, 2.5);
        d.text([632.0, y + 5.0], name);
    }
    d.finish()
}

/// Spectra of lamps and of two paints that look alike under one of them.
fn spectra() -> String {
    let mut d = Drawing::new(720, 300);
    let wavelengths = [400.0, 500.0, 600.0, 700.0];
    let lamps = Panel { area: [45.0, 36.0, 335.0, 220.0], world: [380.0, 0.0, 730.0, 2.5] };
    lamps.axes(&mut d, &wavelengths, &[0.0, 1.0, 2.0], ["wavelength, in nm", "light, with luminance 1"]);
    for (i, (name, words, colour)) in
        [("D65", "D65, daylight", RAY), ("A", "A, tungsten", "#c78a00"), ("FL11", "FL11, a tube", GREEN)]
            .into_iter()
            .enumerate()
    {
        let Some(light) = Illuminant::named(name).map(Illuminant::spectrum) else { continue };
        let light = illuminant::of_unit_luminance(&light);
        d.path(
            &lamps.curve(|nm| ops::min(light.at(f64::from(nm), Quantity::Emission) as f32, 2.5)),
            colour,
            1.8,
        );
        let x = 30.0 + 115.0 * i as f32;
        d.path(&[[x, 280.0], [x + 16.0, 280.0]], colour, 2.5);
        d.words([x + 20.0, 285.0], words, "start", INK);
    }
    let paints = Panel { area: [415.0, 36.0, 705.0, 220.0], world: [380.0, 0.0, 730.0, 1.0] };
    paints.axes(&mut d, &wavelengths, &[0.0, 0.5, 1.0], ["wavelength, in nm", "share that is reflected"]);
    let paint = uplift::Uplift::new()
        .fit([0xb0, 0xa0, 0x90].map(|c: u8| f64::from(srgb::decode(f32::from(c) / 255.0))))
        .bins();
    let twin = metamer::of(&paint, &illuminant::d65(), Observer::Cie1931);
    for (i, (words, bins, colour)) in
        [("a paint", Some(paint), INK), ("its twin under D65", twin, HOT)].into_iter().enumerate()
    {
        let Some(bins) = bins else { continue };
        d.path(&paints.curve(|nm| bins[nm as usize - FIRST] as f32), colour, 1.8);
        let x = 430.0 + 110.0 * i as f32;
        d.path(&[[x, 280.0], [x + 16.0, 280.0]], colour, 2.5);
        d.words([x + 20.0, 285.0], words, "start", INK);
    }
    d.finish()
}

/// Directions drawn evenly, and in proportion to a sky with a sun.
fn environment_draws() -> String {
    use straal_math::lowdisc::PatternKind;
    use straal_study::points::Request;
    let mut d = Drawing::new(700, 220);
    let bright = |x: f32, y: f32| {
        let (dx, dy) = ((x - 0.68) / 0.035, (y - 0.62) / 0.07);
        0.15 + 0.85 * y * y + 60.0 * ops::exp(-dx * dx - dy * dy)
    };
    // A table over cells, drawn from by its sums: rows first, then columns.
    const N: usize = 64;
    let cell = |i: usize| (i as f32 + 0.5) / N as f32;
    let rows: Vec<f32> = (0..N)
        .map(|j| {
            ops::sin(std::f32::consts::PI * cell(j)) * (0..N).map(|i| bright(cell(i), cell(j))).sum::<f32>()
        })
        .collect();
    let pick = |weights: &[f32], u: f32| {
        let mut left = u * weights.iter().sum::<f32>();
        for (i, w) in weights.iter().enumerate() {
            if left < *w {
                return (i as f32 + left / w) / weights.len() as f32;
            }
            left -= w;
        }
        1.0
    };
    let request = Request { kind: PatternKind::Sobol, count: 256, seed: 1, dimensions: [0, 1] };
    for (left, name, table) in
        [(20.0, "drawn evenly over the sphere", false), (365.0, "drawn by brightness", true)]
    {
        let panel = Panel { area: [left, 20.0, left + 315.0, 177.5], world: [0.0, 0.0, 1.0, 1.0] };
        d.boxed([left, 20.0], [left + 315.0, 177.5], "#e9f2fa", FAINT);
        let sun = panel.at([0.68, 0.62]);
        d.circle(sun, 9.0, GLOW, "#c78a00");
        for [u, v] in request.points([0, 0]) {
            let p = if table {
                let y = pick(&rows, v);
                let row = ops::min(y * N as f32, N as f32 - 1.0) as usize;
                let weights: Vec<f32> = (0..N).map(|i| bright(cell(i), cell(row))).collect();
                [pick(&weights, u), y]
            } else {
                [u, ops::acos(1.0 - 2.0 * v) / std::f32::consts::PI]
            };
            d.circle(panel.at(p), 1.8, RAY, "none");
        }
        d.label([left + 157.0, 205.0], name);
    }
    d.finish()
}
