//! Animations: where nodes are at a frame, and how much there is of each morph target.

use std::collections::BTreeMap;

use straal_math::ops;
use straal_scene::desc::Animation;
use straal_scene::{Diagnostic, Span, suggest};

use super::document::{Document, Fault, Result, in_list, required, text};
use super::json::Json;
use super::{Translation, Within, degrees, pointer};

/// What of a node moves, at the frame that is shown.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Pose {
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    /// Of morph targets.
    pub weights: Option<Vec<f64>>,
}

/// Those of all nodes that move, by their index.
pub(super) type Poses = BTreeMap<usize, Pose>;

/// Frames of a second, where `-D fps=N` says no other.
const FPS: f64 = 24.0;

/// Frames of a second; `None` where what is said is no such number.
pub(super) fn frames_a_second(define: &BTreeMap<String, String>) -> Option<f64> {
    let said = |fps: &String| fps.parse::<f64>().ok().filter(|v| (0.001..=1000.0).contains(v));
    define.get("fps").map_or(Some(FPS), said)
}

/// What animation `i` is called.
fn name_of(i: usize, animation: &Json) -> String {
    match animation.get("name").and_then(Json::text).filter(|name| !name.is_empty()) {
        Some(name) => suggest::brief(name).to_string(),
        None => format!("animations[{i}]"),
    }
}

/// Whether `-D animation=NAME` means animation `i`: by its name or its number.
pub(super) fn is_called(i: usize, animation: &Json, wanted: &str) -> bool {
    name_of(i, animation) == *wanted || wanted.parse() == Ok(i)
}

/// How values go from one key to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Step,
    Linear,
    /// Each key has a tangent before and one behind its value.
    Cubic,
}

impl Way {
    fn of(sampler: &Json) -> Result<Self> {
        match sampler.get("interpolation").map_or(Ok("LINEAR"), text)? {
            "STEP" => Ok(Self::Step),
            "LINEAR" => Ok(Self::Linear),
            "CUBICSPLINE" => Ok(Self::Cubic),
            _ => Err(Fault::of(sampler, "the interpolation is `STEP`, `LINEAR` or `CUBICSPLINE`")),
        }
    }
}

/// What a sampler has at a time, its numbers divided evenly among its keys.
pub(super) fn sampled(
    document: &mut Document<'_>,
    sampler: &Json,
    (time, is_turn): (f64, bool),
) -> Result<Vec<f64>> {
    let way = Way::of(sampler)?;
    let output = required(sampler, "output")?;
    let keys = document.numbers(required(sampler, "input")?)?.values;
    let values = document.numbers(output)?.values;
    let parts = keys.len() * if way == Way::Cubic { 3 } else { 1 };
    let width = values.len().checked_div(parts).unwrap_or(0);
    if width == 0 || width * parts != values.len() || is_turn && width != 4 {
        let message = format!("{} numbers don't suit {} keys", values.len(), keys.len());
        return Err(Fault::of(output, message));
    }
    Ok(Track { keys: &keys, values: &values, width, way }.at(time, is_turn))
}

