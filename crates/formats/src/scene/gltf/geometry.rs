//! Primitives of meshes as triangles: attributes of any encoding, strips and fans, shapes that are mixed (morph targets), and what
//! follows a skeleton (skins).

use std::collections::BTreeMap;

use straal_math::{Affine, DVec3};
use straal_scene::Mesh;
use straal_scene::mesh::{Attribute, Per};

use super::accessor::Numbers;
use super::document::{Document, Fault, Result, required, size_or};
use super::json::Json;
use crate::Limits;

/// What a primitive is to be made with.
#[derive(Clone, Copy, Default)]
pub(super) struct Shape<'s> {
    /// How much of each morph target.
    pub weights: &'s [f64],
    /// Which set of texture coordinates is the mesh's own, by which it can shine.
    pub primary: usize,
    /// By which set of texture coordinates directions of the surface are told, where its material asks for them.
    pub directions: Option<usize>,
    /// From each joint's bind pose to where it is, if the mesh follows a skeleton.
    pub joints: Option<&'s [Affine]>,
}

/// What comes of a primitive.
pub(super) struct Made {
    pub mesh: Mesh,
    pub has_normals: bool,
    /// What is said of it, each a sentence without a full stop.
    pub notes: Vec<&'static str>,
}

/// The name of a set of texture coordinates among the attributes of a mesh that has another for its own, whose place the first takes.
pub(super) fn set_name(set: usize, primary: usize) -> String {
    format!("uv{}", if set == 0 { primary } else { set })
}

/// So many sets of texture coordinates are read.
pub(super) const SETS: usize = 8;

/// How its indices make a primitive's triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Triangles,
    Strip,
    Fan,
}

impl Mode {
    /// That of a primitive; none of points and lines, of which the name is given.
    pub fn of(primitive: &Json) -> Result<std::result::Result<Self, &'static str>> {
        Ok(match size_or(primitive, "mode", 4)? {
            0 => Err("points"),
            1..=3 => Err("lines"),
            4 => Ok(Self::Triangles),
            5 => Ok(Self::Strip),
            6 => Ok(Self::Fan),
            other => {
                let at = primitive.get("mode").unwrap_or(primitive);
                return Err(Fault::of(at, format!("{other} is no mode of a primitive: 0 to 6 are")));
            }
        })
    }

    /// The triangles that vertices in this order make.
    fn triangles(self, order: &[u32]) -> Vec<[u32; 3]> {
        match self {
            Self::Triangles => order.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            // Every other triangle is turned, so that all face the same way.
            Self::Strip => {
                let turned = |(i, t): (usize, &[u32])| {
                    if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] }
                };
                order.windows(3).enumerate().map(turned).collect()
            }
            Self::Fan => {
                let hub = order.first().copied().unwrap_or(0);
                order.windows(2).skip(1).map(|pair| [pair[0], pair[1], hub]).collect()
            }
        }
    }
}

/// Where the attributes of a primitive come from.
struct Columns<'d, 'a> {
    document: &'d mut Document<'a>,
    attributes: &'d Json,
    /// Those that were packed together (Draco).
    unpacked: BTreeMap<String, Numbers>,
    /// How many vertices there are, when it is known.
    count: Option<usize>,
}

impl Columns<'_, '_> {
    /// An attribute, if there is one of that name.
    fn numbers(&mut self, name: &str) -> Result<Option<Numbers>> {
        let Some(at) = self.attributes.get(name) else { return Ok(None) };
        let numbers = match self.unpacked.remove(name) {
            Some(numbers) => numbers,
            None => self.document.numbers(at)?,
        };
        let count = *self.count.get_or_insert(numbers.count());
        if numbers.count() != count {
            let message = format!("there are {} of them, and {count} positions", numbers.count());
            return Err(Fault::of(at, message));
        }
        Ok(Some(numbers))
    }

