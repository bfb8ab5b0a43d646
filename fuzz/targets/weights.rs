//! Weights of a denoising network: any bytes are read or refused; those that are read denoise a picture.
#![no_main]

use libfuzzer_sys::fuzz_target;
use straal_denoise::{Network, Picture, Settings, Signal, denoise};

fuzz_target!(|bytes: &[u8]| {
    for signal in [Signal::Light, Signal::Albedo, Signal::Normal] {
        let Ok(network) = Network::from_archive(bytes, signal) else { continue };
        let pixels = [[0.5, f32::NAN, -1.0]; 3];
        let guide = |wanted: usize| (network.inputs() >= wanted).then_some(&pixels[..]);
        let picture = Picture { width: 3, height: 1, color: &pixels, albedo: guide(2), normal: guide(3) };
        let clean = denoise(&network, &picture, &Settings::default()).expect("a picture that fits");
        assert!(clean.iter().flatten().all(|v| v.is_finite()));
    }
});
