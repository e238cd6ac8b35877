//! The strokes with which a user would mark the ceiling and the lamps on the photo of the exemplar room.

use super::Exemplar;
use crate::error::Result;
use crate::image::Image;
use crate::maths;
use crate::scene::Camera;
use crate::segment::{Stroke, StrokeSet};
use glam::{DVec2, Vec2, Vec3};

/// Brush radius as a share of the photo's height. [convention]
const RADIUS: f64 = 0.006;

/// Returns the strokes for a photo of `width` × `height` pixels, taken by the room's own camera.
pub fn strokes(exemplar: &Exemplar, width: usize, height: usize) -> Result<StrokeSet> {
    let camera = &exemplar.scene.cameras[exemplar.camera];
    let grid = &exemplar.grid;
    let radius = (RADIUS * height as f64).max(1.0);
    let on_ceiling = |p: Vec2| Vec3::new(p.x, exemplar.ceiling_height, p.y);
    let stroke = |points: &[Vec3], positive: bool| {
        let seen: Vec<DVec2> = points.iter().filter_map(|&p| project(camera, p, width, height)).collect();
        Stroke::polyline(&seen, radius, positive, width, height)
    };
    // `lamp`: centre of the lamp at (column, row). `between`: the point half a period from this centre along x. `half`:
    // step from the centre of a lamp to the end of a stroke across the lamp.
    let lamp = |column: usize, row: usize| grid.first + grid.period * Vec2::new(column as f32, row as f32);
    let between = |column: usize, row: usize| lamp(column, row) + grid.period * Vec2::new(0.5, 0.0);
    let half = Vec2::new(0.3, 0.0) * grid.size;

    // Strokes for the plane. Positive strokes lie on the ceiling: along the room between two columns of lamps, once
    // far and once near, and across the room between two rows. Negative strokes lie on the walls, and on objects in
    // front of them. No two strokes cross, so that a single drawing can hold them all.
    let along = |column: usize, row: usize| [on_ceiling(between(column, row)), on_ceiling(between(column, row + 1))];
    let across = |column: usize, row: usize| {
        let middle = Vec2::new(0.0, 0.5) * grid.period;
        [on_ceiling(lamp(column, row) + middle), on_ceiling(between(column, row) + middle)]
    };
    let not_plane = [
        vec![Vec3::new(0.01, 2.5, 2.2), Vec3::new(0.01, 2.0, 1.2)],
        vec![Vec3::new(5.39, 2.6, 5.0), Vec3::new(5.39, 2.5, 2.5)],
        vec![Vec3::new(5.39, 2.2, 4.0), Vec3::new(5.39, 1.5, 2.0)],
        vec![Vec3::new(1.0, 2.4, 0.01), Vec3::new(4.4, 2.0, 0.01)],
        vec![Vec3::new(1.4, 2.0, 0.01), Vec3::new(2.6, 1.8, 0.01)],
    ];
    let mut set = StrokeSet::default();
    set.plane.push(stroke(&along(0, 1), true)?);
    set.plane.push(stroke(&along(0, 4), true)?);
    set.plane.push(stroke(&across(1, 3), true)?);
    for points in &not_plane {
        set.plane.push(stroke(points, false)?);
    }

    // Strokes for the lights. Positive strokes run across three lamps; negative strokes lie on the ceiling.
    for (column, row) in [(0, 2), (1, 1), (1, 3)] {
        let centre = lamp(column, row);
        set.lights.push(stroke(&[on_ceiling(centre - half), on_ceiling(centre + half)], true)?);
    }
    set.lights.push(stroke(&along(1, 2), false)?);
    set.lights.push(stroke(&across(0, 3), false)?);
    Ok(set)
}

/// Draws all strokes into one image, in the colours that [`crate::segment::strokes::from_image`] reads.
pub fn drawing(set: &StrokeSet, width: usize, height: usize) -> Result<Image> {
    let mut image = Image::new(width, height, 3)?;
    let colours = [(&set.plane, [Vec3::Y, Vec3::X]), (&set.lights, [Vec3::new(1.0, 1.0, 0.0), Vec3::Z])];
    for (strokes, [positive, negative]) in colours {
        for stroke in strokes {
            let colour = if stroke.positive { positive } else { negative };
            for &pixel in &stroke.pixels {
                colour.write_to_slice(&mut image.data[3 * pixel as usize..]);
            }
        }
    }
    Ok(image)
}

/// Returns the position in pixels at which a camera sees a point; `None` if the point is behind the camera.
fn project(camera: &Camera, point: Vec3, width: usize, height: usize) -> Option<DVec2> {
    let v = point - camera.position;
    let depth = v.dot(camera.forward);
    if depth <= 1e-3 {
        return None;
    }
    let right = camera.forward.cross(camera.up);
    let scale = f64::from(height as u32) / 2.0 / f64::from(maths::tan(camera.fov_y / 2.0));
    let offset = DVec2::new(f64::from(v.dot(right) / depth), -f64::from(v.dot(camera.up) / depth));
    Some(DVec2::new(width as f64 / 2.0, height as f64 / 2.0) + offset * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_projected_point_lies_on_its_cameras_ray() {
        let exemplar = super::super::exemplar_room().unwrap();
        let camera = &exemplar.scene.cameras[exemplar.camera];
        for point in [Vec3::new(1.0, 2.7, 4.0), Vec3::new(3.0, 0.0, 1.0)] {
            let pixel = project(camera, point, 600, 400).unwrap();
            let ray = camera.direction(pixel.x as f32 / 600.0, pixel.y as f32 / 400.0, 1.5);
            assert!(ray.normalize().dot((point - camera.position).normalize()) > 1.0 - 1e-6);
        }
    }

    #[test]
    fn the_drawing_holds_every_stroke() {
        let exemplar = super::super::exemplar_room().unwrap();
        let set = strokes(&exemplar, 720, 480).unwrap();
        let read = crate::segment::strokes::from_image(&drawing(&set, 720, 480).unwrap()).unwrap();
        assert_eq!((read.plane.len(), read.lights.len()), (set.plane.len(), set.lights.len()));
        let pixels = |s: &StrokeSet| s.plane.iter().chain(&s.lights).map(|s| s.pixels.len()).sum::<usize>();
        assert_eq!(pixels(&read), pixels(&set));
    }

    #[test]
    fn every_stroke_lands_on_the_photo() {
        let exemplar = super::super::exemplar_room().unwrap();
        let set = strokes(&exemplar, 960, 640).unwrap();
        for stroke in set.plane.iter().chain(&set.lights) {
            assert!(stroke.pixels.len() > 100, "{} pixels", stroke.pixels.len());
        }
    }
}