    /// An attribute of so many numbers a vertex; empty where there is none.
    fn lists<const N: usize>(&mut self, name: &str) -> Result<Vec<[f32; N]>> {
        let Some(numbers) = self.numbers(name)? else { return Ok(Vec::new()) };
        let has = numbers.channels;
        let at = self.attributes.get(name).unwrap_or(self.attributes);
        numbers
            .lists()
            .ok_or_else(|| Fault::of(at, format!("{N} numbers a vertex are wanted, these are {has}")))
    }
}

/// The triangles of a primitive.
pub(super) fn read(
    document: &mut Document<'_>,
    primitive: &Json,
    mode: Mode,
    shape: Shape<'_>,
    limits: &Limits,
) -> Result<Made> {
    let attributes = required(primitive, "attributes")?;
    let mut notes = Vec::new();
    let (unpacked, packed_order) = match primitive.extension("KHR_draco_mesh_compression") {
        Some(draco) => {
            let (columns, order) = super::draco::read(document, attributes, draco, limits)?;
            (columns, Some(order))
        }
        None => (BTreeMap::new(), None),
    };
    let mut columns = Columns { document: &mut *document, attributes, unpacked, count: None };
    let mut positions = columns.lists::<3>("POSITION")?;
    let vertices = positions.len();
    check(primitive, "vertices", vertices, limits.max_vertices)?;
    let mut normals = columns.lists::<3>("NORMAL")?;
    // Without normals faces are flat, and tangents are passed over.
    let told = shape.directions.filter(|_| !normals.is_empty());
    let mut tangents = if told.is_some() { columns.lists::<4>("TANGENT")? } else { Vec::new() };
    let mut sets = Vec::new();
    for set in 0..SETS {
        sets.push(columns.lists::<2>(&format!("TEXCOORD_{set}"))?);
    }
    let mut colours = columns.numbers("COLOR_0")?;
    if let Some(wrong) = colours.as_ref().filter(|c| !matches!(c.channels, 3 | 4)) {
        let at = attributes.get("COLOR_0").unwrap_or(attributes);
        return Err(Fault::of(at, format!("a colour has 3 or 4 numbers, these have {}", wrong.channels)));
    }
    let skin = match shape.joints {
        Some(joints) => Some((joints, influences(&mut columns)?)),
        None => None,
    };

    let targets = primitive.get("targets").map_or(&[][..], |targets| targets.items());
    for (target, &weight) in targets.iter().zip(shape.weights).filter(|(_, weight)| **weight != 0.0) {
        let mut target = Columns {
            document: &mut *document,
            attributes: target,
            unpacked: BTreeMap::new(),
            count: Some(vertices),
        };
        add(&mut positions, &target.lists("POSITION")?, weight);
        add(&mut normals, &target.lists("NORMAL")?, weight);
        if !tangents.is_empty() {
            // What is added has no side.
            let more: Vec<[f32; 3]> = target.lists("TANGENT")?;
            let pairs = tangents.iter_mut().zip(&more);
            pairs.for_each(|(to, more)| (0..3).for_each(|k| to[k] += weight as f32 * more[k]));
        }
        for (set, coordinates) in sets.iter_mut().enumerate().filter(|(_, c)| !c.is_empty()) {
            add(coordinates, &target.lists(&format!("TEXCOORD_{set}"))?, weight);
        }
        if let (Some(colours), Some(more)) = (&mut colours, target.numbers("COLOR_0")?)
            && more.channels == colours.channels
        {
            let pairs = colours.values.iter_mut().zip(&more.values);
            pairs.for_each(|(to, more)| *to += weight as f32 * more);
        }
    }
    if let Some((joints, influences)) = skin {
        follow([&mut positions, &mut normals], &mut tangents, joints, &influences);
    }

    let order = match (packed_order, primitive.get("indices")) {
        (Some(order), _) => order,
        (None, Some(at)) => document.indices(at)?,
        (None, None) => (0..vertices as u32).collect(),
    };
    if let Some(beyond) = order.iter().find(|&&i| i as usize >= vertices) {
        let at = primitive.get("indices").unwrap_or(primitive);
        return Err(Fault::of(at, format!("one of them is {beyond}, and there are {vertices} vertices")));
    }
    if mode == Mode::Triangles && order.len() % 3 != 0 {
        notes.push("the last vertices make no triangle: their number is no multiple of 3");
    }
    let triangles = mode.triangles(&order);
    check(primitive, "triangles", triangles.len(), limits.max_triangles)?;

    // The first row of a picture is at v = 0 in glTF, and at v = 1 here.
    sets.iter_mut().flatten().for_each(|uv| uv[1] = 1.0 - uv[1]);
    let mut mesh = Mesh { positions, normals, triangles, tangents, ..Mesh::default() };
    for (set, coordinates) in sets.into_iter().enumerate().filter(|(_, c)| !c.is_empty()) {
        if set == shape.primary {
            mesh.uvs = coordinates;
            continue;
        }
        let values = coordinates.into_flattened();
        mesh.attributes.push(Attribute {
            name: set_name(set, shape.primary),
            per: Per::Vertex,
            channels: 2,
            is_code: false,
            values,
        });
    }
    if let Some(Numbers { channels, mut values }) = colours {
        values.iter_mut().for_each(|v| *v = if *v > 0.0 { if *v < 1.0 { *v } else { 1.0 } } else { 0.0 });
        let name = "color".to_owned();
        mesh.attributes.push(Attribute { name, per: Per::Vertex, channels, is_code: false, values });
    }
    if let Some(set) = told.filter(|_| mesh.tangents.is_empty()) {
        super::tangents::make(&mut mesh, set, shape.primary, limits.max_vertices);
    }
    let has_normals = !mesh.normals.is_empty();
    Ok(Made { mesh, has_normals, notes })
}

