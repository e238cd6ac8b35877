//! The result of a render.

use super::denoise;
use super::layers::Layer;
use super::light::Reach;
use crate::error::Result;
use crate::image::Image;

/// The image rendered so far; it stays usable after a cancel or at the end of the time budget.
#[derive(Clone, Debug)]
pub struct Film {
    /// Mean radiance per pixel, linear RGB in cd/m². A pixel without paths shows a nearby pixel.
    pub beauty: Image,
    /// Variance of that mean per channel, each pixel from its own paths; infinite below two paths. [`Film::interval`]
    /// derives confidence intervals from it.
    pub variance: Image,
    /// Number of paths of each pixel; one channel.
    pub paths: Image,
    /// Mean number of paths per pixel so far.
    pub samples: u32,
    /// Root mean square over pixels and channels of the standard error, relative to the mean of the image.
    pub error: f64,
    /// Root mean square of the standard error relative to the radiance of each pixel (mean of its channels, at least a
    /// hundredth of the image's mean). With few paths it overestimates: with 8 paths by about a quarter.
    pub relative_error: f64,
    /// Number of paths dropped because their radiance was not finite.
    pub discarded: u64,
    /// Number of lights that shine from points, so that the image does not show them.
    pub unseen_lights: usize,
    /// The lamps that do not reach the surfaces in view; `None` if the render did not find any.
    pub reach: Option<Reach>,
    /// What the render skips, in words: [`super::Requirements::left_out`] and [`Reach::sentence`].
    pub requirements: Vec<String>,
    /// The additional images: those of expressions in order, then the AOVs in order.
    pub layers: Vec<Layer>,
    /// The filtered image and an estimate of its bias, if requested. It is not an unbiased estimate.
    pub preview: Option<denoise::Output>,
}

impl Film {
    /// Clones the film, or returns an error if there is no memory for the copy.
    pub fn try_clone(&self) -> Result<Self> {
        let layer = |l: &Layer| {
            Ok(Layer { image: l.image.try_clone()?, name: l.name.clone(), expression: l.expression.clone(), ..*l })
        };
        let preview = |p: &denoise::Output| Ok(denoise::Output { image: p.image.try_clone()?, ..*p });
        Ok(Self {
            beauty: self.beauty.try_clone()?,
            variance: self.variance.try_clone()?,
            paths: self.paths.try_clone()?,
            requirements: self.requirements.clone(),
            layers: self.layers.iter().map(layer).collect::<Result<_>>()?,
            preview: self.preview.as_ref().map(preview).transpose()?,
            ..*self
        })
    }
}
