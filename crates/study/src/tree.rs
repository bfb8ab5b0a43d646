//! The tree of a scene as text: what stands where, by which steps, and what they do to points.

use std::fmt::Write;

use straal_math::{Affine, DVec3};
use straal_scene::Scene;
use straal_scene::desc::{MaterialRef, Node, Step, Transform};

/// What is shown of each node besides what it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Show {
    /// The matrix of each step and of all together, from the node's own coordinates to the world's, its inverse, and the matrix of
    /// normals.
    pub matrices: bool,
    /// Its points after each step, in the world, and as the camera sees them: x to the right, y up, looking along -z.
    pub points: bool,
}

/// Most points of a node that are shown.
const MOST_POINTS: usize = 8;

/// The tree as text, a line for each node, indented by how deep it is. Objects come after the world, in coordinates of their own.
pub fn tree(scene: &Scene, show: Show) -> String {
    let o = scene.camera.observer();
    let view = Affine::look_at(o.eye, o.look_at, o.up);
    let mut out =
        format!("camera {} at {}, looks at {}\n", scene.camera.kind(), vector(o.eye), vector(o.look_at));
    let seen = view.as_ref().and_then(Affine::inverse);
    if let (true, Some(seen)) = (show.matrices, &seen) {
        matrix(&mut out, 1, "from the world to the camera", seen);
    }
    let mut walk = Walk { out, show, seen };
    walk.out.push_str("world\n");
    for node in &scene.world {
        walk.node(node, 1, &Affine::IDENTITY, "in the world");
    }
    // What an object looks like to the camera depends on who shows it.
    walk.seen = None;
    for (name, node) in scene.objects.iter() {
        let _ = writeln!(walk.out, "object {}", name.value);
        walk.node(node, 1, &Affine::IDENTITY, "in the object");
    }
    walk.out
}

struct Walk {
    out: String,
    show: Show,
    /// From the world to the camera.
    seen: Option<Affine>,
}

impl Walk {
    fn node(&mut self, node: &Node, depth: usize, outer: &Affine, outside: &str) {
        let indent = "  ".repeat(depth);
        let mut line = format!("{indent}{}", node.kind());
        match node {
            Node::Instance(i) => line += &format!(" of {}", i.of.name.value),
            Node::Instances(i) => line += &format!(" of {}, {}", i.of.name.value, i.transforms.len()),
            _ => {}
        }
        if let Some(name) = node.name() {
            let _ = write!(line, " \"{}\"", name.value);
        }
        match node.material() {
            Some(MaterialRef::Named(link)) => {
                let _ = write!(line, ", material {}", link.name.value);
            }
            Some(MaterialRef::Inline(material)) => {
                let _ = write!(line, ", {}", material.kind());
            }
            None => {}
        }
        let _ = writeln!(self.out, "{line}");
        let own = node.placement();
        let steps = steps(node.transform(), own.as_ref());
        for (i, (told, step)) in steps.iter().enumerate() {
            let _ = writeln!(self.out, "{indent}  {}. {told}", i + 1);
            if self.show.matrices {
                rows(&mut self.out, depth + 2, step);
            }
        }
        let Some(all) = own.map(|own| own.then(outer)) else { return };
        if self.show.matrices && !all.is_identity() {
            matrix(&mut self.out, depth + 1, &format!("all together, {outside}"), &all);
            if let Some(inverse) = all.inverse() {
                matrix(&mut self.out, depth + 1, "and back", &inverse);
                let normals =
                    |i: usize| std::array::from_fn(|j| if j == 3 { 0.0 } else { inverse.rows[j][i] });
                let normals = Affine { rows: std::array::from_fn(normals) };
                matrix(&mut self.out, depth + 1, "of normals: the inverse, transposed", &normals);
            }
        }
        if self.show.points {
            self.points(node, depth + 1, &steps, (outer, outside));
        }
        for child in node.children() {
            self.node(child, depth + 1, &all, outside);
        }
    }

    fn points(
        &mut self,
        node: &Node,
        depth: usize,
        steps: &[(String, Affine)],
        (outer, outside): (&Affine, &str),
    ) {
        let indent = "  ".repeat(depth);
        let (points, left) = points_of(node);
        for (name, p) in points {
            let _ = write!(self.out, "{indent}{name} {}", vector(p));
            let mut at = p;
            for (i, (_, step)) in steps.iter().enumerate() {
                at = step.point(at);
                let _ = write!(self.out, ", after {}: {}", i + 1, vector(at));
            }
            let world = outer.point(at);
            if world != at {
                let _ = write!(self.out, ", {outside}: {}", vector(world));
            }
            if let Some(seen) = &self.seen {
                let _ = write!(self.out, ", seen: {}", vector(seen.point(world)));
            }
            self.out.push('\n');
        }
        if left > 0 {
            let _ = writeln!(self.out, "{indent}and {left} points more");
        }
    }
}

