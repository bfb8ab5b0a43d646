//! Shading normals that lean: no light comes through what is opaque, and smooth balls of few triangles have no black rims.

use straal::{Control, Job, LoadOptions, Overrides, Picture};

fn render(text: &str) -> Picture {
    let loaded = straal::load_str("leaning.yaml", text, std::path::Path::new(""), &LoadOptions::default())
        .expect(text);
    let job = Job::new(loaded, Overrides { threads: Some(2), ..Overrides::default() }).expect("a job");
    job.render(&mut Control::to_the_end()).expect("a picture").picture
}

/// A quad in the plane z = 0, its normals leaning by 53 degrees, seen from +z.
fn quad(material: &str, light: &str) -> String {
    format!(
        "camera: {{ orthographic: {{ eye: [0, 0, 5], look_at: [0, 0, 0], width: 1.8 }} }}
film: {{ size: [8, 8] }}
sampler: {{ spp: 64 }}
world:
  - mesh:
      positions: [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
      normals: [[0.8, 0, 0.6], [0.8, 0, 0.6], [0.8, 0, 0.6], [0.8, 0, 0.6]]
      triangles: [[0, 1, 2], [0, 2, 3]]
      material: {material}
lights:
  - {light}
"
    )
}

#[test]
fn lamps_behind_a_surface_do_not_light_it() {
    let lamps = [
        "directional: { direction: [-1, 0, 0.2], irradiance: 3.14159265 }",
        "point: { position: [3, 0, -0.5], intensity: 10 }",
        "spot: { position: [3, 0, -0.5], look_at: [0, 0, 0], intensity: 10, cutoff: 40 }",
    ];
    for material in ["{ diffuse: { reflectance: 0.8 } }", "{ conductor: { eta: 0, k: 1, roughness: 0.5 } }"] {
        for lamp in lamps {
            let dark = render(&quad(material, lamp));
            assert!(dark.layers.rgb.iter().flatten().all(|v| *v == 0.0), "{material} {lamp}");
        }
    }
    // And one in front does, as the shading normal says: 0.8 / pi E cos.
    let lit = render(&quad(
        "{ diffuse: { reflectance: 0.8 } }",
        "directional: { direction: [0, 0, -1], irradiance: 3.14159265 }",
    ));
    let want = 0.8 * 0.6;
    assert!(lit.layers.rgb.iter().flatten().all(|v| (v - want).abs() < 1e-4), "{:?}", lit.layers.rgb[0]);
}

/// An icosahedron.
fn mesh(shading: &str, material: &str) -> String {
    let g = 0.525_731_1;
    let l = 0.850_650_8;
    let mut corners = Vec::new();
    for (a, b) in [(g, l), (g, -l), (-g, l), (-g, -l)] {
        corners.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]]);
    }
    // Its edges are the pairs at the least distance, its triangles what three edges close.
    let near = |a: usize, b: usize| {
        let square: f64 =
            (0..3).map(|c| (corners[a][c] - corners[b][c]) * (corners[a][c] - corners[b][c])).sum();
        square < 1.2
    };
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let [p, q, r] = [a, b, c].map(|i| corners[i]);
                    let [u, v]: [[f64; 3]; 2] = [q, r].map(|x| std::array::from_fn(|i| x[i] - p[i]));
                    let out = p[0] * (u[1] * v[2] - u[2] * v[1])
                        + p[1] * (u[2] * v[0] - u[0] * v[2])
                        + p[2] * (u[0] * v[1] - u[1] * v[0]);
                    triangles.push(if out > 0.0 { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    format!(
        "mesh: {{ positions: {corners:?}, triangles: {triangles:?}, shading: {shading}, material: {material} }}"
    )
}

/// One under an even sky.
fn ball(shading: &str, material: &str) -> String {
    let mesh = mesh(shading, material);
    format!(
        "camera: {{ perspective: {{ eye: [0.3, 0.2, 2.6], look_at: [0, 0, 0], fov: 50 }} }}
film: {{ size: [60, 60], filter: {{ box: {{}} }} }}
sampler: {{ spp: 256 }}
world:
  - {mesh}
lights:
  - environment: {{ radiance: 1 }}
"
    )
}

/// A ball of 20 triangles in the light of a lamp to its left, or a true one.
fn beside_a_lamp(shape: &str) -> Picture {
    render(&format!(
        "camera: {{ orthographic: {{ eye: [0, 0, 5], look_at: [0, 0, 0], width: 1.2 }} }}
film: {{ size: [24, 24], filter: {{ box: {{}} }} }}
sampler: {{ spp: 16 }}
world:
  - {shape}
lights:
  - directional: {{ direction: [1, 0.3, -0.2], irradiance: 3.14159265 }}
"
    ))
}

#[test]
fn shadow_begins_on_a_coarse_ball_where_it_does_on_a_round_one() {
    let material = "{ diffuse: { reflectance: 1 } }";
    let [few, steps] =
        ["smooth", "{ smooth: { rays: faces } }"].map(|shading| beside_a_lamp(&mesh(shading, material)));
    let round = beside_a_lamp(&format!("sphere: {{ material: {material} }}"));
    let far = |picture: &Picture| {
        let pairs = picture.layers.rgb.iter().zip(&round.layers.rgb);
        pairs.fold(0.0, |far, (a, b)| straal_math::ops::max(far, (a[0] - b[0]).abs()))
    };
    // The normals between the corners of 20 triangles are those of a ball within some degrees.
    assert!(far(&few) < 0.15, "{}", far(&few));
    assert!(far(&steps) > 0.22, "{}", far(&steps));
}

/// Gouraud's colours are those of the corners, and lie between them as planes do.
#[test]
fn colours_at_vertices_are_interpolated() {
    let picture = render(
        "camera: { orthographic: { eye: [0, 0, 5], look_at: [0, 0, 0], width: 1.6 } }
film: { size: [8, 8], filter: { box: {} } }
sampler: { spp: 256 }
integrator: { path: { max_depth: 2 } }
world:
  - mesh:
      positions: [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
      normals: [[0.8, 0, 0.6], [0, 0, 1], [0, 0, 1], [0.8, 0, 0.6]]
      triangles: [[0, 1, 2], [0, 2, 3]]
      shading: gouraud
      material: { diffuse: { reflectance: 1 } }
lights:
  - directional: { direction: [0, 0, -1], irradiance: 3.14159265 }
",
    );
    for (i, got) in picture.layers.rgb.iter().enumerate() {
        // Half way across a pixel; colours are 0.6 at the left and 1 at the right.
        let want = 0.8 + 0.2 * (-0.7 + 0.2 * (i % 8) as f32);
        assert!((got[0] - want).abs() < 0.02, "{i}: {got:?}, not {want}");
    }
}

#[test]
fn smooth_balls_of_few_triangles_have_no_black_rims() {
    for material in [
        "{ conductor: { metal: gold, roughness: 0.3 } }",
        "{ conductor: { metal: gold, roughness: 0.05 } }",
        "{ conductor: { metal: gold } }",
        "{ diffuse: { reflectance: 1 } }",
    ] {
        let [flat, smooth] = ["flat", "smooth"].map(|shading| render(&ball(shading, material)).layers);
        let mut worst = (f32::INFINITY, 0);
        for (i, (f, s)) in flat.rgb.iter().zip(&smooth.rgb).enumerate() {
            let ratio = s[0] / f[0];
            if ratio < worst.0 {
                worst = (ratio, i);
            }
        }
        let (ratio, i) = worst;
        assert!(ratio > 0.9, "{material}: {:?} for {:?} at {i}", smooth.rgb[i], flat.rgb[i]);
    }
}