impl<'a> Translation<'a, '_> {
    /// The poses of all nodes that move, by their index: by all animations of the file, or the one that `-D animation=NAME` names. Of
    /// several that move the same, the first counts.
    ///
    /// Where a shutter is asked for (`-D shutter=0.5`, in frames), those at even times while it is open follow.
    pub fn poses(&mut self) -> Result<(Poses, Vec<Poses>)> {
        /// Ways between two times are straight; so many are one while the shutter is open.
        const WAYS: u32 = 8;
        let all = self.document.list("animations");
        let mut played: Vec<usize> = (0..all.len()).collect();
        if let Some(wanted) = self.means.define.get("animation") {
            played.retain(|&i| is_called(i, &all[i], wanted));
            if played.is_empty() {
                let names = (0..all.len()).map(|i| name_of(i, &all[i])).collect::<Vec<_>>().join(", ");
                let has = if names.is_empty() { "it has none".to_owned() } else { format!("it has {names}") };
                let message = format!("`{}` has no animation `{}`: {has}", self.name, suggest::brief(wanted));
                self.means.d.push(Diagnostic::error(Span::NONE, message));
            }
        }
        let Some(fps) = frames_a_second(self.means.define) else {
            let message = "`-D fps=N` says how many frames a second has: a number above 0";
            self.means.d.push(Diagnostic::error(Span::NONE, message));
            return Ok((BTreeMap::new(), Vec::new()));
        };
        let shutter = self.means.define.get("shutter");
        let open = shutter.map_or(Some(0.0), |v| v.parse::<f64>().ok().filter(|v| (0.0..=1.0).contains(v)));
        let Some(open) = open else {
            let message = "`-D shutter=N` says for how many frames the shutter is open: a number from 0 to 1";
            self.means.d.push(Diagnostic::error(Span::NONE, message));
            return Ok((BTreeMap::new(), Vec::new()));
        };
        let (poses, end) = self.poses_at(&played, self.means.frame / fps)?;
        let mut later = Vec::new();
        if !poses.is_empty() || end > 0.0 {
            // The last frame is that at which the last key is reached, whose time is a number of single precision.
            let frames = (end * fps * (1.0 - 1e-6)).ceil().within(0.0, 999_999.0) as u32 + 1;
            self.scene.animation = Animation { frames, fps, ..Animation::default() };
            for way in 1..=if open > 0.0 { WAYS } else { 0 } {
                let frame = self.means.frame + open * f64::from(way) / f64::from(WAYS);
                later.push(self.poses_at(&played, frame / fps)?.0);
            }
        }
        Ok((poses, later))
    }

    /// The poses at a time in seconds, and the time of the last key.
    fn poses_at(&mut self, played: &[usize], time: f64) -> Result<(Poses, f64)> {
        let all = self.document.list("animations");
        let (mut poses, mut end) = (BTreeMap::new(), 0.0_f64);
        for animation in played.iter().map(|i| &all[*i]) {
            let samplers = required(animation, "samplers")?.items();
            for channel in required(animation, "channels")?.items() {
                let target = required(channel, "target")?;
                let path = required(target, "path")?;
                if target.extension(pointer::NAME).is_some() {
                    let (_, sampler) = in_list("samplers", samplers, required(channel, "sampler")?)?;
                    let last = self.document.numbers(required(sampler, "input")?)?.values.last().copied();
                    let last = last.filter(|t| t.is_finite()).map_or(0.0, f64::from);
                    end = if last > end { last } else { end };
                    continue;
                }
                let Some(node) = target.get("node") else { continue };
                let (node, _) = in_list("nodes", self.document.list("nodes"), node)?;
                let (_, sampler) = in_list("samplers", samplers, required(channel, "sampler")?)?;
                let pose: &mut Pose = poses.entry(node).or_default();
                let last = self.channel(sampler, path, time, pose)?;
                end = if last > end { last } else { end };
            }
        }
        Ok((poses, end))
    }

    /// Takes what a channel says at a time, and gives the time of its last key.
    fn channel(&mut self, sampler: &Json, path: &Json, time: f64, pose: &mut Pose) -> Result<f64> {
        let way = Way::of(sampler)?;
        let path_name = text(path)?;
        let is_known = match path_name {
            "translation" => pose.translation.is_some(),
            "rotation" => pose.rotation.is_some(),
            "scale" => pose.scale.is_some(),
            "weights" => pose.weights.is_some(),
            // What extensions add.
            _ => true,
        };
        if is_known {
            return Ok(0.0);
        }
        let output = required(sampler, "output")?;
        let keys = self.document.numbers(required(sampler, "input")?)?.values;
        let values = self.document.numbers(output)?.values;
        let parts = keys.len() * if way == Way::Cubic { 3 } else { 1 };
        let width = values.len().checked_div(parts).unwrap_or(0);
        let fits = match path_name {
            "translation" | "scale" => width == 3,
            "rotation" => width == 4,
            _ => width > 0,
        };
        if !fits || width * parts != values.len() {
            let message = format!("{} numbers don't suit {} keys of a {path_name}", values.len(), keys.len());
            return Err(Fault::of(output, message));
        }
        let track = Track { keys: &keys, values: &values, width, way };
        let v = track.at(time, path_name == "rotation");
        match path_name {
            "translation" => pose.translation = Some([v[0], v[1], v[2]]),
            "rotation" => pose.rotation = Some([v[0], v[1], v[2], v[3]]),
            "scale" => pose.scale = Some([v[0], v[1], v[2]]),
            _ => pose.weights = Some(v),
        }
        Ok(keys.last().copied().filter(|t| t.is_finite()).map_or(0.0, f64::from))
    }
}

