//! Takes the weights of Open Image Denoise out of a Python wheel that carries its library: `pip download pyoidn==2.5.1.0`.
//!
//! The library holds each set as an archive of tensors (TZA), one after the other. What is taken is known by its hash, so that nothing
//! else can come in.

use crate::{Failure, root};
use std::path::{Path, PathBuf};

/// A set of weights of version 2.5.1: its name there, its bytes, and their BLAKE3 hash.
type Set = (&'static str, usize, &'static str);

/// All sets of the filter `RT`, in alphabetical order.
const SETS: [Set; 21] = [
    ("rt_alb", 1_830_792, "d4edfd773efc0ba740c7a9bd5a5c2bfc"),
    ("rt_alb_large", 7_684_615, "afc4d01f4018cd350e176858074b62f8"),
    ("rt_hdr", 1_830_792, "9d6b9c10ca03fbef49f89c266bfdcdef"),
    ("rt_hdr_alb", 1_835_976, "742b87c7b445ab9246061496a6eca1ba"),
    ("rt_hdr_alb_nrm", 1_841_160, "447f8bee2e6536ec8bfa713595f4117b"),
    ("rt_hdr_alb_nrm_small", 641_480, "9f6c68afbdacd2daecbcb8e270266a17"),
    ("rt_hdr_alb_small", 638_024, "e88940688ed643e1fa375a58faf280eb"),
    ("rt_hdr_calb_cnrm", 1_841_160, "32468f735a8acb8def7303fe4fc95535"),
    ("rt_hdr_calb_cnrm_large", 7_698_439, "a3df77b39ff11359cfa42bc1016a6524"),
    ("rt_hdr_calb_cnrm_small", 641_480, "59f02578efb767e8bcf4f80ca619a7d6"),
    ("rt_hdr_small", 634_568, "30a112240813456dc7caced90fe720ff"),
    ("rt_ldr", 1_830_792, "9219b423f01c4df31ceffeebe7f19470"),
    ("rt_ldr_alb", 1_835_976, "c92013580a418da8d4830bbdc7b0cc28"),
    ("rt_ldr_alb_nrm", 1_841_160, "49ac2d5de43ce8043f51dfc3c3300540"),
    ("rt_ldr_alb_nrm_small", 641_480, "e6cf8f417ea247726bee5690b08ca148"),
    ("rt_ldr_alb_small", 638_024, "36d5b2252ca0257c27adecd5c2eced91"),
    ("rt_ldr_calb_cnrm", 1_841_160, "60eebefcd93fd73a101cabeb6af6755b"),
    ("rt_ldr_calb_cnrm_small", 641_480, "31b44671c0668128a80f758ed03173a9"),
    ("rt_ldr_small", 634_568, "19dc041df902e11262f6cfa1df6153b8"),
    ("rt_nrm", 1_830_792, "21fcfe23b56f6e69544df3ee79f8b9eb"),
    ("rt_nrm_large", 7_684_615, "2718b4fe18915c3440c55d9916acc983"),
];

/// The library inside the wheel.
const LIBRARY: &str = "libOpenImageDenoise_core.so";

/// The sets that `straal_denoise` carries.
fn carried() -> [&'static str; 4] {
    straal_denoise::Weights::ALL.map(straal_denoise::Weights::name)
}

/// `weights WHEEL`: writes the sets that `crates/denoise` carries; `weights WHEEL FOLDER`: all sets, to that folder; `weights check`:
/// whether what is there is what it should be.
pub fn run(words: &[String]) -> Result<bool, Failure> {
    let data = root().join("crates/denoise/data");
    match words {
        [check] if check == "check" => Ok(check_files(&data)?),
        [wheel] => take(Path::new(wheel), &data, |name| carried().contains(&name)),
        [wheel, folder] => take(Path::new(wheel), Path::new(folder), |_| true),
        _ => Err("write `weights WHEEL`, `weights WHEEL FOLDER` or `weights check`".into()),
    }
}

fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex()[..32].to_owned()
}

fn check_files(data: &Path) -> Result<bool, Failure> {
    let mut fine = true;
    for (name, bytes, expected) in SETS.iter().filter(|(name, ..)| carried().contains(name)) {
        let file = std::fs::read(file_of(data, name))?;
        let is_right = file.len() == *bytes && hash(&file) == *expected;
        println!("{name}: {}", if is_right { "as published" } else { "NOT as published" });
        fine &= is_right;
    }
    Ok(fine)
}

fn file_of(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.tza"))
}

fn take(wheel: &Path, folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<bool, Failure> {
    let file = std::fs::read(wheel)?;
    let library = if file.starts_with(b"PK") { entry(&file, LIBRARY)? } else { file };
    std::fs::create_dir_all(folder)?;
    let mut missing: Vec<&str> = SETS.iter().map(|(name, ..)| *name).filter(|name| wanted(name)).collect();
    // The header of an archive: magic number, version 2.0.
    for at in memchr::memmem::find_iter(&library, b"\xd7\x41\x02\x00") {
        let found = SETS.iter().find(|(_, bytes, expected)| {
            library.get(at..at + bytes).is_some_and(|archive| hash(archive) == *expected)
        });
        let Some((name, bytes, _)) = found.filter(|(name, ..)| missing.contains(name)) else { continue };
        std::fs::write(file_of(folder, name), &library[at..at + bytes])?;
        println!("{name}: {bytes} bytes");
        missing.retain(|other| other != name);
    }
    if missing.is_empty() {
        return Ok(true);
    }
    Err(format!("{} hasn't the sets of version 2.5.1: {}", wheel.display(), missing.join(", ")).into())
}

/// The entry of a ZIP file whose name holds `part` (APPNOTE.TXT 6.3.10, without ZIP64).
fn entry(zip: &[u8], part: &str) -> Result<Vec<u8>, Failure> {
    let number = |at: usize, bytes: usize| -> Result<usize, Failure> {
        let bytes = zip.get(at..at + bytes).ok_or("the wheel is cut short")?;
        Ok(bytes.iter().rev().fold(0, |sum, b| sum << 8 | usize::from(*b)))
    };
    let end = memchr::memmem::rfind(zip, b"PK\x05\x06").ok_or("the wheel has no table of contents")?;
    let (count, mut at) = (number(end + 10, 2)?, number(end + 16, 4)?);
    for _ in 0..count {
        let [name, extra, comment] = [number(at + 28, 2)?, number(at + 30, 2)?, number(at + 32, 2)?];
        let path = zip.get(at + 46..at + 46 + name).ok_or("the wheel is cut short")?;
        if String::from_utf8_lossy(path).contains(part) {
            let (method, packed, local) = (number(at + 10, 2)?, number(at + 20, 4)?, number(at + 42, 4)?);
            let start = local + 30 + number(local + 26, 2)? + number(local + 28, 2)?;
            let packed = zip.get(start..start + packed).ok_or("the wheel is cut short")?;
            return match method {
                0 => Ok(packed.to_vec()),
                8 => Ok(miniz_oxide::inflate::decompress_to_vec(packed)
                    .map_err(|e| format!("the wheel is damaged: {e}"))?),
                other => Err(format!("the wheel is packed by method {other}").into()),
            };
        }
        at += 46 + name + extra + comment;
    }
    Err(format!("the wheel has no file {part}").into())
}
