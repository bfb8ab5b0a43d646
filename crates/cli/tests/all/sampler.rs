//! `straal sampler` from outside.

use crate::common::Folder;

#[test]
fn points_are_drawn_where_they_are_told() {
    let folder = Folder::new();
    for words in ["sampler sobol --count 16 --plot", "sampler halton --count 16 --plot disc.SVG --map disc"] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(0), "{run:?}");
    }
    assert_eq!(folder.names(), ["disc.SVG", "sobol.svg"]);
    assert!(folder.read("disc.SVG").starts_with(b"<svg"));
}

#[test]
fn drawings_of_other_kinds_are_refused() {
    let folder = Folder::new();
    for (name, better) in [("x.png", "x.svg"), ("x", "x.svg"), ("some/x.svg.pdf", "some/x.svg.svg")] {
        let run = folder.straal(&format!("sampler sobol --plot {name}"));
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{run:?}");
        let problem =
            format!("can't write {name}: points are drawn as SVG, so that the name must end in .svg");
        assert!(run.err.contains(&problem) && run.err.contains(&format!("--plot {better}\n")), "{run:?}");
    }
    let run = folder.straal("sampler --plot sobol");
    assert!(run.code == Some(2) && run.err.contains("--plot draws one pattern: name it"), "{run:?}");
    assert!(folder.names().is_empty());
}