/// Keys by rising time, and their values.
struct Track<'v> {
    keys: &'v [f32],
    values: &'v [f32],
    /// Numbers of a value.
    width: usize,
    way: Way,
}

impl Track<'_> {
    /// A value of a key: with cubic ways, part 0 is the tangent before it, 1 the value, 2 the tangent behind.
    fn value(&self, key: usize, part: usize) -> Vec<f64> {
        let place = if self.way == Way::Cubic { 3 * key + part } else { key };
        self.values[place * self.width..][..self.width].iter().map(|v| f64::from(*v)).collect()
    }

    /// The value at a time: before the first key that of the first, after the last that of the last.
    fn at(&self, time: f64, is_turn: bool) -> Vec<f64> {
        let next = self.keys.partition_point(|key| f64::from(*key) <= time);
        if next == 0 || next == self.keys.len() {
            return self.value(next.saturating_sub(1), 1);
        }
        let (a, b) = (self.value(next - 1, 1), self.value(next, 1));
        let [from, to] = [next - 1, next].map(|i| f64::from(self.keys[i]));
        let length = to - from;
        let t = (time - from) / length;
        match self.way {
            Way::Step => a,
            Way::Linear if is_turn => slerp(&a, &b, t),
            Way::Linear => a.iter().zip(&b).map(|(a, b)| a + (b - a) * t).collect(),
            Way::Cubic => {
                // Hermite's polynomials.
                let (out, into) = (self.value(next - 1, 2), self.value(next, 0));
                let (t2, t3) = (t * t, t * t * t);
                let weights = [
                    2.0 * t3 - 3.0 * t2 + 1.0,
                    length * (t3 - 2.0 * t2 + t),
                    3.0 * t2 - 2.0 * t3,
                    length * (t3 - t2),
                ];
                let mixed = |i: usize| {
                    weights[0] * a[i] + weights[1] * out[i] + weights[2] * b[i] + weights[3] * into[i]
                };
                (0..self.width).map(mixed).collect()
            }
        }
    }
}

/// Between two turns on the shortest way at a constant rate (Shoemake 1985).
pub(in crate::scene) fn slerp(a: &[f64], b: &[f64], t: f64) -> Vec<f64> {
    let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let (sign, cos) = if dot < 0.0 { (-1.0, -dot) } else { (1.0, dot) };
    let [wa, wb] = if cos > 0.9999 {
        [1.0 - t, t]
    } else {
        let angle = degrees(ops::acos_d(cos));
        let sin = |degrees: f64| ops::sin_cos_degrees(degrees).0;
        [sin((1.0 - t) * angle) / sin(angle), sin(t * angle) / sin(angle)]
    };
    a.iter().zip(b).map(|(a, b)| wa * a + wb * sign * b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(way: Way, values: &[f32], width: usize, time: f64) -> Vec<f64> {
        Track { keys: &[1.0, 3.0], values, width, way }.at(time, width == 4)
    }

    #[test]
    fn values_go_from_key_to_key() {
        for (time, step, linear) in
            [(0.0, 10.0, 10.0), (1.0, 10.0, 10.0), (2.5, 10.0, 25.0), (3.0, 30.0, 30.0), (9.0, 30.0, 30.0)]
        {
            assert_eq!(at(Way::Step, &[10.0, 30.0], 1, time), [step]);
            assert_eq!(at(Way::Linear, &[10.0, 30.0], 1, time), [linear]);
        }
        // With the slope of a straight line at both ends a cubic is the line; without, it is in the middle half-way.
        assert_eq!(at(Way::Cubic, &[0.0, 10.0, 10.0, 10.0, 30.0, 0.0], 1, 1.5), [15.0]);
        assert_eq!(at(Way::Cubic, &[0.0, 10.0, 0.0, 0.0, 30.0, 0.0], 1, 2.0), [20.0]);
    }

    #[test]
    fn turns_go_the_shortest_way_at_a_constant_rate() {
        // From none to a quarter about z, told with the other sign.
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let third = at(Way::Linear, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -half, -half], 4, 1.0 + 2.0 / 3.0);
        let (sin, cos) = ops::sin_cos_degrees(15.0);
        assert!((third[2] - sin).abs() < 1e-7 && (third[3] - cos).abs() < 1e-7, "{third:?}");
    }
}
