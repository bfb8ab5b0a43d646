//! The network's layers: which there are, what each reads, and its weights in the order in which the convolution reads them.
//!
//! Open Image Denoise's U-Net goes down four levels, each of half the width and height, and up again. On its way up, every level takes the
//! result of the level below, each pixel four times, and beside it what it knew on the way down. All layers are convolutions by 3x3
//! weights with zeros beyond the rim, followed by max(x, 0).

use crate::tza::Tensor;
use crate::{DenoiseError, Signal, WeightsError};
use straal_math::simd::{BLOCK, Block};

/// Pixels of a picture are completed to a multiple of this, since its width and height are halved four times.
pub(crate) const ALIGNMENT: usize = 16;

/// What a layer does besides its convolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Plain,
    /// Of each 2x2 pixels of the result the greatest remains.
    Pool,
    /// What came before is read with each pixel four times, then the output of the named layer.
    Up(&'static str),
}

/// The network's own inputs, by name.
const INPUT: &str = "input";

/// Layers of the usual network and of the small one.
const BASE: &[(&str, Kind)] = &[
    ("enc_conv0", Kind::Plain),
    ("enc_conv1", Kind::Pool),
    ("enc_conv2", Kind::Pool),
    ("enc_conv3", Kind::Pool),
    ("enc_conv4", Kind::Pool),
    ("enc_conv5a", Kind::Plain),
    ("enc_conv5b", Kind::Plain),
    ("dec_conv4a", Kind::Up("enc_conv3")),
    ("dec_conv4b", Kind::Plain),
    ("dec_conv3a", Kind::Up("enc_conv2")),
    ("dec_conv3b", Kind::Plain),
    ("dec_conv2a", Kind::Up("enc_conv1")),
    ("dec_conv2b", Kind::Plain),
    ("dec_conv1a", Kind::Up(INPUT)),
    ("dec_conv1b", Kind::Plain),
    ("dec_conv0", Kind::Plain),
];

/// Layers of the large network.
const LARGE: &[(&str, Kind)] = &[
    ("enc_conv1a", Kind::Plain),
    ("enc_conv1b", Kind::Pool),
    ("enc_conv2a", Kind::Plain),
    ("enc_conv2b", Kind::Pool),
    ("enc_conv3a", Kind::Plain),
    ("enc_conv3b", Kind::Pool),
    ("enc_conv4a", Kind::Plain),
    ("enc_conv4b", Kind::Pool),
    ("enc_conv5a", Kind::Plain),
    ("enc_conv5b", Kind::Plain),
    ("dec_conv4a", Kind::Up("enc_conv3b")),
    ("dec_conv4b", Kind::Plain),
    ("dec_conv3a", Kind::Up("enc_conv2b")),
    ("dec_conv3b", Kind::Plain),
    ("dec_conv2a", Kind::Up("enc_conv1b")),
    ("dec_conv2b", Kind::Plain),
    ("dec_conv1a", Kind::Up(INPUT)),
    ("dec_conv1b", Kind::Plain),
    ("dec_conv1c", Kind::Plain),
];

/// What a layer reads; tensor 0 is the network's input, tensor k + 1 the output of layer k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reads {
    /// One tensor of the layer's own level.
    Plain(usize),
    /// One of the level below, each pixel four times, and one of its own level.
    Up { below: usize, beside: usize },
}

/// The shape of a tensor: which part of the picture's width and height, how many channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    /// Width and height are those of the picture divided by two to this power.
    pub level: u32,
    pub channels: usize,
}

impl Shape {
    pub fn blocks(self) -> usize {
        self.channels.div_ceil(BLOCK)
    }
}

/// One convolution.
#[derive(Clone, Debug)]
pub(crate) struct Layer {
    pub reads: Reads,
    pub pools: bool,
    pub weights: Weights,
}

/// Weights in the order in which they are read. All are by block of output channels.
#[derive(Clone, Debug)]
pub(crate) struct Weights {
    pub bias: Vec<Block<f32>>,
    /// Of the tensor of the layer's own level: by block of input channels, row, column, input channel.
    pub plain: Vec<Block<f32>>,
    /// Of the tensor of the level below, for each of the four pixels that are made of one (by the parity of row, then column): by
    /// block of input channels, one of two rows, one of two columns, input channel. A pixel and its copies lie under up to four of the nine weights, whose sum is what counts.
    pub below: [Vec<Block<f32>>; 4],
}

