//! The same as Open Image Denoise itself makes of a picture, and what it makes of bad input.

use crate::Sample;
use straal_denoise::{DenoiseError, Network, Picture, Settings, Signal, Weights, WeightsError, denoise};

/// What version 2.5.1 gave on a processor with AVX-512 for [`Sample`] with one firefly, in the order of [`Weights::ALL`]: every fourth row from the second on,
/// of it every fourth pixel from the third on.
const REFERENCE: &[u8] = include_bytes!("../../data/reference.f32");

#[test]
fn output_is_that_of_the_original() {
    let mut sample = Sample::new(64, 48);
    sample.color[20 * 64 + 30] = [500.0; 3];
    let mut reference = REFERENCE.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b));
    for weights in Weights::ALL {
        let network = weights.network().unwrap();
        let clean = denoise(&network, &sample.picture(network.inputs() == 3), &Settings::default()).unwrap();
        let mut worst = 0.0;
        for (y, x) in (1..48).step_by(4).flat_map(|y| (2..64).step_by(4).map(move |x| (y, x))) {
            for own in clean[y * 64 + x] {
                let other = reference.next().unwrap();
                let off = (own - other).abs() / other;
                worst = if off > worst { off } else { worst };
            }
        }
        // Sums in another order, and other powers and logarithms.
        assert!(worst < 1e-4, "{}: {worst}", weights.name());
    }
    assert_eq!(reference.next(), None);
}

#[test]
fn what_is_no_picture_is_refused_or_black() {
    let guided = Weights::GuidedFast.network().unwrap();
    let settings = Settings::default();
    let sample = Sample::new(5, 3);
    let light = sample.picture(false);
    let error = denoise(&guided, &light, &settings).unwrap_err();
    let told = "these weights want colour, albedo and normals, but the picture has colour alone";
    assert_eq!(error.to_string(), told);
    let short = Picture { albedo: Some(&sample.albedo[1..]), ..sample.picture(true) };
    let error = denoise(&guided, &short, &settings).unwrap_err();
    assert_eq!(error.to_string(), "the layer of albedo has 14 pixels: 5 x 3 were expected");
    let huge = Picture { width: usize::MAX, ..sample.picture(true) };
    assert!(matches!(denoise(&guided, &huge, &settings), Err(DenoiseError::Size { .. })));
    let nothing = Picture { width: 0, height: 3, color: &[], albedo: Some(&[]), normal: Some(&[]) };
    assert_eq!(denoise(&guided, &nothing, &settings), Ok(vec![]));
    for exposure in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let settings = Settings { exposure: Some(exposure), ..settings };
        assert_eq!(denoise(&guided, &sample.picture(true), &settings), Err(DenoiseError::Exposure));
    }
    let ended = straal_denoise::denoise_with(&guided, &sample.picture(true), &settings, |rows| rows > 16);
    assert_eq!(ended, Err(DenoiseError::Ended));
    // Numbers that no light has, in a picture of one pixel.
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1.0, 0.0] {
        let pixel = [[bad; 3]];
        let one = Picture { width: 1, height: 1, color: &pixel, albedo: Some(&pixel), normal: Some(&pixel) };
        let clean = denoise(&guided, &one, &settings).unwrap();
        assert!(clean[0].iter().all(|v| v.is_finite() && *v >= 0.0), "{bad}: {clean:?}");
    }
}

#[test]
fn weights_of_something_else_are_refused() {
    let archive = Weights::GuidedFast.archive();
    assert_eq!(Network::from_archive(b"", Signal::Light).unwrap_err(), WeightsError::NoArchive);
    assert_eq!(Network::from_archive(archive, Signal::Normal).unwrap_err(), WeightsError::Inputs(9));
    for length in [2, 3, 11, 1000, archive.len() - 1] {
        assert!(Network::from_archive(&archive[..length], Signal::Light).is_err(), "{length}");
    }
    // A layer's name that no network has.
    let mut other = archive.to_vec();
    let at = other.windows(9).rposition(|w| w == b"enc_conv3").unwrap();
    other[at] = b'x';
    let error = Network::from_archive(&other, Signal::Light).unwrap_err();
    assert_eq!(error.to_string(), "the tensor 'enc_conv3.bias' is missing");
}
