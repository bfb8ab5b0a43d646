//! Values of a binary layer, of every type that is asked for.

use straal_scene::bitmap;

use super::super::layer::{Kind, Value};
use super::{Cursor, File, Rep, Result};

/// Where numbers of a type are.
#[derive(Clone, Copy)]
pub(super) enum Number {
    Bool,
    Byte,
    Int { wide: bool, signed: bool },
    Half,
    Float,
    Double,
}

impl Number {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::Bool | Self::Byte => 1,
            Self::Half => 2,
            Self::Int { wide: false, .. } | Self::Float => 4,
            Self::Int { wide: true, .. } | Self::Double => 8,
        }
    }

    pub(super) fn of(self, bytes: &[u8]) -> f64 {
        let mut all = [0; 8];
        all[..bytes.len()].copy_from_slice(bytes);
        let bits = u64::from_le_bytes(all);
        match self {
            Self::Bool => f64::from(u8::from(bits != 0)),
            Self::Byte => bits as f64,
            Self::Int { wide, signed } => whole(bits as i64, wide, signed),
            Self::Half => f64::from(bitmap::of_half(bits as u16)),
            Self::Float => f64::from(f32::from_bits(bits as u32)),
            Self::Double => f64::from_bits(bits),
        }
    }
}

fn whole(v: i64, wide: bool, signed: bool) -> f64 {
    match (wide, signed) {
        (true, true) => v as f64,
        (true, false) => v as u64 as f64,
        (false, true) => f64::from(v as i32),
        (false, false) => f64::from(v as u32),
    }
}

/// Of types that are numbers: of which kind they are, and how many each has.
pub(super) fn numbers_of(kind: u8) -> Option<(Number, usize)> {
    let int = |wide, signed| Number::Int { wide, signed };
    Some(match kind {
        1 => (Number::Bool, 1),
        2 => (Number::Byte, 1),
        3 => (int(false, true), 1),
        4 => (int(false, false), 1),
        5 => (int(true, true), 1),
        6 => (int(true, false), 1),
        7 => (Number::Half, 1),
        8 => (Number::Float, 1),
        9 | 56 => (Number::Double, 1),
        13 => (Number::Double, 4),
        14 => (Number::Double, 9),
        15 => (Number::Double, 16),
        16 => (Number::Double, 4),
        17 => (Number::Float, 4),
        18 => (Number::Half, 4),
        19..=30 => {
            let number =
                [Number::Double, Number::Float, Number::Half, int(false, true)][usize::from(kind - 19) % 4];
            (number, usize::from(kind - 19) / 4 + 2)
        }
        _ => return None,
    })
}

impl File {
    /// A value, read.
    pub fn value(&self, rep: Rep) -> Result<Value> {
        if let Some(known) = self.known.borrow().get(&rep) {
            return Ok(known.clone());
        }
        let value = self.read_value(rep)?;
        if !rep.is_inlined() {
            self.known.borrow_mut().insert(rep, value.clone());
        }
        Ok(value)
    }

