//! Texture unwarping (§5.3). The room axes and the focal length give the homography of the plane with its true aspect
//! ratio; their errors give the expected error of the corners.

use super::axes::direction;
use super::camera::{self, FREE_ERROR};
use super::plane::{Plane, choose, marked_pixels};
use super::{UnwarpParams, Unwarped, View, quad, resample};
use crate::error::Result;
use crate::geometry::linear::symmetric_eigen;
use crate::geometry::{Homography, Perspective, PhotoMap};
use crate::image::Image;
use crate::job::Job;
use crate::maths;
use glam::{DMat3, DVec2, DVec3};

pub fn unwarp(photo: &Image, view: &View, mask: &Image, params: &UnwarpParams, job: Job) -> Result<Unwarped> {
    photo.check_same_size("photo", mask, "mask")?;
    params.check()?;
    let pixels = marked_pixels(mask)?;
    let plane = choose(view, mask, &pixels, params.axes)?;
    job.check()?;
    let rectangle = quad::largest(&plane, mask, &pixels, params.max_magnification)?;
    job.check()?;
    job.report(0.1);

    // The best-resolved part of the plane determines the pixel size, unless the image would become larger than
    // `max_side`.
    let size = rectangle.high - rectangle.low;
    let pixel_size = rectangle.finest_pixel_side.max(size.max_element() / params.max_side as f64);
    let side = |length: f64| ((length / pixel_size).round() as usize).clamp(1, params.max_side);
    let (width, height) = (side(size.x), side(size.y));
    // Keep pixels square; distribute the rounding of the size over opposite sides.
    let spare = size - DVec2::new(width as f64, height as f64) * pixel_size;
    let to_plane = DMat3::from_translation(rectangle.low + spare / 2.0) * DMat3::from_scale(DVec2::splat(pixel_size));
    let homography = Homography(plane.homography().0 * to_plane).rescaled();
    let to_photo = PhotoMap { homography, lens: view.perspective.lens() };

    let mut image = resample::warp_photo(&photo.to_rgb()?, &to_photo, width, height, job.part(0.1, 0.8))?;
    let mut valid = resample::warp_photo(&mask.channel(0)?, &to_photo, width, height, job.part(0.8, 1.0))?;
    for (pixel, valid) in image.data.chunks_exact_mut(3).zip(&mut valid.data) {
        // Mark pixels that are not finite as invalid, and show them black.
        *valid = if *valid >= 0.5 && pixel.iter().all(|v| v.is_finite()) { 1.0 } else { 0.0 };
        if pixel.iter().any(|v| !v.is_finite()) {
            pixel.fill(0.0);
        }
    }

    let (w, h) = (width as f64, height as f64);
    let corners = [DVec2::ZERO, DVec2::new(w, 0.0), DVec2::new(w, h), DVec2::new(0.0, h)];
    let uncertainty = uncertainty(&plane, view, corners.map(|c| homography.apply(c)), pixel_size);
    job.report(1.0);
    Ok(Unwarped {
        image,
        valid,
        to_photo,
        pixel_size,
        corners: corners.map(|c| to_photo.apply(c)),
        aspect_confidence: uncertainty.aspect_confidence,
        corner_error: uncertainty.corner_error,
    })
}

impl Unwarped {
    /// The union of `valid` and of `mask`, a mask of the photo, unwarped. A pixel of `mask` that is NaN marks nothing.
    pub fn valid_with(&self, mask: &Image, job: Job) -> Result<Image> {
        let Image { width, height, .. } = self.valid;
        let mut valid = resample::warp_photo(&mask.channel(0)?, &self.to_photo, width, height, job)?;
        for (joined, valid) in valid.data.iter_mut().zip(&self.valid.data) {
            *joined = if *joined >= 0.5 { 1.0 } else { *valid };
        }
        Ok(valid)
    }
}

struct Uncertainty {
    aspect_confidence: f64,
    corner_error: [f64; 4],
}

