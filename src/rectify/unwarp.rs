//! Texture unwarping (§5.3): the homography of the plane from the room axes and the focal length, so that the aspect
//! ratio is true, and its expected error.

use super::camera::{USUAL_SPREAD, focal_from_points};
use super::plane::{Plane, choose, marked_pixels};
use super::{UnwarpParams, Unwarped, View, quad, resample};
use crate::error::Result;
use crate::geometry::{FocalSource, Homography};
use crate::image::Image;
use crate::job::Job;
use glam::{DMat3, DQuat, DVec2, DVec3};

pub fn unwarp(photo: &Image, view: &View, mask: &Image, params: &UnwarpParams, job: Job) -> Result<Unwarped> {
    photo.check_same_size("photo", mask, "mask")?;
    params.check()?;
    let pixels = marked_pixels(mask)?;
    let plane = choose(view, mask, &pixels, params.axes)?;
    job.check()?;
    let rectangle = quad::largest(&plane, mask, &pixels, params.max_magnification)?;
    job.check()?;
    job.report(0.1);

    // The densest part of the photo decides the size of a pixel, unless the image became too large.
    let size = rectangle.high - rectangle.low;
    let pixel_size = rectangle.densest.max(size.max_element() / params.max_side as f64);
    let side = |length: f64| ((length / pixel_size).round() as usize).clamp(1, params.max_side);
    let (width, height) = (side(size.x), side(size.y));
    // Square pixels; what rounding adds or takes is shared by both ends.
    let spare = size - DVec2::new(width as f64, height as f64) * pixel_size;
    let to_plane = DMat3::from_translation(rectangle.low + spare / 2.0) * DMat3::from_scale(DVec2::splat(pixel_size));
    let to_photo = Homography(plane.to_photo().0 * to_plane).rescaled();

    let mut image = resample::warp(&photo.to_rgb()?, &to_photo, width, height, job.part(0.1, 0.8))?;
    let mut valid = resample::warp(&mask.channel(0)?, &to_photo, width, height, job.part(0.8, 1.0))?;
    for (pixel, valid) in image.data.chunks_exact_mut(3).zip(&mut valid.data) {
        // What the photo does not know is not shown.
        *valid = if *valid >= 0.5 && pixel.iter().all(|v| v.is_finite()) { 1.0 } else { 0.0 };
        if pixel.iter().any(|v| !v.is_finite()) {
            pixel.fill(0.0);
        }
    }

    let (w, h) = (width as f64, height as f64);
    let corners = [DVec2::ZERO, DVec2::new(w, 0.0), DVec2::new(w, h), DVec2::new(0.0, h)].map(|c| to_photo.apply(c));
    let uncertainty = uncertainty(&plane, view, corners, pixel_size);
    job.report(1.0);
    Ok(Unwarped {
        image,
        valid,
        to_photo,
        pixel_size,
        corners,
        aspect_confidence: uncertainty.aspect_confidence,
        corner_error: uncertainty.corner_error,
    })
}

struct Uncertainty {
    aspect_confidence: f64,
    corner_error: [f64; 4],
}

/// Carries the errors of the vanishing points and of the focal length over to the rectified corners, to first order:
/// each of three small rotations and a small change of focal length moves them by so much.
fn uncertainty(plane: &Plane, view: &View, corners: [DVec2; 4], pixel_size: f64) -> Uncertainty {
    const AXES: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];
    let errors: [f64; 3] = std::array::from_fn(|k| view.vanishing_points[k].error.max(1e-9));
    let nominal = rectified(plane, corners);
    let aspect = |c: &[DVec2; 4]| {
        ((c[1].distance(c[0]) + c[2].distance(c[3])) / (c[3].distance(c[0]) + c[2].distance(c[1]))).ln()
    };

    // A rotation about one axis turns the other two, each of which fixes it to its error across one of two directions.
    let mut moved: Vec<([DVec2; 4], f64)> = (0..3)
        .map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let deviation = (2.0 / errors[i].powi(2) + 2.0 / errors[j].powi(2)).powf(-0.5);
            let axes = view.perspective.axes;
            let turn = DMat3::from_quat(DQuat::from_axis_angle(axes * AXES[k], SMALL));
            (rectified(&plane.turned(turn), corners), deviation)
        })
        .collect();
    moved.push((rectified(&plane.with_focal(plane.perspective.focal * SMALL.exp()), corners), focal_deviation(view)));

    let mut squares = [0.0; 4];
    let mut aspect_variance = 0.0;
    for (corners, deviation) in &moved {
        let factor = deviation / SMALL;
        for (square, (a, b)) in squares.iter_mut().zip(corners.iter().zip(&nominal)) {
            *square += (a.distance(*b) * factor / pixel_size).powi(2);
        }
        aspect_variance += ((aspect(corners) - aspect(&nominal)) * factor).powi(2);
    }
    // One half where the aspect ratio is uncertain by 10 %.
    Uncertainty { aspect_confidence: 1.0 / (1.0 + aspect_variance / 0.01), corner_error: squares.map(f64::sqrt) }
}

/// Step of the finite differences.
const SMALL: f64 = 1e-5;

/// Plane coordinates of photo points relative to their mean, which is of no consequence.
fn rectified(plane: &Plane, corners: [DVec2; 4]) -> [DVec2; 4] {
    let inverse = plane.to_photo().inverse();
    let at = corners.map(|c| inverse.apply(c));
    let mean = at.iter().sum::<DVec2>() / 4.0;
    at.map(|p| p - mean)
}

/// Standard deviation of the logarithm of the focal length.
fn focal_deviation(view: &View) -> f64 {
    let camera = &view.perspective;
    match camera.focal_source {
        FocalSource::Given => 0.0,
        FocalSource::Assumed => USUAL_SPREAD,
        FocalSource::VanishingPoints => {
            let known: Vec<_> = view.vanishing_points.iter().filter(|v| v.support > 0).cloned().collect();
            let spread = focal_from_points(&known, camera.principal, camera.focal).map_or(USUAL_SPREAD, |f| f.1);
            (spread.powi(-2) + USUAL_SPREAD.powi(-2)).powf(-0.5)
        }
    }
}

impl Plane {
    fn turned(&self, turn: DMat3) -> Self {
        Self { right: turn * self.right, down: turn * self.down, normal: turn * self.normal, ..self.clone() }
    }

    /// The plane that the same two vanishing points mean under another focal length.
    fn with_focal(&self, focal: f64) -> Self {
        let ratio = self.perspective.focal / focal;
        let again = |d: DVec3| (d.truncate() * ratio).extend(d.z).normalize();
        let (right, down) = (again(self.right), again(self.down));
        // No longer quite orthogonal: share the difference.
        let normal = right.cross(down).normalize();
        let half = (right + down).normalize();
        let other = normal.cross(half);
        let (right, down) = ((half - other).normalize(), (half + other).normalize());
        Self {
            right,
            down,
            normal,
            perspective: crate::geometry::Perspective { focal, ..self.perspective },
            ..self.clone()
        }
    }
}
