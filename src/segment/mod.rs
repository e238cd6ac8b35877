//! Guided segmentation: strokes on the photo to a mask with per-pixel confidence (Lipp et al., §4.2).

use crate::error::Result;
use crate::features::CHANNELS;
use crate::image::Image;
use crate::job::Job;

/// One stroke of the brush: the pixels it covers (`y * width + x`) and what they are examples of.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    pub pixels: Vec<u32>,
    pub positive: bool,
}

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// Any number of channels of the photo's size; finite everywhere.
    pub features: &'a Image,
    pub strokes: &'a [Stroke],
    /// Where to look (1) and where not (0): the plane's mask in the second phase.
    pub within: Option<&'a Image>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Samples drawn from the strokes of each class, in `[1, 1e6]`.
    pub samples_per_class: usize,
    /// Which feature channels to use; bit `i` is channel `i`.
    pub channels: u32,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self { samples_per_class: 1000, channels: (1 << CHANNELS) - 1, seed: 1 }
    }
}

#[derive(Clone, Debug)]
pub struct Segmentation {
    /// 1 where the confidence is above one half, else 0.
    pub mask: Image,
    /// Probability that a pixel belongs to the positive class, in `[0, 1]`.
    pub confidence: Image,
    /// Expected share of wrong pixels, from cross-validation over strokes.
    pub error: f64,
}

pub fn run(_input: &Input, _params: &Params, _job: Job) -> Result<Segmentation> {
    todo!()
}

/// The mask grown by a disc of `radius` pixels.
pub fn dilate(_mask: &Image, _radius: usize) -> Result<Image> {
    todo!()
}
