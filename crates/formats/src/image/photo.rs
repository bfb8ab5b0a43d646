//! A picture of any format as every use of it takes it: surroundings, developing, comparing, telling.

use std::io::{Read, Seek};

use straal_color::{Adaptation, RgbSpace, Space};
use straal_scene::Image;

use super::exr::{self, Beauty, Window};
use super::{Format, bmp, hdr, jpeg, ktx2, pfm, png, tga, webp};
use crate::{Limits, ReadError};

/// The colours of a picture, with what its file says of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    /// What kind of file it was.
    pub format: Format,
    /// Width and height of the whole picture, which is what is shown.
    pub size: [usize; 2],
    /// The part that has pixels, from the top left of the whole: it may be smaller, or reach beyond.
    pub part: Window,
    /// Linear light of that part, row by row from the top.
    pub pixels: Vec<[f32; 3]>,
    /// What the three numbers are, where the file says it.
    pub space: Option<RgbSpace>,
    /// The layer of an EXR that they come from.
    pub layer: String,
    /// How a picture of codes encodes light.
    pub encoding: Option<png::Encoding>,
    /// Texts of the file by their keys.
    pub metadata: Vec<(String, String)>,
    /// What a person should know of how it was read, each a sentence without a full stop: what was guessed, and what couldn't
    /// be honoured.
    pub notes: Vec<String>,
}

/// The key under which straal tells which part of the whole picture it rendered.
const CROP: &str = "straal.crop";

/// What a half-precision number can hold at most: light that is infinite was more than this.
const LARGEST_HALF: f32 = 65_504.0;

impl Photo {
    /// Reads a picture of any format.
    pub fn read(bytes: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        Self::read_layer(bytes, limits, None)
    }

    /// Reads a picture; of an EXR the layer of that name.
    pub fn read_layer(bytes: &[u8], limits: &Limits, layer: Option<&str>) -> Result<Self, ReadError> {
        limits.check_bytes(bytes)?;
        let format = Format::of(bytes)?;
        if let Some(layer) = layer.filter(|_| format != Format::Exr) {
            return Err(ReadError::file(format!("it has no layers, so none called `{layer}`")));
        }
        match format {
            Format::Exr => {
                let (picture, beauty) = exr::read_colours(bytes, limits, layer)?;
                Ok(Self::of_beauty(&picture, beauty))
            }
            Format::Png => png::read_photo(bytes, limits),
            Format::Hdr => hdr::read_photo(bytes, limits),
            Format::Pfm => Ok(Self::of_image(Format::Pfm, pfm::read(bytes, limits)?)),
            Format::Jpeg => Ok(jpeg::read_codes(bytes, limits)?.into_photo()),
            Format::Webp => Ok(webp::read_codes(bytes, limits)?.into_photo()),
            Format::Tga => Ok(tga::read_codes(bytes, limits)?.into_photo()),
            Format::Bmp => Ok(bmp::read_codes(bytes, limits)?.into_photo()),
            Format::Ktx2 => ktx2::read_photo(bytes, limits),
        }
    }

    /// The colours of an EXR that was read, or those of a layer.
    pub fn of_exr(picture: &exr::Layered, layer: Option<&str>) -> Result<Self, ReadError> {
        let beauty = match layer {
            Some(layer) => picture.colours_of(layer),
            None => picture.beauty(),
        }?;
        Ok(Self::of_beauty(picture, beauty))
    }

    /// The colours of an EXR that is read by rows.
    pub fn of_strips<R: Read + Seek>(strips: &mut exr::Strips<R>) -> Result<Self, ReadError> {
        // As many rows as the chunks of most files have, or twice as many.
        const ROWS: usize = 32;
        let Window { width, height, .. } = strips.head().data_window;
        let mut beauty = strips.colours(0..ROWS)?;
        beauty.pixels.reserve_exact(width * height - beauty.pixels.len());
        for first in (ROWS..height).step_by(ROWS) {
            beauty.pixels.append(&mut strips.colours(first..first + ROWS)?.pixels);
        }
        Ok(Self::of_beauty(strips.head(), beauty))
    }

    fn of_beauty(picture: &exr::Layered, beauty: Beauty) -> Self {
        let (whole, part) = (picture.display_window, picture.data_window);
        // Windows that lie more than 2^31 pixels apart share none.
        let from = |at: i32, start: i32| at.saturating_sub(start);
        Self {
            format: Format::Exr,
            size: [whole.width, whole.height],
            part: Window { x: from(part.x, whole.x), y: from(part.y, whole.y), ..part },
            pixels: beauty.pixels,
            space: beauty.space,
            layer: beauty.layer,
            encoding: None,
            metadata: picture.metadata.clone(),
            notes: beauty.notes,
        }
    }

