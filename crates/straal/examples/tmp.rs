#![allow(clippy::all, clippy::disallowed_methods, missing_docs)]
use straal::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let loaded = load(a[1].as_ref(), &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let t0 = std::time::Instant::now();
    let spp = a[3].parse().unwrap();
    let job = Job::new(
        loaded,
        Overrides {
            spp: Some(spp),
            pattern: std::env::var("SOBOL").ok().map(|_| straal_math::lowdisc::Pattern::Sobol),
            threads: a.get(4).map(|t| t.parse().unwrap()),
            ..Default::default()
        },
    )
    .unwrap();
    println!("compile {:?}", t0.elapsed());
    let t = std::time::Instant::now();
    let mut f = |_: &Progress| job::Verdict::GoOn;
    let mut c = Control::new(&mut f);
    c.clock = Some(std::sync::Arc::new(move || t.elapsed().as_nanos() as u64));
    let o = job.render(&mut c).unwrap();
    let s = t.elapsed().as_secs_f64();
    let px = (o.picture.layers.width * o.picture.layers.height) as f64;
    println!(
        "{s:.2}s {:.2} Msamples/s {:.2} Mrays/s times {:?} dropped {:?} hash {:?}",
        px * spp as f64 / s / 1e6,
        (o.times.rays + o.times.shadow_rays) as f64 / s / 1e6,
        o.times.nanoseconds.map(|n| n as f64 / 1e9),
        o.dropped,
        o.picture.tells("film_hash")
    );
    o.picture.save(a[2].as_ref(), &job.look()).unwrap();
}
