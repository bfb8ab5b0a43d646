//! The book's page about the command line and the command's own help say the same.

use crate::common::{BALL, Folder};

fn page() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../book/src/command-line.md");
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn the_page_knows_every_option() {
    let (folder, page) = (Folder::new(), page());
    let commands = [
        "render",
        "merge",
        "check",
        "accel",
        "schema",
        "tree",
        "sampler",
        "diff",
        "info",
        "develop",
        "denoise",
        "gamma-chart",
        "metamer",
        "completions",
        "man",
    ];
    for command in commands {
        assert!(page.contains(&format!("`straal {command}")), "{command}");
        let help = folder.straal(&format!("help {command}")).out;
        let lines = help.lines().map(str::trim_start).filter(|l| l.starts_with('-'));
        for word in lines.flat_map(|l| l.split([' ', ',']).take(3)).filter(|w| w.starts_with('-')) {
            let option = word.trim_end_matches(|c: char| !c.is_alphanumeric());
            let known = ["-h", "--help", "--version", "-V"].contains(&option);
            assert!(known || page.contains(&format!("`{option}")), "{command} {option}");
        }
    }
}

#[test]
fn the_page_knows_every_exit_code() {
    let (folder, page) = (Folder::new(), page());
    let help = folder.straal("help").out;
    let (_, table) = help.split_once("Exit codes:").unwrap();
    let codes: Vec<_> = table.lines().filter_map(|l| l.trim().split_once(' ')).collect();
    assert!(codes.len() >= 6, "{help}");
    for (code, meaning) in codes {
        // The help is wrapped to the terminal's width.
        assert!(
            code.parse::<u8>().is_err() || page.contains(&format!("| {code} | {}", meaning.trim())),
            "{code}"
        );
    }
}

#[test]
fn the_page_knows_every_key_of_the_report() {
    let (folder, page) = (Folder::with_scene(BALL), page());
    let report = folder.json("render scene.yaml");
    for key in report.as_object().unwrap().keys() {
        assert!(page.contains(&format!("`{key}`")), "{key}");
    }
}
