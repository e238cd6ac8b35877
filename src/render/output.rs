//! The film: the result of a render, with its errors and additional images.

use super::denoise;
use super::layers::Layer;
use super::light::LampVisibility;
use crate::error::Result;
use crate::image::Image;

/// The image rendered so far. It stays usable after cancellation and when the time budget is used up.
#[derive(Clone, Debug)]
pub struct Film {
    /// Mean radiance of each pixel, linear RGB in cd/m². A pixel without paths shows a nearby pixel that has paths.
    pub beauty: Image,
    /// Variance of the mean radiance, per channel, from the pixel's own paths; infinite for fewer than two paths.
    /// [`Film::interval`] derives confidence intervals from it.
    pub variance: Image,
    /// Number of paths of each pixel; one channel.
    pub paths: Image,
    /// Mean number of paths per pixel so far.
    pub samples: u32,
    /// Root mean square of the standard error over pixels and channels, relative to the mean of the image.
    pub error: f64,
    /// Root mean square of the relative errors of the pixels. The relative error of a pixel is its standard error,
    /// divided by its radiance (mean of the channels, at least a hundredth of the image's mean). With few paths, this
    /// value is too large: with 8 paths by about a quarter.
    pub relative_error: f64,
    /// Number of paths dropped because their radiance was not finite.
    pub discarded: u64,
    /// Number of lights that illuminate the scene but have no surface, so that the image cannot show them: point
    /// lights, spot lights, and luminaires without faces.
    pub unseen_lights: usize,
    /// How many lamps do not reach the surfaces in view. The render samples such lamps less often. `None` if there are
    /// too few of them to gain time that way, or if the render did not count them.
    pub lamp_visibility: Option<LampVisibility>,
    /// Sentences for the user: what the render leaves out ([`super::Requirements::left_out`]), and how it treats lamps
    /// out of reach ([`LampVisibility::sentence`]).
    pub requirements: Vec<String>,
    /// The additional images: first the light path expressions, then the surface attributes, in the order of the
    /// request.
    pub layers: Vec<Layer>,
    /// The filtered image with its interval, error and bias, if requested. The filtered image is not an unbiased
    /// estimate.
    pub preview: Option<denoise::Output>,
}

impl Film {
    /// Clones the film, or returns an error if there is no memory for the copy.
    pub fn try_clone(&self) -> Result<Self> {
        let layer = |l: &Layer| {
            Ok(Layer { image: l.image.try_clone()?, name: l.name.clone(), expression: l.expression.clone(), ..*l })
        };
        let preview = |p: &denoise::Output| {
            Ok(denoise::Output { image: p.image.try_clone()?, interval: p.interval.try_clone()?, ..*p })
        };
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
