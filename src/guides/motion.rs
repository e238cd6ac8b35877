//! Computes the position of each pixel of a frame in the previous frame, for a moving camera in a static scene.

use super::Guides;
use crate::error::Result;
use crate::image::Image;
use glam::Vec3;

/// A point was occluded in the previous frame if its depth exceeds the depth seen there by more than this share.
/// [origin not recorded]
const DEPTH_TOLERANCE: f32 = 0.02;

/// Computes the displacement in pixels from each pixel to the position of its surface point in the previous frame: two
/// channels, NaN where there is no surface, and where the point was occluded or outside the picture.
pub fn motion(now: &Guides, before: &Guides) -> Result<Image> {
    now.depth.check_same_size("this frame", &before.depth, "the frame before")?;
    let (width, height) = (now.depth.width, now.depth.height);
    let size = [width as f32, height as f32];
    let aspect = size[0] / size[1];
    let forward = now.camera.forward.normalize_or_zero();
    let old = &before.camera;
    let old_forward = old.forward.normalize_or_zero();
    let right = old_forward.cross(old.up).normalize_or_zero();
    let up = right.cross(old_forward);
    let half = (old.fov_y / 2.0).tan();
    let mut out = Image::new(width, height, 2)?;
    for (i, motion) in out.data.chunks_exact_mut(2).enumerate() {
        let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        // Reproject the visible point into the camera of the previous frame.
        let ray = now.camera.direction(x / size[0], y / size[1], aspect);
        let point = now.camera.position + ray * (now.depth.data[i] / ray.dot(forward));
        let offset: Vec3 = point - old.position;
        let depth = offset.dot(old_forward);
        let u = (offset.dot(right) / (depth * half * aspect) + 1.0) / 2.0 * size[0];
        let v = (1.0 - offset.dot(up) / (depth * half)) / 2.0 * size[1];
        let inside = depth > 0.0 && u >= 0.0 && v >= 0.0 && u < size[0] && v < size[1];
        let seen = inside && depth <= before.depth.pixel(u as usize, v as usize)[0] * (1.0 + DEPTH_TOLERANCE);
        motion.copy_from_slice(&if seen { [u - x, v - y] } else { [f32::NAN; 2] });
    }
    Ok(out)
}
