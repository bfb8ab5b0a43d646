//! The tree of nodes: which are in the scene, where each stands, and that none is within itself.

use std::collections::BTreeMap;

use straal_math::{Affine, DVec3};
use straal_scene::desc::{Step, Transform};
use straal_scene::value::{Factors, Matrix};

use super::animation::Pose;
use super::document::{Document, Fault, Result, flag, in_list, size, vector};
use super::json::Json;

/// The nodes of a file.
pub(super) struct Tree<'a> {
    pub nodes: &'a [Json],
    /// What moves of them, at the frame that is shown.
    pub poses: BTreeMap<usize, Pose>,
    /// Of each node, the one that it is a child of.
    pub parents: Vec<Option<usize>>,
    /// Where each stands in the world; of nodes that no root leads to, nothing.
    pub globals: Vec<Option<Affine>>,
    /// How many nodes each is within.
    depths: Vec<usize>,
    /// Those that the scene shows, each before its children.
    pub shown: Vec<usize>,
}

/// Groups are within one another so deep at most; deeper nodes stand in the last of them, where they are.
pub(super) const DEEPEST: usize = 64;

impl<'a> Tree<'a> {
    /// The tree of a document; `scene` is the one that is shown, or all roots where there is none.
    pub fn of(
        document: &Document<'a>,
        scene: Option<&'a Json>,
        poses: BTreeMap<usize, Pose>,
    ) -> Result<Self> {
        let nodes = document.list("nodes");
        let mut parents = vec![None; nodes.len()];
        for (i, node) in nodes.iter().enumerate() {
            for at in children(node) {
                let (child, _) = in_list("nodes", nodes, at)?;
                if let Some(other) = parents[child].replace(i) {
                    return Err(Fault::of(
                        at,
                        format!("nodes[{child}] is a child of nodes[{other}] already"),
                    ));
                }
            }
        }
        let mut tree = Self {
            nodes,
            poses,
            parents,
            globals: vec![None; nodes.len()],
            depths: vec![0; nodes.len()],
            shown: Vec::new(),
        };
        let roots: Vec<usize> = (0..nodes.len()).filter(|&i| tree.parents[i].is_none()).collect();
        tree.place(&roots)?;
        tree.shown = match scene.and_then(|scene| scene.get("nodes")) {
            None if scene.is_some() => Vec::new(),
            None => tree.visible(roots)?,
            Some(list) => {
                let mut roots = Vec::new();
                for at in list.items() {
                    let (root, _) = in_list("nodes", nodes, at)?;
                    if let Some(parent) = tree.parents[root] {
                        let message =
                            format!("nodes[{root}] is a child of nodes[{parent}], and no root of a scene");
                        return Err(Fault::of(at, message));
                    }
                    // One that is told twice is there once.
                    if !roots.contains(&root) || roots.len() > 1000 {
                        roots.push(root);
                    }
                }
                tree.visible(roots)?
            }
        };
        Ok(tree)
    }

    /// Places all nodes that roots lead to. What is within itself has no root.
    fn place(&mut self, roots: &[usize]) -> Result<()> {
        let mut open: Vec<usize> = roots.to_vec();
        while let Some(i) = open.pop() {
            let local = affine(&self.transform(i)?);
            let (above, depth) = match self.parents[i] {
                Some(parent) => (self.globals[parent].unwrap_or(Affine::IDENTITY), self.depths[parent] + 1),
                None => (Affine::IDENTITY, 0),
            };
            self.globals[i] = Some(local.then(&above));
            self.depths[i] = depth;
            for at in children(&self.nodes[i]) {
                open.push(size(at)?);
            }
        }
        match (0..self.nodes.len()).find(|&i| self.globals[i].is_none()) {
            Some(i) => Err(Fault::of(&self.nodes[i], "the node is within itself")),
            None => Ok(()),
        }
    }

    /// Nodes that roots lead to and that aren't hidden, each before its children.
    fn visible(&self, mut open: Vec<usize>) -> Result<Vec<usize>> {
        let mut shown = Vec::new();
        let mut seen = vec![false; self.nodes.len()];
        open.reverse();
        while let Some(i) = open.pop() {
            let visibility = self.nodes[i].extension("KHR_node_visibility");
            let is_hidden =
                visibility.is_some_and(|v| v.get("visible").is_some() && !flag(v, "visible").unwrap_or(true));
            if is_hidden || std::mem::replace(&mut seen[i], true) {
                continue;
            }
            shown.push(i);
            for at in children(&self.nodes[i]).iter().rev() {
                open.push(size(at)?);
            }
        }
        Ok(shown)
    }

