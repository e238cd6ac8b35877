//! The colour that the photo asks for.
//!
//! Pixels that are clipped say no more than "at least white" in the channels that are. As a plane has one colour, more or
//! less, a channel that is clipped follows from those that are not, by the ratio they have on the rest of the plane; where
//! nothing says how bright it is, it counts as white, and a channel most of which is so is asked for as a least.

use crate::error::{Error, Result};
use crate::image::Image;
use crate::job::Job;
use crate::relight::Sense;
use crate::segment;
use glam::{BVec3, DVec3, Vec3};

/// Which part of the photo the target surface is to look like (the paper's two variants, its Table 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetColour {
    /// The plane that carries the lights, without the lights and their halo.
    Surface,
    /// The whole photo.
    WholeImage,
}

/// What the photo asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Target {
    /// Mean linear colour, relative to the photo's white.
    pub colour: Vec3,
    /// Whether that is all that is known of a channel, or it may be brighter.
    pub sense: [Sense; 3],
}

/// Halo of a lamp that glare brightens, as a share of the photo's longer side.
const HALO: f32 = 0.01;
/// From where on a channel counts as clipped: the two largest values of eight bits, decoded, are.
const CLIPPED: f32 = 0.987;
/// Photos that are brighter than this somewhere have no white that they are clipped at.
const WHITE: f32 = 1.001;
/// Share of the pixels without a clipped channel that is enough to know the ratio of the channels by.
const LEAST_WHOLE: f64 = 0.02;
/// Share of the pixels from which on a channel that is not known is asked for as a least.
const MOSTLY: f64 = 0.5;

/// Mean of the chosen part.
pub(super) fn target(which: TargetColour, photo: &Image, plane: &Image, lights: &Image, job: Job) -> Result<Target> {
    photo.check_same_size("the photo", plane, "the plane's mask")?;
    photo.check_same_size("the photo", lights, "the lights' mask")?;
    let everything = |_: usize| true;
    let mean = match which {
        TargetColour::WholeImage => mean_where(photo, everything),
        TargetColour::Surface => {
            let radius = (HALO * photo.width.max(photo.height) as f32).ceil();
            let glare = segment::dilate(lights, radius, job)?;
            let beside = |i: usize| plane.data[i] > 0.5 && glare.data[i] <= 0.5;
            let on_plane = |i: usize| plane.data[i] > 0.5 && lights.data[i] <= 0.5;
            mean_where(photo, beside).or_else(|| mean_where(photo, on_plane))
        }
    };
    mean.ok_or_else(|| {
        Error::degenerate(
            "the plane shows nothing but lights, so its own colour is unknown: mark less as light, or match the whole image",
        )
    })
}

/// Mean over the finite pixels that are selected.
fn mean_where(photo: &Image, selected: impl Fn(usize) -> bool) -> Option<Target> {
    let pixels = || {
        let colours = photo.data.chunks_exact(photo.channels).map(|p| Vec3::new(p[0], p[1], p[2]));
        colours.enumerate().filter(|(i, rgb)| selected(*i) && rgb.is_finite()).map(|(_, rgb)| rgb.max(Vec3::ZERO))
    };
    // A photo with a range beyond white is not clipped there.
    let clips = photo.data.iter().all(|v| *v <= WHITE || !v.is_finite());
    let clipped = |rgb: Vec3| if clips { rgb.cmpge(Vec3::splat(CLIPPED)) } else { BVec3::FALSE };

    // The colour of what is not clipped.
    let (mut whole, mut whole_count, mut count) = (DVec3::ZERO, 0.0, 0.0);
    for rgb in pixels() {
        count += 1.0;
        if !clipped(rgb).any() {
            whole += rgb.as_dvec3();
            whole_count += 1.0;
        }
    }
    let known = whole_count >= LEAST_WHOLE * count && whole.min_element() > 0.0;
    let (mut sum, mut open) = (DVec3::ZERO, DVec3::ZERO);
    for rgb in pixels() {
        let mask = clipped(rgb);
        let rgb = rgb.as_dvec3();
        sum += rgb;
        if !mask.any() {
            continue;
        }
        let least = DVec3::select(mask, DVec3::ONE, DVec3::ZERO);
        if mask.all() || !known {
            open += least;
            continue;
        }
        // As bright as the channels that are not clipped say, but no darker than white.
        let rest = DVec3::ONE - least;
        let brightness = rgb.dot(rest) / whole.dot(rest);
        sum += least * (brightness * whole - rgb).max(DVec3::ZERO);
    }
    let sense = open.to_array().map(|n| if n > MOSTLY * count { Sense::AtLeast } else { Sense::Exactly });
    (count > 0.0).then(|| Target { colour: (sum / count).as_vec3(), sense })
}

#[cfg(test)]
#[path = "tests/colour.rs"]
mod tests;
