//! `straal diff`

use super::{print, read_picture};
use crate::args::DiffArgs;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::quantity::grouped;
use serde_json::{Value as Json, json};
use std::path::Path;
use straal::compare::{Comparison, Estimate, Tails, Tally, compare};
use straal::development::Development;
use straal_color::{Adaptation, Exposure, Matrix3, RgbSpace, Tone};
use straal_formats::ReadError;
use straal_formats::image::exr::{self, Window};
use straal_formats::image::{Format, Photo, framed};
use straal_scene::Image;

/// Degrees of freedom of a variance that doesn't tell its own: that of 16 replicates, the usual number.
const USUAL_DOF: f64 = 15.0;

/// Compares two pictures; the exit says whether they differ beyond chance.
pub fn run(args: &DiffArgs) -> Result<Exit, Failure> {
    let (a, mut b) = (Compared::read(&args.a)?, Compared::read(&args.b)?);
    if let Some(path) = &args.variance {
        b.noise = Some(Compared::read(path)?.into_noise());
    }
    for (path, picture) in [(&args.a, &a), (&args.b, &b)] {
        for note in picture.notes() {
            out::say(&format!("warning: {}: {note}\n", path.display()));
        }
    }
    let region = common(&a.photo, &b.photo)?;
    b.bring_to(a.photo.space_or_srgb());
    let tails = if args.heavy_tails { Tails::Heavy } else { Tails::Light };
    let (sheet_a, sheet_b) = (a.cut(region), b.cut(region));
    let identical = sheet_a.is_same(&sheet_b);
    let found =
        compare(sheet_a.estimate(), sheet_b.estimate(), tails).map_err(|e| Failure::input(e.to_string()))?;
    if args.json {
        print(&format!("{:#}\n", as_json(&found, identical, region)))?;
    } else if identical {
        print(&(told_region(region) + &tell_identical(&found)))?;
    } else {
        print(&(told_region(region) + &tell(&found)))?;
    }
    Ok(if found.differs && !identical { Exit::Differ } else { Exit::Fine })
}

/// A picture as it is compared.
struct Compared {
    photo: Photo,
    noise: Option<Noise>,
}

/// How unsure a picture is.
struct Noise {
    /// Of each number of the picture, or of a picture by itself.
    variance: Photo,
    dof: f64,
}

/// What of a picture is compared.
struct Sheet {
    image: Image,
    variance: Option<Image>,
    dof: f64,
}

/// The part of the whole picture that both have, where that isn't all of both. What a crop of straal doesn't show was not rendered; what is
/// outside the data window of any other picture is black.
fn common(a: &Photo, b: &Photo) -> Result<Option<Window>, Failure> {
    if a.size != b.size || !(a.is_crop() || b.is_crop()) {
        return Ok(None);
    }
    let known = |p: &Photo| if p.is_crop() { p.part } else { Window::of_size(p.size[0], p.size[1]) };
    let (a, b) = (known(a), known(b));
    let both = |(x, w): (i32, usize), (x2, w2): (i32, usize)| {
        let start = x.max(x2);
        let end = (i64::from(x) + w as i64).min(i64::from(x2) + w2 as i64);
        usize::try_from(end - i64::from(start))
            .ok()
            .filter(|length| *length > 0)
            .map(|length| (start, length))
    };
    let across = both((a.x, a.width), (b.x, b.width));
    let Some(((x, width), (y, height))) = across.zip(both((a.y, a.height), (b.y, b.height))) else {
        let message = "the pictures show different parts: their first pixels are";
        return Err(Failure::input(format!("{message} {}, {} and {}, {}", a.x, a.y, b.x, b.y)));
    };
    Ok(Some(Window { x, y, width, height }))
}

/// A part of the whole picture; without any, all of it, or of a crop what is there.
fn cut(photo: &Photo, region: Option<Window>) -> Image {
    let part = photo.part;
    match region {
        Some(r) if photo.size != [r.width, r.height] || photo.is_crop() => {
            let from = |at: i32, start: i32| at.saturating_sub(start);
            let part = Window { x: from(part.x, r.x), y: from(part.y, r.y), ..part };
            framed(&photo.pixels, part, [r.width, r.height])
        }
        None if photo.is_crop() => {
            Image { width: part.width, height: part.height, pixels: photo.pixels.clone() }
        }
        _ => framed(&photo.pixels, part, photo.size),
    }
}

impl Compared {
    fn read(path: &Path) -> Result<Self, Failure> {
        let bytes = read_picture(path)?;
        Self::from_bytes(&bytes).map_err(|e| Failure::input(format!("can't read {}: {e}", path.display())))
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        let limits = super::picture_limits();
        if Format::of(bytes)? != Format::Exr {
            return Ok(Self { photo: Photo::read(bytes, &limits)?, noise: None });
        }
        let picture = exr::read(bytes, &limits)?;
        // In its own space, which that of its variance is as well.
        Ok(Self { photo: Photo::of_exr(&picture, None)?, noise: noise(&picture) })
    }

