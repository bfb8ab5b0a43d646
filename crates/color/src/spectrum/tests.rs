//! Against the numbers of an independent program, and against what must hold.

use super::refraction::{Glass, Metal};
use super::*;
use crate::{Space, srgb};
use straal_math::ops;
use uplift::Uplift;

#[path = "../../../../tests/shared.rs"]
mod shared_data;

/// The folder of spectral tables, if this machine has it.
fn shared() -> Option<std::path::PathBuf> {
    Some(shared_data::shared()?.join("scenes/spectral"))
}

/// The numbers in brackets after a label.
fn expected(text: &str, label: &str) -> Vec<f64> {
    let at = text.find(label).unwrap_or_else(|| panic!("{label} is not among the expected values"));
    let rest = &text[at + label.len()..];
    let (_, rest) = rest.split_once('[').unwrap();
    let (list, _) = rest.split_once(']').unwrap();
    list.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

fn chromaticity([x, y, z]: [f64; 3]) -> [f64; 2] {
    [x / (x + y + z), y / (x + y + z)]
}

fn assert_near(found: &[f64], want: &[f64], what: &str) {
    assert_eq!(found.len(), want.len(), "{what}");
    for (a, b) in found.iter().zip(want) {
        assert!((a - b).abs() < 1e-4, "{what}: {found:?}, expected {want:?}");
    }
}

#[test]
fn illuminants_are_those_of_the_oracle() {
    let Some(folder) = shared() else { return };
    let text = std::fs::read_to_string(folder.join("expected_values.txt")).unwrap();
    let white = Observer::Cie1931.light(&illuminant::d65());
    let want = expected(&text, "XYZ of perfect reflector under D65 (ASTM E308):");
    assert_near(&white, &want.iter().map(|v| v / 100.0).collect::<Vec<_>>(), "D65");
    for name in ["A", "D50", "D65", "E"] {
        let light = Illuminant::named(name).unwrap().spectrum();
        let xy = chromaticity(Observer::Cie1931.light(&light.bins(Quantity::Emission)));
        assert_near(&xy, &expected(&text, &format!("xy of {name}:")), name);
    }
    for kelvin in [1000, 2856, 4000, 5500, 6500, 10000] {
        let light = thermal::black_body(f64::from(kelvin)).bins(Quantity::Emission);
        let xy = chromaticity(Observer::Cie1931.light(&light));
        assert_near(&xy, &expected(&text, &format!("blackbody {kelvin} K xy:")), &format!("{kelvin} K"));
    }
}

#[test]
fn the_color_checker_is_that_of_the_oracle() {
    let Some(folder) = shared() else { return };
    let text = std::fs::read_to_string(folder.join("expected_values.txt")).unwrap();
    let table = std::fs::read_to_string(folder.join("colourchecker_babelcolor_average.csv")).unwrap();
    let mut lines = table.lines().skip(1);
    let names: Vec<&str> = lines.next().unwrap().split(',').skip(1).collect();
    let rows: Vec<Vec<f64>> = lines.map(|l| l.split(',').map(|w| w.parse().unwrap()).collect()).collect();
    // The matrix that the oracle rounds to four places.
    let after = text.split_once("sRGB matrix XYZ->RGB:").unwrap().1;
    let numbers: Vec<f64> = after
        .split(|c: char| c.is_whitespace() || "[]".contains(c))
        .filter(|w| !w.is_empty())
        .map_while(|w| w.parse().ok())
        .collect();
    assert_eq!((names.len(), numbers.len()), (24, 9));
    let white = illuminant::d65();
    let uplift = Uplift::new();
    for (k, name) in names.iter().enumerate() {
        let wavelengths = rows.iter().map(|r| r[0]).collect();
        let values = rows.iter().map(|r| r[k + 1]).collect();
        let patch = TabulatedSpectrum::new(wavelengths, values).unwrap().bins(Quantity::Reflectance);
        let xyz = Observer::Cie1931.surface(&patch, &white);
        let label = format!("BabelColor Average {name} XYZ under D65 /100:");
        assert_near(&xyz, &expected(&text, &label), name);
        let rgb: Vec<f64> = (0..3).map(|r| (0..3).map(|c| numbers[3 * r + c] * xyz[c]).sum()).collect();
        let after = text.split_once(&label).unwrap().1;
        let want = expected(after, "linear sRGB:");
        assert_near(&rgb, &want, name);
        // The oracle's matrix is rounded to four digits: in the brightest patch that makes 1.5e-4 (tests/colorchecker.rs).
        for (a, b) in uplift.rgb_of_reflectance(&patch).iter().zip(&want) {
            assert!((a - b).abs() < 6e-4, "{name}: {a} {b}");
        }
    }
}

#[test]
fn tables_are_those_that_were_measured() {
    let Some(folder) = shared() else { return };
    for (name, file) in
        [("A", "illuminant_A"), ("C", "illuminant_C"), ("D50", "illuminant_D50"), ("D65", "illuminant_D65")]
    {
        let text = std::fs::read_to_string(folder.join(format!("{file}.csv"))).unwrap();
        let ours = Illuminant::named(name).unwrap().spectrum();
        let points: Vec<(f64, f64)> = text
            .lines()
            .filter(|l| !l.starts_with('#'))
            .map(|l| l.split_once(',').unwrap())
            .map(|(a, b)| (a.parse().unwrap(), b.parse().unwrap()))
            .collect();
        let theirs = |nm: f64| points.iter().find(|p| p.0 == nm).unwrap().1;
        let scale = theirs(560.0) / ours.at(560.0, Quantity::Emission);
        for &(nm, value) in points.iter().filter(|p| p.0 >= 360.0) {
            assert!((ours.at(nm, Quantity::Emission) * scale - value).abs() < 1e-3 * 100.0, "{name} at {nm}");
        }
    }
}

#[test]
fn daylight_by_formula_is_that_of_the_tables() {
    for (name, kelvin) in [("D50", 5000.0), ("D65", 6500.0)] {
        let table = Illuminant::named(name).unwrap().spectrum();
        let formula = illuminant::of_unit_luminance(&thermal::daylight(kelvin).unwrap());
        for nm in (360..=830).step_by(5) {
            let (a, b) = (table.at(nm as f64, Quantity::Emission), formula.at(nm as f64, Quantity::Emission));
            assert!((a - b).abs() < 1e-4, "{name} at {nm}: {a} {b}");
        }
    }
    assert!(thermal::daylight(3999.0).is_none() && thermal::daylight(f64::NAN).is_none());
    // The CIE's own figures for D55 and D75 (CIE 15:2018, table 3).
    for (name, want) in [("D55", [0.33243, 0.34744]), ("D75", [0.29903, 0.31488])] {
        let light = Illuminant::named(name).unwrap().spectrum().bins(Quantity::Emission);
        assert_near(&chromaticity(Observer::Cie1931.light(&light)), &want, name);
    }
}

/// Chromaticities of fluorescent lamps as CIE 15:2018 prints them: summed every 5 nm, which lines of mercury feel.
#[test]
fn fluorescent_lamps_are_the_cies() {
    let printed = [
        ("FL1", [0.3131, 0.3371]),
        ("FL2", [0.3721, 0.3751]),
        ("FL3", [0.4091, 0.3941]),
        ("FL4", [0.4402, 0.4031]),
        ("FL5", [0.3138, 0.3452]),
        ("FL6", [0.3779, 0.3882]),
        ("FL7", [0.3129, 0.3292]),
        ("FL8", [0.3458, 0.3586]),
        ("FL9", [0.3741, 0.3727]),
        ("FL10", [0.3458, 0.3588]),
        ("FL11", [0.3805, 0.3769]),
        ("FL12", [0.4370, 0.4042]),
    ];
    for (name, want) in printed {
        let light = Illuminant::named(name).unwrap().spectrum().bins(Quantity::Emission);
        let coarse: Bins = std::array::from_fn(|i| if i % 5 == 0 { light[i] } else { 0.0 });
        assert_near(&chromaticity(Observer::Cie1931.light(&coarse)), &want, name);
    }
    let d65 = Observer::Cie1964.light(&illuminant::d65());
    assert_near(&chromaticity(d65), &[0.31382, 0.33100], "D65, 10 degrees");
    for name in illuminant::NAMES {
        let light = Illuminant::named(&format!("cie-{}", name.to_lowercase())).unwrap().spectrum();
        let [_, y, _] = Observer::Cie1931.light(&light.bins(Quantity::Emission));
        assert!((y - 1.0).abs() < 1e-12, "{name}");
    }
    assert!(Illuminant::named("D64").is_none() && Illuminant::named("").is_none());
}

/// The measured Cornell box in RGB, beside the numbers that Mitsuba 3.9.1 makes of the same table (its RGB variant), which
/// are those of `scenes/reference/cbox-rgb.yaml`. It sums over the observer every 5 nm and divides by a sum 0.1 % too great.
#[test]
fn the_cornell_boxes_walls_in_rgb() {
    let Some(folder) = shared() else { return };
    let text = std::fs::read_to_string(folder.join("cornell_box_measured.csv")).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|l| !l.starts_with('#'))
        .map(|l| l.split(',').map(|w| w.parse().unwrap()).collect())
        .collect();
    let theirs = [
        [0.735013, 0.7356246, 0.73626435],
        [0.49132004, 0.049228106, 0.050921898],
        [0.06828254, 0.39776018, 0.086290874],
    ];
    for (k, want) in theirs.into_iter().enumerate() {
        let column = |c: usize| rows.iter().map(|r| r[c]).collect();
        // Their spectra are 0 outside the table.
        let bins = TabulatedSpectrum::new(column(0), column(k + 1)).unwrap().bins(Quantity::Emission);
        for (ours, theirs) in Uplift::new().rgb_of_reflectance(&bins).into_iter().zip(want) {
            assert!((ours - theirs).abs() < 1.5e-3, "{ours} {theirs}");
        }
    }
}

