//! The light of groups of lights in a denoised picture.
//!
//! Each group is denoised by the same network with the same guides. What it makes of the parts doesn't add up to what it makes of the whole, which has less noise and the
//! benefit of all that a render knows besides. So the parts are taken as shares: group by group they are scaled by the same factor, pixel by pixel, to add up to the clean picture.
//! (The group's noisy light times clean over noisy light of the whole would keep the noise of which lamp a sample asked.)

use super::{Guides, NoDenoise, Noisy, Ready};
use straal_render::film::{CLAMPED, GroupLayer};

/// Denoises groups so that they add up to `clean`. What was taken away from the light is no part of it, and stays.
pub(crate) fn denoise(
    groups: &mut [GroupLayer],
    ready: &Ready,
    guides: &Guides,
    width: usize,
    clean: &[[f32; 3]],
) -> Result<(), NoDenoise> {
    let mut parts: Vec<&mut Vec<[f32; 3]>> =
        groups.iter_mut().filter(|group| group.name != CLAMPED).map(|group| &mut group.rgb).collect();
    for part in &mut parts {
        **part = ready.run(&Noisy { width, rgb: part, guides })?;
    }
    share(&mut parts, clean);
    Ok(())
}

/// Scales parts to add up to a whole; where there is nothing of any, they share it evenly.
fn share(parts: &mut [&mut Vec<[f32; 3]>], whole: &[[f32; 3]]) {
    let even = 1.0 / parts.len().max(1) as f32;
    for (k, whole) in whole.iter().enumerate() {
        for c in 0..3 {
            let sum = parts.iter().fold(0.0, |sum, part| sum + part[k][c]);
            for part in parts.iter_mut() {
                let share = if sum > 0.0 && sum.is_finite() { part[k][c] / sum } else { even };
                part[k][c] = share * whole[c];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_add_up() {
        let mut a = vec![[1.0, 0.0, 2.0], [0.0; 3]];
        let mut b = vec![[3.0, 0.0, 0.0], [0.0; 3]];
        share(&mut [&mut a, &mut b], &[[2.0, 1.0, 4.0], [6.0, 0.0, 0.0]]);
        assert_eq!(a, [[0.5, 0.5, 4.0], [3.0, 0.0, 0.0]]);
        assert_eq!(b, [[1.5, 0.5, 0.0], [3.0, 0.0, 0.0]]);
        share(&mut [], &[[1.0; 3]]);
    }
}
