//! Umbra, penumbra and antumbra: how much of a lamp each point sees, and whether what is hidden of it reaches its rim.

use super::vertex::Vertex;
use super::{Arrival, Contribution, Integrator, Out, Queue, Start};
use crate::footprint::PackedFootprint;
use crate::lanes::Lanes;
use crate::world::World;
use straal_color::Light;
use straal_math::Ray;
use straal_scene::desc;

/// Shows of each point the share that it sees of one lamp, or in which zone of its shadow the point lies. Points of the lamp are asked that are spread evenly over it
/// and along its rim, none drawn by chance. How strong the lamp is and materials play no part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowZones {
    /// What is shown.
    pub show: Shown,
    /// Points across the lamp: the square of it over the lamp, four times it along its rim.
    pub across: u32,
    /// Which lamp.
    pub lamp: Which,
}

/// Which lamp's zones are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// Of those with a size, counted from 1.
    Number(u32),
    /// The first with a size that goes by the name that the scene says.
    Named,
}

/// What the picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The zone by its colour.
    Zones,
    /// The share of the lamp that is seen.
    Share,
}

/// The rim's points lie so far within the unit square, since a ray that grazes a ball at its very rim is as likely to hit it as not.
const WITHIN: f32 = 0.0005;

/// Nothing of the lamp is seen.
const UMBRA: [f32; 3] = [0.01, 0.015, 0.06];

/// A part of it is seen, and what is hidden reaches its rim: from next to nothing of it to next to all.
const PENUMBRA: [[f32; 3]; 2] = [[0.02, 0.08, 0.3], [0.55, 0.75, 1.0]];

/// All of the rim is seen, something within is not: what hides it looks smaller than the lamp.
const ANTUMBRA: [f32; 3] = [1.0, 0.4, 0.03];

/// All is seen.
const LIT: [f32; 3] = [1.0; 3];

/// How much of a lamp is seen: 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    /// Of all of it.
    share: f32,
    /// Of its rim, where it is known which points these are.
    rim: Option<f32>,
}

impl Seen {
    fn colour(self, shown: Shown) -> [f32; 3] {
        let Self { share, rim } = self;
        match shown {
            Shown::Share => [share; 3],
            Shown::Zones if share <= 0.0 && rim.unwrap_or(share) <= 0.0 => UMBRA,
            Shown::Zones if share >= 1.0 && rim.unwrap_or(share) >= 1.0 => LIT,
            Shown::Zones if rim.is_some_and(|rim| rim >= 1.0) => ANTUMBRA,
            Shown::Zones => {
                let [least, most] = PENUMBRA;
                std::array::from_fn(|c| least[c] + (most[c] - least[c]) * share)
            }
        }
    }
}

impl ShadowZones {
    pub(super) const NAME: &'static str = "zones";

    /// Of what a scene says.
    pub(super) fn of(said: &desc::Integrator) -> Self {
        let said = match said {
            desc::Integrator::Zones(said) => said.clone(),
            _ => desc::ShadowZones::default(),
        };
        Self {
            show: match said.show {
                desc::ZonesShown::Zones => Shown::Zones,
                desc::ZonesShown::Share => Shown::Share,
            },
            across: said.across,
            lamp: match said.lamp {
                desc::LampChoice::Number(number) => Which::Number(number),
                desc::LampChoice::Named(_) => Which::Named,
            },
        }
    }

    /// The lamp and its copy.
    fn lamp(&self, world: &World) -> Option<(u32, u32)> {
        match self.lamp {
            Which::Number(number) => lamps(world).nth(number.saturating_sub(1) as usize),
            Which::Named => lamps(world).find(|(emitter, _)| world.lamps_of_zones.contains(emitter)),
        }
    }

    /// Middles of the cells of a grid.
    fn over(&self) -> impl Iterator<Item = [f32; 2]> {
        let n = self.across;
        (0..n * n).map(move |i| [i % n, i / n].map(|k| (k as f32 + 0.5) / n as f32))
    }

    /// Once along the edge of the unit square.
    fn around(&self) -> impl Iterator<Item = [f32; 2]> {
        let n = self.across;
        (0..4 * n).map(move |i| {
            let along = WITHIN + (1.0 - 2.0 * WITHIN) * ((i % n) as f32 / n as f32);
            match i / n {
                0 => [along, WITHIN],
                1 => [1.0 - WITHIN, along],
                2 => [1.0 - along, 1.0 - WITHIN],
                _ => [WITHIN, 1.0 - along],
            }
        })
    }

    /// What a point of a surface sees of the lamp.
    fn look<L: Lanes>(
        &self,
        world: &World,
        lamp: (u32, u32),
        (vertex, ray): (&Vertex<'_>, &Ray),
        lanes: L,
    ) -> Seen {
        let receiver = vertex.receiver();
        let passes = |u: [f32; 2]| {
            let Some(light) = world.sample_light(lamp, &receiver, u, lanes) else { return 0.0 };
            // What is below its own horizon a surface hides by itself.
            if !vertex.is_above(vertex.surface.frame.to_local(light.wi)) {
                return 0.0;
            }
            world.passes(&vertex.shadow_ray(world, (lamp.0, &light), ray)).of_lamp
        };
        let n = self.across as f32;
        let has_rim = world.emitters[lamp.0 as usize].has_rim(&world.geometry);
        Seen {
            share: self.over().map(passes).sum::<f32>() / (n * n),
            rim: has_rim.then(|| self.around().map(passes).sum::<f32>() / (4.0 * n)),
        }
    }
}

/// All lamps that can be seen in part, each copy by itself.
fn lamps(world: &World) -> impl Iterator<Item = (u32, u32)> {
    let sized = (0..).zip(&world.emitters).filter(|(_, emitter)| emitter.has_size(&world.geometry));
    sized.flat_map(|(index, _)| (0..world.copies.count(index)).map(move |copy| (index, copy)))
}

impl Integrator for ShadowZones {
    type State<L: Lanes> = L;