#[test]
fn tables_are_refused_with_the_reason() {
    let of = |w: &[f64], v: &[f64]| TabulatedSpectrum::new(w.to_vec(), v.to_vec());
    assert_eq!(of(&[], &[]), Err(Fault::Empty));
    assert_eq!(of(&[400.0], &[]), Err(Fault::Lengths { wavelengths: 1, values: 0 }));
    assert_eq!(of(&[400.0, f64::NAN], &[1.0; 2]), Err(Fault::NotFinite(1)));
    assert_eq!(of(&[400.0], &[f64::INFINITY]), Err(Fault::NotFinite(0)));
    assert_eq!(of(&[500.0, 500.0], &[1.0; 2]), Err(Fault::Order { index: 1, now: 500.0, before: 500.0 }));
    assert_eq!(of(&[500.0], &[-0.1]), Err(Fault::Negative { index: 0, wavelength: 500.0, value: -0.1 }));
    assert_eq!(of(&[0.5], &[1.0]), Err(Fault::NoLight(0.5)));
    assert_eq!(of(&[900.0, 1000.0], &[1.0; 2]), Err(Fault::Unseen { first: 900.0, last: 1000.0 }));
    let smooth = |w: &[f64]| of(w, &vec![0.5; w.len()]).unwrap().interpolated(Interpolation::Smooth);
    assert_eq!(smooth(&[400.0, 410.0, 420.0]), Err(Fault::Few(3)));
    assert_eq!(
        smooth(&[400.1, 410.3, 420.5, 431.5]),
        Err(Fault::Uneven { index: 3, step: 11.0, first: 10.2 })
    );
    assert_eq!(
        smooth(&[400.1, 410.3, 420.5, 431.5]).unwrap_err().to_string(),
        "a smooth curve needs wavelengths in equal steps, but number 4 is 11 nm after the one before, and the second is 10.2 nm \
         after the first"
    );
}

