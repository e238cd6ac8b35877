//! Resizes images along their last two axes, one axis after the other. Each output row or column is a weighted sum of
//! up to four input rows or columns.

use super::super::read::unsupported;
use super::super::tensor::{MemoryBudget, Tensor, count};
use super::call::{Call, Settings};
use crate::error::{Error, Result};
use crate::exec;
use crate::job::Job;

pub struct Resize {
    pub filter: Filter,
    pub transform: CoordinateTransform,
    scales: Option<Vec<f32>>,
    /// Indices of the inputs that hold the scales and the sizes.
    scales_at: usize,
    sizes_at: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    Nearest(Rounding),
    Linear,
    /// Keys' cubic convolution with this parameter: -0.75 in OpenCV and ONNX.
    Cubic(f32),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rounding {
    HalfDown,
    HalfUp,
    Floor,
    Ceil,
}

/// How an output pixel's coordinate maps to an input coordinate. The variants are named as in ONNX.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoordinateTransform {
    HalfPixel,
    /// Like `HalfPixel`, but if the output has a single pixel, this pixel maps to the first input pixel.
    PytorchHalfPixel,
    AlignCorners,
    Asymmetric,
}

/// The sizes along one axis before and after resampling, in pixels.
#[derive(Clone, Copy)]
pub struct Axis {
    pub from: usize,
    pub to: usize,
    /// Output pixels per input pixel.
    pub scale: f64,
}

impl Resize {
    pub fn read(kind: &str, at: &Settings, opset: i64, constants: &[Option<&Tensor>]) -> Result<Self> {
        let is_old = kind == "Upsample" || opset < 11;
        let rounding = match at.text("nearest_mode", if is_old { "floor" } else { "round_prefer_floor" }) {
            "round_prefer_floor" => Rounding::HalfDown,
            "round_prefer_ceil" => Rounding::HalfUp,
            "floor" => Rounding::Floor,
            "ceil" => Rounding::Ceil,
            other => return Err(unsupported(format_args!("nearest_mode {other}"))),
        };
        let filter = match at.text("mode", "nearest") {
            "nearest" => Filter::Nearest(rounding),
            "linear" | "bilinear" => Filter::Linear,
            "cubic" => Filter::Cubic(at.float("cubic_coeff_a", -0.75)),
            other => return Err(unsupported(format_args!("resizing of mode {other}"))),
        };
        let transform =
            match at.text("coordinate_transformation_mode", if is_old { "asymmetric" } else { "half_pixel" }) {
                "half_pixel" => CoordinateTransform::HalfPixel,
                "pytorch_half_pixel" => CoordinateTransform::PytorchHalfPixel,
                "align_corners" => CoordinateTransform::AlignCorners,
                "asymmetric" => CoordinateTransform::Asymmetric,
                other => return Err(unsupported(format_args!("coordinate_transformation_mode {other}"))),
            };
        at.only("exclude_outside", 0)?;
        at.only("antialias", 0)?;
        if at.integers("axes").is_some() || at.text("keep_aspect_ratio_policy", "stretch") != "stretch" {
            return Err(unsupported("resizing of some axes or by a policy"));
        }
        let scales = at.0.get("scales").map(|a| a.floats.clone());
        let (scales_at, sizes_at) = if is_old { (1, None) } else { (2, Some(3)) };
        let known = constants.get(scales_at).copied().flatten();
        if known.is_some_and(|tensor| tensor.as_floats().is_err()) {
            return Err(Error::format("scales must be floats"));
        }
        Ok(Self { filter, transform, scales, scales_at, sizes_at })
    }

    pub fn run(&self, call: &Call) -> Result<Tensor> {
        let x = call.input(0)?;
        let rank = x.shape.len();
        let wrong = || Error::format(format!("neither sizes nor scales for the {rank} axes of the input"));
        let sizes = self.sizes_at.and_then(|k| call.optional(k)).filter(|sizes| !sizes.is_empty());
        let (shape, scales): (Vec<usize>, Vec<f64>) = if let Some(sizes) = sizes {
            let sizes = super::gather::shape_from(sizes)?;
            let scales = sizes.iter().zip(&x.shape).map(|(&to, &from)| to as f64 / from as f64).collect();
            (sizes, scales)
        } else {
            let given = match (&self.scales, call.optional(self.scales_at)) {
                (Some(scales), _) => scales.as_slice(),
                (None, Some(scales)) => scales.as_floats()?,
                (None, None) => return Err(wrong()),
            };
            if let Some(bad) = given.iter().find(|s| !(**s > 0.0 && **s <= 65536.0)) {
                return Err(Error::format(format!("a scale is {bad}; it must lie in (0, 65536]")));
            }
            let scaled = |(&n, &s): (&usize, &f32)| (n as f64 * f64::from(s)).floor() as usize;
            (x.shape.iter().zip(given).map(scaled).collect(), given.iter().map(|&s| f64::from(s)).collect())
        };
        if shape.len() != rank || scales.len() != rank || rank < 2 || shape[..rank - 2] != x.shape[..rank - 2] {
            return Err(if shape.len() == rank {
                unsupported("resizing of axes other than the last two")
            } else {
                wrong()
            });
        }
        if count(&shape)? == 0 || x.is_empty() {
            return Err(Error::format(format!("shape {:?} cannot be resized to {shape:?}", x.shape)));
        }
        let axis = |k: usize| Axis { from: x.shape[k], to: shape[k], scale: scales[k] };
        let axes = [axis(rank - 2), axis(rank - 1)];
        let planes: usize = x.shape[..rank - 2].iter().product();
        let out = resample(x.as_floats()?, planes, axes, self.filter, self.transform, call.budget, call.job)?;
        Ok(Tensor::floats(shape, out))
    }
}

