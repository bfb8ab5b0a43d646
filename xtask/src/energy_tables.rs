//! The tables of what rough surfaces lose.

use crate::{Failure, root};
use std::path::Path;
use straal_render::material::open_pbr::energy;

/// Where the tables are kept: numbers of 16 bits, little-endian.
const FILE: &str = "crates/render/data/energy.bin";

/// Where they come from, in their order there.
const HEADERS: [&str; 7] = [
    "ideal_dielectric_energy_complement",
    "opaque_dielectric_energy_complement",
    "ideal_dielectric_avg_energy_complement",
    "opaque_dielectric_avg_energy_complement",
    "ideal_metal_energy_complement",
    "ideal_metal_avg_energy_complement",
    "ideal_dielectric_reflection_ratio",
];

/// What integrals may be off by: both sides' rounding and noise. Of what glass loses next to index 1, and along the surface, more.
const OFF: f32 = 4e-3;
/// The part of the nodes that may be off by more.
const SOME: f64 = 2e-3;

/// With `check`, holds the tables against the integrals; with a copy of github adobe/openpbr-bsdf, takes them from there.
pub fn run(words: &[String]) -> Result<bool, Failure> {
    match words {
        [word] if word == "check" => Ok(check()),
        [folder] => {
            std::fs::write(root().join(FILE), read(Path::new(folder))?)?;
            println!("{FILE}");
            Ok(true)
        }
        _ => Err("energy-tables takes `check`, or the folder of a copy of github adobe/openpbr-bsdf".into()),
    }
}

fn read(folder: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    for header in HEADERS {
        let path = folder.join(format!("impl/data/openpbr_{header}_data.h"));
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        for line in text.lines().filter(|l| !l.trim_start().starts_with("//")) {
            for number in line.split(',').map(str::trim).filter(|w| !w.is_empty()) {
                bytes.extend(number.parse::<u16>()?.to_le_bytes());
            }
        }
    }
    Ok(bytes)
}

fn check() -> bool {
    let mut is_fine = true;
    for table in energy::checked() {
        let off: Vec<f32> = table.kept.iter().zip(&table.found).map(|(a, b)| (a - b).abs()).collect();
        let worst = off.iter().copied().fold(0.0, |a: f32, b| if b > a { b } else { a });
        let mean = off.iter().map(|v| f64::from(*v)).sum::<f64>() / off.len() as f64;
        let many = off.iter().filter(|v| **v > OFF).count();
        println!(
            "{:38} off by {mean:.1e} in the mean, {worst:.1e} at most; {many} of {} by more than {OFF}",
            table.name,
            off.len()
        );
        is_fine &= mean < 1e-3 && many as f64 <= SOME * off.len() as f64;
    }
    is_fine
}
