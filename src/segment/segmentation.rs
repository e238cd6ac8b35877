//! The result of a segmentation.

use super::strokes::Stroke;
use crate::error::{Error, Result, check_range};
use crate::image::Image;

/// The two families of classifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// `bᵀx + c`.
    Linear,
    /// `xᵀAx + bᵀx + c`.
    Quadratic,
}

#[derive(Clone, Debug)]
pub struct Segmentation {
    /// 1 where the confidence is above one half, else 0.
    pub mask: Image,
    /// Probability that a pixel belongs to the positive class, in `[0, 1]`, calibrated on held-out strokes.
    pub confidence: Image,
    /// How far a pixel's features lie beyond those of all strokes, in `[0, 1]`: where it is high, one more stroke helps.
    pub unseen: Image,
    /// Expected share of wrong pixels, in `[0, 1]`, by cross-validation: the error on held-out parts of strokes where
    /// pixels are like those painted, the error on wholly held-out strokes where they are `unseen`.
    pub error: f64,
    /// The classifier; of lamps and of a caller's own mask there is none.
    pub model: Option<Model>,
    /// The channels it looks at; bit `i` is channel `i`.
    pub channels: u32,
    /// Samples used of the negative and the positive class.
    pub samples: [usize; 2],
    /// Pixels that strokes of both classes cover; the later stroke won.
    pub contradictory: usize,
    /// Stroke pixels outside the image; they were ignored.
    pub off_image: usize,
    /// Whether the mask was proposed because strokes were missing: of the plane strokes of one class, of lamps positive
    /// strokes.
    pub is_proposed: bool,
    /// Regions outside the given mask that have the size and the shape of a lamp if the plane goes on there: then the
    /// room is larger than it was laid out. Of lamps only.
    pub beyond: Vec<Stroke>,
}

impl Segmentation {
    /// A caller's own: one channel of probabilities in `[0, 1]`, or a mask.
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
            is_proposed: false,
            beyond: Vec::new(),
        })
    }
}
