//! The part of the room's surface that each pixel shows: lamps of one kind cover equal areas of it, in equal shapes, at
//! any distance.

use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_collect, try_vec};
use crate::job::Job;
use glam::Vec3;

/// Where the positions are in the features.
const POSITION: usize = 4;

/// The part of the room's surface that each pixel shows, in the unit of the positions.
pub struct Footprint {
    pub area: Vec<f32>,
    /// Coordinates along the face that the strokes lie on.
    pub at: Vec<[f32; 2]>,
}

impl Footprint {
    /// Areas by the cross product of the differences of positions along rows and columns; coordinates along the two
    /// room axes that are farthest from the normal of the face.
    pub fn new(features: &Image, normal: Vec3, job: Job) -> Result<Self> {
        let (width, height) = (features.width, features.height);
        let position = |x: usize, y: usize| Vec3::from_slice(&features.pixel(x, y)[POSITION..]);
        let mut area = try_vec(width * height, 0f32)?;
        exec::for_rows(&mut area, width, job, |y, row| {
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            for (x, area) in row.iter_mut().enumerate() {
                let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
                let across = position(right, y) - position(left, y);
                let down = position(x, below) - position(x, above);
                let steps = ((right - left).max(1) * (below - above).max(1)) as f32;
                *area = across.cross(down).length() / steps;
            }
        })?;
        let off = normal.abs().max_position();
        let at = try_collect((0..width * height).map(|i| {
            let p = position(i % width, i / width);
            [p[(off + 1) % 3], p[(off + 2) % 3]]
        }))?;
        Ok(Self { area, at })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::CHANNELS;
    use crate::job::Monitor;

    #[test]
    fn a_pixel_of_an_inclined_plane_shows_the_area_of_its_parallelogram() {
        let (across, down) = (Vec3::new(0.5, 0.0, 0.25), Vec3::new(0.0, 0.75, -0.5));
        let features = Image::from_fn(6, 5, |x, y| {
            let at = x as f32 * across + y as f32 * down;
            let mut pixel = [0.0; CHANNELS];
            pixel[POSITION..POSITION + 3].copy_from_slice(&at.to_array());
            pixel
        });
        let footprint = Footprint::new(&features.unwrap(), Vec3::Y, Monitor::default().job()).unwrap();
        let areas = footprint.area;
        let expected = across.cross(down).length();
        assert!(areas.iter().all(|area| (area - expected).abs() < 1e-5 * expected), "{expected} {areas:?}");
    }
}
