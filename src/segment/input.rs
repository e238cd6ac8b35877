//! The input of a segmentation.

use super::strokes::Stroke;
use crate::error::{Result, check_range};
use crate::image::Image;

/// Maximum number of channels of the features.
pub const MAX_CHANNELS: usize = 16;

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The features of each pixel, 1 to 16 channels; an image of the photo's size with finite values.
    pub features: &'a Image,
    pub strokes: &'a [Stroke],
    /// Mask of the pixels to classify: 1 inside, 0 outside; `None` means the whole image. In the second phase, which
    /// finds the lamps, it is the mask of the plane. Outside the mask the confidence is 0, except on three kinds of
    /// lamps: lamps that reach over the mask's border, lamps in a hole of the mask, and lamps under a positive stroke.
    /// Strokes outside the mask still count as examples.
    pub region: Option<&'a Image>,
}

impl Input<'_> {
    /// Checks the numbers of channels, and that features and region have the same size.
    pub fn check(&self) -> Result<()> {
        check_range("the number of feature channels", self.features.channels, 1, MAX_CHANNELS)?;
        if let Some(region) = self.region {
            self.features.check_same_size("features", region, "region")?;
            check_range("the number of channels of region", region.channels, 1, 1)?;
        }
        Ok(())
    }
}
