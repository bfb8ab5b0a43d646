//! Animated PNG: pictures that follow one another in one file (PNG Specification, third edition, 4.9 and 11.3.6).
//!
//! The file is put together from pictures that are PNG files already, whose pixels are taken over as they are packed. A viewer that knows
//! nothing of animation shows the first.

use std::io::{self, Write};

const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// A chunk: its name and what it holds.
type Chunk<'a> = (&'a [u8; 4], &'a [u8]);

/// The chunks of a PNG that [`super::png::write`] made.
fn chunks(png: &[u8]) -> Option<Vec<Chunk<'_>>> {
    let mut rest = png.strip_prefix(&SIGNATURE)?;
    let mut found = Vec::new();
    while !rest.is_empty() {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let (name, after) = after.split_first_chunk::<4>()?;
        let length = usize::try_from(u32::from_be_bytes(*length)).ok()?;
        let (data, after) = after.split_at_checked(length)?;
        found.push((name, data));
        rest = after.get(4..)?;
    }
    Some(found)
}

fn put(out: &mut impl Write, name: &[u8; 4], parts: &[&[u8]]) -> io::Result<()> {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    let length = u32::try_from(length).map_err(|_| wrong("a frame is too large for a PNG"))?;
    let mut sum = crc32fast::Hasher::new();
    out.write_all(&length.to_be_bytes())?;
    for part in [name.as_slice()].iter().chain(parts) {
        sum.update(part);
        out.write_all(part)?;
    }
    out.write_all(&sum.finalize().to_be_bytes())
}

fn wrong(problem: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, problem)
}

/// How long a frame is shown, as a fraction of a second.
fn delay(fps: f64) -> [u16; 2] {
    if fps >= 1.0 {
        // Thousandths where they fit: 23.976 is 1000 / 23976.
        let scale = if fps < 65.0 { 1000.0 } else { 1.0 };
        [scale as u16, (fps * scale).round() as u16]
    } else {
        [(1000.0 / fps).round() as u16, 1000]
    }
}

/// Writes pictures, each a whole PNG file, as one animation that is played again and again. All must have the same size and kind.
pub fn write(out: &mut impl Write, frames: &[Vec<u8>], fps: f64) -> io::Result<()> {
    let made = |png: &Vec<u8>| -> io::Result<Vec<([u8; 4], Vec<u8>)>> {
        let chunks = chunks(png).ok_or_else(|| wrong("a frame is no PNG"))?;
        Ok(chunks.into_iter().map(|(name, data)| (*name, data.to_vec())).collect())
    };
    let (Some(first), Ok(count)) = (frames.first(), u32::try_from(frames.len())) else {
        return Err(wrong("an animation has at least one frame"));
    };
    let first = made(first)?;
    let header = first.iter().find(|(name, _)| name == b"IHDR").map(|(_, data)| data.clone());
    let header = header.filter(|data| data.len() == 13).ok_or_else(|| wrong("a frame has no header"))?;
    out.write_all(&SIGNATURE)?;
    let mut sequence = 0_u32;
    for (i, png) in frames.iter().enumerate() {
        let chunks = if i == 0 { first.clone() } else { made(png)? };
        let mut controlled = false;
        for (name, data) in &chunks {
            match name {
                b"IHDR" if i == 0 => {
                    put(out, name, &[data])?;
                    put(out, b"acTL", &[&count.to_be_bytes(), &0_u32.to_be_bytes()])?;
                }
                b"IHDR" if *data != header => return Err(wrong("the frames of an animation differ in size")),
                b"IDAT" => {
                    if !controlled {
                        let [seconds, of] = delay(fps);
                        // Where it lies, and that nothing of the frame before shows through.
                        let place = [0; 8];
                        let parts: [&[u8]; 6] = [
                            &sequence.to_be_bytes(),
                            &header[..8],
                            &place,
                            &seconds.to_be_bytes(),
                            &of.to_be_bytes(),
                            &[0, 0],
                        ];
                        put(out, b"fcTL", &parts)?;
                        sequence += 1;
                        controlled = true;
                    }
                    if i == 0 {
                        put(out, name, &[data])?;
                    } else {
                        put(out, b"fdAT", &[&sequence.to_be_bytes(), data])?;
                        sequence += 1;
                    }
                }
                b"IEND" => {}
                _ if i == 0 => put(out, name, &[data])?,
                _ => {}
            }
        }
    }
    put(out, b"IEND", &[])
}

#[cfg(test)]
mod tests {
    use super::super::png::{Curve, Encoded, Pixels};
    use super::*;

    fn frame(width: usize, grey: u8) -> Vec<u8> {
        let pixels = vec![[grey; 3]; width * 2];
        let picture = Encoded {
            width,
            height: 2,
            pixels: Pixels::Eight(&pixels),
            curve: Curve::Srgb,
            metadata: &[("Title".to_owned(), format!("grey {grey}"))],
        };
        let mut out = Vec::new();
        super::super::png::write(&mut out, &picture).unwrap();
        out
    }

    #[test]
    fn a_decoder_plays_what_was_written() {
        let mut file = Vec::new();
        write(&mut file, &[frame(3, 10), frame(3, 200), frame(3, 30)], 24.0).unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(&file)).read_info().unwrap();
        let control = *reader.info().animation_control().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        for grey in [10, 200, 30] {
            reader.next_frame(&mut pixels).unwrap();
            let shown = *reader.info().frame_control().unwrap();
            assert_eq!((shown.delay_num, shown.delay_den), (1000, 24000));
            assert_eq!((shown.width, shown.height), (3, 2));
            assert_eq!(pixels, [grey; 18]);
        }
    }

    #[test]
    fn what_makes_no_animation_is_refused() {
        let refused = |frames: &[Vec<u8>]| write(&mut Vec::new(), frames, 24.0).unwrap_err().to_string();
        assert_eq!(refused(&[]), "an animation has at least one frame");
        assert_eq!(refused(&[frame(3, 1), frame(4, 1)]), "the frames of an animation differ in size");
        assert_eq!(refused(&[vec![1, 2, 3]]), "a frame is no PNG");
        assert_eq!(refused(&[frame(3, 1)[..40].to_vec()]), "a frame is no PNG");
    }

    #[test]
    fn delays_are_near_what_was_asked_for() {
        for fps in [0.02, 0.5, 1.0, 12.5, 23.976, 24.0, 60.0, 120.0, 1000.0] {
            let [seconds, of] = delay(fps).map(f64::from);
            assert!((of / seconds / fps - 1.0).abs() < 1e-3, "{fps}: {seconds}/{of}");
        }
    }
}
