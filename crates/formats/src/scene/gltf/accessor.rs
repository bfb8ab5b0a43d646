//! Accessors: columns of numbers in buffers, of whatever encoding, and the few of them that are told apart (sparse).

use super::document::{Document, Fault, Result, View, flag, required, size, size_or, text};
use super::json::Json;

/// The numbers of an accessor, one thing after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Numbers {
    /// Numbers of each thing.
    pub channels: usize,
    pub values: Vec<f32>,
}

impl Numbers {
    /// How many things there are.
    pub fn count(&self) -> usize {
        self.values.len() / if self.channels == 0 { 1 } else { self.channels }
    }

    /// As lists of so many numbers; `None` where there are others.
    pub fn lists<const N: usize>(self) -> Option<Vec<[f32; N]>> {
        if self.channels != N {
            return None;
        }
        Some(self.values.chunks_exact(N).map(|chunk| std::array::from_fn(|i| chunk[i])).collect())
    }
}

/// What a number of an accessor is in its buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(at: &Json) -> Result<Self> {
        Ok(match size(at)? {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => return Err(Fault::of(at, format!("{other} is no type of numbers"))),
        })
    }

    const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// A number as it stands.
    fn number(self, b: &[u8]) -> f32 {
        match self {
            Self::I8 => f32::from(b[0] as i8),
            Self::U8 => f32::from(b[0]),
            Self::I16 => f32::from(i16::from_le_bytes([b[0], b[1]])),
            Self::U16 => f32::from(u16::from_le_bytes([b[0], b[1]])),
            Self::U32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32,
            Self::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    /// What a normalised number is divided by.
    const fn most(self) -> f32 {
        match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32_767.0,
            Self::U16 => 65_535.0,
            Self::U32 => 4_294_967_295.0,
            Self::F32 => 1.0,
        }
    }
}

/// How the things of an accessor lie in its buffer.
struct Layout<'a> {
    component: Component,
    channels: usize,
    /// Numbers of a column of a matrix, which begins at a multiple of four bytes; all numbers of anything else.
    rows: usize,
    /// Whether whole numbers stand for shares of the largest.
    normalized: bool,
    count: usize,
    /// Where they are, and from which byte on; nowhere where all are 0.
    view: Option<(View<'a>, usize)>,
}

impl Layout<'_> {
    /// From one column of a matrix to the next.
    fn column(&self) -> usize {
        let bytes = self.rows * self.component.bytes();
        if self.rows == self.channels { bytes } else { bytes.next_multiple_of(4) }
    }

    /// Bytes of a thing.
    fn size(&self) -> usize {
        self.channels / self.rows * self.column()
    }

    fn number(&self, thing: &[u8], channel: usize) -> f32 {
        let at = channel / self.rows * self.column() + channel % self.rows * self.component.bytes();
        let v = self.component.number(&thing[at..]);
        if !self.normalized {
            return v;
        }
        let share = v / self.component.most();
        // The least number of a signed type is beyond -1.
        if share < -1.0 { -1.0 } else { share }
    }
}

impl<'a> Document<'a> {
    /// The numbers of an accessor.
    pub fn numbers(&mut self, at: &Json) -> Result<Numbers> {
        let (_, accessor) = self.item("accessors", at)?;
        let layout = self.layout(accessor)?;
        let total = layout.count.saturating_mul(layout.channels);
        self.spend(accessor, total as u64)?;
        let mut values = Vec::new();
        values.try_reserve_exact(total).map_err(|_| no_memory(accessor))?;
        match &layout.view {
            None => values.resize(total, 0.0),
            Some((view, start)) => {
                for thing in things(view, *start, layout.size(), layout.count) {
                    values.extend((0..layout.channels).map(|c| layout.number(thing, c)));
                }
            }
        }
        if let Some(sparse) = accessor.get("sparse") {
            for (i, thing) in self.sparse(sparse, &layout)? {
                for (c, v) in values[i * layout.channels..][..layout.channels].iter_mut().enumerate() {
                    *v = layout.number(&thing, c);
                }
            }
        }
        Ok(Numbers { channels: layout.channels, values })
    }

    /// The whole numbers of an accessor, as indices are.
    pub fn indices(&mut self, at: &Json) -> Result<Vec<u32>> {
        let (_, accessor) = self.item("accessors", at)?;
        let layout = self.layout(accessor)?;
        if layout.channels != 1
            || !matches!(layout.component, Component::U8 | Component::U16 | Component::U32)
        {
            return Err(Fault::of(accessor, "indices must be unsigned whole numbers, one by one (`SCALAR`)"));
        }
        self.spend(accessor, layout.count as u64)?;
        let mut values = Vec::new();
        values.try_reserve_exact(layout.count).map_err(|_| no_memory(accessor))?;
        match &layout.view {
            None => values.resize(layout.count, 0),
            Some((view, start)) => {
                let things = things(view, *start, layout.size(), layout.count);
                values.extend(things.map(|thing| whole(layout.component, thing)));
            }
        }
        if let Some(sparse) = accessor.get("sparse") {
            for (i, thing) in self.sparse(sparse, &layout)? {
                values[i] = whole(layout.component, &thing);
            }
        }
        Ok(values)
    }