    /// What a person should know of it.
    fn notes(&self) -> Vec<String> {
        let mut notes = self.photo.notes.clone();
        // Light that was exposed and bent for the screen is not the light of the film.
        let is_png = self.photo.format == Format::Png;
        let told = self.photo.metadata.iter().find(|(key, _)| is_png && key == "straal.look");
        if let Some((_, text)) = told
            && let Ok(development) = text.parse::<Development>()
            && (development.exposure != Exposure::default() || development.tone != Tone::Clamp)
        {
            let (exposure, tone) = (development.exposure, development.tone);
            notes.push(format!(
                "it was developed (exposure {exposure}, tone {tone}): it is compared as it is shown"
            ));
        }
        if self.photo.encoding.as_ref().is_some_and(|encoding| encoding.bits < 16) {
            notes.push(
                "it has 8 bits a channel: its light is rounded, by up to half a 255th of the signal".into(),
            );
        }
        notes
    }

    /// Brings the colours to another space. Channels of noise may go together, which a variance of each doesn't tell: theirs
    /// become the greatest that is possible, so that noise is not taken for a difference.
    fn bring_to(&mut self, space: RgbSpace) {
        let own = self.photo.space_or_srgb();
        if own == space {
            return;
        }
        let matrix = own.to(&space, Adaptation::Bradford);
        self.photo.pixels.iter_mut().for_each(|p| *p = matrix.apply_f32(*p));
        if let Some(noise) = &mut self.noise {
            let size = Matrix3(matrix.0.map(|row| row.map(f64::abs)));
            let most = |p: [f32; 3]| size.apply_f32(p.map(f32::sqrt)).map(|error| error * error);
            noise.variance.pixels.iter_mut().for_each(|p| *p = most(*p));
        }
        self.photo.space = Some(space);
    }

    /// A picture of a variance, or the variance that comes with a picture.
    fn into_noise(self) -> Noise {
        self.noise.unwrap_or(Noise { variance: self.photo, dof: USUAL_DOF })
    }

    fn cut(&self, region: Option<Window>) -> Sheet {
        Sheet {
            image: cut(&self.photo, region),
            variance: self.noise.as_ref().map(|n| cut(&n.variance, region)),
            dof: self.noise.as_ref().map_or(USUAL_DOF, |n| n.dof),
        }
    }
}

impl Sheet {
    /// Whether the pixels are the same to the last bit, those that are no numbers as well.
    fn is_same(&self, o: &Self) -> bool {
        let bits = |p: &[f32; 3]| p.map(f32::to_bits);
        let size = |s: &Self| (s.image.width, s.image.height);
        size(self) == size(o) && self.image.pixels.iter().map(bits).eq(o.image.pixels.iter().map(bits))
    }

    fn estimate(&self) -> Estimate<'_> {
        Estimate { dof: self.dof, ..Estimate::new(&self.image, self.variance.as_ref()) }
    }
}

/// The layer `variance`, and its degrees of freedom as the picture's metadata tell them. A variance without any (from
/// a single sample) is none.
fn noise(picture: &exr::Layered) -> Option<Noise> {
    let variance = Photo::of_exr(picture, None).ok()?;
    let variance = Photo { pixels: picture.layer("variance")?.rgb()?, ..variance };
    let told = |key: &str| {
        let value = picture.metadata.iter().find(|(k, _)| k == key);
        value.and_then(|(_, v)| v.parse::<u32>().ok())
    };
    let estimates = told("straal.replicates").or_else(|| told("straal.samples"));
    let dof = estimates.map_or(USUAL_DOF, |n| f64::from(n) - 1.0);
    (dof >= 1.0).then_some(Noise { variance, dof })
}

/// Which part of the pictures was compared, where that isn't all.
fn told_region(region: Option<Window>) -> String {
    region.map_or_else(String::new, |Window { x, y, width, height }| {
        format!("compared        {width} x {height} pixels from {x}, {y}: what was rendered of both\n")
    })
}

