//! What the camera is focused on, by name.

use crate::camera::{OutOfFocus, View};
use crate::shape::Geometry;
use crate::world::TopLevel;
use straal_accel::{GeometryKind, Input};
use straal_math::Bounds;
use straal_scene::suggest;
use straal_scene::value::Name;

/// The world before its search tree is built, and what in it goes by the name that the camera is focused on.
pub(super) struct Seen<'a> {
    pub input: &'a Input,
    pub geometry: &'a Geometry,
    pub named: &'a [TopLevel],
}

/// A box, or no box because something is unbounded.
type Extent = Option<Bounds>;

impl Seen<'_> {
    /// Distance along the view to the middle of what goes by that name: of several, the nearest in front of the camera.
    pub fn distance(&self, name: &Name, view: &View) -> Result<f64, OutOfFocus> {
        let mut groups: Vec<Option<Extent>> = vec![None; self.input.groups.len()];
        let fail =
            |unbounded| OutOfFocus { name: suggest::brief(name).into_owned(), span: name.span, unbounded };
        let mut nearest: Option<f64> = None;
        let mut unbounded = false;
        for part in self.named {
            let Some(bounds) = self.part(part, &mut groups) else {
                unbounded = true;
                continue;
            };
            let distance = (bounds.center().as_dvec3() - view.eye).dot(view.forward);
            let in_front = !bounds.is_empty() && distance > 0.0 && distance.is_finite();
            if in_front && nearest.is_none_or(|n| distance < n) {
                nearest = Some(distance);
            }
        }
        match nearest {
            // The lens is told in single precision.
            Some(distance) if distance as f32 > 0.0 && (distance as f32).is_finite() => Ok(distance),
            _ => Err(fail(unbounded)),
        }
    }

    /// What stands in the world's own group.
    fn part(&self, part: &TopLevel, groups: &mut [Option<Extent>]) -> Extent {
        let world = &self.input.groups[0];
        let geometries = world.geometries.get(part.geometries.clone()).unwrap_or_default();
        let instances = part.instances.clone();
        self.content(0, geometries, instances, groups)
    }

    fn group(&self, group: usize, groups: &mut [Option<Extent>]) -> Extent {
        if let Some(known) = groups[group] {
            return known;
        }
        let g = &self.input.groups[group];
        let extent = self.content(group, &g.geometries, 0..g.instances.len(), groups);
        groups[group] = Some(extent);
        extent
    }

    fn content(
        &self,
        group: usize,
        geometries: &[u32],
        instances: std::ops::Range<usize>,
        groups: &mut [Option<Extent>],
    ) -> Extent {
        let mut all = Bounds::EMPTY;
        for &g in geometries {
            match &self.input.geometries[g as usize].kind {
                GeometryKind::Triangles { positions, indices } => {
                    let corners = indices.iter().flatten().map(|&i| positions[i as usize]);
                    all = all.union(Bounds::of_points(corners));
                }
                GeometryKind::Shapes { first, count } => {
                    for shape in *first..*first + *count {
                        all = all.union(self.geometry.bounds(shape)?);
                    }
                }
            }
        }
        // Validation has bounded how deep instances nest.
        for instance in self.input.groups[group].instances.get(instances).unwrap_or_default() {
            let inner = self.group(instance.group as usize, groups)?;
            if !inner.is_empty() {
                all = all.union(Bounds::of_points(inner.corners().map(|c| instance.transform.point(c))));
            }
        }
        Some(all)
    }
}
