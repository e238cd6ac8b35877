//! Computes the target colour of the surface from the photo.
//!
//! A clipped channel of a pixel is known only to be at least white. Often its true value follows from the unclipped
//! channels of the pixel ([`clipping`]); otherwise the channel counts as white. If a channel is unknown in most pixels,
//! its target is a lower bound instead of an exact value.

use super::clipping;
use super::sided::Constraint;
use crate::error::{Error, Result};
use crate::image::{Image, dilate};
use crate::job::Job;
use glam::{DVec3, Vec3};

/// The part of the photo whose mean colour the target surface should have (the two variants in Table 1 of the paper).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetColour {
    /// The plane that carries the lights, without the lights and their halo.
    Surface,
    /// The whole photo.
    WholeImage,
}

/// The target colour, computed from the photo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotoColour {
    /// Mean linear colour, relative to the photo's white.
    pub colour: Vec3,
    /// For each channel, whether `colour` is an exact target or a lower bound.
    pub constraint: [Constraint; 3],
}

/// Width of the halo of glare around a lamp, as a share of the photo's longer side. [bench constants:colour]
const HALO: f32 = 0.01;
/// A photo with a value above this has values beyond white (1), so it is not clipped at white. [rounding]
const WHITE: f32 = 1.001;
/// If a channel's value is unknown in more than this share of the pixels, the target of this channel is a lower bound.
/// [convention]
const MAX_UNKNOWN_SHARE: f64 = 0.5;

/// Computes the mean colour of the part of the photo that `which` chooses. `plane` and `lights` are masks of the photo.
///
/// [`TargetColour::Surface`] is the plane without the lights and their halos, which are the pixels closer to a light
/// than `HALO` times the photo's longer side. If nothing else of the plane is left, the halos are included.
pub fn photo_colour(
    which: TargetColour,
    photo: &Image,
    plane: &Image,
    lights: &Image,
    job: Job,
) -> Result<PhotoColour> {
    photo.check_same_size("the photo", plane, "the plane's mask")?;
    photo.check_same_size("the photo", lights, "the lights' mask")?;
    let everything = |_: usize| true;
    let mean = match which {
        TargetColour::WholeImage => mean_where(which, photo, everything),
        TargetColour::Surface => {
            let radius = (HALO * photo.width.max(photo.height) as f32).ceil();
            let glare = dilate(lights, radius, job)?;
            let beside = |i: usize| plane.data[i] > 0.5 && glare.data[i] <= 0.5;
            let on_plane = |i: usize| plane.data[i] > 0.5 && lights.data[i] <= 0.5;
            mean_where(which, photo, beside).or_else(|| mean_where(which, photo, on_plane))
        }
    };
    mean.ok_or_else(|| {
        Error::degenerate(
            "the plane shows nothing but lights, so its own colour is unknown: mark less as light, or match the whole image",
        )
    })
}

/// Returns the mean colour of the selected pixels. Pixels with NaN or infinite values are ignored. `None` if no pixel
/// is left.
fn mean_where(which: TargetColour, photo: &Image, selected: impl Fn(usize) -> bool) -> Option<PhotoColour> {
    let colours = photo.data.chunks_exact(photo.channels).map(|p| Vec3::new(p[0], p[1], p[2])).enumerate();
    let selected = &selected;
    let pixels = colours.filter(move |(i, rgb)| selected(*i) && rgb.is_finite()).map(|(_, rgb)| rgb.max(Vec3::ZERO));
    // A photo with values above white is not clipped at white.
    if photo.data.iter().any(|v| *v > WHITE && v.is_finite()) {
        let (mut sum, mut count) = (DVec3::ZERO, 0.0);
        pixels.for_each(|rgb| (sum, count) = (sum + rgb.as_dvec3(), count + 1.0));
        return (count > 0.0)
            .then(|| PhotoColour { colour: (sum / count).as_vec3(), constraint: [Constraint::Exactly; 3] });
    }
    let (mean, unknown) = clipping::mean(pixels, which == TargetColour::Surface)?;
    let constraint = unknown
        .to_array()
        .map(|share| if share > MAX_UNKNOWN_SHARE { Constraint::AtLeast } else { Constraint::Exactly });
    Some(PhotoColour { colour: mean.as_vec3(), constraint })
}

#[cfg(test)]
#[path = "tests/photo_colour.rs"]
mod tests;
