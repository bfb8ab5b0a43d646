//! OpenPBR held against another implementation: values of Adobe's OpenPBR BSDF for many materials (`reference/openpbr` of the shared data;
//! its README tells how they were made).
//!
//! `STRAAL_REPORT=1 cargo test -p straal --test all open_pbr -- --nocapture` prints for each material how far off it is.

use crate::common::shared;
use serde_json::Value;
use std::path::Path;
use straal::{Job, LoadOptions, Overrides};
use straal_color::Light;
use straal_math::Vec3;
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_render::lanes::Rgb;
use straal_render::material::{Bsdf, Material, Transport};
use straal_render::texture::ShadingPoint;
use straal_render::world::World;

/// Of a row's largest channel: numbers are kept in 16 bits (`material/open_pbr/record.rs`).
const ROW: f64 = 5e-4;

/// Of the whole light, besides noise.
const ALBEDO: f64 = 2e-3;

/// Draws by which an albedo is estimated.
const DRAWS: u32 = 512;

/// A lobe of facets narrower than this is a delta lobe, or nearly: rows near its peak tell nothing.
const NARROW: f64 = 1e-3;

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().map_or(Vec::new(), |a| a.iter().filter_map(Value::as_f64).collect())
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or(0.0)
}

/// A world with the material.
fn world_of(parameters: &Value) -> World {
    let Value::Object(map) = parameters else { panic!("parameters are a mapping") };
    let said: Vec<String> = map.iter().map(|(key, v)| format!("{key}: {v}")).collect();
    let scene = format!(
        "camera: {{ perspective: {{ eye: [0, 0, 5], look_at: [0, 0, 0] }} }}\nmaterials:\n  m: {{ open_pbr: {{ {} }} }}\n\
         world:\n  - sphere: {{ material: m }}\n",
        said.join(", ")
    );
    let loaded = straal::load_str("test.yaml", &scene, Path::new(""), &LoadOptions::default());
    Job::new(loaded.unwrap_or_else(|d| panic!("{scene}\n{d}")), Overrides::default()).expect("a world").world
}

fn bsdf(world: &World) -> Bsdf<'_> {
    world.materials.bsdf(1, &ShadingPoint::NOWHERE, &world.reading(Rgb::default()))
}

/// How far off a material is.
#[derive(Default)]
struct Off {
    rows: usize,
    skipped: usize,
    /// Of the largest channel, beyond the reference's own rounding.
    worst_row: f64,
    sum_row: f64,
    worst_albedo: f64,
    faults: Vec<String>,
}

struct View<'a> {
    name: &'a str,
    wo: Vec3,
    /// Index beyond over before, by channel.
    eta: [f64; 3],
    /// Roughnesses, of base and coat.
    alphas: [f64; 2],
    has_coat: bool,
}

impl View<'_> {
    /// Whether a direction lies where a narrow lobe has its peak.
    fn is_near_peak(&self, wi: Vec3) -> bool {
        let passes = wi.z * self.wo.z < 0.0;
        let leans = |h: Vec3| {
            let h = h.normalize();
            (h.x * h.x + h.y * h.y).sqrt() < 0.1
        };
        let mirrored = Vec3::new(wi.x, wi.y, wi.z.abs().copysign(self.wo.z));
        let base = self.alphas[0] < NARROW;
        let coat = self.has_coat && self.alphas[1] < NARROW;
        let bent = || self.eta.iter().any(|eta| leans(self.wo + wi * *eta as f32));
        (base || coat) && leans(self.wo + mirrored) || passes && base && bent()
            // Light is hardly bent: however rough, the lobe is narrow.
            || passes && self.eta.iter().any(|eta| self.alphas[0] * (eta - 1.0).abs() < NARROW && leans_on(self.wo, wi))
    }
}

fn leans_on(wo: Vec3, wi: Vec3) -> bool {
    (wo + wi).length() < 0.1
}

