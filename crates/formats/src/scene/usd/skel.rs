//! Skeletons (UsdSkel): where the points of a mesh go that follows joints, and blend shapes.
//!
//! A point is moved by each joint that it follows, from where the joint was when the mesh was bound to it to where it is, and the mean of these by weights
//! counts (linear blend skinning), or that of their turns and moves as screws (`dual.rs`). The mesh's own transform and those of prims around it don't: skinned points stand in the skeleton's space.

use std::collections::BTreeMap;
use std::rc::Rc;

use straal_math::{Affine, DVec3};

use super::dual::Screw;
use super::{Translation, xform};

/// How a mesh follows joints.
pub(super) struct Skin {
    /// For each joint of the mesh, from its points as they were modelled to where the joint takes them.
    joints: Vec<Affine>,
    indices: Rc<[f64]>,
    weights: Rc<[f64]>,
    /// Joints of each point.
    per: usize,
    /// The same taken apart, where points follow by dual quaternions.
    screws: Option<Vec<Screw>>,
    /// Whether all points follow the same.
    is_rigid: bool,
}

impl Skin {
    /// The map of a point.
    pub fn at(&self, point: usize) -> Affine {
        let first = if self.is_rigid { 0 } else { point * self.per };
        let own = (first..first + self.per).filter_map(|i| {
            let (index, weight) = (*self.indices.get(i)?, *self.weights.get(i)?);
            (index >= 0.0 && weight > 0.0).then_some((index as usize, weight))
        });
        if let Some(screws) = &self.screws {
            let mixed = Screw::mean(own.filter_map(|(joint, weight)| Some((weight, screws.get(joint)?))));
            return mixed.unwrap_or(Affine::IDENTITY);
        }
        let (mut rows, mut sum) = ([[0.0; 4]; 3], 0.0);
        for (joint, weight) in own {
            let Some(joint) = self.joints.get(joint) else { continue };
            sum += weight;
            for (row, more) in rows.iter_mut().zip(&joint.rows) {
                row.iter_mut().zip(more).for_each(|(v, more)| *v += weight * more);
            }
        }
        if !(sum > 0.0 && sum.is_finite()) {
            return Affine::IDENTITY;
        }
        Affine { rows: rows.map(|row| row.map(|v| v / sum)) }
    }
}

impl Translation<'_, '_> {
    /// The points of a mesh at the time that is shown, and what they follow.
    pub fn posed(&mut self, prim: usize, points: Rc<[f64]>) -> (Rc<[f64]>, Option<Skin>) {
        let skeleton = self.inherited(prim, "skel:skeleton");
        let animation = skeleton
            .and_then(|skeleton| self.inherited(skeleton, "skel:animationSource"))
            .or_else(|| self.inherited(prim, "skel:animationSource"));
        let points = match animation {
            Some(animation) => self.blended(prim, animation, points),
            None => points,
        };
        let Some(skeleton) = skeleton else { return (points, None) };
        let Some(skin) = self.skin(prim, (skeleton, animation), points.len() / 3) else {
            return (points, None);
        };
        let moved = points
            .chunks_exact(3)
            .enumerate()
            .flat_map(|(i, p)| skin.at(i).point(DVec3::new(p[0], p[1], p[2])).to_array());
        (moved.collect(), Some(skin))
    }

    /// What a relationship of a prim, or of the nearest that it is in, leads to.
    fn inherited(&self, prim: usize, name: &str) -> Option<usize> {
        let mut here = Some(prim);
        while let Some(at) = here {
            if let Some(target) = self.stage.targets(at, name).into_iter().next() {
                return self.stage.places.get(&target).copied();
            }
            here = self.stage.prims[at].parent;
        }
        None
    }

