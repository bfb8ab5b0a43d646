//! Where prims stand: their transform ops, as steps.

use straal_math::{Affine, DVec3};
use straal_scene::desc::{Rotation, Step};
use straal_scene::value::{Axis, Factors, Matrix};

use super::stage::Stage;

/// A prim's own transform.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Local {
    /// The first is applied first.
    pub steps: Vec<Step>,
    /// Whether it stands in the world, rather than in the prim that it is in.
    pub is_reset: bool,
    /// An op that isn't known.
    pub unknown: Option<String>,
}

impl Local {
    /// As one map; none where it leaves nothing of what is in it.
    pub fn affine(&self) -> Option<Affine> {
        let mut all = Affine::IDENTITY;
        for step in &self.steps {
            all = all.then(&step.affine()?);
        }
        all.inverse().is_some().then_some(all)
    }
}

/// The transform of a prim at the time that is shown.
pub(super) fn local(stage: &Stage<'_, '_>, prim: usize) -> Local {
    let mut found = Local::default();
    // The first op is the outermost: it is applied last.
    for name in stage.texts(prim, "xformOpOrder").iter().rev() {
        if name == "!resetXformStack!" {
            // What stands before it has no effect.
            found.is_reset = true;
            break;
        }
        let (inverted, name) = match name.strip_prefix("!invert!") {
            Some(name) => (true, name),
            None => (false, name.as_str()),
        };
        let Some(mut steps) = op(stage, prim, name) else {
            found.unknown = Some(name.to_owned());
            continue;
        };
        if inverted {
            let all =
                steps.iter().filter_map(Step::affine).fold(Affine::IDENTITY, |all, step| all.then(&step));
            steps = vec![Step::Matrix(Matrix(all.inverse().unwrap_or(Affine::IDENTITY)))];
        }
        found.steps.append(&mut steps);
    }
    found
}

/// The steps of an op, such as `xformOp:rotateXYZ:lid`; none of what isn't known. An op without a value does nothing.
fn op(stage: &Stage<'_, '_>, prim: usize, name: &str) -> Option<Vec<Step>> {
    let kind = name.strip_prefix("xformOp:")?.split(':').next()?;
    let one = || stage.number(prim, name);
    let three = || stage.vector::<3>(prim, name).map(DVec3::from_array);
    let turn = |axis: u8, degrees: f64| {
        let axis = [DVec3::X, DVec3::Y, DVec3::Z][usize::from(axis - b'X')];
        Step::Rotate(Rotation { axis: Axis(axis), degrees })
    };
    let along = |axis: u8, v: f64, rest: f64| {
        DVec3::from_array(std::array::from_fn(|i| if i == usize::from(axis - b'X') { v } else { rest }))
    };
    let steps = match kind.as_bytes() {
        b"translate" => three().map(|v| vec![Step::Translate(v)]),
        b"scale" => three().map(|v| vec![Step::Scale(Factors(v))]),
        [b't', b'r', b'a', b'n', b's', b'l', b'a', b't', b'e', axis @ b'X'..=b'Z'] => {
            one().map(|v| vec![Step::Translate(along(*axis, v, 0.0))])
        }
        [b's', b'c', b'a', b'l', b'e', axis @ b'X'..=b'Z'] => {
            one().map(|v| vec![Step::Scale(Factors(along(*axis, v, 1.0)))])
        }
        [b'r', b'o', b't', b'a', b't', b'e', axis @ b'X'..=b'Z'] => one().map(|v| vec![turn(*axis, v)]),
        [b'r', b'o', b't', b'a', b't', b'e', axes @ ..]
            if axes.len() == 3 && axes.iter().all(|a| (b'X'..=b'Z').contains(a)) =>
        {
            let degrees = three().map(|v| v.to_array());
            degrees.map(|v| axes.iter().map(|axis| turn(*axis, v[usize::from(axis - b'X')])).collect())
        }
        b"orient" => stage.vector::<4>(prim, name).map(|q| vec![Step::Matrix(Matrix(quaternion(q)))]),
        b"transform" => stage.vector::<16>(prim, name).map(|m| vec![Step::Matrix(Matrix(matrix(&m)))]),
        _ => return None,
    };
    let mut steps = steps.unwrap_or_default();
    steps.retain(|step| !step.affine().is_some_and(|a| a.is_identity()));
    Some(steps)
}

/// A matrix of USD, which is written row by row for vectors that stand before it.
pub(super) fn matrix(m: &[f64; 16]) -> Affine {
    Affine { rows: std::array::from_fn(|i| std::array::from_fn(|j| m[4 * j + i])) }
}

/// The turn of a quaternion x, y, z, w of any length; none where it has none.
pub(super) fn quaternion(q: [f64; 4]) -> Affine {
    crate::scene::gltf::rotation(q)
}
