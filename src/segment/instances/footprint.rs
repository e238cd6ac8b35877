//! The area of the room's surface that each pixel shows: lamps of one kind cover equal areas of it, however far they are.

use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_vec};
use crate::job::Job;
use glam::Vec3;

/// Where the positions are in the features.
const POSITION: usize = 4;

/// Areas in the square of the unit of the positions, by the cross product of their differences along rows and columns.
pub fn areas(features: &Image, job: Job) -> Result<Vec<f32>> {
    let (width, height) = (features.width, features.height);
    let position = |x: usize, y: usize| Vec3::from_slice(&features.pixel(x, y)[POSITION..]);
    let mut areas = try_vec(width * height, 0f32)?;
    exec::for_rows(&mut areas, width, job, |y, row| {
        let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
        for (x, area) in row.iter_mut().enumerate() {
            let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
            let across = position(right, y) - position(left, y);
            let down = position(x, below) - position(x, above);
            let steps = ((right - left).max(1) * (below - above).max(1)) as f32;
            *area = across.cross(down).length() / steps;
        }
    })?;
    Ok(areas)
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
        let areas = areas(&features.unwrap(), Monitor::default().job()).unwrap();
        let expected = across.cross(down).length();
        assert!(areas.iter().all(|area| (area - expected).abs() < 1e-5 * expected), "{expected} {areas:?}");
    }
}