#[test]
fn between_and_beyond_the_table() {
    let s = TabulatedSpectrum::new(vec![400.0, 410.0, 700.0], vec![1.0, 3.0, 2.0]).unwrap();
    assert_eq!(
        [399.0, 400.0, 405.0, 700.0, 701.0].map(|nm| s.at(nm, Quantity::Emission)),
        [0.0, 1.0, 2.0, 2.0, 0.0]
    );
    assert_eq!([399.0, 701.0].map(|nm| s.at(nm, Quantity::Index)), [1.0, 2.0]);
    // A line half a nanometre wide between two nanometres loses nothing.
    let line = TabulatedSpectrum::new(vec![546.2, 546.4, 546.7], vec![0.0, 10.0, 0.0]).unwrap();
    let sum = |bins: Bins| bins.iter().sum::<f64>();
    assert!((sum(line.means(Quantity::Emission)) - 2.5).abs() < 1e-12);
    assert_eq!(sum(line.bins(Quantity::Emission)), 0.0);
    assert_eq!(s.above_one().map(|(nm, _)| nm), Some(400));
    assert_eq!(s.scaled(0.3).above_one(), None);
    let flat = TabulatedSpectrum::new(vec![400.0], vec![0.25]).unwrap();
    assert!(flat.means(Quantity::Index).iter().all(|v| (v - 0.25).abs() < 1e-12));
}

