//! A film as two pictures of other samples: what differs between them is chance, so that they tell how much of it there is in anything that
//! is made of them.

use super::{Film, FilmTile};

/// Two pictures that know nothing of each other, by rows from the top left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Halves {
    /// The mean of the one part of each pixel's samples, and that of the other.
    pub rgb: [Vec<[f32; 3]>; 2],
    /// The share of the first part in the mean of both.
    pub share: Vec<f32>,
}

impl Film {
    /// The film's picture as the mean of two, where it holds what that takes: halves of blocks that end by themselves, or batches. `None` for pixels of one sample,
    /// or where light came that is no pixel's own.
    pub fn halves(&self) -> Option<Halves> {
        let (width, pixels) = (self.crop.width() as usize, self.crop.area());
        let mut out =
            Halves { rgb: [vec![[0.0; 3]; pixels], vec![[0.0; 3]; pixels]], share: vec![0.5; pixels] };
        for tile in &self.tiles {
            if tile.splats.is_some() || !tile.light_splats.is_empty() {
                return None;
            }
            let across = tile.region.width() as usize;
            for k in 0..tile.pixels.len() {
                let at = [(k % across) as u32 + tile.region.min[0], (k / across) as u32 + tile.region.min[1]];
                if !self.crop.contains(at) {
                    continue;
                }
                let [x, y] = [0, 1].map(|axis| (at[axis] - self.crop.min[axis]) as usize);
                let i = y * width + x;
                let (parts, share) = tile.two_parts(k)?;
                for (rgb, part) in out.rgb.iter_mut().zip(parts) {
                    rgb[i] = part;
                }
                out.share[i] = share;
            }
        }
        Some(out)
    }
}

impl FilmTile {
    /// The means of two parts of pixel `k`'s samples, and the share of the first.
    fn two_parts(&self, k: usize) -> Option<([[f32; 3]; 2], f32)> {
        if !self.halves.is_empty() {
            self.mean_of_halves(k, 0, false)?;
            let means =
                [0, 1].map(|half| std::array::from_fn(|c| self.mean_of_half(k, half, c, false).0 as f32));
            return Some((means, 0.5));
        }
        let p = &self.pixels[k];
        let whole = p.count.next_power_of_two() / 2;
        if whole == 0 {
            return None;
        }
        // The end of a batch that lies nearest to the middle.
        let [at_half, at_whole] = self.batch_sums.get(k)?.0;
        let (sums, count) =
            if p.count < whole + whole / 2 { (at_half, whole / 2) } else { (at_whole, whole) };
        let (first, second) = (f64::from(count), f64::from(p.count - count));
        // What the weights of a filter owe to chance is known for all samples together, and comes to both.
        let own: [f64; 3] = std::array::from_fn(|c| p.value[c].to_f64());
        let shift: [f64; 3] = std::array::from_fn(|c| self.mean(k, c) - own[c] / f64::from(p.count));
        let one = std::array::from_fn(|c| (sums[c] / first + shift[c]) as f32);
        let other = std::array::from_fn(|c| ((own[c] - sums[c]) / second + shift[c]) as f32);
        Some(([one, other], (first / f64::from(p.count)) as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ErrorEstimate, Sample};
    use super::*;
    use crate::film::Region;

    fn film(adapts: bool, samples: u32) -> Film {
        let mut film = Film::new([2, 1], Region::whole([2, 1]));
        if adapts {
            film.adapt(true);
        } else {
            film.hold_batches();
        }
        film.tell_error(ErrorEstimate::Batches);
        for (index, x) in (0..samples).flat_map(|index| [(index, 0), (index, 1)]) {
            let rgb = [(index * 7 % 5) as f32, index as f32, 1.0];
            film.tiles[0].add([x, 0], index, &Sample { rgb, ..Sample::default() }, &[]);
        }
        film
    }

    /// Any number of samples is cut near its middle, and the parts make the whole.
    #[test]
    fn parts_make_the_whole() {
        for (adapts, samples) in
            [(false, 2), (false, 3), (false, 4), (false, 5), (false, 6), (false, 7), (false, 16), (true, 32)]
        {
            let film = film(adapts, samples);
            let (halves, whole) = (film.halves().unwrap(), film.layers().rgb);
            let share = halves.share[1];
            assert!((1.0 / 3.0..=2.0 / 3.0).contains(&share), "{samples}: {share}");
            for c in 0..3 {
                let [a, b] = [0, 1].map(|part: usize| halves.rgb[part][1][c]);
                let mean = share * a + (1.0 - share) * b;
                assert!((mean - whole[1][c]).abs() < 1e-5 * whole[1][c], "{samples} {c}: {mean}");
            }
            // Samples come in order, so that the parts differ.
            assert!(halves.rgb[0][0][1] < halves.rgb[1][0][1]);
        }
    }

    #[test]
    fn one_sample_or_no_batches_have_no_halves() {
        assert_eq!(film(false, 1).halves(), None);
        assert_eq!(film(true, 8).halves(), None);
        assert_eq!(Film::new([2, 1], Region::whole([2, 1])).halves(), None);
    }
}
