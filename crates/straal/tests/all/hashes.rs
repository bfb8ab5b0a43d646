//! The same scene gives the same bits on every machine: film hashes that are committed. `.ci/arm` runs this test on
//! another processor.

use crate::common;

use straal::Overrides;

#[test]
fn committed_hashes_hold() {
    let table = include_str!("../hashes.txt");
    let lines = table.lines().filter(|l| !l.starts_with('#') && !l.trim().is_empty());
    let mut wrong = Vec::new();
    let mut count = 0;
    for line in lines {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [scene, size, spp, want] = words[..] else { panic!("not scene, size, samples, hash: {line}") };
        let (w, h) = size.split_once('x').expect("a size like 64x36");
        let size = [w.parse().expect("a width"), h.parse().expect("a height")];
        let spp = spp.parse().expect("samples");
        let wish = Overrides { size: Some(size), spp: Some(spp), ..Overrides::default() };
        let outcome = common::render(scene, wish);
        let hash = outcome.picture.tells("film_hash").expect("every picture tells its hash").to_owned();
        count += 1;
        if hash != want {
            wrong.push(format!("{scene} {}x{} {spp} {hash}", size[0], size[1]));
        }
    }
    assert!(count >= 4, "there are only {count} hashes");
    assert!(
        wrong.is_empty(),
        "these hashes differ (if that is meant, say why in CHANGELOG.md):\n{}",
        wrong.join("\n")
    );
}