#[test]
fn smooth_curves_meet_their_points_and_parabolas() {
    let parabola = |nm: f64| 0.1 + 1e-5 * (nm - 500.0) * (nm - 500.0);
    let wavelengths: Vec<f64> = (36..=83).map(|k| 10.0 * f64::from(k)).collect();
    let values = wavelengths.iter().map(|&nm| parabola(nm)).collect();
    let bins = TabulatedSpectrum::new(wavelengths, values).unwrap().bins(Quantity::Index);
    for (i, v) in bins.iter().enumerate() {
        assert!((v - parabola((FIRST + i) as f64)).abs() < 1e-12, "{i}");
    }
}

#[test]
fn curves_are_for_tables_in_equal_steps_no_wider_than_20_nm() {
    let of = |w: &[f64]| {
        TabulatedSpectrum::new(w.to_vec(), (0..w.len()).map(|i| (i * i) as f64).collect()).unwrap()
    };
    // Half a step on from the second of the squares 0, 1, 4, 9: 2.25 by the parabola, 2.5 by the line.
    let middle = |s: &TabulatedSpectrum| {
        let w: Vec<f64> = s.points().map(|p| p.0).collect();
        s.at(0.5 * (w[1] + w[2]), Quantity::Index)
    };
    for steps in [[400.0, 420.0, 440.0, 460.0], [400.0, 403.333, 406.667, 410.0]] {
        assert!((middle(&of(&steps)) - 2.25).abs() < 1e-12, "{steps:?}");
        let lines = of(&steps).interpolated(Interpolation::Linear).unwrap();
        assert!((middle(&lines) - 2.5).abs() < 1e-12, "{steps:?}");
    }
    let wide = of(&[400.0, 500.0, 600.0, 700.0]);
    assert_eq!(middle(&wide), 2.5);
    assert_eq!(middle(&wide.interpolated(Interpolation::Smooth).unwrap()), 2.25);
    assert_eq!(middle(&of(&[400.0, 410.0, 420.0, 431.0])), 2.5);
}

