//! Direct convolution of images, without an im2col matrix. Sums for four output channels by sixteen pixels stay in
//! registers while the code runs over input channels and taps in a fixed order.

use super::super::read::unsupported;
use super::super::tensor::{MemoryBudget, Tensor};
use super::call::{Call, Settings};
use super::pool::{Padding, Window};
use crate::error::{Error, Result};
use crate::exec;
use crate::simd::widest;

/// Number of neighbouring pixels of a row whose sums are accumulated together.
const LANES: usize = 16;
/// Number of output channels whose sums are accumulated together.
const GROUP: usize = 4;

pub struct Conv {
    window: Window,
    groups: usize,
    /// Number of rows and columns that a transposed convolution adds at the end of its output.
    output_padding: [usize; 2],
    output_shape: Option<Vec<i64>>,
}

impl Conv {
    pub fn read(at: &Settings) -> Result<Self> {
        let groups = usize::try_from(at.integer("group", 1)).ok().filter(|g| (1..=65536).contains(g));
        let groups = groups.ok_or_else(|| Error::format("group must lie in [1, 65536]"))?;
        let output_padding = at.sizes("output_padding", 0)?;
        Ok(Self { window: Window::read(at)?, groups, output_padding, output_shape: at.integers("output_shape") })
    }

    /// Convolves the input with weights of the shape `[out, in / groups, rows, columns]`.
    pub fn run(&self, call: &Call) -> Result<Tensor> {
        let (x, weights, bias) = (call.input(0)?, call.input(1)?, call.optional(2));
        let [batch, channels, height, width] = x.shape_of()?;
        let [out_channels, per_group, rows, columns] = weights.shape_of()?;
        let groups = self.groups;
        if per_group * groups != channels || out_channels % groups != 0 || out_channels == 0 || rows * columns == 0 {
            return Err(Error::format(format!(
                "weights of shape {:?} in {groups} groups do not fit an input of shape {:?}",
                weights.shape, x.shape
            )));
        }
        let zeros;
        let bias = match bias {
            Some(bias) => biases(bias, out_channels)?,
            None => {
                zeros = call.budget.vec(out_channels, 0.0)?;
                &zeros
            }
        };
        let placement = self.window.place([height, width], [rows, columns], false)?;
        let padded = Padded::of(x.as_floats()?, batch * channels, [height, width], &placement, call.budget)?;
        let [out_height, out_width] = placement.out;
        let shape = vec![batch, out_channels, out_height, out_width];
        let mut out = call.budget.zeros(&shape)?;

        // Accumulate four, two or one output channels together: the largest of these numbers that divides the number
        // of output channels per group, so that the channels accumulated together read the same inputs.
        let of_group = out_channels / groups;
        let together = [GROUP, 2, 1].into_iter().find(|n| of_group.is_multiple_of(*n)).unwrap_or(1);
        let weights = weights.as_floats()?;
        let taps = Taps { per_group, rows, columns, strides: self.window.strides, dilations: self.window.dilations };
        exec::for_rows(&mut out, together * out_height * out_width, call.job, |k, out| {
            let channel = k * together % out_channels;
            let image = k * together / out_channels;
            let plane = padded.height * padded.width;
            let first = image * channels + channel / of_group * per_group;
            let source = Planes { values: &padded.values[first * plane..], height: padded.height, width: padded.width };
            let size = per_group * rows * columns;
            let mine =
                Weights { taps: &weights[channel * size..][..together * size], bias: &bias[channel..][..together] };
            for y in 0..out_height {
                if call.job.is_cancelled() {
                    return;
                }
                match together {
                    GROUP => four_channels(&source, &mine, &taps, y, out_width, out),
                    2 => two(&source, &mine, &taps, y, out_width, out),
                    _ => single(&source, &mine, &taps, y, out_width, out),
                }
            }
        })?;
        call.job.check()?;
        Ok(Tensor::floats(shape, out))
    }

    /// Transposed convolution with weights of the shape `[in, out / groups, rows, columns]`. Each output pixel gathers
    /// the input pixels that contribute to it.
    pub fn run_transposed(&self, call: &Call) -> Result<Tensor> {
        let (x, weights, bias) = (call.input(0)?, call.input(1)?, call.optional(2));
        let [batch, channels, height, width] = x.shape_of()?;
        let [in_channels, of_group, rows, columns] = weights.shape_of()?;
        let Window { strides, dilations, padding, .. } = &self.window;
        let out_channels = of_group * self.groups;
        if in_channels != channels || channels % self.groups != 0 || out_channels == 0 || rows * columns == 0 {
            return Err(Error::format(format!(
                "weights of shape {:?} in {} groups do not fit an input of shape {:?}",
                weights.shape, self.groups, x.shape
            )));
        }
        let Padding::Explicit(pads) = padding else { return Err(unsupported("automatic padding of ConvTranspose")) };
        if self.output_shape.is_some() {
            return Err(unsupported("ConvTranspose with output_shape"));
        }
        let out_size = |axis: usize, size: usize, kernel: usize| {
            let whole =
                strides[axis] * size.saturating_sub(1) + self.output_padding[axis] + (kernel - 1) * dilations[axis] + 1;
            let cut = pads[axis] + pads[axis + 2];
            whole.checked_sub(cut).ok_or_else(|| Error::format(format!("pads of {cut} remove all of {whole}")))
        };
        let (out_height, out_width) = (out_size(0, height, rows)?, out_size(1, width, columns)?);
        let shape = vec![batch, out_channels, out_height, out_width];
        let mut out = call.budget.zeros(&shape)?;
        let (values, weights) = (x.as_floats()?, weights.as_floats()?);
        let bias = bias.map(|bias| biases(bias, out_channels)).transpose()?;
        let per_group = channels / self.groups;
        exec::for_rows(&mut out, out_height * out_width, call.job, |k, out| {
            let (image, channel) = (k / out_channels, k % out_channels);
            let group = channel / of_group;
            out.fill(bias.map_or(0.0, |bias| bias[channel]));
            for c in group * per_group..(group + 1) * per_group {
                if call.job.is_cancelled() {
                    return;
                }
                let source = &values[(image * channels + c) * height * width..][..height * width];
                let kernel = &weights[(c * of_group + channel % of_group) * rows * columns..][..rows * columns];
                for (y, row) in source.chunks_exact(width.max(1)).enumerate() {
                    for (i, taps) in kernel.chunks_exact(columns).enumerate() {
                        let to = (y * strides[0] + i * dilations[0]).checked_sub(pads[0]).filter(|to| *to < out_height);
                        let Some(to) = to else { continue };
                        let out = &mut out[to * out_width..][..out_width];
                        for (j, &tap) in taps.iter().enumerate() {
                            for (x, &v) in row.iter().enumerate() {
                                let to = (x * strides[1] + j * dilations[1]).checked_sub(pads[1]);
                                if let Some(out) = to.and_then(|to| out.get_mut(to)) {
                                    *out += tap * v;
                                }
                            }
                        }
                    }
                }
            }
        })?;
        call.job.check()?;
        Ok(Tensor::floats(shape, out))
    }
}