/// Propagates the covariances of the vanishing points and the uncertainty of the focal length to the rectified
/// corners, to first order: perturbs each input slightly and re-estimates the camera (focal length and axes) from the
/// perturbed inputs. `corners` are pixels of the photo that an ideal lens would take, as in [`rectified`].
fn uncertainty(plane: &Plane, view: &View, corners: [DVec2; 4], pixel_size: f64) -> Uncertainty {
    let camera = &view.perspective;
    let expected = view.expected_focal;
    let points = &view.vanishing_points;
    let nominal = camera::reestimate(camera, points, expected);
    let flat = |found: &Perspective| {
        let turn = found.axes * nominal.axes.transpose();
        rectified(&plane.seen_by(turn, camera.focal * found.focal / nominal.focal), corners)
    };
    let aspect = |c: &[DVec2; 4]| {
        maths::ln((c[1].distance(c[0]) + c[2].distance(c[3])) / (c[3].distance(c[0]) + c[2].distance(c[1])))
    };

    let mut moved: Vec<[DVec2; 4]> = Vec::new();
    for (k, point) in points.iter().enumerate().filter(|(_, p)| p.support > 0) {
        for step in deviations(&point.covariance) {
            let mut points = points.clone();
            let ray = direction(point.point, camera.principal, camera.focal);
            points[k].point = (camera.intrinsics() * (ray + step * SMALL)).normalize();
            moved.push(flat(&camera::reestimate(camera, &points, expected)));
        }
    }
    moved.push(flat(&camera::reestimate(camera, points, expected.moved(SMALL))));
    // A single vanishing point does not determine the rotation about its direction: give this rotation the uncertainty
    // of an axis fixed by convention.
    if points.iter().filter(|p| p.support > 0).count() < 2 {
        for axis in (0..3).filter(|&k| points[k].support > 0).map(|k| camera.axes.col(k)) {
            let turn = DMat3::from_quat(maths::rotation_about(axis, FREE_ERROR * SMALL));
            moved.push(rectified(&plane.seen_by(turn, camera.focal), corners));
        }
    }

    let still = rectified(plane, corners);
    let mut squares = [0.0; 4];
    let mut aspect_variance = 0.0;
    for corners in &moved {
        for (square, (a, b)) in squares.iter_mut().zip(corners.iter().zip(&still)) {
            *square += maths::powi(a.distance(*b) / (SMALL * pixel_size), 2);
        }
        aspect_variance += maths::powi((aspect(corners) - aspect(&still)) / SMALL, 2);
    }
    // A confidence of one half corresponds to a relative standard deviation of 10 % of the aspect ratio. [convention]
    Uncertainty { aspect_confidence: 1.0 / (1.0 + aspect_variance / 0.01), corner_error: squares.map(f64::sqrt) }
}

/// Step of the finite differences as a share of a standard deviation. [rounding]
const SMALL: f64 = 1e-3;

/// Returns vectors whose outer products with themselves sum to the covariance matrix.
fn deviations(covariance: &DMat3) -> [DVec3; 3] {
    let rows = covariance.to_cols_array_2d();
    let (values, vectors) = symmetric_eigen::<3>(rows);
    std::array::from_fn(|k| DVec3::from_array(vectors[k]) * values[k].max(0.0).sqrt())
}

/// Returns the plane coordinates of four photo points relative to their mean. A common translation of the corners does
/// not count as an error, because the origin of the plane's coordinates is arbitrary.
fn rectified(plane: &Plane, corners: [DVec2; 4]) -> [DVec2; 4] {
    let inverse = plane.homography().inverse();
    let at = corners.map(|c| inverse.apply(c));
    let mean = at.iter().sum::<DVec2>() / 4.0;
    at.map(|p| p - mean)
}

impl Plane {
    /// Returns the plane after the camera's axes rotate by `turn` and its focal length becomes `focal`.
    fn seen_by(&self, turn: DMat3, focal: f64) -> Self {
        Self {
            right: turn * self.right,
            down: turn * self.down,
            normal: turn * self.normal,
            perspective: Perspective { focal, ..self.perspective },
        }
    }
}