/// Beside an edge and a line a curve through four points would leave what can be; it must neither, nor change a line's power.
#[test]
fn curves_neither_ring_below_black_nor_above_white() {
    let wavelengths: Vec<f64> = (36..=83).map(|k| 10.0 * f64::from(k)).collect();
    let of = |f: &dyn Fn(f64) -> f64| {
        TabulatedSpectrum::new(wavelengths.clone(), wavelengths.iter().map(|&nm| f(nm)).collect()).unwrap()
    };
    let edge = of(&|nm| if nm < 555.0 { 0.0 } else { 1.0 });
    for tenth in 3600..=8300 {
        let v = edge.at(f64::from(tenth) / 10.0, Quantity::Reflectance);
        assert!((0.0..=1.0).contains(&v), "{v}");
    }
    // What is above 1 in the table itself is not made to look like a reflectance.
    assert_eq!(edge.scaled(1.5).above_one().map(|(nm, _)| nm), Some(557));
    // The same numbers as light may be more than 1, and are where nothing else is known of them.
    let wave = of(&|nm| 0.5 + 0.5 * ops::sin_cos_degrees(12.0 * (nm - 365.0)).0);
    let most = |q| wave.bins(q).into_iter().fold(0.0, |a: f64, b| if b > a { b } else { a });
    assert!(most(Quantity::Reflectance) <= 1.0 && most(Quantity::Emission) <= 1.0 + 1e-3);
    for (floor, height) in [(0.0, 1.0), (0.1, 1.0), (5.0, 1.0)] {
        let line = of(&|nm| floor + if nm == 550.0 { height } else { 0.0 });
        let sum = |bins: Bins| bins[20..COUNT - 21].iter().sum::<f64>();
        let want = 10.0 * height + floor * (COUNT - 41) as f64;
        assert!((sum(line.means(Quantity::Emission)) - want).abs() < 1e-9 * want, "{floor}");
        assert!(line.bins(Quantity::Emission).iter().all(|v| *v >= 0.0));
    }
    // Numbers at the end of their range.
    let vast = of(&|nm| if nm == 550.0 { f64::MAX } else { 0.0 });
    assert!(vast.bins(Quantity::Emission).iter().all(|v| v.is_finite() && *v >= 0.0));
}

/// The greatest difference of a colour and its smooth reflectance's, in sRGB.
fn round_trip(uplift: &Uplift, rgb: [f64; 3]) -> f32 {
    let back = uplift.rgb_of_reflectance(&uplift.fit(rgb).bins());
    let error = |c: usize| (srgb::encode(back[c] as f32) - srgb::encode(rgb[c] as f32)).abs();
    (0..3).map(error).fold(0.0, ops::max)
}

#[test]
fn smooth_reflectances_keep_their_colour() {
    let uplift = Uplift::new();
    let mut worst = (0.0, [0.0; 3]);
    const N: usize = 8;
    for k in 0..(N + 1) * (N + 1) * (N + 1) {
        let code = |i: usize| srgb::decode(i as f32 / N as f32);
        let rgb = [k % (N + 1), k / (N + 1) % (N + 1), k / (N + 1) / (N + 1)].map(|i| f64::from(code(i)));
        let bins = uplift.fit(rgb).bins();
        assert!(bins.iter().all(|v| (0.0..=1.0).contains(v)), "{rgb:?}");
        let error = round_trip(&uplift, rgb);
        if error > worst.0 {
            worst = (error, rgb);
        }
    }
    assert!(worst.0 < 1e-3, "{} at {:?}", worst.0, worst.1);
}

/// Colours of Rec. 2020 that sRGB doesn't hold: paints of half their strength keep them, lamps nearly all.
#[test]
fn colours_beyond_srgb_are_met_where_they_can_be() {
    let uplift = Uplift::new();
    let wide = |rgb: [f64; 3]| Space::Rec2020.to(Space::Srgb).apply(rgb);
    for rgb in [[0.5, 0.05, 0.04], [0.03, 0.4, 0.05], [0.02, 0.04, 0.4], [0.02, 0.5, 0.5], [0.6, 0.1, 0.5]] {
        let rgb = wide(rgb);
        let bins = uplift.reach(rgb).unwrap_or_else(|_| panic!("{rgb:?}")).bins();
        assert!(bins.iter().all(|v| (0.0..=1.0).contains(v)));
        for (a, b) in uplift.rgb_of_reflectance(&bins).iter().zip(rgb) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
    }
    for rgb in [[5.0, 0.03, 0.02], [0.1, 9.0, 0.1], [0.01, 0.01, 0.6]] {
        let rgb = wide(rgb);
        let (smooth, scale) = uplift.reach_light(rgb).unwrap_or_else(|_| panic!("{rgb:?}"));
        let light = std::array::from_fn(|i| smooth.bins()[i] * scale * uplift.white()[i]);
        for (a, b) in uplift.rgb_of_light(&light).iter().zip(rgb) {
            assert!((a - b).abs() < 1e-5 * scale, "{a} {b}");
        }
    }
    // No paint is a pure spectral colour at full strength, and no light is beyond them.
    assert!(uplift.reach(wide([0.0, 1.0, 0.0])).is_err());
    assert!(uplift.reach_light([-1.0, 1.0, -1.0]).is_err());
}