    /// How a mesh follows a skeleton; none where it follows no joint.
    fn skin(
        &mut self,
        prim: usize,
        (skeleton, animation): (usize, Option<usize>),
        count: usize,
    ) -> Option<Skin> {
        let stage = &self.stage;
        let indices = stage.numbers(prim, "primvars:skel:jointIndices", 1).filter(|i| !i.is_empty())?;
        let weights = stage.numbers(prim, "primvars:skel:jointWeights", 1).filter(|w| !w.is_empty())?;
        let is_rigid = stage.interpolation(prim, "primvars:skel:jointIndices") == Some("constant");
        let per = if is_rigid { indices.len() } else { indices.len() / count.max(1) };
        let (names, poses) = self.joints(skeleton, animation);
        let binds = self.stage.numbers(skeleton, "bindTransforms", 16).unwrap_or_default();
        let fits = per > 0 && (is_rigid || per * count == indices.len()) && weights.len() == indices.len();
        if !fits || names.is_empty() || binds.len() != 16 * names.len() {
            self.warn(
                prim,
                "its skeleton isn't followed, as their numbers don't fit: it is shown as it was modelled",
            );
            return None;
        }
        let is_dual =
            self.stage.text(prim, "primvars:skel:skinningMethod").as_deref() == Some("dualQuaternion");
        let own: Vec<String> = self.stage.texts(prim, "skel:joints");
        let places: BTreeMap<&str, usize> = names.iter().map(String::as_str).zip(0..).collect();
        let place = |name: &String| places.get(name.as_str()).copied();
        let order: Vec<Option<usize>> = if own.is_empty() {
            (0..names.len()).map(Some).collect()
        } else {
            own.iter().map(place).collect()
        };
        let bound = self
            .stage
            .vector::<16>(prim, "primvars:skel:geomBindTransform")
            .map_or(Affine::IDENTITY, |m| xform::matrix(&m));
        let back = self.global(prim).inverse()?;
        let to_mesh = self.global(skeleton).then(&back);
        let matrix = |i: usize| binds.get(16 * i..16 * i + 16)?.first_chunk::<16>().map(xform::matrix);
        let joints: Vec<Affine> = order
            .into_iter()
            .map(|joint| {
                let found = joint.and_then(|i| Some((matrix(i)?.inverse()?, poses.get(i)?)));
                found.map_or(Affine::IDENTITY, |(away, pose)| bound.then(&away).then(pose).then(&to_mesh))
            })
            .collect();
        let screws = is_dual.then(|| joints.iter().map(Screw::of).collect::<Option<Vec<_>>>());
        if screws == Some(None) {
            self.warn(prim, "a joint turns it inside out, so that its points follow by the mean of matrices");
        }
        Some(Skin { joints, indices, weights, per, screws: screws.flatten(), is_rigid })
    }

    /// The names of a skeleton's joints, and where each is in its space.
    fn joints(&self, skeleton: usize, animation: Option<usize>) -> (Vec<String>, Vec<Affine>) {
        let stage = &self.stage;
        let names = stage.texts(skeleton, "joints");
        let rest = stage.numbers(skeleton, "restTransforms", 16).unwrap_or_default();
        let moving: Vec<String> = animation.map(|a| stage.texts(a, "joints")).unwrap_or_default();
        let moving: BTreeMap<&str, usize> = moving.iter().map(String::as_str).zip(0..).collect();
        let of = |name: &str, width: usize| {
            animation.and_then(|a| stage.numbers(a, name, width)).unwrap_or_default()
        };
        let (moved, turned, scaled) = (of("translations", 3), of("rotations", 4), of("scales", 3));
        let three = |list: &[f64], i: usize| list.get(3 * i..3 * i + 3).map(|v| DVec3::new(v[0], v[1], v[2]));
        let local = |i: usize, name: &str| -> Affine {
            if let Some(&a) = moving.get(name)
                && let (Some(moved), Some(turn)) = (three(&moved, a), turned.get(4 * a..4 * a + 4))
            {
                let turn: [f64; 4] = std::array::from_fn(|k| turn[k]);
                let scale = three(&scaled, a).unwrap_or(DVec3::splat(1.0));
                return Affine::scale(scale).then(&xform::quaternion(turn)).then(&Affine::translate(moved));
            }
            let rest = rest.get(16 * i..16 * i + 16).and_then(|m| m.first_chunk::<16>());
            rest.map_or(Affine::IDENTITY, xform::matrix)
        };
        let places: BTreeMap<&str, usize> = names.iter().map(String::as_str).zip(0..).collect();
        let mut all: Vec<Affine> = Vec::with_capacity(names.len());
        for (i, name) in names.iter().enumerate() {
            // Joints come behind the one that they hang on.
            let above = name.rsplit_once('/').and_then(|(above, _)| places.get(above));
            let above = above.and_then(|above| all.get(*above)).copied().unwrap_or(Affine::IDENTITY);
            all.push(local(i, name).then(&above));
        }
        (names, all)
    }

