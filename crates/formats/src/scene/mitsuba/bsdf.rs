//! BSDFs.
//!
//! One-sided unless `twosided` is around them, as in Mitsuba, where most are black from behind. A normal or bump map is handed down to the materials inside
//! it, since here each has its own; so is what fills a clear one.

use straal_scene::desc::{
    Bump, CoatedConductor, Conductor, Dielectric, Diffuse, DiffuseTransmission, Distribution, GreenAxis,
    Highlight, Index, Interior, Mask, Material, MaterialRef, Mirror, Mix, NormalMap, NormalSpace, OpenPbr,
    Phong, Plastic, Principled, Relief, RoughDiffuse, Spectrum, ThinDielectric, TwoFaces, Varying,
};
use straal_scene::limit::Limit;
use straal_scene::value::{Known, LinearRgb, Link};
use straal_scene::{Diagnostic, Spanned, suggest};

use super::spectrum::For;
use super::texture::Role;
use super::translate::{Translator, free_name};
use super::tree::{Class, Object, Value};
use super::uv::Uv;

/// What is around a BSDF and decides what becomes of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Around {
    /// Whether it is in a `twosided`.
    pub two_sided: bool,
    /// The surface's coordinates.
    pub uv: Uv,
    /// Which of the reliefs it has.
    pub relief: usize,
    /// What fills it: one more than the medium's place.
    pub interior: usize,
    /// Which attributes of the mesh are bytes: one of the lists.
    pub codes: usize,
}

