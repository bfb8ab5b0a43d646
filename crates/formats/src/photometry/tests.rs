//! Files as luminaires have them, whole and damaged.

use super::*;

fn lm63(head: &str, numbers: &str) -> String {
    format!("{head}\n[TEST] 12345\n[MANUFAC] Any, \u{e4}\nTILT=NONE\n{numbers}\n")
}

/// One lamp, no multiplier: so many vertical and horizontal angles of a type.
fn numbers(angles: &str, planes: &str, kind: u32, candela: &str) -> String {
    let count = |list: &str| list.split_whitespace().count();
    format!(
        "1 1000 1 {} {} {kind} 2 0.1 0.2 0\n1 1 20\n{angles}\n{planes}\n{candela}",
        count(angles),
        count(planes)
    )
}

fn lamp(text: &str) -> Photometry {
    let lamp = read(text.as_bytes()).unwrap_or_else(|e| panic!("{e:?} in\n{text}"));
    assert!(lamp.is_whole(), "{lamp:?}");
    lamp
}

#[test]
fn a_lamp_that_is_the_same_all_around() {
    for head in ["IESNA:LM-63-2002", "IESNA:LM-63-1995", "IESNA91", "a lamp of 1986"] {
        let lamp = lamp(&lm63(head, &numbers("0 45 90", "0", 1, "100 70 0")));
        assert_eq!(
            (lamp.at(0.0, 0.0), lamp.at(200.0, 45.0), lamp.at(10.0, 67.5), lamp.at(0.0, 120.0)),
            (100.0, 70.0, 35.0, 0.0)
        );
    }
}

#[test]
fn factors_are_multiplied() {
    let text = lm63("IESNA91", "2 500 2 2 1 1 1 0 0 0 0.5 0.8 100\n0,90\n0\n100,50");
    assert!((lamp(&text).at(0.0, 0.0) - 80.0).abs() < 1e-4);
    // Numbers of tilt are passed over.
    let text = "TILT=INCLUDE\n1\n3\n0 45 90\n1 .95 .9\n".to_owned() + &numbers("0 90", "0", 1, "8 4");
    assert_eq!(lamp(&text).at(0.0, 90.0), 4.0);
}

/// At 30 degrees from the axis the intensity tells which measured plane it is of.
#[test]
fn symmetries_are_written_out() {
    let at = |planes: &str, candela: &str, wanted: &[(f64, f64)]| {
        let lamp = lamp(&lm63("IESNA:LM-63-2002", &numbers("0 30", planes, 1, candela)));
        for (plane, want) in wanted {
            let got = lamp.at(*plane, 30.0);
            assert!((got - want).abs() < 1e-4, "planes {planes}, at {plane}: {got}, expected {want}");
        }
    };
    at(
        "0 45 90",
        "9 1 9 2 9 3",
        &[
            (0.0, 1.0),
            (45.0, 2.0),
            (90.0, 3.0),
            (135.0, 2.0),
            (180.0, 1.0),
            (225.0, 2.0),
            (270.0, 3.0),
            (360.0, 1.0),
        ],
    );
    at(
        "0 90 180",
        "9 1 9 2 9 3",
        &[(0.0, 1.0), (90.0, 2.0), (180.0, 3.0), (270.0, 2.0), (315.0, 1.5), (360.0, 1.0)],
    );
    at(
        "90 180 270",
        "9 1 9 2 9 3",
        &[(90.0, 1.0), (180.0, 2.0), (270.0, 3.0), (0.0, 2.0), (45.0, 1.5), (315.0, 2.5), (360.0, 2.0)],
    );
    at(
        "0 90 180 270 360",
        "9 1 9 2 9 3 9 4 9 1",
        &[(0.0, 1.0), (90.0, 2.0), (180.0, 3.0), (270.0, 4.0), (315.0, 2.5)],
    );
    at("0 90 180 270", "9 1 9 2 9 3 9 4", &[(0.0, 1.0), (270.0, 4.0), (315.0, 2.5), (360.0, 1.0)]);
}