#[test]
fn glasses_are_schotts() {
    // n_d and Abbe's numbers as in the data sheets of 2017.
    for (name, n, v) in [
        ("N-BK7", 1.51680, 64.17),
        ("bk7", 1.51680, 64.17),
        ("SF11", 1.78472, 25.76),
        ("N-SF11", 1.78472, 25.68),
    ] {
        let glass = Glass::named(name).unwrap().index();
        assert!((glass.at(587.5618) - n).abs() < 1e-5, "{name}: {}", glass.at(587.5618));
        assert!((glass.abbe_number() - v).abs() < 0.01, "{name}: {}", glass.abbe_number());
    }
    for glass in Glass::all() {
        let (name, glass) = (glass.name(), glass.index());
        assert!((FIRST..=LAST).all(|nm| (1.2..2.6).contains(&glass.at(nm as f64))), "{name}");
        assert!(glass.at(400.0) > glass.at(700.0), "{name}");
    }
    let cauchy = refraction::Index::Cauchy(vec![1.5, 0.004]);
    assert!((cauchy.at(500.0) - 1.516).abs() < 1e-12 && Glass::named("BK8").is_none());
}

#[test]
fn metals_have_their_colours() {
    for metal in Metal::all() {
        let (name, [n, k]) = (metal.name(), metal.index());
        assert!(n.points().len() >= 10 && k.points().len() == n.points().len(), "{name}");
    }
    let reflected = |name: &str, nm: f64| {
        let [n, k] = Metal::named(name).unwrap().index().map(|s| s.at(nm, Quantity::Index));
        ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k)
    };
    assert!(reflected("gold", 650.0) > 0.95 && reflected("Gold", 450.0) < 0.45);
    assert!(reflected("silver", 450.0) > 0.95 && reflected("copper", 650.0) > 0.9);
    // By optical constants: electron-loss data have tungsten as bright as silver.
    assert!((reflected("tungsten", 589.0) - 0.51).abs() < 0.01);
    assert!((reflected("platinum", 589.0) - 0.74).abs() < 0.01);
    assert!(Metal::named("unobtainium").is_none());
}

/// Single values of CIE 15:2018, table 6, which other tables that go round have otherwise.
#[test]
fn fluorescent_lamps_have_the_values_of_the_cie() {
    for (name, nm, want) in [
        ("FL10", 605.0, 8.31),
        ("FL10", 385.0, 0.80),
        ("FL5", 690.0, 1.48),
        ("FL6", 625.0, 8.95),
        ("FL9", 530.0, 10.78),
        ("FL12", 390.0, 0.40),
    ] {
        let lamp = Illuminant::named(name).unwrap().spectrum();
        // Scaled to a luminance of 1: the table is told by a value beside it.
        let scale = at_400(name) / lamp.at(400.0, Quantity::Emission);
        let got = lamp.at(nm, Quantity::Emission) * scale;
        assert!((got - want).abs() < 1e-9, "{name} at {nm} nm: {got}");
    }
}

/// Relative power at 400 nm by the same table.
fn at_400(name: &str) -> f64 {
    match name {
        "FL5" => 5.10,
        "FL6" => 3.11,
        "FL9" => 2.59,
        "FL10" => 1.48,
        _ => 1.19,
    }
}