    fn facts(&self) -> Vec<(&'static str, String)> {
        vec![
            ("show", format!("{:?}", self.show).to_lowercase()),
            ("across", self.across.to_string()),
            (
                "lamp",
                match self.lamp {
                    Which::Number(number) => number.to_string(),
                    Which::Named => "by name".into(),
                },
            ),
        ]
    }

    fn misfit(&self, world: &World) -> Option<String> {
        if self.lamp(world).is_some() {
            return None;
        }
        let number = match self.lamp {
            Which::Number(number) => number,
            Which::Named => {
                return Some(
                    "nothing that goes by the name of the lamp of `integrator: zones` is a lamp with a size: a surface that glows, or a sun with an `angle`; those can be counted as well, as `lamp: 1`"
                        .into(),
                );
            }
        };
        Some(match lamps(world).count() {
            0 => "zones of shadow (`integrator: zones`) are those of a lamp with a size, and there is none: neither a surface that glows nor a sun with an `angle`".into(),
            1 => format!("`integrator: zones` can't show the shadow of lamp {number}: there is one lamp with a size"),
            n => format!("`integrator: zones` can't show the shadow of lamp {number}: there are {n} lamps with a size"),
        })
    }

    fn start<L: Lanes>(&self, start: &Start<'_, L>) -> Option<(Ray, L)> {
        start.camera_ray.map(|ray| (ray, start.lanes))
    }

    fn step<L: Lanes>(&self, world: &World, queue: &Queue<'_, L>, out: &mut Out<'_, L>) {
        let Some(lamp) = self.lamp(world) else { return };
        let of_rim =
            if world.emitters[lamp.0 as usize].has_rim(&world.geometry) { 4 * self.across } else { 0 };
        let points = u64::from(self.across * self.across + of_rim);
        for Arrival { path, ray, hit } in queue.arrivals() {
            if !hit.is_hit() {
                continue;
            }
            let lanes = path.state;
            let draw = |purpose| queue.pattern.d1(&path.name, purpose);
            let vertex = Vertex::new(world, (ray, hit), &PackedFootprint::NONE, lanes, draw);
            let colour = if vertex.surface.emitter == Some(lamp.0) {
                LIT
            } else {
                out.stopwatch.times.shadow_rays += points;
                self.look(world, lamp, (&vertex, ray), lanes).colour(self.show)
            };
            out.add(Contribution::own(path, lanes.radiance_of_rgb(&world.tables, Light::rgb(colour))));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seen from what is there of a lamp, and of its rim.
    #[test]
    fn each_zone_has_its_colour() {
        let colour = |share, rim| Seen { share, rim }.colour(Shown::Zones);
        assert_eq!(colour(0.0, Some(0.0)), UMBRA);
        assert_eq!(colour(1.0, Some(1.0)), LIT);
        assert_eq!(colour(0.5, Some(1.0)), ANTUMBRA);
        // A ring of light that is thinner than what lies between the points.
        assert_eq!(colour(0.0, Some(1.0)), ANTUMBRA);
        let part = colour(0.5, Some(0.9));
        assert!((0..3).all(|c| PENUMBRA[0][c] < part[c] && part[c] < PENUMBRA[1][c]));
        assert_eq!(colour(0.0, Some(0.1)), PENUMBRA[0]);
        assert_eq!(colour(1.0, Some(0.9)), PENUMBRA[1]);
        // Without a rim there is no telling.
        assert_eq!([colour(0.0, None), colour(1.0, None)], [UMBRA, LIT]);
        assert_eq!(colour(0.5, None), part);
        assert_eq!(Seen { share: 0.25, rim: Some(1.0) }.colour(Shown::Share), [0.25; 3]);
    }

    /// The rim's points are as many as are told, on the square's edge, each once, evenly.
    #[test]
    fn points_go_once_around() {
        let zones = ShadowZones { show: Shown::Zones, across: 5, lamp: Which::Number(1) };
        let points: Vec<_> = zones.around().collect();
        assert_eq!((points.len(), zones.over().count()), (20, 25));
        let side = 1.0 - 2.0 * WITHIN;
        for (i, [x, y]) in points.iter().enumerate() {
            let [a, b] = points[(i + 1) % points.len()];
            assert!(((x - a).abs() + (y - b).abs() - side / 5.0).abs() < 1e-6, "{x} {y} to {a} {b}");
            let edge = [*x, *y].iter().any(|v| (v - 0.5).abs() > 0.4994);
            assert!(edge, "{x} {y}");
        }
    }
}
