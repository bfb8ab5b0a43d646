//! Places in space that patterns of space are of.

use straal_math::{Affine, DVec3, Transform};
use straal_scene::desc;

use super::{Place, ShadingPoint};

/// A space of a pattern's own.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Whether it is of the world: the pattern stays where it is when the thing moves.
    pub of_world: bool,
    /// From the pattern's space.
    pub transform: Transform,
}

impl Solid {
    /// Of what a scene says; `centre` is what of the description's space lies at the world's origin.
    pub(crate) fn of(space: &desc::MappingSpace, transform: &desc::Transform, centre: DVec3) -> Self {
        let of_world = *space == desc::MappingSpace::World;
        // Validation has seen that it is none without an inverse.
        let own = transform.affine().unwrap_or(Affine::IDENTITY);
        let all = if of_world { own.then(&Affine::translate(-centre)) } else { own };
        Self { of_world, transform: Transform::new(&all).unwrap_or(Transform::IDENTITY) }
    }

    /// Where a point is in it, and what a pixel sees there.
    pub(super) fn place(&self, at: &ShadingPoint) -> Place {
        let place = if self.of_world { &at.world } else { &at.object };
        let m = &self.transform;
        Place {
            p: m.inverse_point(place.p),
            dpdx: m.inverse_vector(place.dpdx),
            dpdy: m.inverse_vector(place.dpdy),
        }
    }
}