/// A network with its weights, ready to run.
#[derive(Clone, Debug)]
pub struct Network {
    pub(crate) layers: Vec<Layer>,
    /// Of every tensor; the last is red, green and blue.
    pub(crate) shapes: Vec<Shape>,
    pub(crate) signal: Signal,
}

impl Network {
    /// Makes a network of an archive of weights (TZA, of Open Image Denoise's filter `RT`) that was trained for that signal.
    pub fn from_archive(bytes: &[u8], signal: Signal) -> Result<Self, WeightsError> {
        let tensors = crate::tza::read(bytes)?;
        let is_large = tensors.iter().any(|t| t.name == "enc_conv1b.weight");
        let names = if is_large { LARGE } else { BASE };
        let first = convolution(&tensors, names[0].0)?;
        let inputs = first.0.shape[1];
        let is_known = match signal {
            Signal::Light => matches!(inputs, 3 | 6 | 9),
            Signal::Albedo | Signal::Normal => inputs == 3,
        };
        if !is_known {
            return Err(WeightsError::Inputs(inputs));
        }
        let mut network =
            Self { layers: Vec::new(), shapes: vec![Shape { level: 0, channels: inputs }], signal };
        for (name, kind) in names {
            network.add(&tensors, names, name, *kind)?;
        }
        let last = network.shapes[network.shapes.len() - 1];
        if last != (Shape { level: 0, channels: 3 }) {
            return Err(WeightsError::Tensor(names[names.len() - 1].0.to_owned()));
        }
        Ok(network)
    }

    /// Pictures of three channels that it wants: colours alone, also albedo, or also normals.
    pub fn inputs(&self) -> usize {
        self.shapes[0].channels / 3
    }

    /// Whether it was trained with such guides.
    pub(crate) fn check(&self, [albedo, normal]: [bool; 2]) -> Result<(), DenoiseError> {
        let kinds = ["colour alone", "colour and albedo", "colour, albedo and normals"];
        let given = match (albedo, normal) {
            (false, false) => kinds[0],
            (true, false) => kinds[1],
            (true, true) => kinds[2],
            (false, true) => "colour and normals",
        };
        let wanted = kinds[self.inputs() - 1];
        if wanted == given { Ok(()) } else { Err(DenoiseError::Layers { wanted, given }) }
    }

    fn add(
        &mut self,
        tensors: &[Tensor],
        names: &[(&str, Kind)],
        name: &str,
        kind: Kind,
    ) -> Result<(), WeightsError> {
        let (weight, bias) = convolution(tensors, name)?;
        let before = self.layers.len();
        let wrong = || WeightsError::Tensor(format!("{name}.weight"));
        let (reads, level) = match kind {
            Kind::Plain | Kind::Pool => (Reads::Plain(before), self.shapes[before].level),
            Kind::Up(other) => {
                let beside = names.iter().position(|(n, _)| *n == other).map_or(0, |k| k + 1);
                (Reads::Up { below: before, beside }, self.shapes[beside].level)
            }
        };
        let pools = kind == Kind::Pool;
        let channels = weight.shape[0];
        let split = match reads {
            Reads::Plain(from) => [0, self.shapes[from].channels],
            Reads::Up { below, beside } => [self.shapes[below].channels, self.shapes[beside].channels],
        };
        if split[0] + split[1] != weight.shape[1] {
            return Err(wrong());
        }
        let is_last = before + 1 == names.len();
        let weights = if is_last {
            if channels != 3 {
                return Err(wrong());
            }
            Weights::of_last(weight, bias)
        } else {
            Weights::new(weight, bias, split)
        };
        self.layers.push(Layer { reads, pools, weights });
        self.shapes.push(Shape { level: level + u32::from(pools), channels });
        Ok(())
    }
}

