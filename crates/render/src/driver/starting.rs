//! Samples that set out: where they lie on the film and on the lens, and the rays that the camera sends there, a block of them
//! side by side.

use super::stream::Name;
use crate::camera::{Camera, CameraRays, FilmPoint, FilmPoints};
use crate::film::named_by;
use crate::filter::{Filter, FilterSample};
use crate::surface::{BLOCK, Column};
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::simd::{Float, Kernel, Mask, Uint};
use straal_math::{Ray, Vec3};

/// What a block of samples starts from.
#[derive(Default)]
pub(super) struct Starting {
    /// What names their random numbers.
    names: Names,
    /// Displacements from their pixels' centres.
    offset: [Column; 2],
    /// What the filter multiplies their light by.
    weight: Column,
    position: [Column; 2],
    lens: [Column; 2],
    time: Column,
    /// Numbers that draw their wavelengths.
    wavelength: Column,
    /// Of the camera rays, origin and least t, direction and largest t.
    rays: [[[f32; 4]; 2]; BLOCK],
    /// A bit for each whose camera ray is there.
    seen: u32,
}

struct Names([SampleName; BLOCK]);

impl Default for Names {
    fn default() -> Self {
        Self([SampleName::new(0, [0; 2], 0); BLOCK])
    }
}

impl Starting {
    /// What names the random numbers of sample `i`.
    #[inline(always)]
    pub fn name(&self, i: usize) -> SampleName {
        self.names.0[i]
    }

    /// Where sample `i` lies from its pixel's centre.
    pub fn offset(&self, i: usize) -> [f32; 2] {
        [self.offset[0].at(i), self.offset[1].at(i)]
    }

    /// What the filter multiplies the light of sample `i` by.
    pub fn weight(&self, i: usize) -> f32 {
        self.weight.at(i)
    }

    /// The number that draws the wavelengths of sample `i`, where that was asked for.
    pub fn wavelength(&self, i: usize) -> f32 {
        self.wavelength.at(i)
    }

    /// What the camera ray of sample `i` of a pixel is made from.
    pub fn film_point(&self, i: usize, pixel: [u32; 2]) -> FilmPoint {
        let two = |columns: &[Column; 2]| [columns[0].at(i), columns[1].at(i)];
        FilmPoint { pixel, position: two(&self.position), lens: two(&self.lens), time: self.time.at(i) }
    }

    /// The camera ray of sample `i`; `None` where nothing is seen, and where none was asked for.
    #[inline(always)]
    pub fn ray(&self, i: usize) -> Option<Ray> {
        let [[ox, oy, oz, t_min], [dx, dy, dz, t_max]] = self.rays[i];
        let (o, d) = (Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz));
        let ray = Ray { o, t_min, d, t_max, time: self.time.at(i), mask: u32::MAX };
        (self.seen >> i & 1 == 1).then_some(ray)
    }
}

/// Draws numbers and makes rays.
pub(super) struct Start<'a> {
    /// At most [`BLOCK`] of them.
    pub names: &'a [Name],
    pub pattern: Pattern,
    pub seed: u64,
    /// Whether the halves of each pixel's samples are independent.
    pub halves: bool,
    pub filter: &'a Filter,
    pub wanted: Wanted,
    pub camera: &'a Camera,
    pub out: &'a mut Starting,
}

/// What samples need; as numbers are pure functions of their names, those that aren't drawn change none.
#[derive(Clone, Copy)]
pub(super) struct Wanted {
    pub lens: bool,
    pub time: bool,
    pub wavelength: bool,
    pub rays: bool,
}

impl Kernel for Start<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { names, pattern, seed, halves, filter, wanted, camera, out } = self;
        out.seen = 0;
        let last = names.len().saturating_sub(1);
        for first in (0..names.len().min(BLOCK)).step_by(F::WIDTH) {
            // Lanes without a sample do what the last one does.
            let [mut x, mut y, mut named_x, mut index] = [F::Uint::splat(0).to_array(); 4];
            for i in 0..F::WIDTH {
                let (pixel, sample) = names[if first + i < last { first + i } else { last }];
                let (named, number) = if halves { named_by(pixel, sample) } else { (pixel, sample) };
                (x.as_mut()[i], y.as_mut()[i]) = pixel.into();
                (named_x.as_mut()[i], index.as_mut()[i]) = (named[0], number);
            }
            let pixel = [F::Uint::from_array(x), F::Uint::from_array(y)];
            let named = [F::Uint::from_array(named_x), pixel[1]];
            let name = pattern.names::<F>(seed, named, F::Uint::from_array(index));
            name.for_each(
                #[inline(always)]
                |i, name| {
                    if let Some(slot) = out.names.0.get_mut(first + i) {
                        *slot = name;
                    }
                },
            );

            // The first two of four numbers are the same as two by themselves, which are cheaper.
            let (film, lens) = if wanted.lens {
                let [x, y, u, v] = pattern.d4(&name, Purpose::Film);
                ([x, y], [u, v])
            } else {
                (pattern.d2(&name, Purpose::Film), [F::splat(0.5); 2])
            };
            let time = if wanted.time { pattern.d1(&name, Purpose::Time) } else { F::ZERO };
            if wanted.wavelength {
                out.wavelength.store(first, pattern.d1(&name, Purpose::Wavelength));
            }
            let FilterSample { offset, weight } = filter.sample(film);
            let position =
                [F::from_uint(pixel[0]) + 0.5 + offset[0], F::from_uint(pixel[1]) + 0.5 + offset[1]];
            out.weight.store(first, weight);
            out.time.store(first, time);
            for k in 0..2 {
                out.offset[k].store(first, offset[k]);
                out.position[k].store(first, position[k]);
                out.lens[k].store(first, lens[k]);
            }
            if wanted.rays {
                let CameraRays { o, d, seen } = camera.rays(&FilmPoints { pixel, position, lens, time });
                F::to_rows(
                    [o.x, o.y, o.z, F::ZERO],
                    #[inline(always)]
                    |i, row| out.rays[first + i][0] = row,
                );
                F::to_rows(
                    [d.x, d.y, d.z, F::splat(f32::INFINITY)],
                    #[inline(always)]
                    |i, row| out.rays[first + i][1] = row,
                );
                out.seen |= seen.to_bits() << first;
            }
        }
    }
}