    /// A picture whose file says nothing of its colours.
    pub(super) fn of_image(format: Format, image: Image) -> Self {
        let Image { width, height, pixels } = image;
        Self {
            format,
            size: [width, height],
            part: Window::of_size(width, height),
            pixels,
            space: None,
            layer: String::new(),
            encoding: None,
            metadata: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Whether its pixels are all of the picture and nothing else.
    pub fn is_whole(&self) -> bool {
        self.part == Window::of_size(self.size[0], self.size[1])
    }

    /// Whether it is a crop that straal rendered: what is outside of it isn't black but unknown.
    pub fn is_crop(&self) -> bool {
        let Window { x, y, width, height } = self.part;
        let told = self.metadata.iter().find(|(key, _)| key == CROP);
        !self.is_whole()
            && told.is_some_and(|(_, crop)| {
                *crop == format!("{x},{y},{},{}", i64::from(x) + width as i64, i64::from(y) + height as i64)
            })
    }

    /// The space of its colours; sRGB where the file doesn't say.
    pub fn space_or_srgb(&self) -> RgbSpace {
        self.space.unwrap_or(Space::Srgb.rgb())
    }

    /// The whole picture: black where there are no pixels, without those beyond it.
    pub fn whole(self) -> Image {
        let [width, height] = self.size;
        if self.is_whole() {
            return Image { width, height, pixels: self.pixels };
        }
        framed(&self.pixels, self.part, self.size)
    }

    /// The whole picture as linear RGB with the primaries of sRGB.
    pub fn to_srgb(mut self) -> Image {
        let srgb = Space::Srgb.rgb();
        let space = self.space_or_srgb();
        if space != srgb {
            let matrix = space.to(&srgb, Adaptation::Bradford);
            self.pixels.iter_mut().for_each(|pixel| *pixel = matrix.apply_f32(*pixel));
        }
        self.whole()
    }

    /// Where its numbers are no light.
    pub fn faults(&self) -> Faults {
        let mut faults = Faults::default();
        let width = self.part.width.max(1);
        for (i, pixel) in self.pixels.iter().enumerate() {
            let is_negative = |v: &f32| *v < 0.0;
            let tests: [(&mut Fault, bool); 3] = [
                (&mut faults.nan, pixel.iter().any(|v| v.is_nan())),
                (&mut faults.infinite, pixel.contains(&f32::INFINITY)),
                (&mut faults.negative, pixel.iter().any(is_negative)),
            ];
            for (fault, is_met) in tests {
                if is_met {
                    let at = [i % width, i / width].map(|v| v as i64);
                    fault.add([at[0] + i64::from(self.part.x), at[1] + i64::from(self.part.y)]);
                }
            }
            for v in pixel.iter().filter(|v| v.is_finite()) {
                faults.largest = if *v > faults.largest { *v } else { faults.largest };
            }
        }
        faults
    }

    /// Makes light of what is none, as [`surroundings`] takes it, and tells what was done.
    pub(super) fn tame(&mut self) {
        let faults = self.faults();
        let largest = if faults.largest > LARGEST_HALF { faults.largest } else { LARGEST_HALF };
        let tamed = |v: f32| match v {
            v if v.is_nan() || v == f32::NEG_INFINITY => 0.0,
            f32::INFINITY => largest,
            v => v,
        };
        if faults.nan.count + faults.infinite.count + faults.negative.count > 0 {
            self.pixels.iter_mut().for_each(|pixel| *pixel = pixel.map(tamed));
        }
        self.notes.extend(
            faults
                .infinite
                .told("infinite", &format!("{largest} is taken, the largest number that could be meant")),
        );
        self.notes.extend(faults.nan.told("no number (NaN)", "0 is taken"));
        let negative =
            "that is a colour which the file's primaries don't hold, or black where nothing is above 0";
        self.notes.extend(faults.negative.told("below 0", negative));
    }
}

/// Numbers of a picture that no light has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Pixels with a NaN.
    pub nan: Fault,
    /// Pixels with an infinite number above 0.
    pub infinite: Fault,
    /// Pixels with a number below 0.
    pub negative: Fault,
    /// The largest finite number, at least 0.
    pub largest: f32,
}

/// Pixels with one kind of fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fault {
    /// Their number.
    pub count: usize,
    /// Column and row of the first, from the top left of the whole picture.
    pub first: [i64; 2],
}

impl Fault {
    fn add(&mut self, at: [i64; 2]) {
        if self.count == 0 {
            self.first = at;
        }
        self.count += 1;
    }

    /// A sentence without a full stop: how many pixels are so, where the first is, and what becomes of them. `None` when
    /// there are none.
    pub fn told(&self, what: &str, becomes: &str) -> Option<String> {
        let [x, y] = self.first;
        let told = match self.count {
            0 => return None,
            1 => format!("a number of the pixel {x}, {y} is {what}"),
            n => format!("numbers of {n} pixels are {what}, the first at {x}, {y}"),
        };
        Some(if becomes.is_empty() { told } else { format!("{told}: {becomes}") })
    }
}