/// Weights and bias of a layer, whose shapes fit each other.
fn convolution<'a>(tensors: &'a [Tensor], name: &str) -> Result<(&'a Tensor, &'a Tensor), WeightsError> {
    let find = |part: &str| {
        let name = format!("{name}.{part}");
        tensors.iter().find(|t| t.name == name).ok_or(WeightsError::Missing(name))
    };
    let (weight, bias) = (find("weight")?, find("bias")?);
    match (&weight.shape[..], &bias.shape[..]) {
        (&[o, i, 3, 3], &[b]) if o == b && (1..=1024).contains(&o) && (1..=2048).contains(&i) => {
            Ok((weight, bias))
        }
        _ => Err(WeightsError::Tensor(weight.name.clone())),
    }
}

impl Weights {
    /// Of a layer that reads `below` channels of the level below, then `beside` channels of its own.
    fn new(weight: &Tensor, bias: &Tensor, [below, beside]: [usize; 2]) -> Self {
        let [outputs, inputs] = [weight.shape[0], weight.shape[1]];
        let blocks = outputs.div_ceil(BLOCK);
        let at = |o: usize, i: usize, row: usize, column: usize| {
            if o < outputs { weight.numbers[((o * inputs + i) * 3 + row) * 3 + column] } else { 0.0 }
        };
        let lanes = |block: usize, of: &dyn Fn(usize) -> f32| {
            Block(std::array::from_fn(|lane| of(block * BLOCK + lane)))
        };
        let mut plain = Vec::with_capacity(blocks * beside * 9);
        for block in 0..blocks {
            for (group, row, column) in places(beside, 3) {
                let inputs = group.map(|i| below + i);
                plain.extend(inputs.map(|i| lanes(block, &|o| at(o, i, row, column))));
            }
        }
        let of_parity = |parity: usize| {
            let mut sums = Vec::with_capacity(blocks * below * 4);
            for block in 0..blocks {
                for (group, row, column) in places(below, 2) {
                    let rows = under(parity >> 1, row);
                    let columns = under(parity & 1, column);
                    let sum = |o: usize, i: usize| {
                        let each = rows.clone().flat_map(|r| columns.clone().map(move |c| (r, c)));
                        each.fold(0.0, |sum, (r, c)| sum + at(o, i, r, c))
                    };
                    sums.extend(group.map(|i| lanes(block, &|o| sum(o, i))));
                }
            }
            sums
        };
        let bias = (0..blocks).map(|block| lanes(block, &|o| bias.numbers.get(o).copied().unwrap_or(0.0)));
        Self { bias: bias.collect(), plain, below: std::array::from_fn(of_parity) }
    }

    /// Of the last layer, whose three outputs would leave most lanes idle: lane 3 c + o has what column c of the weights gives to output o, and the three are
    /// added up pixel by pixel. The rows are as ever.
    fn of_last(weight: &Tensor, bias: &Tensor) -> Self {
        let inputs = weight.shape[1];
        let lane = |lane: usize, i: usize, row: usize| match lane {
            0..9 => weight.numbers[((lane % 3 * inputs + i) * 3 + row) * 3 + lane / 3],
            _ => 0.0,
        };
        let mut plain = Vec::with_capacity(inputs * 3);
        for start in (0..inputs).step_by(BLOCK) {
            for row in 0..3 {
                let group = start..inputs.min(start + BLOCK);
                plain.extend(group.map(|i| Block(std::array::from_fn(|l| lane(l, i, row)))));
            }
        }
        let bias = Block(std::array::from_fn(|o| bias.numbers.get(o).copied().unwrap_or(0.0)));
        Self { bias: vec![bias], plain, below: Default::default() }
    }
}

/// Blocks of channels with each row and column of a square, in the order of the weights.
fn places(channels: usize, side: usize) -> impl Iterator<Item = (std::ops::Range<usize>, usize, usize)> {
    (0..channels).step_by(BLOCK).flat_map(move |start| {
        let group = start..channels.min(start + BLOCK);
        (0..side * side).map(move |k| (group.clone(), k / side, k % side))
    })
}

/// Which of three weights lie over the first or second of the two pixels that a pixel of this parity sees of the level below: an even
/// one sees the end of the pixel before and both copies of its own.
fn under(parity: usize, which: usize) -> std::ops::Range<usize> {
    let split = 1 + parity;
    if which == 0 { 0..split } else { split..3 }
}
