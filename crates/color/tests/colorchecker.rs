//! XYZ to linear sRGB, chromaticity and Lab, beside the shared table that another program computed (colour-science
//! 0.4.7, with the matrix of IEC 61966-2-1, whose rounding to four digits reaches 1.5e-4 in the brightest patch).

use straal_color::{Lab, Matrix3, Space, White, Xyz};

#[path = "../../../tests/shared.rs"]
mod shared;

/// The shared table; without it the test says so.
fn table() -> Option<String> {
    let path = shared::shared()?.join("scenes/spectral/expected_values.txt");
    Some(std::fs::read_to_string(path).expect("the table"))
}

/// The numbers between the next brackets after `from`.
fn numbers<const N: usize>(line: &str, from: &str) -> [f64; N] {
    let list = &line[line.find(from).unwrap() + from.len()..];
    let list = &list[list.find('[').unwrap() + 1..list.find(']').unwrap()];
    let all: Vec<f64> = list.split_whitespace().map(|v| v.parse().unwrap()).collect();
    all.try_into().unwrap()
}

/// As IEC 61966-2-1 prints it: the exact matrix rounded to four digits, inverted, and rounded again.
fn printed_srgb() -> Matrix3 {
    let rounded = |m: Matrix3| Matrix3(m.0.map(|row| row.map(|v| (v * 1e4).round() / 1e4)));
    let there = rounded(Space::Srgb.rgb().to_xyz());
    rounded(there.inverse().unwrap())
}

#[test]
fn patches_of_the_colour_checker_have_the_expected_colours() {
    let Some(table) = table() else { return };
    let lines: Vec<&str> = table.lines().filter(|l| l.contains("linear sRGB:")).collect();
    assert_eq!(lines.len(), 24);
    for (matrix, tolerance) in [(printed_srgb(), 1e-7), (Space::Srgb.rgb().from_xyz(), 1.5e-4)] {
        for line in &lines {
            let xyz: [f64; 3] = numbers(line, "/100:");
            let want: [f64; 3] = numbers(line, "linear sRGB:");
            for (got, want) in matrix.apply(xyz).into_iter().zip(want) {
                assert!((got - want).abs() < tolerance, "{line}: {got}");
            }
        }
    }
}

#[test]
fn matrices_are_those_of_the_table() {
    let Some(table) = table() else { return };
    for (title, matrix, tolerance) in [
        ("sRGB matrix XYZ->RGB:", printed_srgb(), 1e-9),
        ("ACEScg XYZ->RGB:", Space::AcesCg.rgb().from_xyz(), 1e-8),
    ] {
        let rows = table.lines().skip_while(|l| *l != title).skip(1);
        for (row, got) in rows.zip(matrix.0) {
            let want: Vec<f64> =
                row.split_whitespace().filter_map(|v| v.trim_matches(['[', ']']).parse().ok()).collect();
            assert_eq!(want.len(), 3, "{row}");
            for (got, want) in got.into_iter().zip(want) {
                assert!((got - want).abs() < tolerance, "{title} {row} {got}");
            }
        }
    }
}

#[test]
fn whites_lie_where_the_table_has_them() {
    let Some(table) = table() else { return };
    for (name, white) in [("A", White::A), ("D50", White::D50), ("D65", White::D65), ("E", White::E)] {
        let start = format!("xy of {name}:");
        let line = table.lines().find(|l| l.starts_with(&start)).unwrap();
        let [x, y] = numbers(line, ":");
        let at = white.chromaticity();
        // Integrals over a spectrum in steps of 5 or 10 nm differ in the fifth digit.
        assert!((at.x - x).abs() < 5e-5 && (at.y - y).abs() < 5e-5, "{name}: {at:?}");
    }
}

/// The published L*a*b* of the perfect greys: lightness by Y alone, no hue under the table's own white.
#[test]
fn greys_of_the_checker_are_nearly_without_hue() {
    let Some(table) = table() else { return };
    let white: [f64; 3] =
        numbers(table.lines().find(|l| l.starts_with("XYZ of perfect")).unwrap(), "(ASTM E308)");
    let white = Xyz::new(white) * 0.01;
    for line in table.lines().filter(|l| l.contains("Average neutral")) {
        let xyz = Xyz::new(numbers(line, "/100:"));
        let lab = Lab::from_xyz(xyz, white);
        assert!(lab.to_lch().c < 1.5, "{line}: {lab:?}");
        let back = lab.to_xyz(white);
        assert!((back.y - xyz.y).abs() < 1e-12);
    }
}