/// The steps of a transform as text and as maps; the last is the turn towards what is looked at, if there is one.
fn steps(transform: &Transform, all: Option<&Affine>) -> Vec<(String, Affine)> {
    let mut out: Vec<_> =
        transform.steps.iter().filter_map(|step| Some((told(step), step.affine()?))).collect();
    let by_steps = out.iter().fold(Affine::IDENTITY, |all, (_, step)| all.then(step));
    if let Some(all) = all.filter(|all| **all != by_steps)
        && let Some(back) = by_steps.inverse()
    {
        out.push(("turn to what it looks at".to_owned(), back.then(all)));
    }
    out
}

fn told(step: &Step) -> String {
    match step {
        Step::Translate(v) => format!("translate {}", vector(*v)),
        Step::Rotate(r) => format!("rotate {} degrees about {}", number(r.degrees), axis(r.axis.0)),
        Step::Scale(f) => format!("scale {}", vector(f.0)),
        Step::Shear(s) => {
            let [x, y] = [s.axis.kind(), s.by.kind()];
            format!("shear {x} by {} times {y}", number(s.factor))
        }
        Step::Reflect(r) => format!("reflect across {}, at {}", axis(r.normal.0), vector(r.point)),
        Step::LookAt(v) => format!("look from {} at {}", vector(v.eye), vector(v.target)),
        Step::Matrix(_) => "matrix".to_owned(),
    }
}

fn axis(v: DVec3) -> String {
    match [DVec3::X, DVec3::Y, DVec3::Z].iter().position(|a| *a == v) {
        Some(i) => ["x", "y", "z"][i].to_owned(),
        None => vector(v),
    }
}

fn matrix(out: &mut String, depth: usize, name: &str, m: &Affine) {
    let _ = writeln!(out, "{}{name}:", "  ".repeat(depth));
    rows(out, depth + 1, m);
}

/// As a homogeneous matrix of four rows, its columns in line.
fn rows(out: &mut String, depth: usize, m: &Affine) {
    let cells: Vec<[String; 4]> =
        m.rows.iter().chain([&[0.0, 0.0, 0.0, 1.0]]).map(|row| row.map(number)).collect();
    let widths: [usize; 4] = std::array::from_fn(|j| cells.iter().map(|row| row[j].len()).max().unwrap_or(0));
    for row in &cells {
        let line: Vec<String> = row.iter().zip(widths).map(|(cell, w)| format!("{cell:>w$}")).collect();
        let _ = writeln!(out, "{}| {} |", "  ".repeat(depth), line.join("  "));
    }
}

