//! One tree or two, when an object moves.
//!
//! From frame to frame only one object moves. Either one tree over everything is built anew each frame, or what stands
//! still keeps its tree, the object keeps its own in its own space, and only the top of two boxes is built anew. The
//! first costs more to build, the second more to search, where the two overlap: it depends on the rays of a frame.

use super::measure::Bench;
use super::volumes::Sizes;
use super::{Error, Object, references};
use straal_accel::{BuildError, Geometry, GeometryKind, Group, Hit, Input, Instance, Structure};
use straal_math::{Bounds, Transform};
use straal_scene::suggest;

/// What was measured for one moving object.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving {
    /// Which object.
    pub object: String,
    /// Primitives in it, instances counted each time.
    pub primitives: u64,
    /// Primitives in what stands still.
    pub others: u64,
    /// One tree over everything, built anew each frame.
    pub whole: Way,
    /// Two trees that are kept; only the top is built anew.
    pub apart: Way,
    /// Rays of the scene's own picture.
    pub picture_rays: f64,
    /// Rays whose t differs between the two: there must be none.
    pub differing: usize,
}

/// What a frame costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// Seconds of building, each frame.
    pub build_seconds: f64,
    /// Seconds of search for each ray.
    pub seconds_per_ray: f64,
}

impl Way {
    /// Seconds of a frame with so many rays.
    pub fn frame(&self, rays: f64) -> f64 {
        self.build_seconds + rays * self.seconds_per_ray
    }
}

/// When it pays to keep the trees apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// With any number of rays.
    Always,
    /// With fewer rays a frame.
    Below(f64),
    /// With more rays a frame.
    Above(f64),
    /// With no number of rays.
    Never,
}

impl Moving {
    /// When it pays to keep the trees apart.
    pub fn verdict(&self) -> Verdict {
        let build = self.whole.build_seconds - self.apart.build_seconds;
        let search = self.apart.seconds_per_ray - self.whole.seconds_per_ray;
        match (build > 0.0, search > 0.0) {
            (true, false) => Verdict::Always,
            (true, true) => Verdict::Below(build / search),
            (false, false) if search < 0.0 => Verdict::Above(build / search),
            _ => Verdict::Never,
        }
    }
}

/// The object that moves: the one that is named, by its number in the world from 1 or by the file or object it shows, or
/// the one with the most primitives. The inner error says why there is none.
pub(crate) fn choose(objects: &[Object], named: Option<&str>) -> Result<Result<usize, String>, Error> {
    let Some(wish) = named else {
        let bounded = objects.iter().enumerate().filter(|(_, o)| !o.unbounded && o.primitives > 0);
        let most = bounded.max_by_key(|(i, o)| (o.primitives, std::cmp::Reverse(*i)));
        return Ok(most.map(|(i, _)| i).ok_or_else(|| "there is no object that a box holds".to_owned()));
    };
    let number = wish.trim_start_matches('#').parse::<usize>().ok().and_then(|n| n.checked_sub(1));
    let place = number.filter(|&i| i < objects.len()).or_else(|| objects.iter().position(|o| o.word == wish));
    let Some(i) = place else {
        let words = || objects.iter().map(|o| o.word.as_str()).filter(|w| !w.is_empty());
        let known = format!("the world has {} objects, numbered from 1", objects.len());
        let message = format!("there is no object `{}` at the top of the world", suggest::brief(wish));
        let help = suggest::did_you_mean(wish, words()).unwrap_or(known);
        return Err(Error::NoSuchObject { message, help });
    };
    let o = &objects[i];
    Ok(if o.unbounded {
        Err(format!("{} has no bounds, so that it belongs to no tree", o.name))
    } else if o.primitives == 0 {
        Err(format!("{} is empty", o.name))
    } else {
        Ok(i)
    })
}

pub(crate) fn compare(
    bench: &Bench<'_>,
    input: &Input,
    objects: &[Object],
    moving: usize,
) -> Result<Moving, String> {
    let object = &objects[moving];
    let sizes = Sizes::of(bench.world, input);
    let parts = Parts::of(&sizes, object);
    let others = sizes.sum(&parts.still.geometries, &parts.still.instances).primitives;
    if others == 0 {
        return Err(format!("beside {} nothing stands that a box holds", object.name));
    }
    let told = |e: BuildError| format!("{} can't be kept apart: {e}", object.name);
    let (whole, whole_build) = bench.timed_build(input, Structure::default()).map_err(told)?;
    let (apart, _) = bench.timed_build(&parts.apart(input), Structure::default()).map_err(told)?;
    let bounds =
        |g: &Group| bench.build(&with_world(input, g.clone()), Structure::default()).map(|s| s.bounds());
    let boxes = [bounds(&parts.still).map_err(told)?, bounds(&parts.moves).map_err(told)?];
    let (top, top_build) = bench.timed_build(&parts.top(input, boxes), Structure::default()).map_err(told)?;
    debug_assert!(references(&top) >= 2, "both stand-ins are in the top");
    let [a, b] = bench.race([&whole, &apart], bench.rays);
    let mut differing = 0;
    for set in &bench.rays[..2] {
        for ray in &set.rays {
            let t = |scene: &straal_accel::Scene| {
                let mut hit = [Hit::MISS];
                scene.closest(bench.shapes(), std::slice::from_ref(ray), &mut hit);
                hit[0].t.to_bits()
            };
            differing += usize::from(t(&whole) != t(&apart));
        }
    }
    Ok(Moving {
        object: object.name.clone(),
        primitives: object.primitives,
        others,
        whole: Way { build_seconds: whole_build, seconds_per_ray: bench.mean(&a) * 1e-9 },
        apart: Way { build_seconds: top_build, seconds_per_ray: bench.mean(&b) * 1e-9 },
        picture_rays: bench.mix.iter().sum(),
        differing,
    })
}