#[test]
fn floodlights_are_measured_to_the_front() {
    let text = lm63("IESNA:LM-63-2002", &numbers("-90 0 90", "0 90", 2, "1 10 3 0 5 0"));
    let lamp = lamp(&text);
    assert_eq!(lamp.system, Planes::B);
    // Up and down it was measured, to the right only.
    assert_eq!((lamp.at(0.0, 0.0), lamp.at(90.0, 0.0), lamp.at(-90.0, 0.0)), (10.0, 3.0, 1.0));
    assert_eq!((lamp.at(0.0, 90.0), lamp.at(0.0, -90.0)), (5.0, 5.0));
    let head = self::lamp(&text.replace(" 2 2 0.1", " 3 2 0.1"));
    assert_eq!((head.system, head.at(0.0, 90.0), head.at(-90.0, 0.0)), (Planes::A, 3.0, 5.0));
}

/// A file of four C-planes and two angles: of some symmetry, with so many lamps of 2000 lm in its set.
fn ldt(symmetry: u32, lamps: i32, candela: &str) -> String {
    let head = format!("firm\n1\n{symmetry}\n4\n90\n2\n30\n");
    let names = "report\nname\nnumber\nfile\ndate\n";
    let sizes = "100\n100\n50\n90\n90\n0\n0\n0\n0\n100\n80\n";
    let set = format!("1.0\n0\n1\n{lamps}\nLED\n2000\n3000K\n80\n20\n");
    let tables = "0\n".repeat(10) + "0\n90\n180\n270\n0\n30\n";
    head + names
        + sizes
        + &set
        + &tables
        + &candela.split_whitespace().map(|v| format!("{v}\n")).collect::<String>()
}

#[test]
fn eulumdat_says_intensities_for_each_thousand_lumens() {
    let at = |symmetry: u32, candela: &str, wanted: [f64; 4]| {
        let lamp = lamp(&ldt(symmetry, 1, candela).replace('.', ","));
        for (i, want) in wanted.into_iter().enumerate() {
            let got = lamp.at(90.0 * i as f64, 30.0);
            assert!(
                (got - 2.0 * want).abs() < 1e-4,
                "symmetry {symmetry}, plane {i}: {got}, expected {}",
                2.0 * want
            );
        }
        assert_eq!(lamp.at(123.0, 0.0), 18.0);
    };
    at(0, "9 1 9 2 9 3 9 4", [1.0, 2.0, 3.0, 4.0]);
    at(1, "9 1", [1.0; 4]);
    at(2, "9 1 9 2 9 3", [1.0, 2.0, 3.0, 2.0]);
    // From C270 by way of C0 to C90.
    at(3, "9 4 9 1 9 2", [1.0, 2.0, 1.0, 4.0]);
    at(4, "9 1 9 2", [1.0, 2.0, 1.0, 2.0]);
    // As it stands, where the number of lamps is below 0.
    assert_eq!(lamp(&ldt(1, -1, "9 1")).at(0.0, 0.0), 9.0);
}

#[test]
fn damaged_files_are_told() {
    let whole = lm63("IESNA:LM-63-2002", &numbers("0 45 90", "0 90", 1, "1 2 3 4 5 6"));
    let says = |text: &str, what: &str| {
        let told = read(text.as_bytes()).expect_err(text).to_string();
        assert!(told.contains(what), "{told}, expected `{what}`");
    };
    says("", "neither");
    says("a text\nof no lamp\n", "neither");
    says(&whole.replace("1 2 3 4 5 6", "1 2 3"), "it ends after");
    says(&whole.replace("0 45 90", "0 95 90"), "don't rise");
    says(&whole.replace("1 2 3 4 5 6", "0 0 0 0 0 0"), "no light");
    says(&whole.replace("1 2 3 4 5 6", "1 2 x 4 5 6"), "found `x`");
    says(&whole.replace("1 1000 1 3 2 1", "1 1000 1 3 2 7"), "type of photometry is 7");
    says(&whole.replace("1 1000 1 3 2 1", "1 1000 1 1e9 2 1"), "vertical angles: from 1 to");
    says(&whole.replace("1 1000 1 3 2 1", "1 1000 -1 3 2 1"), "nothing would shine");
    says(&ldt(5, 1, "9 1"), "neither");
    says(&ldt(0, 1, "9 1"), "it ends at line");
    // Cut anywhere, it is refused or read, never a panic.
    for text in [whole, ldt(3, 1, "9 4 9 1 9 2")] {
        for end in 0..text.len() {
            let _ = read(&text.as_bytes()[..end]);
        }
    }
}
