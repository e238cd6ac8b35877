//! Pooling operators, which combine the pixels in each window of an image.

use super::super::read::unsupported;
use super::super::tensor::Tensor;
use super::call::{Call, Settings};
use crate::error::{Error, Result};
use crate::exec;

/// How windows are placed over an image. `strides` and `dilations` are in pixels, as `[vertical, horizontal]`.
pub struct Window {
    pub strides: [usize; 2],
    pub dilations: [usize; 2],
    pub padding: Padding,
}

pub enum Padding {
    /// Rows and columns added at the top, left, bottom and right.
    Explicit([usize; 4]),
    /// Padding for which the output size is `⌈input / stride⌉`. An odd number of padding rows or columns has its
    /// larger half at the start if `odd_first`, otherwise at the end.
    Same { odd_first: bool },
}

/// The placement of windows over an image of a given size.
pub struct Placement {
    /// Number of rows and columns of padding before the image.
    pub before: [usize; 2],
    /// Number of rows and columns that all windows together cover, including padding.
    pub extent: [usize; 2],
    pub out: [usize; 2],
}

impl Window {
    pub fn read(at: &Settings) -> Result<Self> {
        let (strides, dilations): ([usize; 2], [usize; 2]) = (at.sizes("strides", 1)?, at.sizes("dilations", 1)?);
        if strides.contains(&0) || dilations.contains(&0) {
            return Err(Error::format("strides and dilations must be positive"));
        }
        let padding = match at.text("auto_pad", "NOTSET") {
            "NOTSET" => Padding::Explicit(at.sizes("pads", 0)?),
            "VALID" => Padding::Explicit([0; 4]),
            "SAME_UPPER" => Padding::Same { odd_first: false },
            "SAME_LOWER" => Padding::Same { odd_first: true },
            other => return Err(unsupported(format_args!("auto_pad {other}"))),
        };
        Ok(Self { strides, dilations, padding })
    }

    pub fn place(&self, size: [usize; 2], kernel: [usize; 2], rounds_up: bool) -> Result<Placement> {
        let mut placement = Placement { before: [0; 2], extent: [0; 2], out: [0; 2] };
        for axis in 0..2 {
            let (stride, n) = (self.strides[axis], size[axis]);
            let extent = (kernel[axis].saturating_sub(1)).saturating_mul(self.dilations[axis]).saturating_add(1);
            let (before, after) = match &self.padding {
                Padding::Explicit(pads) => (pads[axis], pads[axis + 2]),
                Padding::Same { odd_first } => {
                    let all = (n.div_ceil(stride).saturating_sub(1) * stride).saturating_add(extent).saturating_sub(n);
                    if *odd_first { (all.div_ceil(2), all / 2) } else { (all / 2, all.div_ceil(2)) }
                }
            };
            let Some(steps) = (n + before + after).checked_sub(extent) else {
                return Err(Error::format(format!(
                    "a window of {extent} is larger than the {n} pixels it is moved over"
                )));
            };
            let mut last = if rounds_up { steps.div_ceil(stride) } else { steps / stride };
            // No window may begin in the padding after the end of the image.
            if rounds_up && last * stride >= n + before {
                last -= 1;
            }
            placement.before[axis] = before;
            placement.out[axis] = last + 1;
            placement.extent[axis] = last * stride + extent;
        }
        Ok(placement)
    }
}

pub struct Pool {
    window: Window,
    kernel: [usize; 2],
    rounds_up: bool,
    is_max: bool,
    counts_padding: bool,
}

impl Pool {
    pub fn read(at: &Settings, is_max: bool) -> Result<Self> {
        at.only("storage_order", 0)?;
        let kernel: [usize; 2] = at.sizes("kernel_shape", 0)?;
        if kernel.contains(&0) {
            return Err(Error::format("kernel_shape is missing or zero"));
        }
        Ok(Self {
            window: Window::read(at)?,
            kernel,
            rounds_up: at.integer("ceil_mode", 0) == 1,
            is_max,
            counts_padding: at.integer("count_include_pad", 0) == 1,
        })
    }

    pub fn run(&self, call: &Call) -> Result<Tensor> {
        let x = call.input(0)?;
        let [batch, channels, height, width] = x.shape_of()?;
        let placement = self.window.place([height, width], self.kernel, self.rounds_up)?;
        let [out_height, out_width] = placement.out;
        let shape = vec![batch, channels, out_height, out_width];
        let mut out = call.budget.zeros(&shape)?;
        let values = x.as_floats()?;
        let Window { strides, dilations, .. } = &self.window;
        // Iterates, along one axis, over the coordinates of the pixels that window `k` covers inside the image.
        let inside = |axis: usize, k: usize, size: usize| {
            let start = k * strides[axis];
            (0..self.kernel[axis]).filter_map(move |i| {
                (start + i * dilations[axis]).checked_sub(placement.before[axis]).filter(|p| *p < size)
            })
        };
        exec::for_rows(&mut out, out_width, call.job, |k, out| {
            let plane = &values[k / out_height * height * width..][..height * width];
            for (x, out) in out.iter_mut().enumerate() {
                let (mut best, mut sum, mut n) = (f32::NEG_INFINITY, 0.0, 0usize);
                for y in inside(0, k % out_height, height) {
                    for x in inside(1, x, width) {
                        let v = plane[y * width + x];
                        (best, sum, n) = (best.max(v), sum + v, n + 1);
                    }
                }
                let n = if self.counts_padding { self.kernel[0] * self.kernel[1] } else { n.max(1) };
                *out = if self.is_max { best } else { sum / n as f32 };
            }
        })?;
        Ok(Tensor::floats(shape, out))
    }
}

/// Returns the mean of each channel of each image.
pub fn global_average(call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let [batch, channels, height, width] = x.shape_of()?;
    let values = x.as_floats()?;
    let mut out = call.budget.zeros(&[batch, channels, 1, 1])?;
    let size = (height * width).max(1);
    for (out, plane) in out.iter_mut().zip(values.chunks_exact(size)) {
        *out = (plane.iter().map(|&v| f64::from(v)).sum::<f64>() / size as f64) as f32;
    }
    Ok(Tensor::floats(vec![batch, channels, 1, 1], out))
}
