//! Whether two structures found the same.

use super::Kind;
use straal_accel::Hit;

/// What a search answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// What a primary or bounce ray hits first.
    Hit(Hit),
    /// Whether a shadow ray hits anything.
    Blocked(bool),
}

/// A ray on which two structures disagree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Of the ray.
    pub kind: Kind,
    /// Its number among the recorded rays of its kind, from 0.
    pub ray: usize,
    /// What the baseline found.
    pub expected: Answer,
    /// What this structure found.
    pub found: Answer,
}

/// How two structures compare.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Answers that were compared.
    pub compared: usize,
    /// How many differ.
    pub differing: usize,
    /// The first of these; at most [`Agreement::TOLD`].
    pub first: Vec<Difference>,
}

impl Agreement {
    /// Differences that are told.
    pub const TOLD: usize = 5;

    /// Whether all is the same.
    pub fn is_whole(&self) -> bool {
        self.differing == 0
    }

    /// Compares the answer to one ray.
    pub fn compare(&mut self, kind: Kind, ray: usize, [expected, found]: [Answer; 2]) {
        self.compared += 1;
        if !same(&expected, &found) {
            self.differing += 1;
            if self.first.len() < Self::TOLD {
                self.first.push(Difference { kind, ray, expected, found });
            }
        }
    }
}

/// The same to the last bit: t, u, v, the primitive and the instances it lies in.
fn same(a: &Answer, b: &Answer) -> bool {
    match (a, b) {
        (Answer::Blocked(a), Answer::Blocked(b)) => a == b,
        (Answer::Hit(a), Answer::Hit(b)) => {
            let bits = |h: &Hit| [h.t, h.u, h.v].map(f32::to_bits);
            bits(a) == bits(b) && (a.geometry, a.primitive, a.chain) == (b.geometry, b.primitive, b.chain)
        }
        _ => false,
    }
}

impl Answer {
    /// In words.
    pub fn tell(&self) -> String {
        match self {
            Self::Blocked(true) => "blocked".into(),
            Self::Blocked(false) => "free".into(),
            Self::Hit(h) if !h.is_hit() => "a miss".into(),
            Self::Hit(h) => {
                let chain: Vec<String> = h.chain.iter().map(|id| id.to_string()).collect();
                let inside = if chain.is_empty() {
                    String::new()
                } else {
                    format!(" in instance {}", chain.join(" > "))
                };
                format!(
                    "t {:?}, u {:?}, v {:?} on geometry {}, primitive {}{inside}",
                    h.t, h.u, h.v, h.geometry, h.primitive
                )
            }
        }
    }
}

impl Difference {
    /// In words.
    pub fn tell(&self) -> String {
        format!(
            "{} ray {}: {} instead of {}",
            self.kind.name(),
            self.ray,
            self.found.tell(),
            self.expected.tell()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_accel::Chain;

    const HIT: Hit = Hit { t: 1.0, u: 0.25, v: 0.5, geometry: 3, primitive: 7, chain: Chain::EMPTY };

    fn differs(doctored: Hit) -> bool {
        let mut a = Agreement::default();
        a.compare(Kind::Primary, 0, [Answer::Hit(HIT), Answer::Hit(doctored)]);
        !a.is_whole()
    }

    #[test]
    fn the_least_thing_that_a_broken_structure_could_do_is_told() {
        assert!(!differs(HIT));
        assert!(differs(Hit { t: f32::from_bits(1.0_f32.to_bits() + 1), ..HIT }), "the last bit of t");
        assert!(differs(Hit { u: 0.3, ..HIT }) && differs(Hit { v: 0.3, ..HIT }));
        assert!(differs(Hit { geometry: 4, ..HIT }) && differs(Hit { primitive: 8, ..HIT }));
        assert!(differs(Hit::MISS));
        assert!(differs(Hit { u: -0.0, v: 0.5, ..HIT }));
    }

    #[test]
    fn differences_are_counted_and_the_first_are_told() {
        let mut a = Agreement::default();
        for ray in 0..20 {
            let found = if ray % 2 == 0 { HIT } else { Hit::MISS };
            a.compare(Kind::Bounce, ray, [Answer::Hit(HIT), Answer::Hit(found)]);
        }
        a.compare(Kind::Shadow, 3, [Answer::Blocked(true), Answer::Blocked(true)]);
        assert_eq!((a.compared, a.differing, a.first.len()), (21, 10, 5));
        assert_eq!(
            a.first[0].tell(),
            "bounce ray 1: a miss instead of t 1.0, u 0.25, v 0.5 on geometry 3, primitive 7"
        );
    }
}