fn check(at: &Json, what: &str, count: usize, most: u64) -> Result<()> {
    if count as u64 <= most {
        Ok(())
    } else {
        Err(Fault::of(at, format!("too many {what}: {count}, the limit is {most}")))
    }
}

/// Adds a share of something to each.
fn add<const N: usize>(to: &mut [[f32; N]], what: &[[f32; N]], weight: f64) {
    for (v, more) in to.as_flattened_mut().iter_mut().zip(what.as_flattened()) {
        *v += weight as f32 * more;
    }
}

/// Four joints of each vertex, and how much it follows each.
type Influence = (Vec<[f32; 4]>, Vec<[f32; 4]>);

/// Which joints each vertex follows, and how much: four or more of each.
fn influences(columns: &mut Columns<'_, '_>) -> Result<Vec<Influence>> {
    let mut sets = Vec::new();
    for set in 0..SETS {
        let [joints, weights] = ["JOINTS", "WEIGHTS"].map(|of| columns.lists::<4>(&format!("{of}_{set}")));
        let (joints, weights) = (joints?, weights?);
        if !joints.is_empty() && !weights.is_empty() {
            sets.push((joints, weights));
        }
    }
    Ok(sets)
}

/// Moves vertices with the joints that they follow.
fn follow(
    [positions, normals]: [&mut Vec<[f32; 3]>; 2],
    tangents: &mut [[f32; 4]],
    joints: &[Affine],
    influences: &[Influence],
) {
    if influences.is_empty() {
        return;
    }
    for i in 0..positions.len() {
        let mut sum = Affine { rows: [[0.0; 4]; 3] };
        let mut all = 0.0;
        for (which, shares) in influences {
            for (joint, share) in which[i].iter().zip(shares[i]) {
                let share = f64::from(share);
                let Some(joint) = joints.get(*joint as usize).filter(|_| share > 0.0) else { continue };
                all += share;
                let pairs = sum.rows.as_flattened_mut().iter_mut().zip(joint.rows.as_flattened());
                pairs.for_each(|(to, v)| *to += share * v);
            }
        }
        if all <= 0.0 {
            continue;
        }
        sum.rows.as_flattened_mut().iter_mut().for_each(|v| *v /= all);
        let double = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        positions[i] = sum.point(double(positions[i])).to_array().map(|v| v as f32);
        if let Some([x, y, z, _]) = tangents.get_mut(i) {
            let along = sum.vector(double([*x, *y, *z]));
            [*x, *y, *z] = along.to_array().map(|v| v as f32);
        }
        if let Some(normal) = normals.get_mut(i) {
            let n = double(*normal);
            let moved = sum.inverse().map_or_else(|| sum.vector(n), |inverse| inverse.normal_by_inverse(n));
            *normal = moved.try_normalize().unwrap_or(n).to_array().map(|v| v as f32);
        }
    }
}

