//! Films are written, taken up again, and put together.

use super::super::{BandSample, CostSample, Flying, Keep, Sample};
use super::*;
use crate::filter::{Filter, Profile, Separable};
use straal_math::simd::Simd;

const SIZE: [u32; 2] = [37, 20];

/// A number from 0 to 1 that belongs to a sample.
fn number([x, y]: [u32; 2], index: u32) -> f32 {
    let mut z = u64::from(x) << 40 | u64::from(y) << 20 | u64::from(index);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z >> 40) as f32 / (1_u64 << 24) as f32
}

fn filter() -> Filter {
    Filter::Separable(Separable::new(Profile::Tent, 2.0).expect("a filter"))
}

/// A film with everything, or with splats in place of batches, and samples from `first` on.
fn film(crop: Region, samples: [u32; 2], splat: bool) -> Film {
    let region = if splat { crop.grown(2).intersection(Region::whole(SIZE)) } else { crop };
    let mut film = Film::over(SIZE, [crop, region], Keep::ALL);
    let groups = ["rest", "key"].map(str::to_owned);
    film.hold_bands(Some(Bands::new(400.0, 700.0, 3).expect("bands")), &groups);
    film.count_costs(true);
    if splat {
        film.splat(&filter(), Simd::best());
    } else {
        film.hold_batches();
    }
    film.tell_error(if splat { ErrorEstimate::Spread } else { ErrorEstimate::Batches });
    film.begin_at(samples[0]);
    for tile in &mut film.tiles {
        let Region { min, max } = tile.region;
        for pixel in (min[1]..max[1]).flat_map(|y| (min[0]..max[0]).map(move |x| [x, y])) {
            for i in samples[0]..samples[1] {
                let v = number(pixel, i);
                let rgb = if i == 13 && pixel[0] % 7 == 3 { [f32::NAN; 3] } else { [v, v * v, 7.0 * v] };
                let seen = std::array::from_fn(|k| [v, 0.5 - v, k as f32 * v]);
                let sample = Sample { rgb, negative: v < 0.1, seen: Some(&seen) };
                // A band of wavelengths, and the second group's green.
                let bands = [(i % 3) as u16, 7].map(|band| BandSample { band, value: v });
                let taken = tile.add(pixel, i, &sample, &bands);
                tile.add_cost(pixel, &CostSample { nodes: i.into(), primitives: 2, nanoseconds: 3 });
                if let Some(splats) = tile.splats() {
                    let sample = taken.then_some(&sample);
                    splats.add(&filter(), &Flying { pixel, offset: [v - 0.5, 0.25], sample, bands: &bands });
                }
            }
        }
    }
    film
}

fn bytes(film: &Film) -> Vec<u8> {
    let mut bytes = Vec::new();
    film.write_sums(&mut bytes).expect("memory takes all");
    assert_eq!(bytes.len(), film.region().area() * film.held().bytes_a_pixel(film.first_sample()));
    bytes
}

fn same(a: &Film, b: &Film) {
    assert_eq!(a.layers(), b.layers());
    assert_eq!(a.dropped(), b.dropped());
}

fn joined(whole: &Film, parts: &[(Region, [u32; 2], u32)], splat: bool) -> Film {
    let mut joined = Joined::new(SIZE, [whole.crop, whole.region()], &whole.held(), whole.error);
    for &(crop, samples, group) in parts {
        let film = film(crop, samples, splat);
        let span = Span { crop, region: film.region(), first: samples[0], end: samples[1] };
        let sums = bytes(&film);
        joined.add(&span, group, &mut sums.as_slice(), film.dropped().first).expect("whole");
    }
    joined.into_film()
}

#[test]
fn what_is_taken_up_is_what_was_written() {
    let crop = Region { min: [3, 2], max: [30, 19] };
    for splat in [false, true] {
        let whole = film(crop, [0, 23], splat);
        let mut empty = film(crop, [0, 0], splat);
        empty.read_sums(&mut bytes(&whole).as_slice(), whole.dropped().first).expect("whole");
        same(&empty, &whole);
        assert_eq!(bytes(&empty), bytes(&whole));
    }
}

#[test]
fn runs_of_samples_make_the_whole() {
    let crop = Region::whole(SIZE);
    for splat in [false, true] {
        for ends in [[8, 16], [5, 6], [1, 2], [7, 22], [16, 17]] {
            let whole = film(crop, [0, 23], splat);
            let [a, b] = ends;
            let parts = [(crop, [0, a], 1), (crop, [a, b], 1), (crop, [b, 23], 1)];
            same(&joined(&whole, &parts, splat), &whole);
        }
    }
}

#[test]
fn crops_make_the_whole() {
    let region = |min, max| Region { min, max };
    for splat in [false, true] {
        let whole = film(Region::whole(SIZE), [0, 9], splat);
        let parts = [
            (region([0, 0], [18, 20]), [0, 9], 1),
            (region([18, 0], [37, 7]), [0, 9], 2),
            (region([18, 7], [37, 20]), [0, 4], 3),
            (region([18, 7], [37, 20]), [4, 9], 3),
        ];
        same(&joined(&whole, &parts, splat), &whole);
    }
}

#[test]
fn too_few_bytes_are_an_error() {
    let whole = film(Region::whole(SIZE), [0, 2], false);
    let sums = bytes(&whole);
    let mut empty = film(Region::whole(SIZE), [0, 0], false);
    assert!(empty.read_sums(&mut &sums[..sums.len() - 1], None).is_err());
}
