//! `straal diff`

use super::{print, read_bytes};
use crate::args::DiffArgs;
use crate::exit::{Exit, Failure};
use crate::quantity::grouped;
use serde_json::{Value as Json, json};
use std::path::Path;
use straal::compare::{Comparison, Estimate, Tails, Tally, compare};
use straal_color::{Adaptation, Matrix3, RgbSpace, Space};
use straal_formats::image::exr::Beauty;
use straal_formats::image::{self, exr};
use straal_formats::{Limits, ReadError};
use straal_scene::Image;

/// Degrees of freedom of a variance that doesn't tell its own: that of 16 replicates, the usual number.
const USUAL_DOF: f64 = 15.0;

/// Compares two pictures; the exit says whether they differ beyond chance.
pub fn run(args: &DiffArgs) -> Result<Exit, Failure> {
    let (a, mut b) = (Picture::read(&args.a)?, Picture::read(&args.b)?);
    if let Some(path) = &args.variance {
        b.noise = Some(Picture::read(path)?.into_noise());
    }
    if let (Some(at_a), Some(at_b)) = (a.corner, b.corner)
        && at_a != at_b
    {
        let place = |[x, y]: [i32; 2]| format!("{x}, {y}");
        let message = "the pictures show different parts: their first pixels are";
        return Err(Failure::input(format!("{message} {} and {}", place(at_a), place(at_b))));
    }
    b.bring_to(a.space);
    let identical = a.is_same(&b);
    let tails = if args.heavy_tails { Tails::Heavy } else { Tails::Light };
    let found = compare(a.estimate(), b.estimate(), tails).map_err(|e| Failure::input(e.to_string()))?;
    if args.json {
        print(&format!("{:#}\n", as_json(&found, identical)))?;
    } else if identical {
        print(&tell_identical(&found))?;
    } else {
        print(&tell(&found))?;
    }
    Ok(if found.differs && !identical { Exit::Differ } else { Exit::Fine })
}

/// A picture as it is compared.
struct Picture {
    image: Image,
    /// Its first pixel in the whole picture, where the file tells.
    corner: Option<[i32; 2]>,
    /// The space of its colours; sRGB where the file doesn't say.
    space: RgbSpace,
    noise: Option<Noise>,
}

/// How unsure a picture is.
struct Noise {
    variance: Image,
    dof: f64,
}

impl Picture {
    fn read(path: &Path) -> Result<Self, Failure> {
        let bytes = read_bytes(path)?;
        Self::from_bytes(&bytes).map_err(|e| Failure::input(format!("can't read {}: {e}", path.display())))
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        let limits = Limits::default();
        if !bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
            let space = Space::Srgb.rgb();
            return Ok(Self { image: image::read(bytes, &limits)?, corner: None, space, noise: None });
        }
        let picture = exr::read(bytes, &limits)?;
        let corner = Some([picture.data_window.x, picture.data_window.y]);
        // In its own space, which that of its variance is as well.
        let Beauty { pixels, space, .. } = picture.beauty()?;
        let (width, height) = (picture.data_window.width, picture.data_window.height);
        let space = space.unwrap_or(Space::Srgb.rgb());
        Ok(Self { image: Image { width, height, pixels }, corner, space, noise: noise(&picture) })
    }

    /// Brings the colours to another space. Channels of noise may go together, which a variance of each doesn't tell: theirs
    /// become the greatest that is possible, so that noise is not taken for a difference.
    fn bring_to(&mut self, space: RgbSpace) {
        if self.space == space {
            return;
        }
        let matrix = self.space.to(&space, Adaptation::Bradford);
        self.image.pixels.iter_mut().for_each(|p| *p = matrix.apply_f32(*p));
        if let Some(noise) = &mut self.noise {
            let size = Matrix3(matrix.0.map(|row| row.map(f64::abs)));
            let most = |p: [f32; 3]| size.apply_f32(p.map(f32::sqrt)).map(|error| error * error);
            noise.variance.pixels.iter_mut().for_each(|p| *p = most(*p));
        }
        self.space = space;
    }

    /// A picture of a variance, or the variance that comes with a picture.
    fn into_noise(self) -> Noise {
        self.noise.unwrap_or(Noise { variance: self.image, dof: USUAL_DOF })
    }

    /// Whether the pixels are the same to the last bit, those that are no numbers as well.
    fn is_same(&self, o: &Self) -> bool {
        let bits = |p: &[f32; 3]| p.map(f32::to_bits);
        let size = |p: &Self| (p.image.width, p.image.height);
        size(self) == size(o) && self.image.pixels.iter().map(bits).eq(o.image.pixels.iter().map(bits))
    }

    fn estimate(&self) -> Estimate<'_> {
        let variance = self.noise.as_ref().map(|n| &n.variance);
        Estimate {
            dof: self.noise.as_ref().map_or(USUAL_DOF, |n| n.dof),
            ..Estimate::new(&self.image, variance)
        }
    }
}

/// The layer `variance`, and its degrees of freedom as the picture's story tells them. A variance without any (from
/// a single sample) is none.
fn noise(picture: &exr::Picture) -> Option<Noise> {
    let pixels = picture.layer("variance")?.rgb()?;
    let told = |key: &str| {
        let value = picture.metadata.iter().find(|(k, _)| k == key);
        value.and_then(|(_, v)| v.parse::<u32>().ok())
    };
    let estimates = told("straal.replicates").or_else(|| told("straal.samples"));
    let dof = estimates.map_or(USUAL_DOF, |n| f64::from(n) - 1.0);
    let variance = Image { width: picture.data_window.width, height: picture.data_window.height, pixels };
    (dof >= 1.0).then_some(Noise { variance, dof })
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
        n => format!(
            "; {} infinite or not a number, in both",
            if n == 1 { "1 pixel is".into() } else { format!("{} pixels are", grouped(n as u64)) }
        ),
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
fn as_json(c: &Comparison, identical: bool) -> Json {
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

    fn picture(metadata: &[(&str, &str)], with_variance: bool) -> exr::Picture {
        let mut p = exr::Picture::of_size(1, 1);
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
        let read = |p: &exr::Picture| {
            let mut bytes = std::io::Cursor::new(Vec::new());
            exr::write(&mut bytes, p).unwrap();
            Picture::from_bytes(bytes.get_ref()).unwrap().into_noise()
        };
        assert_eq!(read(&picture(&[], false)).variance.pixels, [[1.0, 2.0, 3.0]]);
        assert_eq!(read(&picture(&[], true)).variance.pixels, [[0.1, 0.2, 0.3]]);
    }
}