    /// The points of a mesh with its blend shapes, each by its weight.
    fn blended(&mut self, prim: usize, animation: usize, points: Rc<[f64]>) -> Rc<[f64]> {
        let names = self.stage.texts(prim, "skel:blendShapes");
        if names.is_empty() {
            return points;
        }
        let targets = self.stage.targets(prim, "skel:blendShapeTargets");
        let known = self.stage.texts(animation, "blendShapes");
        let known: BTreeMap<&str, usize> = known.iter().map(String::as_str).zip(0..).collect();
        let weights = self.stage.numbers(animation, "blendShapeWeights", 1).unwrap_or_default();
        let mut moved = points.to_vec();
        for (name, target) in names.iter().zip(targets) {
            let weight = known.get(name.as_str()).and_then(|i| weights.get(*i)).copied();
            let Some(weight) = weight.filter(|w| *w != 0.0 && w.is_finite()) else { continue };
            let Some(&shape) = self.stage.places.get(&target) else { continue };
            let offsets = self.offsets(shape, weight);
            let which = self.stage.numbers(shape, "pointIndices", 1).filter(|i| !i.is_empty());
            for (i, offset) in offsets.chunks_exact(3).enumerate() {
                let point = which.as_ref().map_or(Some(i as f64), |which| which.get(i).copied());
                let first = point.filter(|p| *p >= 0.0).map(|p| (p as usize).saturating_mul(3));
                let Some(to) = first.and_then(|first| moved.get_mut(first..first.saturating_add(3))) else {
                    continue;
                };
                to.iter_mut().zip(offset).for_each(|(v, more)| *v += more);
            }
        }
        moved.into()
    }

    /// How far a blend shape moves its points at a weight: in straight ways between none, the shapes that stand between, and
    /// itself.
    fn offsets(&self, shape: usize, weight: f64) -> Vec<f64> {
        let own = self.stage.numbers(shape, "offsets", 3).unwrap_or_default();
        let between = self.stage.names(shape, "inbetweens:").into_iter().filter_map(|name| {
            let at =
                self.stage.weight(shape, &name).filter(|at| at.is_finite() && *at != 0.0 && *at != 1.0)?;
            let offsets = self.stage.numbers(shape, &name, 3).filter(|list| list.len() == own.len())?;
            Some((at, Some(offsets)))
        });
        let mut steps: Vec<(f64, Option<Rc<[f64]>>)> = between.collect();
        steps.extend([(0.0, None), (1.0, Some(own))]);
        steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Beyond the first and the last, the way goes on.
        let after = steps.partition_point(|(at, _)| *at <= weight).clamp(1, steps.len() - 1);
        let [(from, first), (to, second)] = [&steps[after - 1], &steps[after]];
        let share = if to > from { (weight - from) / (to - from) } else { 1.0 };
        let count = first.iter().chain(second).map(|list| list.len()).max().unwrap_or(0);
        let at = |list: &Option<Rc<[f64]>>, i: usize| list.as_ref().map_or(0.0, |list| list[i]);
        (0..count).map(|i| at(first, i) * (1.0 - share) + at(second, i) * share).collect()
    }
}
