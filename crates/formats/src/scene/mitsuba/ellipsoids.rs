//! Ellipsoids of a PLY file, as clouds of Gaussians are kept: a centre, logarithms of three radii, and a quaternion for each point.
//!
//! Straal shows them as solids, as Mitsuba's integrators for surfaces do; what they are for there are volumes.

use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::{Group, Instances, Node, Sphere};
use straal_scene::limit::Limit;
use straal_scene::mesh::Attribute;
use straal_scene::value::{Link, Matrix};
use straal_scene::{Diagnostic, Mesh, Spanned, suggest};

use super::translate::{Translator, free_name};
use super::tree::Object;
use super::uv::Uv;
use crate::files;
use crate::mesh::ply;

/// What each has besides its centre.
const COLUMNS: [&str; 8] = ["scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3", "opacity"];

/// As large in Mitsuba as where a Gaussian of full opacity is as faint as this.
const FAINTEST: f64 = 0.01;

/// How large they are.
struct Size {
    factor: f64,
    /// Whether faint ones are smaller.
    by_opacity: bool,
}

impl<'o> Translator<'o, '_, '_> {
    /// Ellipsoids: copies of a ball.
    pub fn ellipsoids(&mut self, i: usize) -> Option<Node> {
        let o: &'o Object = &self.objects[i];
        self.only(
            o,
            &["filename", "scale_factor", "extent", "extent_adaptive_clamping", "shell", "to_world", "*"],
        );
        let Some(file) = self.text(o, "filename") else {
            let message = format!("`{}` needs a `filename`", suggest::brief(&o.plugin));
            self.fail(o.plugin.span, message);
            return None;
        };
        self.alike("solid", o, format!("`{}` are solids here, smooth and opaque", suggest::brief(&o.plugin)));
        let factor = self.within(o, "scale_factor", 1.0, Limit::POSITIVE)
            * self.within(o, "extent", 3.0, Limit::POSITIVE);
        let by_opacity = self.boolean(o, "extent_adaptive_clamping").unwrap_or(false);
        let found = self.file(o, &file)?;
        let bytes = match files::read(&found.path, self.means.limits.max_bytes) {
            Ok(bytes) => bytes,
            Err(refusal) => {
                self.refuse(&file, &refusal);
                return None;
            }
        };
        let read = ply::read_points(&bytes, self.means.limits, &|name| COLUMNS.contains(&name))
            .map_err(|e| e.to_string())
            .and_then(|mesh| places(&mesh, &Size { factor, by_opacity }));
        let transforms = match read {
            Ok(places) => places,
            Err(problem) => {
                let message = format!("cannot read `{}`: {problem}", suggest::brief(&file));
                self.push(Diagnostic::error(file.span, message));
                return None;
            }
        };
        self.means.ledger.keep(size_of_val(transforms.as_slice()) as u64);
        self.read.push((found.path, found.name, blake3::hash(&bytes).into()));
        let at = self.placed(o, &Affine::IDENTITY);
        let mut surface = self.surface(o, &Affine::IDENTITY, Uv::Same, false);
        (surface.transform, surface.name) = Default::default();
        let ball = Node::Sphere(Sphere { surface, ..Sphere::default() });
        let own = o.id.clone().unwrap_or_else(|| format!("ellipsoids {i}"));
        let name = free_name(&own, &[], |name| self.scene.objects.get(name).is_some());
        let name = Spanned::new(name, o.plugin.span);
        let group = Group {
            transform: Default::default(),
            look_at: None,
            material: None,
            children: vec![ball],
            name: None,
        };
        self.scene.objects.insert(name.clone(), Node::Group(group));
        Some(Node::Instances(Instances {
            of: Link::new(name),
            transforms,
            transform: self.moving(o, &at),
            look_at: None,
            material: None,
            name: None,
        }))
    }
}

/// Where the ball of radius 1 goes for each point.
fn places(mesh: &Mesh, size: &Size) -> Result<Vec<Matrix>, String> {
    let column = |name: &str| mesh.attributes.iter().find(|a| a.name == name && a.channels == 1);
    let needed = |name: &str| column(name).ok_or_else(|| format!("its points have no `{name}`"));
    let scale: Vec<&Attribute> = COLUMNS[..3].iter().map(|name| needed(name)).collect::<Result<_, _>>()?;
    let turn: Vec<&Attribute> = COLUMNS[3..7].iter().map(|name| needed(name)).collect::<Result<_, _>>()?;
    let opacity = column("opacity").filter(|_| size.by_opacity);
    let number = |a: &Attribute, i: usize| f64::from(a.values.get(i).copied().unwrap_or(0.0));
    let mut out = Vec::with_capacity(mesh.positions.len());
    for (i, p) in mesh.positions.iter().enumerate() {
        let smaller = opacity.map_or(1.0, |a| {
            // How opaque it is goes through a sigmoid.
            let opaque = 1.0 / (1.0 + ops::exp_d(-number(a, i)));
            let square = 2.0 * ops::ln_d(opaque / FAINTEST);
            if square > 0.0 { square.sqrt() / 3.0 } else { 0.0 }
        });
        let radii = [0, 1, 2].map(|k| {
            let radius = ops::exp_d(number(scale[k], i));
            size.factor * smaller * if radius > 1e-6 { radius } else { 1e-6 }
        });
        let [w, x, y, z] = [0, 1, 2, 3].map(|k| number(turn[k], i));
        let p = DVec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]));
        let place = Affine::scale(DVec3::from_array(radii))
            .then(&crate::scene::gltf::rotation([x, y, z, w]))
            .then(&Affine::translate(p));
        // Those of which nothing is seen.
        if place.is_finite() && place.inverse().is_some() {
            out.push(Matrix(place));
        }
    }
    if out.is_empty() { Err("there is no ellipsoid in it".to_owned()) } else { Ok(out) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Limits;

    fn read(opacity: f64) -> Result<Vec<Matrix>, String> {
        let columns: String = COLUMNS.iter().map(|name| format!("property float {name}\n")).collect();
        // As wide as e, 1 and 1, turned by a quarter about z.
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n{columns}\
             end_header\n1 2 3 1 0 0 1 0 0 1 {opacity}\n"
        );
        let mesh = ply::read_points(text.as_bytes(), &Limits::default(), &|_| true).unwrap();
        places(&mesh, &Size { factor: 2.0, by_opacity: opacity != 0.0 })
    }

    #[test]
    fn radii_are_powers_and_quaternions_begin_with_the_real_part() {
        let place = read(0.0).unwrap()[0].0;
        let e = std::f64::consts::E;
        assert!((place.vector(DVec3::X) - DVec3::new(0.0, 2.0 * e, 0.0)).length() < 1e-6);
        assert!((place.vector(DVec3::Y) - DVec3::new(-2.0, 0.0, 0.0)).length() < 1e-6);
        assert_eq!(place.point(DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
        // Full opacity: the square root of 2 ln 100, over 3.
        let long = read(40.0).unwrap()[0].0.vector(DVec3::Z).length();
        assert!((long - 2.0 * 3.034_854 / 3.0).abs() < 1e-5, "{long}");
        assert!(read(-10.0).unwrap_err().contains("no ellipsoid"));
    }
}