fn rows(view: &View<'_>, bsdf: &Bsdf<'_>, rows: &Value, off: &mut Off) {
    for row in rows.as_array().into_iter().flatten().map(numbers) {
        let wi = Vec3::new(row[0] as f32, row[1] as f32, row[2] as f32);
        let dev = row[7];
        if dev > 0.05 || view.is_near_peak(wi) {
            off.skipped += 1;
            continue;
        }
        let got = bsdf.eval(view.wo, wi, Transport::Radiance).to_rgb();
        let most = row[3..6].iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        off.rows += 1;
        let mut worst = 0.0;
        for c in 0..3 {
            let by = if wi.z * view.wo.z < 0.0 { view.eta[c] * view.eta[c] } else { 1.0 };
            let apart = (f64::from(got[c]) * by - row[3 + c]).abs();
            let beyond = (apart - 1e-6 - 4.0 * dev * most) / most;
            if most > 0.0 && beyond > worst {
                worst = beyond;
            } else if most == 0.0 && apart > 1e-6 {
                worst = f64::INFINITY;
            }
        }
        off.sum_row += worst;
        if worst > off.worst_row {
            off.worst_row = worst;
        }
        if worst > ROW {
            off.faults.push(format!(
                "{} from {:?} to {wi:?}: {got:?}, want {:?}",
                view.name,
                view.wo,
                &row[3..6]
            ));
        }
    }
}

/// What is reflected and what passes, with the standard errors.
fn albedo(view: &View<'_>, bsdf: &Bsdf<'_>) -> [[[f64; 2]; 3]; 2] {
    let mut sums = [[[0.0; 2]; 3]; 2];
    for i in 0..DRAWS {
        let name = SampleName::new(3, [0, 0], i);
        let [u, v, lobe, _] = Pattern::Sobol.d4(&name, Purpose::Custom);
        let Some(s) = bsdf.sample(view.wo, lobe, [u, v], Transport::Radiance) else { continue };
        for (c, sum) in sums[usize::from(s.transmitted)].iter_mut().enumerate() {
            let by = if s.transmitted { view.eta[c] * view.eta[c] } else { 1.0 };
            let weight = f64::from(s.weight[c]) * by;
            sum[0] += weight;
            sum[1] += weight * weight;
        }
    }
    let n = f64::from(DRAWS);
    sums.map(|side| {
        side.map(|[sum, squares]| {
            let mean = sum / n;
            [mean, ((squares / n - mean * mean).abs() / n).sqrt()]
        })
    })
}

/// What is sent out, dimmed by coat and fuzz.
fn emission(view: &View<'_>, world: &World, want: &Value, off: &mut Off) {
    let (Some(material), want) = (world.materials.get(1), numbers(want)) else { return };
    let reading = world.reading(Rgb::default());
    let at = &ShadingPoint::NOWHERE;
    let got = material.emission().map_or(Light::ZERO, |e| {
        reading.eval(&e.radiance, at) * material.lets_out(view.wo.z.abs(), at, &reading)
    });
    for (c, want) in want.iter().enumerate() {
        if (f64::from(got[c]) - want).abs() > 1e-3 * want {
            off.faults.push(format!("{} from {:?} sends out {got:?}, want {want}", view.name, view.wo));
        }
    }
}

fn energies(view: &View<'_>, bsdf: &Bsdf<'_>, want: &Value, off: &mut Off) {
    for (side, got) in ["R", "T"].into_iter().zip(albedo(view, bsdf)) {
        let (energy, error) = (numbers(&want[side]), numbers(&want[&format!("{side}_se")]));
        for c in 0..3 {
            let [mean, own] = got[c];
            let beyond = (mean - energy[c]).abs() - 4.0 * error[c] - 4.5 * own;
            if beyond > off.worst_albedo {
                off.worst_albedo = beyond;
            }
            if beyond > ALBEDO {
                off.faults.push(format!(
                    "{} from {:?}: {side} of channel {c} is {mean}, want {}",
                    view.name, view.wo, energy[c]
                ));
            }
        }
    }
}