    fn layout(&mut self, accessor: &Json) -> Result<Layout<'a>> {
        let component = Component::of(required(accessor, "componentType")?)?;
        let kind = required(accessor, "type")?;
        let (channels, rows) = match text(kind)? {
            "SCALAR" => (1, 1),
            "VEC2" => (2, 2),
            "VEC3" => (3, 3),
            "VEC4" => (4, 4),
            "MAT2" => (4, 2),
            "MAT3" => (9, 3),
            "MAT4" => (16, 4),
            _ => return Err(Fault::of(kind, "this is no type of an accessor, such as `SCALAR` or `VEC3`")),
        };
        let normalized = flag(accessor, "normalized")? && component != Component::F32;
        let count = size(required(accessor, "count")?)?;
        let mut layout = Layout { component, channels, rows, normalized, count, view: None };
        if let Some(view) = accessor.get("bufferView") {
            let view = self.view(view)?;
            let start = size_or(accessor, "byteOffset", 0)?;
            fits(accessor, &view, start, layout.size(), count)?;
            layout.view = Some((view, start));
        } else if count as u64 > self.held {
            // Things of which each takes no byte: more than there are bytes, no file has a use for.
            return Err(Fault::of(
                accessor,
                format!("{count} things without bytes are more than a file of this size can mean"),
            ));
        }
        Ok(layout)
    }

    /// The things that are told apart: which, and their bytes.
    fn sparse(&mut self, sparse: &Json, layout: &Layout<'_>) -> Result<Vec<(usize, Vec<u8>)>> {
        let count = size(required(sparse, "count")?)?;
        let (which, what) = (required(sparse, "indices")?, required(sparse, "values")?);
        let component = Component::of(required(which, "componentType")?)?;
        if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
            return Err(Fault::of(which, "indices must be unsigned whole numbers"));
        }
        let (indices, first) = (self.view(required(which, "bufferView")?)?, size_or(which, "byteOffset", 0)?);
        fits(which, &indices, first, component.bytes(), count)?;
        let (values, start) = (self.view(required(what, "bufferView")?)?, size_or(what, "byteOffset", 0)?);
        fits(what, &values, start, layout.size(), count)?;
        self.spend(sparse, (count as u64).saturating_mul(layout.channels as u64))?;
        let indices = things(&indices, first, component.bytes(), count);
        let values = things(&values, start, layout.size(), count);
        indices
            .zip(values)
            .map(|(index, thing)| {
                let i = whole(component, index) as usize;
                let is_one = i < layout.count;
                let wrong =
                    || Fault::of(which, format!("one of them is {i}, and there are {}", layout.count));
                if is_one { Ok((i, thing.to_vec())) } else { Err(wrong()) }
            })
            .collect()
    }
}

fn no_memory(at: &Json) -> Fault {
    Fault::of(at, "there is no memory for its numbers")
}

/// An unsigned whole number.
fn whole(component: Component, b: &[u8]) -> u32 {
    match component {
        Component::U8 => u32::from(b[0]),
        Component::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
        _ => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
    }
}

/// From one thing to the next.
fn step(view: &View<'_>, size: usize) -> usize {
    view.stride.unwrap_or(size)
}

/// Complains where so many things of that size don't fit into a view.
fn fits(at: &Json, view: &View<'_>, start: usize, size: usize, count: usize) -> Result<()> {
    let steps = (count.saturating_sub(1)).checked_mul(step(view, size));
    let end = steps.and_then(|steps| steps.checked_add(size)?.checked_add(start));
    let has = view.bytes().len();
    if count > 0 && end.is_none_or(|end| end > has) {
        let message = format!(
            "{count} things of {size} bytes each, {} apart and from byte {start} on, are more than the {has} bytes of the buffer view",
            step(view, size)
        );
        return Err(Fault::of(at, message));
    }
    Ok(())
}

/// The bytes of things that fit.
fn things<'v>(view: &'v View<'_>, start: usize, size: usize, count: usize) -> impl Iterator<Item = &'v [u8]> {
    let (bytes, step) = (view.bytes(), step(view, size));
    (0..count).map(move |i| &bytes[start + i * step..][..size])
}
