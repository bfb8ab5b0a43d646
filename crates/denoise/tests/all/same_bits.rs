//! The same bits by every instruction set, for any number of threads and of rows at a time, and wherever a pixel lies that sees the same.

use crate::Sample;
use std::borrow::Cow;
use std::ops::Range;
use straal_denoise::{DenoiseError, GuideRows, Settings, Weights, denoise, denoise_in_place};
use straal_math::simd::{Isa, Simd};

#[test]
fn instruction_sets_threads_and_bands_give_the_same_bits() {
    let sample = Sample::new(37, 50);
    let network = Weights::GuidedFast.network().unwrap();
    let run = |isa: Isa, threads: usize, band: usize| {
        let simd = Simd::new(isa)?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = Settings { simd, band, exposure: None };
        Some(pool.install(|| denoise(&network, &sample.picture(true), &settings)).unwrap())
    };
    let best = Simd::best().isa();
    let expected = run(best, 1, 16).unwrap();
    for (threads, band) in [(1, 1), (3, 16), (2, 48), (4, usize::MAX / 2)] {
        assert_eq!(run(best, threads, band).unwrap(), expected, "{threads} threads, bands of {band}");
    }
    for isa in Isa::ALL {
        // What a processor hasn't is told by another.
        let Some(other) = run(isa, 2, 16) else { continue };
        assert_eq!(other, expected, "{isa}");
    }
}

/// A pixel sees 96 pixels at most to any side, so that a picture can be cut into tiles that overlap by as much.
#[test]
fn a_tile_with_overlap_gives_the_pixels_of_the_whole() {
    let whole = Sample::new(16, 256);
    let network = Weights::Light.network().unwrap();
    let settings = Settings { exposure: Some(1.0), ..Settings::default() };
    let clean = denoise(&network, &whole.picture(false), &settings).unwrap();
    let tile = Sample { color: whole.color[16 * 64..].to_vec(), ..Sample::new(16, 192) };
    let part = denoise(&network, &tile.picture(false), &settings).unwrap();
    assert_eq!(clean[16 * (64 + 96)..], part[16 * 96..]);
    assert_ne!(clean[16 * 64..16 * 65], part[..16]);
}

/// Guides that come by rows, from the top, each once; and light that becomes clean where it stands.
#[test]
fn guides_by_rows_give_the_same_bits() {
    let sample = Sample::new(37, 250);
    let network = Weights::GuidedFast.network().unwrap();
    let settings = Settings { band: 16, ..Settings::default() };
    let expected = denoise(&network, &sample.picture(true), &settings).unwrap();
    let mut light = sample.color.clone();
    let mut asked = 0;
    let picture = sample.picture(true);
    let guides = |rows: Range<usize>| -> Result<GuideRows<'_>, DenoiseError> {
        assert_eq!(rows.start, asked);
        asked = rows.end;
        let pixels = 37 * rows.start..37 * rows.end;
        let of = |layer: Option<&'_ [[f32; 3]]>| Some(layer.unwrap()[pixels.clone()].to_vec().into());
        Ok(GuideRows { albedo: of(picture.albedo), normal: of(picture.normal) })
    };
    denoise_in_place(&network, 37, &mut light, &settings, guides, |_| true).unwrap();
    assert!(light == expected);
    assert_eq!(asked, 250);
    // Guides of other rows, or none, are told.
    let few = |_| -> Result<GuideRows<'_>, DenoiseError> {
        Ok(GuideRows { albedo: Some(Cow::Borrowed(&[])), normal: Some(Cow::Borrowed(&[])) })
    };
    let told = denoise_in_place(&network, 37, &mut light, &settings, few, |_| true).unwrap_err();
    assert!(matches!(told, DenoiseError::Rows { layer: "albedo", pixels: 0, .. }), "{told}");
    let none = |_| -> Result<GuideRows<'_>, DenoiseError> { Ok(GuideRows::default()) };
    let told = denoise_in_place(&network, 37, &mut light, &settings, none, |_| true).unwrap_err();
    assert!(matches!(told, DenoiseError::Layers { .. }), "{told}");
}
