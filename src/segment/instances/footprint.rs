//! Computes the area on a face of the room that each pixel shows. Measured on the face, lamps of one kind have equal
//! areas and equal shapes at any distance from the camera.

use crate::error::Result;
use crate::exec;
use crate::features::{NORMAL, POSITION};
use crate::image::{Image, try_collect, try_vec};
use crate::job::Job;
use glam::Vec3;
use std::f32::consts::FRAC_1_SQRT_2;

/// The area of a face of the room, and the position on it, that each pixel shows. The face's plane counts beyond the
/// face's edges too: if a pixel shows another face, the values belong to the point where the pixel's ray meets this
/// plane. Lengths have the unit of the positions in the features.
pub struct Footprint {
    /// Area on the face's plane that each pixel shows; infinite where the pixel's ray does not meet the plane.
    pub area: Vec<f32>,
    /// Coordinates of each pixel on the face's plane, along two room axes; infinite where the pixel's ray does not meet
    /// the plane.
    pub at: Vec<[f32; 2]>,
    /// Whether each pixel shows the face itself: the pixel's normal in the features deviates by less than 45 degrees
    /// from the face's normal.
    pub is_on_face: Vec<bool>,
}

/// Minimum sine of the angle between a ray and the face that it meets. [rounding]
const MIN_SINE: f32 = 1e-3;

impl Footprint {
    /// Computes the footprints of all pixels on the face with the given normal and signed distance from the camera
    /// (`face::offset`). The area of a pixel is |r × c|, where r and c are the changes of position per pixel along the
    /// row and along the column. The coordinates run along two of the three room axes, without the axis nearest to the
    /// normal.
    pub fn new(features: &Image, (normal, offset): (Vec3, f32), job: Job) -> Result<Self> {
        let (width, height) = (features.width, features.height);
        // The point where the ray through a pixel meets the face or its extension.
        let position = |x: usize, y: usize| {
            let p = Vec3::from_slice(&features.pixel(x, y)[POSITION..]);
            let depth = p.dot(normal) * offset.signum();
            if depth > MIN_SINE * p.length() { p * (offset.abs() / depth) } else { Vec3::INFINITY }
        };
        let mut area = try_vec(width * height, 0f32)?;
        exec::for_rows(&mut area, width, job, |y, row| {
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            for (x, area) in row.iter_mut().enumerate() {
                let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
                let across = position(right, y) - position(left, y);
                let down = position(x, below) - position(x, above);
                let steps = ((right - left).max(1) * (below - above).max(1)) as f32;
                let shown = across.cross(down).length() / steps;
                *area = if shown.is_finite() { shown } else { f32::INFINITY };
            }
        })?;
        let off = normal.abs().max_position();
        let at = try_collect((0..width * height).map(|i| {
            let p = position(i % width, i / width);
            [p[(off + 1) % 3], p[(off + 2) % 3]]
        }))?;
        let pixels = features.data.chunks_exact(features.channels);
        let is_on_face = try_collect(pixels.map(|p| Vec3::from_slice(&p[NORMAL..]).dot(normal) > FRAC_1_SQRT_2))?;
        Ok(Self { area, at, is_on_face })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::CHANNELS;
    use crate::job::Monitor;

    /// An inclined plane. From the given column on, objects at half the distance hide it.
    fn inclined(across: Vec3, down: Vec3, column: usize) -> (Image, (Vec3, f32)) {
        let normal = down.cross(across).normalize();
        let features = Image::from_fn(6, 5, |x, y| {
            let at = Vec3::new(-1.0, -2.0, 4.0) + x as f32 * across + y as f32 * down;
            let at = if x < column { at } else { 0.5 * at };
            let mut pixel = [0.0; CHANNELS];
            pixel[POSITION..POSITION + 3].copy_from_slice(&at.to_array());
            pixel
        });
        (features.unwrap(), (normal, Vec3::new(-1.0, -2.0, 4.0).dot(normal)))
    }

    #[test]
    fn a_pixel_of_an_inclined_plane_shows_the_area_of_its_parallelogram_also_beyond_its_edge() {
        let (across, down) = (Vec3::new(0.5, 0.0, 0.25), Vec3::new(0.0, 0.25, -0.5));
        let expected = across.cross(down).length();
        for column in [6, 3] {
            let (features, face) = inclined(across, down, column);
            let areas = Footprint::new(&features, face, Monitor::default().job()).unwrap().area;
            assert!(areas.iter().all(|area| (area - expected).abs() < 1e-4 * expected), "{expected} {areas:?}");
        }
    }

    #[test]
    fn a_pixel_that_does_not_see_the_plane_shows_an_infinite_area() {
        let (mut features, face) = inclined(Vec3::new(0.5, 0.0, 0.25), Vec3::new(0.0, 0.25, -0.5), 3);
        let behind = features.pixel(5, 2)[POSITION..POSITION + 3].to_vec();
        features.data[(2 * 6 + 5) * CHANNELS + POSITION..][..3].iter_mut().zip(behind).for_each(|(v, p)| *v = -p);
        let areas = Footprint::new(&features, face, Monitor::default().job()).unwrap().area;
        assert_eq!(areas[2 * 6 + 5], f32::INFINITY);
        assert!(areas[2 * 6 + 1].is_finite());
    }
}