/// To five places after the point, without zeros at the end.
fn number(x: f64) -> String {
    let text = format!("{x:.5}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn vector(v: DVec3) -> String {
    let [x, y, z] = v.to_array().map(number);
    format!("[{x}, {y}, {z}]")
}

/// The points by which a node is told, with what each is; and how many more there are.
fn points_of(node: &Node) -> (Vec<(String, DVec3)>, usize) {
    let named =
        |all: &[(&str, DVec3)]| all.iter().map(|(name, p)| ((*name).to_owned(), *p)).collect::<Vec<_>>();
    let listed = |name: &str, all: &[DVec3]| {
        let shown = all.iter().take(MOST_POINTS).map(|p| (name.to_owned(), *p)).collect::<Vec<_>>();
        (shown, all.len().saturating_sub(MOST_POINTS))
    };
    let points = match node {
        Node::Group(_) | Node::Instance(_) | Node::Instances(_) => named(&[("origin", DVec3::ZERO)]),
        Node::Sphere(s) => named(&[("center", s.center), ("top", s.center + DVec3::Y * s.radius)]),
        Node::Plane(s) => named(&[("point", s.point)]),
        Node::Disc(s) => named(&[("center", s.center)]),
        Node::Annulus(s) => named(&[("center", s.center)]),
        Node::Torus(s) => named(&[("center", s.center)]),
        Node::Rectangle(s) => {
            let ([a, b], c) = (s.edges, s.corner);
            named(&[("corner", c), ("corner", c + a), ("corner", c + a + b), ("corner", c + b)])
        }
        Node::Box(s) => {
            let corner = |i: usize| {
                let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
                DVec3::new(pick(0, s.min.x, s.max.x), pick(1, s.min.y, s.max.y), pick(2, s.min.z, s.max.z))
            };
            (0..8).map(|i| ("corner".to_owned(), corner(i))).collect()
        }
        Node::Cylinder(s) => named(&[("from", s.from), ("to", s.to)]),
        Node::Cone(s) => named(&[("from", s.from), ("to", s.to)]),
        Node::Paraboloid(s) => named(&[("from", s.from), ("to", s.to)]),
        Node::Capsule(s) => named(&[("from", s.from), ("to", s.to)]),
        Node::Hyperboloid(s) => named(&[("from", s.line[0]), ("to", s.line[1])]),
        Node::Triangle(s) => return listed("corner", &s.vertices),
        Node::Bilinear(s) => return listed("corner", &s.corners),
        Node::Mesh(m) => return listed("vertex", &m.positions),
        Node::Bezier(b) => return listed("point", &b.points),
        Node::Curves(c) => return listed("point", &c.points),
        Node::HeightField(_)
        | Node::Union(_)
        | Node::Intersection(_)
        | Node::Difference(_)
        | Node::DistanceField(_) => named(&[("origin", DVec3::ZERO)]),
    };
    (points, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(text: &str) -> Scene {
        let loaded = straal::load_str("it", text, std::path::Path::new(""), &straal::LoadOptions::default());
        let loaded = loaded.unwrap_or_else(|d| panic!("{d:?}"));
        loaded.scene
    }

    /// The exercise of the lesson on transformations: each step by hand, then as the tree shows it.
    #[test]
    fn the_exercise_of_the_course() {
        let text = "
camera: { perspective: { eye: [5, 0, 0], look_at: [0, 0, 0], up: [0, 0, 1], fov: 40 } }
world:
  - triangle:
      vertices: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
      transform:
        - scale: [1.4142135623730951, 1.4142135623730951, 1]
        - rotate: { z: 45 }
        - translate: [1, -1, 1]
";
        let scene = scene(text);
        let told = tree(&scene, Show { matrices: true, points: true });
        // S = diag(sqrt 2, sqrt 2, 1); R turns by 45 degrees, so that R S has 1, -1, 1, 1 in its corner; T adds (1, -1, 1). The camera
        // at (5, 0, 0) that looks along -x, z up, has y to its right.
        let want = "\
camera perspective at [5, 0, 0], looks at [0, 0, 0]
  from the world to the camera:
    | 0  1  0   0 |
    | 0  0  1   0 |
    | 1  0  0  -5 |
    | 0  0  0   1 |
world
  triangle
    1. scale [1.41421, 1.41421, 1]
      | 1.41421        0  0  0 |
      |       0  1.41421  0  0 |
      |       0        0  1  0 |
      |       0        0  0  1 |
    2. rotate 45 degrees about z
      | 0.70711  -0.70711  0  0 |
      | 0.70711   0.70711  0  0 |
      |       0         0  1  0 |
      |       0         0  0  1 |
    3. translate [1, -1, 1]
      | 1  0  0   1 |
      | 0  1  0  -1 |
      | 0  0  1   1 |
      | 0  0  0   1 |
    all together, in the world:
      | 1  -1  0   1 |
      | 1   1  0  -1 |
      | 0   0  1   1 |
      | 0   0  0   1 |
    and back:
      |  0.5  0.5  0   0 |
      | -0.5  0.5  0   1 |
      |    0    0  1  -1 |
      |    0    0  0   1 |
    of normals: the inverse, transposed:
      | 0.5  -0.5  0  0 |
      | 0.5   0.5  0  0 |
      |   0     0  1  0 |
      |   0     0  0  1 |
    corner [1, 0, 0], after 1: [1.41421, 0, 0], after 2: [1, 1, 0], after 3: [2, 0, 1], seen: [0, 1, -3]
    corner [0, 1, 0], after 1: [0, 1.41421, 0], after 2: [-1, 1, 0], after 3: [0, 0, 1], seen: [0, 1, -5]
    corner [0, 0, 1], after 1: [0, 0, 1], after 2: [0, 0, 1], after 3: [1, -1, 2], seen: [-1, 2, -4]
";
        assert_eq!(told, want);
    }

    #[test]
    fn groups_instances_and_objects_are_told_apart() {
        let text = "
camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0], fov: 40 } }
materials: { red: { diffuse: { reflectance: [0.5, 0.1, 0.1] } } }
objects:
  wheel: { torus: { radius: 1, tube_radius: 0.1 } }
  axle: { group: { children: [ { instance: { of: wheel, transform: [ { translate: [0, 0, 1] } ] } } ] } }
world:
  - group:
      name: car
      material: red
      transform: [ { translate: [2, 0, 0] } ]
      children:
        - instance: { of: axle }
        - sphere: { center: [0, 1, 0], radius: 0.5, material: red }
";
        let told = tree(&scene(text), Show { points: true, ..Show::default() });
        for line in [
            "  group \"car\", material red",
            "    instance of axle",
            "    sphere, material red",
            "      center [0, 1, 0], in the world: [2, 1, 0], seen: [2, 1, -5]",
            "object wheel",
            "  torus",
            "    instance of wheel",
        ] {
            assert!(told.lines().any(|l| l == line), "no {line:?} in\n{told}");
        }
    }
}