/// One material, by their default or by their switch for reciprocal coats and fuzz.
fn compare(material: &Value, reciprocal: bool) -> Off {
    let mut parameters = material["parameters"].clone();
    if reciprocal {
        parameters["reciprocal"] = Value::Bool(true);
    }
    let world = world_of(&parameters);
    let bsdf = bsdf(&world);
    let thin = parameters["geometry_thin_walled"] == Value::Bool(true);
    let outside = numbers(&material["eta"]);
    let mut off = Off::default();
    for view in material["views"].as_array().into_iter().flatten() {
        let wo = numbers(&view["wo"]);
        let inside = view["side"] == "inside";
        let eta = std::array::from_fn(|c| {
            if thin {
                1.0
            } else if inside {
                1.0 / outside[c]
            } else {
                outside[c]
            }
        });
        let name = material["name"].as_str().unwrap_or_default();
        let least =
            |key: &str| numbers(&material[key]).into_iter().fold(1.0, |a: f64, b| if b < a { b } else { a });
        let view_of = View {
            name,
            wo: Vec3::new(wo[0] as f32, wo[1] as f32, wo[2] as f32),
            eta,
            alphas: [least("alpha"), least("coat_alpha")],
            has_coat: number(&parameters["coat_weight"]) > 0.0,
        };
        if reciprocal {
            let mut given = view["rows"].clone();
            let other = &view["rows_reciprocal"];
            for (i, row) in given.as_array_mut().into_iter().flatten().enumerate() {
                for c in 0..3 {
                    row[3 + c] = other[i][c].clone();
                }
            }
            rows(&view_of, &bsdf, &given, &mut off);
        } else {
            rows(&view_of, &bsdf, &view["rows"], &mut off);
            energies(&view_of, &bsdf, &view["albedo"], &mut off);
            if !inside {
                emission(&view_of, &world, &view["emission"], &mut off);
            }
        }
    }
    off
}

/// What scatters beneath a surface is diffuse here, and a random walk there.
fn is_approximated(material: &Value) -> bool {
    let p = &material["parameters"];
    let share = number(&p["subsurface_weight"])
        * (1.0 - number(&p["transmission_weight"]))
        * (1.0 - number(&p["base_metalness"]));
    share > 0.0 && p["geometry_thin_walled"] != Value::Bool(true)
}

fn materials(shared: &Path) -> Vec<Value> {
    let mut files: Vec<_> = std::fs::read_dir(shared.join("reference/openpbr"))
        .expect("the folder")
        .map(|e| e.expect("an entry").path())
        .filter(|p| p.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    files.iter().map(|f| serde_json::from_slice(&std::fs::read(f).expect("a file")).expect("JSON")).collect()
}

#[test]
fn values_are_those_of_another_implementation() {
    let Some(shared) = shared() else { return };
    let report = std::env::var_os("STRAAL_REPORT").is_some();
    let mut faults = Vec::new();
    let mut told = vec![format!(
        "{:34} {:>5} {:>5} {:>9} {:>9} {:>9}",
        "material", "rows", "left", "worst row", "mean row", "albedo"
    )];
    for material in materials(&shared) {
        let name = material["name"].as_str().unwrap_or_default().to_owned();
        for reciprocal in [false, true] {
            if reciprocal && material["views"][0]["rows_reciprocal"].is_null() {
                continue;
            }
            let off = compare(&material, reciprocal);
            let approximated = is_approximated(&material);
            let mark = match (reciprocal, approximated) {
                (true, _) => " (reciprocal)",
                (_, true) => " (subsurface)",
                _ => "",
            };
            told.push(format!(
                "{:34} {:5} {:5} {:9.1e} {:9.1e} {:9.1e}",
                format!("{name}{mark}"),
                off.rows,
                off.skipped,
                off.worst_row,
                off.sum_row / off.rows.max(1) as f64,
                off.worst_albedo
            ));
            if !approximated {
                faults.extend(off.faults);
            }
        }
    }
    if report {
        use std::io::Write;
        let _ = writeln!(std::io::stdout(), "{}", told.join("\n"));
    }
    assert!(
        faults.is_empty(),
        "{} values are off, such as\n{}",
        faults.len(),
        faults[..faults.len().min(12)].join("\n")
    );
}

/// What fills bodies.
#[test]
fn interiors_are_those_of_another_implementation() {
    let Some(shared) = shared() else { return };
    for material in materials(&shared) {
        let world = world_of(&material["parameters"]);
        let Some(Material::OpenPbr(m)) = world.materials.get(1) else { panic!("not what was said") };
        let got = m.interior(&ShadingPoint::NOWHERE, &world.reading(Rgb::default()));
        let want = &material["volume"];
        let near = |got: Light, key: &str| {
            let want = numbers(&want[key]);
            (0..3).all(|c| (f64::from(got[c]) - want[c]).abs() <= 1e-4 * want[c].abs() + 1e-5)
        };
        assert!(
            near(got.extinction, "extinction")
                && near(got.albedo, "albedo")
                && (f64::from(got.anisotropy) - number(&want["anisotropy"])).abs() < 1e-5,
            "{}: {got:?}, want {want}",
            material["name"]
        );
    }
}
