//! The result of a segmentation.

use super::strokes::Stroke;
use crate::error::{Error, Result, check_range};
use crate::image::Image;

/// The two kinds of classifiers: the logit is a linear or a quadratic function of the features x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// The logit is `bᵀx + c`.
    Linear,
    /// The logit is `xᵀAx + bᵀx + c`.
    Quadratic,
}

/// A region like a lamp beyond the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Beyond {
    pub region: Stroke,
    /// Whether it continues a regular row of lamps of its size and shape.
    pub is_in_regular_row: bool,
}

#[derive(Clone, Debug)]
pub struct Segmentation {
    /// 1 where the confidence is above one half, else 0.
    pub mask: Image,
    /// For a surface: the probability that a pixel belongs to the positive class, in `[0, 1]`, calibrated on held-out
    /// strokes. For lamps: 0.5 on the contour of each lamp, rising to 1 inside and falling to 0 outside within about
    /// one pixel.
    pub confidence: Image,
    /// How unlike all strokes a pixel is, in `[0, 1]`: 0 if its features lie among the samples of a class, near 1 if
    /// they lie far from the samples of both classes. For lamps: 1 in regions that are almost like the painted lamps,
    /// else 0. Another stroke helps most where this value is high.
    pub unseen: Image,
    /// Expected share of wrong pixels, in `[0, 1]`.
    /// - For a surface: `(1 - u) e_parts + u e_strokes`, where `u` is the mean of `unseen`. `e_parts` is the error on
    ///   held-out parts of strokes, and applies to pixels like the painted ones. `e_strokes` is the error on held-out
    ///   whole strokes, and applies to pixels unlike the painted ones.
    /// - For lamps: the expected number of wrong pixels in the lamps and in doubtful regions, divided by the number of
    ///   pixels of the plane or, without a plane, of the photo.
    /// - For a whole face of the room that is proposed: a constant.
    /// - 0 for a mask that the caller supplied.
    pub error: f64,
    /// The classifier. `None` if there is none: for lamps, for a proposal that is a whole face of the room, and for a
    /// mask that the caller supplied.
    pub model: Option<Model>,
    /// The channels that the classifier uses; bit `i` stands for channel `i`.
    pub channels: u32,
    /// Number of samples of the negative and the positive class.
    pub samples: [usize; 2],
    /// Pixels that strokes of both classes cover; the later stroke won.
    pub contradictory: usize,
    /// Stroke pixels outside the image; they were ignored.
    pub off_image: usize,
    /// Whether the segmentation looked for lamps, with or without strokes. False for a mask that the caller supplied.
    pub is_of_lamps: bool,
    /// Whether the mask is a proposal because strokes were missing: for a plane, the strokes of at least one class;
    /// for lamps, the positive strokes.
    pub is_proposed: bool,
    /// For lamps only: regions outside the given plane mask that are probably lamps. Each of them lies in a row with
    /// lamps that were found. Measured as if the plane continued there, it has the size and the shape of these lamps.
    /// Such regions suggest that the room is larger than its layout.
    pub beyond: Vec<Beyond>,
}

impl Segmentation {
    /// Removes from the mask the pixels for which `is_removed(y * width + x)` is true, and sets their confidence to 0.
    pub fn remove(&mut self, is_removed: impl Fn(usize) -> bool) {
        for (i, confidence) in self.confidence.data.iter_mut().enumerate() {
            if self.mask.data[i] > 0.5 && is_removed(i) {
                (self.mask.data[i], *confidence) = (0.0, 0.0);
            }
        }
    }

    /// Removes from the mask of a plane the pixels that lie off the plane, for which `is_off` is true. Exception: if
    /// more than half of the pixels of a positive stroke are off, nothing is removed. The user has then painted this
    /// stroke after `is_off` was determined, so `is_off` is out of date.
    pub fn remove_off_plane<'a>(
        &mut self,
        is_off: impl Fn(usize) -> bool,
        mut strokes: impl Iterator<Item = &'a Stroke>,
    ) {
        let share_off =
            |s: &Stroke| s.pixels.iter().filter(|p| is_off(**p as usize)).count() as f64 / s.pixels.len().max(1) as f64;
        if !strokes.any(|s| s.positive && share_off(s) > 0.5) {
            self.remove(is_off);
        }
    }

    /// Wraps a segmentation that the caller supplies: one channel of probabilities in `[0, 1]`, or a mask of 0 and 1.
    pub fn from_confidence(confidence: &Image) -> Result<Self> {
        check_range("the number of channels of the mask", confidence.channels, 1, 1)?;
        let bad = confidence.data.iter().find(|v| !(0.0..=1.0).contains(*v));
        if let Some(bad) = bad {
            return Err(Error::argument(format!("the mask has a value of {bad}; all must lie in [0, 1]")));
        }
        let mut mask = Image::new(confidence.width, confidence.height, 1)?;
        for (m, &c) in mask.data.iter_mut().zip(&confidence.data) {
            *m = f32::from(c > 0.5);
        }
        Ok(Self {
            mask,
            confidence: confidence.clone(),
            unseen: Image::new(confidence.width, confidence.height, 1)?,
            error: 0.0,
            model: None,
            channels: 0,
            samples: [0, 0],
            contradictory: 0,
            off_image: 0,
            is_of_lamps: false,
            is_proposed: false,
            beyond: Vec::new(),
        })
    }
}
