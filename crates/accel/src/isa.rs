//! Instruction sets of the vector kernels.

use crate::name::UnknownName;
use std::{fmt, str::FromStr};

/// An instruction set. All give the same hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Isa {
    /// One lane at a time; every machine has it.
    Scalar,
    /// SSE4.2: four lanes.
    Sse,
    /// AVX2: eight lanes.
    Avx2,
    /// AVX-512 (F, DQ and VL): sixteen lanes.
    Avx512,
    /// NEON of 64-bit ARM: four lanes.
    Neon,
}

impl Isa {
    /// All of them, in the order of [`Isa::detect`]'s preference, least first.
    pub const ALL: [Self; 5] = [Self::Scalar, Self::Neon, Self::Sse, Self::Avx2, Self::Avx512];

    /// The best that this processor has.
    pub fn detect() -> Self {
        Self::ALL.into_iter().rev().find(|isa| isa.is_available()).unwrap_or(Self::Scalar)
    }

    /// Whether this processor has it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Sse => is_x86_feature_detected!("sse4.2") && is_x86_feature_detected!("popcnt"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                // Every processor with AVX2 has the bit instructions, and the kernels use them.
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2")
                    && is_x86_feature_detected!("lzcnt")
                    && is_x86_feature_detected!("popcnt")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
                    && Self::Avx2.is_available()
            }
            #[cfg(target_arch = "aarch64")]
            Self::Neon => std::arch::is_aarch64_feature_detected!("neon"),
            #[allow(unreachable_patterns)]
            _ => false,
        }
    }

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse => "sse",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
        }
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Isa {
    type Err = UnknownName;

    fn from_str(s: &str) -> Result<Self, UnknownName> {
        Self::ALL.into_iter().find(|isa| isa.name() == s).ok_or_else(|| UnknownName {
            what: "instruction set",
            name: s.to_owned(),
            known: Self::ALL.map(Self::name).join(", "),
        })
    }
}