/// Whether triangles have an edge without a neighbour that faces the same way: so that the backs of some can be seen from outside.
pub(super) fn is_open(mesh: &Mesh) -> bool {
    let place = |i: u32| mesh.positions[i as usize].map(|v| (v + 0.0).to_bits());
    // Vertices at the same place are one.
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.sort_unstable_by_key(|&i| place(i));
    let mut one = vec![0; order.len()];
    for pair in order.windows(2) {
        one[pair[1] as usize] = one[pair[0] as usize] + u32::from(place(pair[0]) != place(pair[1]));
    }
    let mut edges: Vec<(u32, u32, bool)> = Vec::new();
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| one[i as usize]);
        let ends = [(a, b), (b, c), (c, a)].into_iter().filter(|(a, b)| a != b);
        edges.extend(ends.map(|(a, b)| if a < b { (a, b, true) } else { (b, a, false) }));
    }
    edges.sort_unstable();
    let balance = |run: &[(u32, u32, bool)]| 2 * run.iter().filter(|edge| edge.2).count() == run.len();
    !edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)).all(balance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_mesh_has_each_edge_both_ways() {
        let positions =
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-0.0, 0.0, 0.0]];
        let triangles = vec![[0, 2, 1], [4, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mut mesh = Mesh { positions, triangles, ..Mesh::default() };
        assert!(!is_open(&mesh));
        mesh.triangles[0] = [0, 1, 2];
        assert!(is_open(&mesh));
        mesh.triangles.remove(0);
        assert!(is_open(&mesh) && !is_open(&Mesh::default()));
    }

    #[test]
    fn strips_and_fans_face_one_way() {
        let order = [0, 1, 2, 3, 4];
        assert_eq!(Mode::Strip.triangles(&order), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(Mode::Fan.triangles(&order), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        assert_eq!(Mode::Triangles.triangles(&order), [[0, 1, 2]]);
        for mode in [Mode::Triangles, Mode::Strip, Mode::Fan] {
            assert!(mode.triangles(&[7, 8]).is_empty() && mode.triangles(&[]).is_empty());
        }
    }

    #[test]
    fn vertices_move_with_the_mean_of_their_joints() {
        let joints = [Affine::IDENTITY, Affine::translate(DVec3::new(0.0, 2.0, 0.0))];
        let mut positions = vec![[1.0, 0.0, 0.0]; 3];
        let mut normals = vec![[1.0, 0.0, 0.0]; 3];
        let which = vec![[0.0, 1.0, 9.0, 0.0]; 3];
        let shares = vec![[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [0.0; 4]];
        let mut tangents = [[0.0, 0.0, 2.0, -1.0]; 3];
        follow([&mut positions, &mut normals], &mut tangents, &joints, &[(which, shares)]);
        assert_eq!(tangents, [[0.0, 0.0, 2.0, -1.0]; 3]);
        assert_eq!(positions, [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
        assert_eq!(normals, [[1.0, 0.0, 0.0]; 3]);
    }
}