/// Images with a border of zeros.
struct Padded {
    values: Vec<f32>,
    height: usize,
    width: usize,
}

impl Padded {
    fn of(
        values: &[f32],
        planes: usize,
        size: [usize; 2],
        placement: &super::pool::Placement,
        budget: MemoryBudget,
    ) -> Result<Self> {
        let [height, width] = size;
        let [top, left] = placement.before;
        let (padded_height, padded_width) =
            (placement.extent[0].max(height + top), placement.extent[1].max(width + left));
        let mut padded = budget.zeros(&[planes, padded_height, padded_width])?;
        for (k, row) in values.chunks_exact(width.max(1)).enumerate() {
            let (plane, y) = (k / height, k % height);
            padded[(plane * padded_height + y + top) * padded_width + left..][..width].copy_from_slice(row);
        }
        Ok(Self { values: padded, height: padded_height, width: padded_width })
    }
}

/// The input channels of one group. Their planes are stored one after another from the start of `values`; planes of
/// other channels may follow.
struct Planes<'a> {
    values: &'a [f32],
    height: usize,
    width: usize,
}

/// The values of a tensor of biases, one for each channel.
fn biases(tensor: &Tensor, channels: usize) -> Result<&[f32]> {
    if tensor.len() != channels {
        return Err(Error::format(format!("{} biases for {channels} channels", tensor.len())));
    }
    tensor.as_floats()
}

struct Weights<'a> {
    /// Weights of the output channels that are accumulated together, one channel after another.
    taps: &'a [f32],
    bias: &'a [f32],
}

struct Taps {
    per_group: usize,
    rows: usize,
    columns: usize,
    strides: [usize; 2],
    dilations: [usize; 2],
}

/// Computes row `y` of `N` output channels.
#[inline(always)]
fn row<const N: usize>(source: &Planes, weights: &Weights, taps: &Taps, y: usize, width: usize, out: &mut [f32]) {
    let plane = out.len() / N;
    let of_channel = taps.per_group * taps.rows * taps.columns;
    let stride = taps.strides[1];
    for x in (0..width).step_by(LANES) {
        let count = LANES.min(width - x);
        let mut sum = [[0.0; LANES]; N];
        for n in 0..N {
            sum[n] = [weights.bias[n]; LANES];
        }
        for c in 0..taps.per_group {
            for i in 0..taps.rows {
                let line = (c * source.height + y * taps.strides[0] + i * taps.dilations[0]) * source.width;
                let line = &source.values[line..line + source.width];
                let tap = (c * taps.rows + i) * taps.columns;
                for j in 0..taps.columns {
                    let start = x * stride + j * taps.dilations[1];
                    let mut pixels = [0.0; LANES];
                    if stride == 1 && count == LANES {
                        pixels.copy_from_slice(&line[start..start + LANES]);
                    } else {
                        for (k, pixel) in pixels[..count].iter_mut().enumerate() {
                            *pixel = line[start + k * stride];
                        }
                    }
                    for n in 0..N {
                        let weight = weights.taps[n * of_channel + tap + j];
                        for k in 0..LANES {
                            sum[n][k] += weight * pixels[k];
                        }
                    }
                }
            }
        }
        for n in 0..N {
            out[n * plane + y * width + x..][..count].copy_from_slice(&sum[n][..count]);
        }
    }
}

widest! {
    fn four_channels(source: &Planes, weights: &Weights, taps: &Taps, y: usize, width: usize, out: &mut [f32]) {
        row::<GROUP>(source, weights, taps, y, width, out);
    }
}

widest! {
    fn two(source: &Planes, weights: &Weights, taps: &Taps, y: usize, width: usize, out: &mut [f32]) {
        row::<2>(source, weights, taps, y, width, out);
    }
}

widest! {
    fn single(source: &Planes, weights: &Weights, taps: &Taps, y: usize, width: usize, out: &mut [f32]) {
        row::<1>(source, weights, taps, y, width, out);
    }
}