/// Resamples `planes` images, stored one after another, along their rows and columns.
pub fn resample(
    values: &[f32],
    planes: usize,
    [vertical, horizontal]: [Axis; 2],
    filter: Filter,
    transform: CoordinateTransform,
    budget: MemoryBudget,
    job: Job,
) -> Result<Vec<f32>> {
    // Resample along the rows first, then along the columns.
    let taps = taps(horizontal, filter, transform, budget)?;
    let mut wide = budget.zeros(&[planes, vertical.from, horizontal.to])?;
    exec::for_rows(&mut wide, horizontal.to, job.part(0.0, 0.5), |k, out| {
        let row = &values[k * horizontal.from..][..horizontal.from];
        for (out, taps) in out.iter_mut().zip(&taps) {
            *out = taps.iter().map(|&(i, w)| w * row[i]).sum();
        }
    })?;
    let taps = self::taps(vertical, filter, transform, budget)?;
    let mut out = budget.zeros(&[planes, vertical.to, horizontal.to])?;
    exec::for_rows(&mut out, horizontal.to, job.part(0.5, 1.0), |k, out| {
        let plane = &wide[k / vertical.to * vertical.from * horizontal.to..];
        for &(i, weight) in taps[k % vertical.to].iter().filter(|(_, weight)| *weight != 0.0) {
            let row = &plane[i * horizontal.to..][..horizontal.to];
            out.iter_mut().zip(row).for_each(|(out, v)| *out += weight * v);
        }
    })?;
    Ok(out)
}

/// Returns the input indices and weights of each output pixel along one axis.
fn taps(
    axis: Axis,
    filter: Filter,
    transform: CoordinateTransform,
    budget: MemoryBudget,
) -> Result<Vec<[(usize, f32); 4]>> {
    let mut taps = budget.vec(axis.to, [(0, 0.0); 4])?;
    let last = axis.from as i64 - 1;
    let inside = |i: i64| i.clamp(0, last) as usize;
    for (k, taps) in taps.iter_mut().enumerate() {
        let k = k as f64;
        let x = match transform {
            CoordinateTransform::HalfPixel => (k + 0.5) / axis.scale - 0.5,
            CoordinateTransform::PytorchHalfPixel => {
                if axis.to > 1 {
                    (k + 0.5) / axis.scale - 0.5
                } else {
                    0.0
                }
            }
            CoordinateTransform::AlignCorners => {
                if axis.to > 1 {
                    k * last as f64 / (axis.to - 1) as f64
                } else {
                    0.0
                }
            }
            CoordinateTransform::Asymmetric => k / axis.scale,
        };
        match filter {
            Filter::Nearest(rounding) => {
                let nearest = match rounding {
                    Rounding::HalfDown => (x - 0.5).ceil(),
                    Rounding::HalfUp => (x + 0.5).floor(),
                    Rounding::Floor => x.floor(),
                    Rounding::Ceil => x.ceil(),
                };
                taps[0] = (inside(nearest as i64), 1.0);
            }
            Filter::Linear => {
                let x = x.clamp(0.0, last as f64);
                let (i, t) = (x.floor() as i64, (x - x.floor()) as f32);
                *taps = [(inside(i), 1.0 - t), (inside(i + 1), t), (0, 0.0), (0, 0.0)];
            }
            Filter::Cubic(slope) => {
                let (i, t) = (x.floor() as i64, (x - x.floor()) as f32);
                let weights = cubic(t, slope);
                *taps = std::array::from_fn(|n| (inside(i - 1 + n as i64), weights[n]));
            }
        }
    }
    Ok(taps)
}

/// Weights of Keys' cubic convolution for four pixels, at a fraction `t` between the second and the third. `a` is Keys'
/// parameter.
fn cubic(t: f32, a: f32) -> [f32; 4] {
    let near = |t: f32| ((a + 2.0) * t - (a + 3.0)) * t * t + 1.0;
    let far = |t: f32| ((a * t - 5.0 * a) * t + 8.0 * a) * t - 4.0 * a;
    [far(t + 1.0), near(t), near(1.0 - t), far(2.0 - t)]
}

/// Resizes planes by cubic convolution without a low-pass filter, as OpenCV's `INTER_CUBIC` does.
pub fn cubic_planes(values: &[f32], planes: usize, from: [usize; 2], to: [usize; 2], job: Job) -> Result<Vec<f32>> {
    let axis = |k: usize| Axis { from: from[k], to: to[k], scale: to[k] as f64 / from[k] as f64 };
    resample(
        values,
        planes,
        [axis(0), axis(1)],
        Filter::Cubic(-0.75),
        CoordinateTransform::HalfPixel,
        MemoryBudget(usize::MAX),
        job,
    )
}