/// Indices of refraction by name, at 589 nm (Hecht, Optics, and others), as Mitsuba has them.
const INDICES: [(&str, f64); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// What straal calls the metals of Mitsuba that it knows.
const METALS: [(&str, &str); 13] = [
    ("Ag", "silver"),
    ("Au", "gold"),
    ("Cu", "copper"),
    ("Cu_palik", "copper"),
    ("Al", "aluminium"),
    ("Cr", "chromium"),
    ("Ni_palik", "nickel"),
    ("Ni", "nickel"),
    ("W", "tungsten"),
    ("Ti", "titanium"),
    ("Fe", "iron"),
    ("Pt", "platinum"),
    ("Pt_palik", "platinum"),
];

/// A metal by its name, or the two parts of its index.
type MetalOf = (Option<Known<straal_color::spectrum::refraction::Metal>>, [Option<Varying<Spectrum>>; 2]);

/// Alpha of facets.
const ALPHA: Limit = Limit::UNIT;

/// Indices of refraction.
const INDEX: Limit = Limit::within(0.1, 10.0);

impl<'o> Translator<'o, '_, '_> {
    /// A BSDF as a material, for a surface.
    pub fn bsdf(&mut self, i: usize, around: Around) -> MaterialRef {
        let o: &'o Object = &self.objects[i];
        let around = self.that_counts(i, around);
        let Some(id) = &o.id else {
            let is_allowed = self.spend(o.plugin.span);
            return MaterialRef::Inline(Box::new(if is_allowed {
                self.new_bsdf(i, around)
            } else {
                black()
            }));
        };
        if let Some(known) = self.materials.get(&(i, around)) {
            return known.clone();
        }
        if !self.spend(o.plugin.span) {
            return MaterialRef::Inline(Box::new(black()));
        }
        let material = self.new_bsdf(i, around);
        let words = [
            if around.two_sided { "two-sided" } else { "" },
            around.uv.word(),
            if around.relief > 0 { "in relief" } else { "" },
            if around.interior > 0 { "filled" } else { "" },
            if around.codes > 0 { "bytes" } else { "" },
        ];
        // A name as it stands in the file is for the first that is made of it.
        let is_free = self.scene.materials.get(id).is_none();
        let words: &[&str] = if is_free { &[] } else { &words };
        let name = free_name(id, words, |name| self.scene.materials.get(name).is_some());
        let name = Spanned::new(name, o.plugin.span);
        self.scene.materials.insert(name.clone(), material);
        let made = MaterialRef::Named(Link::new(name));
        self.materials.insert((i, around), made.clone());
        made
    }

    /// What is around a BSDF, without what makes no difference to it.
    fn that_counts(&self, i: usize, around: Around) -> Around {
        let (mut reads_uv, mut reads_mesh) = (false, false);
        let mut open = vec![i];
        let mut steps = 0;
        while let Some(i) = open.pop() {
            let o = &self.objects[i];
            steps += 1;
            if steps > 100 {
                (reads_uv, reads_mesh) = (true, true);
                break;
            }
            if o.class == Class::Texture && !super::spectrum::is_spectrum(&o.plugin) {
                let is_of_mesh = ["mesh_attribute", "vertexcolors"].contains(&o.plugin.as_str());
                (reads_uv, reads_mesh) = (reads_uv || !is_of_mesh, reads_mesh || is_of_mesh);
            }
            open.extend(o.objects().map(|(_, inner)| inner));
        }
        Around {
            uv: if reads_uv { around.uv } else { Uv::Same },
            codes: if reads_mesh { around.codes } else { 0 },
            ..around
        }
    }

    fn new_bsdf(&mut self, i: usize, around: Around) -> Material {
        let o: &'o Object = &self.objects[i];
        let uv = around.uv;
        if around.interior > 0 && !is_clear_or_holds(&o.plugin) {
            self.medium_is_left_out(around.interior - 1, "nothing is there instead");
        }
        match o.plugin.as_str() {
            "twosided" => {
                self.only(o, &["allow_transmission", "*"]);
                let around = Around { two_sided: true, ..around };
                let parts = self.inside(o, Class::Bsdf);
                match parts.as_slice() {
                    [one] => self.same_as(*one, around),
                    [front, back, ..] => {
                        let (front, back) = (self.bsdf(*front, around), self.bsdf(*back, around));
                        Material::TwoFaces(TwoFaces {
                            front: Box::new(front),
                            back: Box::new(back),
                            relief: Relief::default(),
                        })
                    }
                    [] => self.lacks_bsdf(o),
                }
            }
            "mask" => {
                self.only(o, &["opacity", "*"]);
                let opacity = self.varying(o, "opacity", 0.5, Limit::UNIT, uv);
                let Some(&part) = self.inside(o, Class::Bsdf).first() else { return self.lacks_bsdf(o) };
                let material = Box::new(self.bsdf(part, around));
                Material::Mask(Mask { material, opacity, relief: Relief::default() })
            }
            "blendbsdf" => {
                self.only(o, &["weight", "*"]);
                let weight = self.varying(o, "weight", 0.5, Limit::UNIT, uv);
                let parts = self.inside(o, Class::Bsdf);
                let [first, second, ..] = parts[..] else { return self.lacks_bsdf(o) };
                let (first, second) = (self.bsdf(first, around), self.bsdf(second, around));
                Material::Mix(Mix {
                    first: Box::new(first),
                    second: Box::new(second),
                    weight,
                    relief: Relief::default(),
                })
            }
            "mixturebsdf" => self.mixture(o, around),
            "bumpmap" => {
                self.only(o, &["scale", "flip_invalid_normals", "use_shadowing_function", "*"]);
                let height = self.within(o, "scale", 1.0, Limit::within(-1e6, 1e6));
                self.in_relief(o, around, |t, texture, relief| {
                    let texture = t.texture(texture, uv, Role::Number);
                    relief.bump = Some(Bump { texture, height });
                })
            }
            "normalmap" => {
                self.only(o, &["flip_invalid_normals", "use_shadowing_function", "*"]);
                if uv == Uv::Disc {
                    self.alike(
                        "disc",
                        o,
                        "on a disc the red of a normal map is along x here, not out from its middle"
                            .to_owned(),
                    );
                }
                self.in_relief(o, around, |t, texture, relief| {
                    let texture = t.texture(texture, uv, Role::Light);
                    // Where u runs the other way here, so do both directions of the frame, which is right-handed there.
                    let strength = if uv == Uv::FlipU { -1.0 } else { 1.0 };
                    let (space, green) = (NormalSpace::Tangent, GreenAxis::Up);
                    relief.normal_map = Some(NormalMap { texture, space, green, strength });
                })
            }
            "coating" | "roughcoating" => {
                self.only(
                    o,
                    &[
                        "int_ior",
                        "ext_ior",
                        "thickness",
                        "sigma_a",
                        "alpha",
                        "distribution",
                        "specular_reflectance",
                        "*",
                    ],
                );
                self.coating(o, around)
            }
            _ => self.lone_bsdf(o, around),
        }
    }

    /// A BSDF that holds no other. Apart from those that do, which are made of one another many deep: what all of these take on the stack together is a lot.
    fn lone_bsdf(&mut self, o: &'o Object, around: Around) -> Material {
        let Around { two_sided, uv, .. } = around;
        let relief = self.reliefs[around.relief].clone();
        match o.plugin.as_str() {
            "diffuse" => {
                self.only(o, &["reflectance"]);
                let reflectance = self.colour(o, "reflectance", 0.5, For::Share, uv);
                Material::Diffuse(Diffuse { reflectance, two_sided, relief, ..Diffuse::default() })
            }
            "roughdiffuse" => {
                self.only(o, &["reflectance", "alpha", "use_fast_approx"]);
                self.alike(
                    "rough",
                    o,
                    "`roughdiffuse` is Oren and Nayar's qualitative model here".to_owned(),
                );
                let reflectance = self.colour(o, "reflectance", 0.5, For::Share, uv);
                // Mitsuba's alpha is that of Beckmann's slopes, whose standard deviation is alpha / √2.
                let alpha = self.within(o, "alpha", 0.2, ALPHA);
                let roughness = Varying::Constant(alpha / std::f64::consts::SQRT_2);
                Material::Diffuse(Diffuse {
                    reflectance,
                    roughness,
                    model: RoughDiffuse::OrenNayar,
                    two_sided,
                    relief,
                })
            }
            "dielectric" | "roughdielectric" => self.dielectric(o, around, relief),
            "thindielectric" => {
                self.only(o, &["int_ior", "ext_ior", "specular_reflectance", "specular_transmittance"]);
                let (eta, eta_outside) = (self.index(o, "int_ior", "bk7"), self.index(o, "ext_ior", "air"));
                let reflectance = self.colour(o, "specular_reflectance", 1.0, For::Share, uv);
                let transmittance = self.colour(o, "specular_transmittance", 1.0, For::Share, uv);
                Material::ThinDielectric(ThinDielectric {
                    eta: eta.into(),
                    eta_outside: eta_outside.into(),
                    reflectance,
                    transmittance,
                    relief,
                })
            }
            "conductor" | "roughconductor" => self.conductor(o, around, relief),
            "plastic" | "roughplastic" | "pplastic" => self.plastic(o, around, relief),
            "principled" => self.principled(o, around, relief),
            "principledthin" => {
                self.only(
                    o,
                    &[
                        "base_color",
                        "roughness",
                        "anisotropic",
                        "spec_trans",
                        "eta",
                        "spec_tint",
                        "sheen",
                        "sheen_tint",
                        "flatness",
                        "diff_trans",
                        "specular_reflectance_sampling_rate",
                        "specular_transmittance_sampling_rate",
                        "diffuse_transmittance_sampling_rate",
                        "diffuse_reflectance_sampling_rate",
                    ],
                );
                self.alike(
                    "thin",
                    o,
                    "`principledthin` is `open_pbr` with thin walls here: alike, not the same".to_owned(),
                );
                let m = OpenPbr {
                    base_color: self.colour(o, "base_color", 0.5, For::Share, uv),
                    specular_roughness: self.varying(o, "roughness", 0.5, Limit::UNIT, uv),
                    transmission_weight: self.varying(o, "spec_trans", 0.0, Limit::UNIT, uv),
                    transmission_color: self.colour(o, "base_color", 0.5, For::Share, uv),
                    specular_ior: Varying::Constant(self.within(o, "eta", 1.5, Limit::within(0.1, 5.0))),
                    geometry_thin_walled: true,
                    two_sided,
                    relief,
                    ..OpenPbr::default()
                };
                Material::OpenPbr(m)
            }
            "null" => {
                self.only(o, &[]);
                nothing()
            }
            "phong" => {
                self.only(
                    o,
                    &["diffuse_reflectance", "specular_reflectance", "exponent", "specular_sampling_weight"],
                );
                let m = Phong {
                    reflectance: self.colour(o, "diffuse_reflectance", 0.5, For::Share, uv),
                    specular: self.colour(o, "specular_reflectance", 0.2, For::Share, uv),
                    exponent: self.varying(o, "exponent", 30.0, Limit::within(0.0, 1e5), uv),
                    highlight: Highlight::Phong,
                    two_sided,
                    relief,
                    ..Phong::default()
                };
                Material::Phong(m)
            }
            "ward" => {
                self.only(
                    o,
                    &[
                        "diffuse_reflectance",
                        "specular_reflectance",
                        "alpha",
                        "alpha_u",
                        "alpha_v",
                        "variant",
                    ],
                );
                self.alike(
                    "ward",
                    o,
                    "Ward's `ward` is `phong` here, as sharp: alike, not the same".to_owned(),
                );
                let alpha = self.within(
                    o,
                    if o.has("alpha_u") { "alpha_u" } else { "alpha" },
                    0.1,
                    Limit::within(0.005, 1.0),
                );
                let m = Phong {
                    reflectance: self.colour(o, "diffuse_reflectance", 0.5, For::Share, uv),
                    specular: self.colour(o, "specular_reflectance", 0.2, For::Share, uv),
                    exponent: Varying::Constant(2.0 / (alpha * alpha)),
                    highlight: Highlight::Blinn,
                    two_sided,
                    relief,
                    ..Phong::default()
                };
                Material::Phong(m)
            }
            "difftrans" => {
                self.only(o, &["transmittance"]);
                let transmittance = self.colour(o, "transmittance", 0.5, For::Share, uv);
                let reflectance = Varying::Constant(Spectrum::grey(0.0));
                Material::DiffuseTransmission(DiffuseTransmission { reflectance, transmittance, relief })
            }
            _ => {
                self.unsupported(o, "grey that scatters evenly stands in for it");
                Material::Diffuse(Diffuse { two_sided, relief, ..Diffuse::default() })
            }
        }
    }

    /// The material of another, in place of one around it.
    fn same_as(&mut self, i: usize, around: Around) -> Material {
        let around = self.that_counts(i, around);
        self.new_bsdf(i, around)
    }

    fn lacks_bsdf(&mut self, o: &'o Object) -> Material {
        let message = format!("`{}` has too few BSDFs in it", suggest::brief(&o.plugin));
        self.push(Diagnostic::error(o.plugin.span, message));
        black()
    }

    /// A BSDF with a relief that a texture in the same object makes.
    fn in_relief(
        &mut self,
        o: &'o Object,
        around: Around,
        make: impl FnOnce(&mut Self, usize, &mut Relief),
    ) -> Material {
        let texture = self.inside(o, Class::Texture).first().copied();
        let part = self.inside(o, Class::Bsdf).first().copied();
        let (Some(texture), Some(part)) = (texture, part) else {
            let message = format!("`{}` needs a texture and a BSDF in it", suggest::brief(&o.plugin));
            self.push(Diagnostic::error(o.plugin.span, message));
            return black();
        };
        let outer = self.reliefs[around.relief].clone();
        let mut relief = outer.clone();
        make(self, texture, &mut relief);
        let is_lost = outer.bump.is_some() && outer.bump != relief.bump
            || outer.normal_map.is_some() && outer.normal_map != relief.normal_map;
        if is_lost {
            self.alike(
                "reliefs",
                o,
                "of two maps of the same kind inside one another the inner one counts".to_owned(),
            );
        }
        let known = self.reliefs.iter().position(|other| *other == relief);
        let place = known.unwrap_or_else(|| {
            self.reliefs.push(relief);
            self.reliefs.len() - 1
        });
        self.same_as(part, Around { relief: place, ..around })
    }

    fn distribution(&mut self, o: &'o Object) -> Distribution {
        match self.word(o, "distribution", &["beckmann", "ggx", "phong", "as"]) {
            Some("ggx") => Distribution::Ggx,
            Some("phong" | "as") => {
                self.alike(
                    "facets",
                    o,
                    "facets after Phong are Beckmann's here: alike, not the same".to_owned(),
                );
                Distribution::Beckmann
            }
            _ => Distribution::Beckmann,
        }
    }

    /// Alpha along u, and along v where it is another.
    fn alpha(&mut self, o: &'o Object, uv: Uv) -> (Varying<f64>, Option<Varying<f64>>) {
        if !o.has("alpha_u") && !o.has("alpha_v") {
            return (self.varying(o, "alpha", 0.1, ALPHA, uv), None);
        }
        if uv == Uv::Disc {
            self.alike(
                "disc",
                o,
                "on a disc what is brushed runs across it here, not out from its middle".to_owned(),
            );
        }
        let along = self.varying(o, "alpha_u", 0.1, ALPHA, uv);
        (along, Some(self.varying(o, "alpha_v", 0.1, ALPHA, uv)))
    }

    /// An index of refraction, as a number or by name.
    fn index(&mut self, o: &'o Object, name: &str, absent: &str) -> f64 {
        let by_name = |wanted: &str| {
            INDICES.iter().find(|(known, _)| known.eq_ignore_ascii_case(wanted.trim())).map(|(_, v)| *v)
        };
        let absent = by_name(absent).unwrap_or(1.0);
        match self.get(o, name).map(|p| (&p.value, p.span)) {
            None => absent,
            Some((Value::Text(text), span)) => by_name(text).unwrap_or_else(|| {
                let names = INDICES.iter().map(|(known, _)| *known);
                let message =
                    format!("`{}` is no material whose index of refraction is known", suggest::brief(text));
                let help = suggest::did_you_mean(text, names.clone());
                let help = help.unwrap_or_else(|| format!("known are {}", suggest::list(names)));
                self.push(Diagnostic::error(span, message).help(help));
                absent
            }),
            Some(_) => self.within(o, name, absent, INDEX),
        }
    }

    fn dielectric(&mut self, o: &'o Object, around: Around, relief: Relief) -> Material {
        let is_rough = o.plugin.as_str() == "roughdielectric";
        let more: &[&str] =
            if is_rough { &["alpha", "alpha_u", "alpha_v", "distribution", "sample_visible"] } else { &[] };
        self.only(
            o,
            &[&["int_ior", "ext_ior", "specular_reflectance", "specular_transmittance"], more].concat(),
        );
        let (eta, eta_outside) = (self.index(o, "int_ior", "bk7"), self.index(o, "ext_ior", "air"));
        let (roughness, roughness_v) =
            if is_rough { self.alpha(o, around.uv) } else { (Varying::Constant(0.0), None) };
        let interior = match around.interior {
            0 => Interior::default(),
            medium => self.interior(medium - 1),
        };
        Material::Dielectric(Dielectric {
            eta: Index::Constant(eta).into(),
            eta_outside: Index::Constant(eta_outside).into(),
            reflectance: self.colour(o, "specular_reflectance", 1.0, For::Share, around.uv),
            transmittance: self.colour(o, "specular_transmittance", 1.0, For::Share, around.uv),
            roughness,
            roughness_v,
            distribution: if is_rough { self.distribution(o) } else { Distribution::Ggx },
            interior,
            relief,
            ..Dielectric::default()
        })
    }

    /// A metal by name or by its index; `None` for the perfect mirror.
    fn metal(&mut self, o: &'o Object, uv: Uv) -> Option<MetalOf> {
        let said = self.text(o, "material");
        if o.has("eta") || o.has("k") {
            let outside = self.index(o, "ext_eta", "vacuum");
            // Relative to air here, whatever it is in.
            let factor = if o.has("ext_eta") && outside > 1.001 { 1.0 / outside } else { 1.0 };
            return Some((
                None,
                [("eta", 0.0), ("k", 1.0)].map(|(name, absent)| {
                    let told = self.colour(o, name, absent, For::Any, uv);
                    Some(if factor < 1.0 { self.times_varying(o.plugin.span, told, factor) } else { told })
                }),
            ));
        }
        let name = said.as_ref().map_or(if o.is_old { "Cu" } else { "none" }, |s| s.trim());
        if name.eq_ignore_ascii_case("none") {
            return None;
        }
        let known =
            METALS.iter().find(|(theirs, _)| theirs.eq_ignore_ascii_case(name)).map(|(_, ours)| *ours);
        let metal = known.and_then(|ours| Known::new(ours.to_owned()));
        if metal.is_none() {
            let message =
                format!("the metal `{}` isn't known: chromium stands in for it", suggest::brief(name));
            let help =
                format!("known are {}; others are told by `eta` and `k`", suggest::list(METALS.map(|m| m.0)));
            let span = said.as_ref().map_or(o.plugin.span, |s| s.span);
            self.push(Diagnostic::warning(span, message).help(help));
            return Some((Known::new("chromium".to_owned()), [None, None]));
        }
        Some((metal, [None, None]))
    }

    fn conductor(&mut self, o: &'o Object, around: Around, relief: Relief) -> Material {
        let is_rough = o.plugin.as_str() == "roughconductor";
        let more: &[&str] =
            if is_rough { &["alpha", "alpha_u", "alpha_v", "distribution", "sample_visible"] } else { &[] };
        self.only(o, &[&["material", "eta", "k", "ext_eta", "specular_reflectance"], more].concat());
        let Around { two_sided, uv, .. } = around;
        let reflectance = self.colour(o, "specular_reflectance", 1.0, For::Share, uv);
        let (roughness, roughness_v) =
            if is_rough { self.alpha(o, uv) } else { (Varying::Constant(0.0), None) };
        let (metal, [eta, k]) = match self.metal(o, uv) {
            Some(found) => found,
            None if !is_rough => {
                return Material::Mirror(Mirror { reflectance, two_sided, relief, ..Mirror::default() });
            }
            // What reflects all of it at any angle.
            None => (None, [0.0, 1.0].map(|grey| Some(Spectrum::grey(grey).into()))),
        };
        Material::Conductor(Conductor {
            metal,
            eta,
            k,
            roughness,
            roughness_v,
            distribution: if is_rough { self.distribution(o) } else { Distribution::Ggx },
            reflectance,
            two_sided,
            relief,
            ..Conductor::default()
        })
    }

    fn plastic(&mut self, o: &'o Object, around: Around, relief: Relief) -> Material {
        let is_rough = o.plugin.as_str() != "plastic";
        let more: &[&str] = match o.plugin.as_str() {
            "roughplastic" => &["alpha", "distribution", "sample_visible"],
            "pplastic" => &["alpha", "alpha_u", "alpha_v", "distribution", "sample_visible", "eta"],
            _ => &[],
        };
        self.only(
            o,
            &[&["int_ior", "ext_ior", "diffuse_reflectance", "specular_reflectance", "nonlinear"], more]
                .concat(),
        );
        if o.plugin.as_str() == "pplastic" {
            self.alike("pplastic", o, "`pplastic` is `plastic` here: alike, not the same".to_owned());
        }
        let Around { two_sided, uv, .. } = around;
        let (mut eta, mut eta_outside) =
            (self.index(o, "int_ior", "polypropylene"), self.index(o, "ext_ior", "air"));
        if o.has("eta") {
            (eta, eta_outside) = (self.within(o, "eta", 1.49, Limit::within(1.0001, 10.0)), 1.0);
        }
        if eta < 1.0001 {
            let held = self.held(o.plugin.span, "int_ior", eta, Limit::within(1.0001, 10.0));
            eta = held;
        }
        let roughness = if is_rough { self.alpha(o, uv).0 } else { Varying::Constant(0.0) };
        Material::Plastic(Plastic {
            reflectance: self.colour(o, "diffuse_reflectance", 0.5, For::Share, uv),
            eta: eta.into(),
            eta_outside: eta_outside.into(),
            roughness,
            distribution: if is_rough { self.distribution(o) } else { Distribution::Ggx },
            specular: self.colour(o, "specular_reflectance", 1.0, For::Share, uv),
            nonlinear: self.boolean(o, "nonlinear").unwrap_or(false),
            two_sided,
            relief,
        })
    }

    fn principled(&mut self, o: &'o Object, around: Around, relief: Relief) -> Material {
        self.only(
            o,
            &[
                "base_color",
                "roughness",
                "anisotropic",
                "metallic",
                "spec_trans",
                "eta",
                "specular",
                "spec_tint",
                "sheen",
                "sheen_tint",
                "flatness",
                "clearcoat",
                "clearcoat_gloss",
                "diffuse_reflectance_sampling_rate",
                "main_specular_sampling_rate",
                "clearcoat_sampling_rate",
            ],
        );
        let Around { two_sided, uv, .. } = around;
        let mut number = |name: &str, absent: f64| self.varying(o, name, absent, Limit::UNIT, uv);
        let (roughness, anisotropic) = (number("roughness", 0.5), number("anisotropic", 0.0));
        let (metallic, spec_trans) = (number("metallic", 0.0), number("spec_trans", 0.0));
        let (spec_tint, sheen) = (number("spec_tint", 0.0), number("sheen", 0.0));
        let (sheen_tint, flatness) = (number("sheen_tint", 0.0), number("flatness", 0.0));
        let (clearcoat, clearcoat_gloss) = (number("clearcoat", 0.0), number("clearcoat_gloss", 0.0));
        if o.has("eta") && o.has("specular") {
            self.warn(o.plugin.span, "`principled` takes `eta` or `specular`: `eta` counts");
        }
        let eta = o.has("eta").then(|| self.within(o, "eta", 1.5, INDEX));
        let specular = (!o.has("eta")).then(|| self.within(o, "specular", 0.5, Limit::UNIT));
        Material::Principled(Principled {
            base_color: self.colour(o, "base_color", 0.5, For::Share, uv),
            roughness,
            anisotropic,
            metallic,
            spec_trans,
            eta: eta.map(Varying::from),
            specular: specular.map(Varying::from),
            spec_tint,
            sheen,
            sheen_tint,
            flatness,
            clearcoat,
            clearcoat_gloss,
            two_sided,
            relief,
        })
    }

    /// Several, each with a weight: two at a time.
    fn mixture(&mut self, o: &'o Object, around: Around) -> Material {
        self.only(o, &["weights", "*"]);
        let parts = self.inside(o, Class::Bsdf);
        let text = self.text(o, "weights");
        let weights = text.as_ref().and_then(|t| super::xml::numbers(t)).unwrap_or_default();
        let sum: f64 = weights.iter().sum();
        let is_sound = weights.iter().all(|w| *w >= 0.0) && sum > 0.0 && sum.is_finite();
        if parts.is_empty() || parts.len() != weights.len() || !is_sound {
            let message = format!(
                "`mixturebsdf` has {} BSDFs and {} weights of 0 or above",
                parts.len(),
                weights.len()
            );
            self.push(Diagnostic::error(o.plugin.span, message));
            return black();
        }
        if sum < 0.999 {
            self.alike("weights", o, "the weights of `mixturebsdf` are made to add up to 1".to_owned());
        }
        let mut left = sum;
        let mut all: Option<(MaterialRef, f64)> = None;
        for (&part, weight) in parts.iter().zip(&weights).rev() {
            let material = self.bsdf(part, around);
            let behind = all.take();
            left = weight + behind.as_ref().map_or(0.0, |(_, w)| *w);
            all = Some(match behind {
                None => (material, left),
                Some((rest, of_rest)) => {
                    let share = if left > 0.0 { of_rest / left } else { 0.0 };
                    let mix = Mix {
                        first: Box::new(material),
                        second: Box::new(rest),
                        weight: Varying::Constant(if share < 1.0 { share } else { 1.0 }),
                        relief: Relief::default(),
                    };
                    (MaterialRef::Inline(Box::new(Material::Mix(mix))), left)
                }
            });
        }
        let _ = left;
        match all {
            Some((MaterialRef::Inline(material), _)) => *material,
            // A single one with a name.
            Some((named, _)) => Material::Mask(Mask {
                material: Box::new(named),
                opacity: Varying::Constant(1.0),
                relief: Relief::default(),
            }),
            None => black(),
        }
    }

    /// A clear coat over another: what comes nearest.
    fn coating(&mut self, o: &'o Object, around: Around) -> Material {
        let relief = self.reliefs[around.relief].clone();
        let Some(&part) = self.inside(o, Class::Bsdf).first() else { return self.lacks_bsdf(o) };
        let (eta, eta_outside) = (self.index(o, "int_ior", "bk7"), self.index(o, "ext_ior", "air"));
        let alpha =
            if o.plugin.as_str() == "roughcoating" { self.within(o, "alpha", 0.1, ALPHA) } else { 0.0 };
        let distribution = self.distribution(o);
        let beneath = self.same_as(part, around);
        self.alike(
            "coat",
            o,
            format!("`{}` is a coat of straal's own here: alike, not the same", o.plugin.value),
        );
        let relative = if eta / eta_outside > 1.0001 { eta / eta_outside } else { 1.0001 };
        match beneath {
            Material::Diffuse(m) => Material::Plastic(Plastic {
                reflectance: m.reflectance,
                eta: if eta > 1.0001 { eta } else { 1.0001 }.into(),
                eta_outside: eta_outside.into(),
                roughness: Varying::Constant(alpha),
                distribution,
                nonlinear: true,
                two_sided: m.two_sided,
                relief,
                ..Plastic::default()
            }),
            Material::Conductor(m) => {
                let mut made = CoatedConductor {
                    metal: m.metal,
                    eta: m.eta,
                    k: m.k,
                    roughness: m.roughness,
                    relief,
                    ..CoatedConductor::default()
                };
                made.coat.coat_eta = if relative < 10.0 { relative } else { 10.0 }.into();
                made.coat.coat_roughness = Varying::Constant(alpha);
                made.coat.two_sided = m.two_sided;
                Material::CoatedConductor(made)
            }
            other => other,
        }
    }
}

/// Whether a medium behind it counts, or behind what it is made of.
fn is_clear_or_holds(plugin: &str) -> bool {
    [
        "dielectric",
        "roughdielectric",
        "mask",
        "blendbsdf",
        "twosided",
        "bumpmap",
        "normalmap",
        "mixturebsdf",
        "coating",
        "roughcoating",
    ]
    .contains(&plugin)
}

/// What reflects nothing.
pub(super) fn black() -> Material {
    let reflectance = Varying::Constant(Spectrum::Rgb(LinearRgb::grey(0.0)));
    Material::Diffuse(Diffuse { reflectance, two_sided: false, ..Diffuse::default() })
}

/// What light passes as if nothing were there.
pub(super) fn nothing() -> Material {
    let material = Box::new(MaterialRef::Inline(Box::new(black())));
    Material::Mask(Mask { material, opacity: Varying::Constant(0.0), relief: Relief::default() })
}
