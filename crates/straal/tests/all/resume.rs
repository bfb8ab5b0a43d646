//! A render that is cut off anywhere, in the middle of a pass as well, goes on to the same bits.

use crate::common;

use std::sync::Arc;
use straal::sums::{self, Allowed, Kept, SumsError};
use straal::{Control, Job, Outcome, Overrides, Snapshot};

fn job(wish: &Overrides) -> Job {
    common::job("scenes/cornell-box.yaml", wish.clone())
}

/// Renders, and keeps the sums of every pause, a tile or two apart.
fn kept(job: &Job) -> (Outcome, Vec<(bool, Vec<u8>)>) {
    let mut all = Vec::new();
    let mut keep = |snapshot: &Snapshot<'_>| {
        let mut bytes = Vec::new();
        snapshot.write(&mut bytes).expect("memory takes all");
        all.push((snapshot.is_midway, bytes));
    };
    let mut control = Control::to_the_end();
    control.keep = Some(&mut keep);
    control.pause = Some(Arc::new(|| true));
    (job.render(&mut control).expect("a picture"), all)
}

#[test]
fn anywhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("x.sums");
    let plain = Overrides { size: Some([40, 40]), spp: Some(6), threads: Some(2), ..Overrides::default() };
    for wish in [
        plain.clone(),
        Overrides { noise: Some(0.2), spp: Some(70), ..plain.clone() },
        Overrides { splat: Some(true), crop: Some([3, 5, 38, 31]), ..plain.clone() },
        Overrides { samples: Some([3, 6]), spectral: Some(true), ..plain },
    ] {
        let job = job(&wish);
        let whole = job.render(&mut Control::to_the_end()).expect("a picture").picture;
        let (outcome, all) = kept(&job);
        assert_eq!(outcome.picture, whole, "{wish:?}: pauses change nothing");
        assert!(all.iter().filter(|(is_midway, _)| *is_midway).count() > 4, "{wish:?}");
        for (_, bytes) in all.iter().step_by(1 + all.len() / 7) {
            std::fs::write(&path, bytes).expect("a file");
            let mut control = Control::to_the_end();
            control.resume = Some(Kept::open(&path).expect("sums"));
            let rest = job.render(&mut control).expect("a picture");
            assert_eq!(rest.picture, whole, "{wish:?}");
        }
    }
}

#[test]
fn the_middle_of_a_pass_is_no_part() {
    let folder = tempfile::tempdir().expect("a folder");
    let paths = [0, 1].map(|i| folder.path().join(format!("{i}.sums")));
    let wish = Overrides { size: Some([40, 40]), spp: Some(5), threads: Some(1), ..Overrides::default() };
    let (_, all) = kept(&job(&wish));
    let midway = all.iter().find(|(is_midway, _)| *is_midway).expect("a pause");
    std::fs::write(&paths[0], &midway.1).expect("a file");
    std::fs::write(&paths[1], &all.last().expect("an end").1).expect("a file");
    let open = |n: usize| paths[..n].iter().map(|p| Kept::open(p).expect("sums")).collect();
    let refused = sums::merge(open(2), Allowed::default());
    assert!(
        matches!(&refused, Err(SumsError::Parts(why)) if why.contains("middle of a pass")),
        "{refused:?}"
    );
    assert!(matches!(sums::merge(open(1), Allowed::default()), Err(SumsError::Gaps(_))));
    let gaps = Allowed { gaps: true, ..Allowed::default() };
    assert!(sums::merge(open(1), gaps).is_ok());
    let short = sums::merge(open(1), Allowed { memory: Some(1000), ..gaps });
    assert!(matches!(short, Err(SumsError::Memory(_))));
}
