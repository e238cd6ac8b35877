//! The colour that the photo asks for.

use crate::error::{Error, Result};
use crate::image::Image;
use crate::job::Job;
use crate::segment;
use glam::{DVec3, Vec3};

/// Which part of the photo the target surface is to look like (the paper's two variants, its Table 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetColour {
    /// The plane that carries the lights, without the lights and their halo.
    Surface,
    /// The whole photo.
    WholeImage,
}

/// Halo of a lamp that glare brightens, as a share of the photo's longer side.
const HALO: f32 = 0.01;

/// Mean linear colour of the chosen part, relative to the photo's white.
pub(super) fn target(which: TargetColour, photo: &Image, plane: &Image, lights: &Image, job: Job) -> Result<Vec3> {
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
fn mean_where(photo: &Image, selected: impl Fn(usize) -> bool) -> Option<Vec3> {
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for (i, pixel) in photo.data.chunks_exact(photo.channels).enumerate() {
        let rgb = DVec3::new(pixel[0].into(), pixel[1].into(), pixel[2].into());
        if selected(i) && rgb.is_finite() {
            sum += rgb.max(DVec3::ZERO);
            count += 1.0;
        }
    }
    (count > 0.0).then(|| (sum / count).as_vec3())
}