/// A picture of surroundings: the whole of it as linear sRGB, without numbers that are no light, and what a person should know
/// of it.
pub fn surroundings(bytes: &[u8], limits: &Limits) -> Result<(Image, Vec<String>), ReadError> {
    let mut photo = Photo::read(bytes, limits)?;
    photo.tame();
    let [width, height] = photo.size;
    let Window { x, y, width: across, height: down } = photo.part;
    let reaches = |at: i32, length: usize, frame: usize| {
        let end = i64::from(at) + length as i64;
        (at > 0 || end < frame as i64, at < 0 || end > frame as i64)
    };
    let (x_side, y_side) = (reaches(x, across, width), reaches(y, down, height));
    let rest =
        [(x_side.0 || y_side.0, "the rest is black"), (x_side.1 || y_side.1, "what lies beyond is left out")];
    let rest: Vec<&str> = rest.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
    if !rest.is_empty() {
        let part = format!("{across} x {down} pixels from {x}, {y} of a picture of {width} x {height}");
        photo.notes.push(format!("it has {part}: {}", rest.join(", ")));
    }
    let notes = std::mem::take(&mut photo.notes);
    Ok((photo.to_srgb(), notes))
}

/// A frame of that size around the pixels of a part of the plane: black where there are none, without those beyond it.
pub fn framed(pixels: &[[f32; 3]], part: Window, size: [usize; 2]) -> Image {
    let [width, height] = size;
    let mut whole = Image { width, height, pixels: vec![[0.0; 3]; width * height] };
    // The columns of a row of the part that lie within the frame.
    let from = (-i64::from(part.x)).clamp(0, part.width as i64);
    let to = (width as i64 - i64::from(part.x)).clamp(from, part.width as i64);
    if from == to {
        return whole;
    }
    for (row, pixels) in pixels.chunks_exact(part.width.max(1)).enumerate() {
        let y = i64::from(part.y) + row as i64;
        if (0..height as i64).contains(&y) {
            let start = y as usize * width + (i64::from(part.x) + from) as usize;
            let pixels = &pixels[from as usize..to as usize];
            whole.pixels[start..start + pixels.len()].copy_from_slice(pixels);
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_cuts_and_fills() {
        let pixels: Vec<[f32; 3]> = (1..=6_u8).map(|v| [f32::from(v); 3]).collect();
        let framed = |x: i32, y: i32, size: [usize; 2]| {
            let image = framed(&pixels, Window { x, y, width: 3, height: 2 }, size);
            assert_eq!([image.width, image.height], size);
            image.pixels.iter().map(|p| p[0] as u8).collect::<Vec<_>>()
        };
        assert_eq!(framed(0, 0, [3, 2]), [1, 2, 3, 4, 5, 6]);
        assert_eq!(framed(1, 1, [4, 3]), [0, 0, 0, 0, 0, 1, 2, 3, 0, 4, 5, 6]);
        assert_eq!(framed(-1, -1, [2, 2]), [5, 6, 0, 0]);
        assert_eq!(framed(2, 0, [3, 1]), [0, 0, 1]);
        for (x, y) in [(9, 0), (-9, 0), (0, 9), (0, -9), (i32::MAX, i32::MIN)] {
            assert_eq!(framed(x, y, [2, 1]), [0, 0], "{x} {y}");
        }
    }

    #[test]
    fn what_is_no_light_is_counted_and_tamed() {
        let pixels = vec![
            [1.0; 3],
            [f32::INFINITY, 1.0, f32::NAN],
            [0.5, f32::NAN, 2.0],
            [-1.0, 0.25, f32::NEG_INFINITY],
        ];
        let image = Image { width: 2, height: 2, pixels };
        let mut photo = Photo::of_image(Format::Pfm, image.clone());
        let faults = photo.faults();
        assert_eq!((faults.infinite.count, faults.infinite.first), (1, [1, 0]));
        assert_eq!((faults.nan.count, faults.nan.first), (2, [1, 0]));
        assert_eq!((faults.negative.count, faults.negative.first), (1, [1, 1]));
        photo.tame();
        assert_eq!(photo.pixels, [[1.0; 3], [65504.0, 1.0, 0.0], [0.5, 0.0, 2.0], [-1.0, 0.25, 0.0]]);
        let told = photo.notes.join("\n");
        assert!(told.starts_with("a number of the pixel 1, 0 is infinite: 65504 is taken"), "{told}");
        assert!(told.contains("numbers of 2 pixels are no number (NaN), the first at 1, 0"), "{told}");
        // Light that is brighter than that is not darker than what is infinite.
        let mut bright = image;
        bright.pixels[0] = [2e5; 3];
        let mut photo = Photo::of_image(Format::Pfm, bright);
        photo.tame();
        assert_eq!(photo.pixels[1], [2e5, 1.0, 0.0]);
    }
}