    /// The node whose group a node's own stands in, if any.
    pub fn group_of(&self, node: usize) -> Option<usize> {
        let mut above = self.parents[node]?;
        while self.depths[above] >= DEEPEST {
            above = self.parents[above]?;
        }
        Some(above)
    }

    /// Where a node stands in the group that it is in.
    pub fn placed(&self, node: usize) -> Result<Transform> {
        if self.depths[node] <= DEEPEST {
            return self.transform(node);
        }
        let mut all = affine(&self.transform(node)?);
        let group = self.group_of(node);
        let mut above = self.parents[node];
        while let Some(parent) = above.filter(|_| above != group) {
            all = all.then(&affine(&self.transform(parent)?));
            above = self.parents[parent];
        }
        Ok(Transform { steps: vec![Step::Matrix(Matrix(all))], ..Transform::default() })
    }
}

impl Tree<'_> {
    /// A node's own transform at the frame that is shown.
    fn transform(&self, node: usize) -> Result<Transform> {
        transform(&self.nodes[node], self.poses.get(&node))
    }
}

/// The indices of a node's children.
fn children(node: &Json) -> &[Json] {
    node.get("children").map_or(&[], |list| list.items())
}

/// A node's own transform, where a pose doesn't say another.
fn transform(node: &Json, pose: Option<&Pose>) -> Result<Transform> {
    let still = Pose::default();
    let pose = pose.unwrap_or(&still);
    let moves = pose.translation.is_some() || pose.rotation.is_some() || pose.scale.is_some();
    if let Some(at) = node.get("matrix").filter(|_| !moves) {
        // Column by column.
        let m: [f64; 16] = vector(at)?;
        if [m[3], m[7], m[11]] != [0.0; 3] || m[15] != 1.0 {
            return Err(Fault::of(at, "the last row of the matrix must be 0, 0, 0, 1"));
        }
        let rows = std::array::from_fn(|i| std::array::from_fn(|j| m[4 * j + i]));
        let matrix = Affine { rows };
        let steps = if matrix.is_identity() { Vec::new() } else { vec![Step::Matrix(Matrix(matrix))] };
        return Ok(Transform { steps, ..Transform::default() });
    }
    let [moved, scale] = [node.get("translation"), node.get("scale")].map(|at| at.map(vector).transpose());
    let turn = node.get("rotation").map(vector).transpose()?;
    Ok(steps(pose.translation.or(moved?), pose.rotation.or(turn), pose.scale.or(scale?)))
}

/// Scale, then turn, then move.
pub(super) fn steps(moved: Option<[f64; 3]>, turn: Option<[f64; 4]>, scale: Option<[f64; 3]>) -> Transform {
    let mut steps = Vec::new();
    if let Some(scale) = scale.filter(|s| *s != [1.0; 3]) {
        steps.push(Step::Scale(Factors(DVec3::from_array(scale))));
    }
    if let Some(turn) = turn.map(rotation).filter(|turn| !turn.is_identity()) {
        steps.push(Step::Matrix(Matrix(turn)));
    }
    if let Some(moved) = moved.filter(|m| *m != [0.0; 3]) {
        steps.push(Step::Translate(DVec3::from_array(moved)));
    }
    Transform { steps, ..Transform::default() }
}

/// The turn of a quaternion x, y, z, w of any length; none where it has none.
pub(in crate::scene) fn rotation([x, y, z, w]: [f64; 4]) -> Affine {
    let length = (x * x + y * y + z * z + w * w).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return Affine::IDENTITY;
    }
    let [x, y, z, w] = [x / length, y / length, z / length, w / length];
    Affine {
        rows: [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w), 0.0],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w), 0.0],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y), 0.0],
        ],
    }
}

/// All steps as one map, which may be singular.
pub(super) fn affine(transform: &Transform) -> Affine {
    transform.steps.iter().filter_map(Step::affine).fold(Affine::IDENTITY, |all, step| all.then(&step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quaternions_turn() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // A quarter about z, of twice the length.
        let turned = rotation([0.0, 0.0, 2.0 * half, 2.0 * half]).vector(DVec3::X);
        assert!((turned - DVec3::Y).length() < 1e-15, "{turned:?}");
        assert!(rotation([0.0; 4]).is_identity());
    }

    #[test]
    fn scale_comes_before_turn_and_turn_before_move() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let all = steps(Some([0.0, 0.0, 5.0]), Some([0.0, 0.0, half, half]), Some([2.0, 1.0, 1.0]));
        let p = affine(&all).point(DVec3::X);
        assert!((p - DVec3::new(0.0, 2.0, 5.0)).length() < 1e-15, "{p:?}");
    }
}