    pub(super) fn read_value(&self, rep: Rep) -> Result<Value> {
        if let Some((number, width)) = numbers_of(rep.kind()) {
            return self.numbers(rep, number, width);
        }
        let word =
            |index| if rep.kind() == 10 { self.string(index) } else { self.token(index) }.map(str::to_owned);
        match rep.kind() {
            10..=12 if rep.is_array() => {
                if rep.payload() == 0 {
                    return Ok(Value::Texts(Vec::new()));
                }
                let mut at = self.at(rep)?;
                let count = self.length(&mut at, 4)?;
                (0..count).map(|_| word(u64::from(at.u32()?))).collect::<Result<_>>().map(Value::Texts)
            }
            10..=12 if rep.is_inlined() => word(rep.payload()).map(Value::Text),
            40 | 41 | 50 => {
                let mut at = self.at(rep)?;
                let one = |at: &mut Cursor<'_>| {
                    let index = at.u32()?;
                    match rep.kind() {
                        40 => self.path(index),
                        41 => Ok(self.token(u64::from(index))?.to_owned()),
                        _ => Ok(self.string(u64::from(index))?.to_owned()),
                    }
                };
                (0..at.count(4)?).map(|_| one(&mut at)).collect::<Result<_>>().map(Value::Texts)
            }
            48 => {
                let mut at = self.at(rep)?;
                let count = at.count(8)?;
                self.take(count)?;
                let values = (0..count).map(|_| at.u64().map(f64::from_bits)).collect::<Result<_>>()?;
                Ok(Value::numbers(1, values, Kind::Real))
            }
            51 | 60 => Ok(Value::Blocked),
            _ => Ok(Value::Other),
        }
    }

    /// How many things an array has, of so many bytes each at least.
    pub(super) fn length(&self, at: &mut Cursor<'_>, each: usize) -> Result<usize> {
        if self.version < [0, 5, 0] {
            at.u32()?;
        }
        if self.version < [0, 7, 0] {
            let count = at.u32()? as usize;
            let fits = count.saturating_mul(each) <= at.bytes.len();
            return if fits { Ok(count) } else { Err("an array is longer than the file".to_owned()) };
        }
        at.count(each)
    }

    /// Takes note of numbers that are made.
    pub(super) fn take(&self, count: usize) -> Result<()> {
        let mut room = self.room.borrow_mut();
        *room = room.checked_sub(count).ok_or("it has more numbers than its size lets expect")?;
        Ok(())
    }

    pub(super) fn numbers(&self, rep: Rep, number: Number, width: usize) -> Result<Value> {
        let kind = match number {
            _ if matches!(rep.kind(), 16..=18) => Kind::Turn,
            Number::Bool | Number::Byte | Number::Int { .. } => Kind::Whole,
            _ => Kind::Real,
        };
        let payload = rep.payload();
        let made = |values| Ok(Value::numbers(width, values, kind));
        if rep.is_array() {
            if payload == 0 {
                return made(Vec::new());
            }
            return made(self.array(rep, number, width)?);
        }
        if !rep.is_inlined() {
            let bytes = self.at(rep)?.take(width * number.bytes())?;
            return made(bytes.chunks_exact(number.bytes()).map(|b| number.of(b)).collect());
        }
        let bytes = payload.to_le_bytes();
        let signed = |i: usize| f64::from(bytes[i] as i8);
        match rep.kind() {
            13..=15 => {
                // The diagonal of a matrix.
                let side = usize::from(rep.kind() - 11);
                made((0..width).map(|i| if i % (side + 1) == 0 { signed(i / side) } else { 0.0 }).collect())
            }
            16..=30 => made((0..width).map(signed).collect()),
            5 => made(vec![f64::from(payload as i32)]),
            6 => made(vec![f64::from(payload as u32)]),
            9 | 56 => made(vec![f64::from(f32::from_bits(payload as u32))]),
            _ => made(vec![number.of(&bytes[..number.bytes()])]),
        }
    }

    pub(super) fn array(&self, rep: Rep, number: Number, width: usize) -> Result<Vec<f64>> {
        /// Shorter arrays aren't packed.
        const SHORT: usize = 16;
        let mut at = self.at(rep)?;
        let is_packed = rep.is_packed() && width == 1;
        if !is_packed {
            let each = width * number.bytes();
            let count = self.length(&mut at, each)?;
            self.take(count * width)?;
            let bytes = at.take(count * each)?;
            return Ok(bytes.chunks_exact(number.bytes()).map(|b| number.of(b)).collect());
        }
        let count = if self.version < [0, 7, 0] { u64::from(at.u32()?) } else { at.u64()? };
        let count = self.table(count)?;
        self.take(count)?;
        if count < SHORT {
            let bytes = at.take(count * number.bytes())?;
            return Ok(bytes.chunks_exact(number.bytes()).map(|b| number.of(b)).collect());
        }
        if let Number::Int { wide, signed } = number {
            let values = self.packed_ints(&mut at, count, wide)?;
            return Ok(values.into_iter().map(|v| whole(v, wide, signed)).collect());
        }
        match at.take(1)?[0] {
            // Whole numbers, or indices into a table.
            b'i' => Ok(self.ints(&mut at, count)?.into_iter().map(|v| f64::from(v as i32)).collect()),
            b't' => {
                let entries = at.u32()? as usize;
                let bytes = at.take(entries.saturating_mul(number.bytes()))?;
                let table: Vec<f64> = bytes.chunks_exact(number.bytes()).map(|b| number.of(b)).collect();
                let entry = |i: i64| table.get(i as u32 as usize).copied().ok_or("a table is too short");
                Ok(self
                    .ints(&mut at, count)?
                    .into_iter()
                    .map(entry)
                    .collect::<std::result::Result<_, _>>()?)
            }
            _ => Err("its numbers are packed in a way that isn't known".to_owned()),
        }
    }
}