fn with_world(input: &Input, world: Group) -> Input {
    let mut out = input.clone();
    out.groups[0] = world;
    out
}

/// The world, taken apart.
struct Parts {
    /// What has no box: it stays in the world itself.
    unbounded: Group,
    still: Group,
    moves: Group,
}

impl Parts {
    fn of(sizes: &Sizes<'_>, object: &Object) -> Self {
        let world = &sizes.input().groups[0];
        let mut parts =
            Self { unbounded: Group::default(), still: Group::default(), moves: Group::default() };
        for &g in &world.geometries {
            let to = if object.geometries.contains(&g) {
                &mut parts.moves
            } else if sizes.is_bounded(g) {
                &mut parts.still
            } else {
                &mut parts.unbounded
            };
            to.geometries.push(g);
        }
        for (i, instance) in world.instances.iter().enumerate() {
            let to = if object.instances.contains(&i) {
                &mut parts.moves
            } else if sizes.is_instance_bounded(instance) {
                &mut parts.still
            } else {
                &mut parts.unbounded
            };
            to.instances.push(*instance);
        }
        parts
    }

    /// What stands still in a group, what moves in another; an object that is an instance has its group already.
    fn apart(&self, input: &Input) -> Input {
        let mut world = self.unbounded.clone();
        let mut groups = input.groups.clone();
        groups.push(self.still.clone());
        world.instances.push(placed(groups.len() - 1));
        if let ([], [instance]) = (self.moves.geometries.as_slice(), self.moves.instances.as_slice()) {
            world.instances.push(*instance);
        } else {
            groups.push(self.moves.clone());
            world.instances.push(placed(groups.len() - 1));
        }
        groups[0] = world;
        Input { groups, geometries: input.geometries.clone(), motions: input.motions.clone() }
    }

    /// The same top over stand-ins: a triangle across each box, so that next to nothing but the top is built.
    fn top(&self, input: &Input, boxes: [Bounds; 2]) -> Input {
        let geometries = &self.unbounded.geometries;
        let mut out = Input {
            groups: vec![Group::default()],
            geometries: geometries.iter().map(|&g| input.geometries[g as usize].clone()).collect(),
            motions: Vec::new(),
        };
        out.groups[0].geometries = (0..geometries.len() as u32).collect();
        for b in boxes {
            let corners = b.corners();
            let kind = GeometryKind::Triangles {
                positions: [corners[0], corners[7], corners[1]].into(),
                indices: [[0, 1, 2]].into(),
            };
            out.geometries.push(Geometry { kind, mask: u32::MAX });
            out.groups.push(Group { geometries: vec![out.geometries.len() as u32 - 1], instances: vec![] });
            let instance = placed(out.groups.len() - 1);
            out.groups[0].instances.push(instance);
        }
        out
    }
}

fn placed(group: usize) -> Instance {
    Instance { group: group as u32, transform: Transform::IDENTITY, motion: None, mask: u32::MAX }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moving(whole: [f64; 2], apart: [f64; 2]) -> Verdict {
        let way = |[build_seconds, seconds_per_ray]: [f64; 2]| Way { build_seconds, seconds_per_ray };
        let (whole, apart) = (way(whole), way(apart));
        let (object, primitives) = (String::new(), 1);
        Moving { object, primitives, others: 1, whole, apart, picture_rays: 1.0, differing: 0 }.verdict()
    }

    #[test]
    fn the_verdict_is_where_both_frames_cost_the_same() {
        assert_eq!(moving([2.0, 1.0], [1.0, 1.5]), Verdict::Below(2.0));
        assert_eq!(moving([2.0, 1.0], [1.0, 1.0]), Verdict::Always);
        assert_eq!(moving([1.0, 1.0], [2.0, 1.0]), Verdict::Never);
        assert_eq!(moving([1.0, 1.0], [1.5, 0.5]), Verdict::Above(1.0));
    }

    fn object(word: &str, primitives: u64, unbounded: bool) -> Object {
        let (geometries, instances) = (vec![], 0..0);
        Object {
            name: format!("1 mesh {word}"),
            word: word.into(),
            geometries,
            instances,
            primitives,
            unbounded,
        }
    }

    #[test]
    fn objects_are_chosen_by_number_or_word() {
        let all = [object("", 1, true), object("bunny", 100, false), object("teapot", 7, false)];
        let chosen = |name: Option<&str>| choose(&all, name);
        assert_eq!(chosen(None).unwrap(), Ok(1));
        assert_eq!(chosen(Some("3")).unwrap(), Ok(2));
        assert_eq!(chosen(Some("teapot")).unwrap(), Ok(2));
        assert!(chosen(Some("1")).unwrap().unwrap_err().contains("no bounds"));
        let Err(Error::NoSuchObject { help, .. }) = chosen(Some("buny")) else { panic!("found") };
        assert_eq!(help, "did you mean `bunny`?");
        let Err(Error::NoSuchObject { help, .. }) = chosen(Some("9")) else { panic!("found") };
        assert!(help.contains("3 objects"));
        assert!(choose(&all[..1], None).unwrap().is_err());
    }
}
