//! The strokes a user would paint on the photo of the exemplar room.

use super::Exemplar;
use crate::error::Result;
use crate::scene::Camera;
use crate::segment::{Stroke, StrokeSet};
use glam::{DVec2, Vec2, Vec3};

/// Brush radius as a share of the photo's height.
const RADIUS: f64 = 0.006;

/// Strokes on a photo of `width` × `height` pixels taken by the room's own camera.
pub fn strokes(exemplar: &Exemplar, width: usize, height: usize) -> Result<StrokeSet> {
    let camera = &exemplar.scene.cameras[exemplar.camera];
    let grid = &exemplar.grid;
    let radius = (RADIUS * height as f64).max(1.0);
    let on_ceiling = |p: Vec2| Vec3::new(p.x, exemplar.ceiling_height, p.y);
    let stroke = |points: &[Vec3], positive: bool| {
        let seen: Vec<DVec2> = points.iter().filter_map(|&p| project(camera, p, width, height)).collect();
        Stroke::polyline(&seen, radius, positive, width, height)
    };
    // Lamp `(column, row)`, and the tile half a period to its right.
    let lamp = |column: usize, row: usize| grid.first + grid.period * Vec2::new(column as f32, row as f32);
    let between = |column: usize, row: usize| lamp(column, row) + grid.period * Vec2::new(0.5, 0.0);
    let half = Vec2::new(0.3, 0.0) * grid.size;

    // Ceiling: along it between two columns of lamps, and across between two rows. Not ceiling: walls, floor, furniture.
    let along = [on_ceiling(between(0, 1)), on_ceiling(between(0, 3))];
    let across = [
        on_ceiling(lamp(0, 2) + grid.period * Vec2::new(0.1, 0.5)),
        on_ceiling(lamp(2, 2) + grid.period * Vec2::new(-0.1, 0.5)),
    ];
    let not_plane = [
        vec![Vec3::new(0.01, 2.5, 2.2), Vec3::new(0.01, 2.0, 1.2)],
        vec![Vec3::new(5.39, 2.6, 5.0), Vec3::new(5.39, 2.5, 2.5)],
        vec![Vec3::new(5.39, 2.2, 4.0), Vec3::new(5.39, 1.5, 2.0)],
        vec![Vec3::new(1.0, 2.4, 0.01), Vec3::new(4.4, 2.0, 0.01)],
        vec![Vec3::new(2.2, 0.0, 3.5), Vec3::new(2.6, 0.0, 2.0)],
    ];
    let mut set = StrokeSet::default();
    set.plane.push(stroke(&along, true)?);
    set.plane.push(stroke(&across, true)?);
    for points in &not_plane {
        set.plane.push(stroke(points, false)?);
    }

    // Lights: across two lamps. Not lights: the same ceiling.
    for (column, row) in [(0, 2), (1, 1), (1, 3)] {
        let centre = lamp(column, row);
        set.lights.push(stroke(&[on_ceiling(centre - half), on_ceiling(centre + half)], true)?);
    }
    set.lights.push(stroke(&along, false)?);
    set.lights.push(stroke(&across, false)?);
    Ok(set)
}

/// Where a camera sees a point, in pixels; `None` behind it.
fn project(camera: &Camera, point: Vec3, width: usize, height: usize) -> Option<DVec2> {
    let v = point - camera.position;
    let depth = v.dot(camera.forward);
    if depth <= 1e-3 {
        return None;
    }
    let right = camera.forward.cross(camera.up);
    let scale = f64::from(height as u32) / 2.0 / f64::from((camera.fov_y / 2.0).tan());
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
    fn every_stroke_lands_on_the_photo() {
        let exemplar = super::super::exemplar_room().unwrap();
        let set = strokes(&exemplar, 960, 640).unwrap();
        for stroke in set.plane.iter().chain(&set.lights) {
            assert!(stroke.pixels.len() > 100, "{} pixels", stroke.pixels.len());
        }
    }
}