/// For people.
fn tell(c: &Comparison) -> String {
    let numbers = |v: [f64; 3]| format!("{:>12.5e} {:>12.5e} {:>12.5e}", v[0], v[1], v[2]);
    let stars = |v: [f64; 3]| format!("{:>12.2} {:>12.2} {:>12.2}", v[0], v[1], v[2]);
    let relmse = match c.relmse {
        Some(v) => format!("{v:.4e} (with the noise of B: {:.4e})", c.relmse_biased),
        None => format!("{:.4e} (biased: the noise of B is not known)", c.relmse_biased),
    };
    let mut text = format!(
        "mean of A       {}\nmean of B       {}\nmean error      {}\n  in std errors {}\n",
        numbers(c.means[0]),
        numbers(c.means[1]),
        numbers(c.mean_error),
        stars(c.mean_z)
    );
    text += &format!("relMSE          {relmse}, median {:.4e}\n", c.relmse_median);
    for (what, tally) in [("pixels", &c.pixels), ("blocks", &c.blocks)] {
        text += &format!("{what:<16}{}\n", tell_tally(tally));
    }
    if c.exact.compared > 0 {
        let (differing, compared, worst) = (c.exact.differing, c.exact.compared, c.exact.worst);
        text +=
            &format!("without noise   {differing} of {compared} values differ, the worst by {worst:.1e}\n");
    }
    if c.differs {
        text += "the pictures differ by more than chance:\n";
        text.extend(c.reasons.iter().map(|reason| format!("  {reason}\n")));
    } else {
        text += "the pictures agree within chance\n";
    }
    text
}

/// For people, of pictures that have nothing to compare.
fn tell_identical(c: &Comparison) -> String {
    let [width, height] = c.size;
    let wrong = match c.non_finite {
        0 => String::new(),
        1 => "; 1 pixel is infinite or not a number, in both".to_owned(),
        n => format!("; {} pixels are infinite or not a number, in both", grouped(n as u64)),
    };
    format!("the pictures are identical: all {width} x {height} pixels are the same to the last bit{wrong}\n")
}

fn tell_tally(t: &Tally) -> String {
    if t.tested == 0 {
        return "none with noise".into();
    }
    let part = 100.0 * t.beyond as f64 / t.tested as f64;
    let [x, y] = t.worst_at;
    format!(
        "{part:.2} % of {} values beyond the 99 % bound; the worst {:.1} standard errors, at {x}, {y}",
        t.tested, t.worst_t
    )
}

/// For scripts. Numbers that are infinite or NaN become `null`.
fn as_json(c: &Comparison, identical: bool, region: Option<Window>) -> Json {
    let tally = |t: &Tally| {
        json!({
            "tested": t.tested, "beyond": t.beyond, "worst_t": t.worst_t, "worst_at": t.worst_at,
            "p_worst": t.p_worst, "p_count": t.p_count,
        })
    };
    json!({
        "differ": c.differs && !identical,
        "identical": identical,
        "reasons": if identical { &[] } else { c.reasons.as_slice() },
        "size": c.size,
        "part": region.map(|w| json!([w.x, w.y, w.width, w.height])),
        "means": c.means,
        "mean_error": c.mean_error,
        "mean_z": c.mean_z,
        "relmse": c.relmse.unwrap_or(c.relmse_biased),
        "biased": c.relmse.is_none(),
        "relmse_biased": c.relmse_biased,
        "relmse_median": c.relmse_median,
        "pixels": tally(&c.pixels),
        "blocks": tally(&c.blocks),
        "without_noise": { "compared": c.exact.compared, "differing": c.exact.differing, "worst": c.exact.worst },
        "non_finite": c.non_finite,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_formats::image::exr::Layer;

    fn picture(metadata: &[(&str, &str)], with_variance: bool) -> exr::Layered {
        let mut p = exr::Layered::of_size(1, 1);
        p.layers.push(Layer::from_rgb("", &[[1.0, 2.0, 3.0]]));
        if with_variance {
            p.layers.push(Layer::from_rgb("variance", &[[0.1, 0.2, 0.3]]));
        }
        p.metadata = metadata.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
        p
    }

    #[test]
    fn degrees_of_freedom_come_from_the_story() {
        let dof = |metadata: &[_]| noise(&picture(metadata, true)).map(|n| n.dof);
        assert_eq!(dof(&[]), Some(15.0));
        assert_eq!(dof(&[("straal.samples", "64")]), Some(63.0));
        assert_eq!(dof(&[("straal.replicates", "4"), ("straal.samples", "64")]), Some(3.0));
        assert_eq!(dof(&[("straal.samples", "1")]), None);
        assert!(noise(&picture(&[("straal.samples", "64")], false)).is_none());
    }

    #[test]
    fn a_picture_of_a_variance_is_one() {
        let read = |p: &exr::Layered| {
            let mut bytes = std::io::Cursor::new(Vec::new());
            exr::write(&mut bytes, p).unwrap();
            Compared::from_bytes(bytes.get_ref()).unwrap().into_noise()
        };
        assert_eq!(read(&picture(&[], false)).variance.pixels, [[1.0, 2.0, 3.0]]);
        assert_eq!(read(&picture(&[], true)).variance.pixels, [[0.1, 0.2, 0.3]]);
    }
}
