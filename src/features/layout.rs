//! The built-in depth: lays out the room as a single box aligned with the room's axes, seen from inside (after Hedau,
//! Hoiem and Forsyth 2009).
//!
//! In room axes the [box](Layout) is `-left <= x <= right`, `-top <= y <= bottom`, `z <= 1`. The back wall is at
//! distance one. This fixes the scale, which a single image cannot determine: if the camera is 1.6 m above the floor,
//! the wall is at `1.6 / bottom` metres. The four numbers are then also the sides of the back wall as seen from the
//! camera, in the coordinates `x/z` and `y/z`. Candidates for a side are the detected segments that could be this side
//! of the back wall. The module `search` covers all boxes that the candidates form, and `score` rates each box.

use super::box_room::{Face, Layout, facing_axes};
use super::depth::Surface;
use super::frustum::Frustum;
use super::input::RoomView;
use super::score::MAX_SEGMENTS;
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use crate::maths;
use glam::{DVec2, Vec3};

/// The confidence of a pixel falls with the distance to the nearest segment that supports its face, from the trust in
/// the layout to the share `UNSUPPORTED` of this trust. `FALLOFF` is the distance, as a share of the photo's diagonal,
/// at which the difference has fallen to 1/e. The confidence is not calibrated: these values only let it fall with the
/// distance. [convention]
const UNSUPPORTED: f64 = 0.3;
const FALLOFF: f64 = 0.15;

impl Layout {
    /// Computes the inverse depth, normal and confidence of every pixel.
    pub fn surface(
        &self,
        room: &RoomView,
        width: usize,
        height: usize,
        frustum: &Frustum,
        job: Job,
    ) -> Result<Surface> {
        let axes = facing_axes(room.perspective);
        let to_room = axes.transpose();
        let ray = |x: f64, y: f64| to_room * room.perspective.ray(DVec2::new(x, y));

        // Scale the depth so that the nearest depth (98 % quantile of inverse depth) lies on the near plane, as for a
        // caller's depth map.
        let steps = |n: usize| (0..48).map(move |i| (i as f64 + 0.5) / 48.0 * n as f64);
        let mut samples: Vec<f64> =
            steps(height).flat_map(|y| steps(width).map(move |x| (x, y))).map(|(x, y)| self.hit(ray(x, y)).1).collect();
        samples.sort_by(f64::total_cmp);
        let nearest = samples[samples.len() * 98 / 100].max(f64::MIN_POSITIVE);
        let scale = 1.0 / (nearest * f64::from(frustum.near));

        let mut inverse_depth = Image::new(width, height, 1)?;
        exec::for_rows(&mut inverse_depth.data, width, job.part(0.0, 0.4), |y, row| {
            for (x, out) in row.iter_mut().enumerate() {
                *out = (self.hit(ray(x as f64 + 0.5, y as f64 + 0.5)).1 * scale) as f32;
            }
        })?;
        let mut normals = Image::new(width, height, 3)?;
        exec::for_rows(&mut normals.data, width * 3, job.part(0.4, 0.7), |y, row| {
            for (x, out) in row.chunks_exact_mut(3).enumerate() {
                let (face, _) = self.hit(ray(x as f64 + 0.5, y as f64 + 0.5));
                Vec3::write_to_slice((axes * face.normal()).as_vec3(), out);
            }
        })?;
        let confidence = self.confidence(room, width, height, job.part(0.7, 1.0))?;
        Ok(Surface { inverse_depth, normals, confidence })
    }

    /// Computes the confidence of each pixel. The segments whose direction is possible on the face on which they lie
    /// are evidence for this face. The confidence of a pixel falls with its distance to the midpoint of the nearest
    /// such segment on the pixel's own face.
    fn confidence(&self, room: &RoomView, width: usize, height: usize, job: Job) -> Result<Image> {
        let to_room = facing_axes(room.perspective).transpose();
        let ray = |p: DVec2| to_room * room.perspective.ray(p);
        let support: Vec<(Face, DVec2)> = room
            .segments
            .iter()
            .filter_map(|(segment, axis)| {
                let face = self.hit(ray(segment.midpoint())).0;
                axis.filter(|&a| a != face.axis()).map(|_| (face, segment.midpoint()))
            })
            .take(MAX_SEGMENTS)
            .collect();
        let falloff = FALLOFF * DVec2::new(width as f64, height as f64).length();

        // Evaluate the confidence on a coarse grid, then interpolate bilinearly.
        let (columns, rows) = (width.div_ceil(16).min(64), height.div_ceil(16).min(64));
        let cell = DVec2::new(width as f64 / columns as f64, height as f64 / rows as f64);
        let mut coarse = Image::new(columns, rows, 1)?;
        exec::for_rows(&mut coarse.data, columns, job, |y, row| {
            for (x, out) in row.iter_mut().enumerate() {
                let centre = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * cell;
                let face = self.hit(ray(centre)).0;
                let on_face = support.iter().filter(|(f, _)| *f == face);
                let distance = on_face.map(|(_, p)| p.distance(centre)).fold(f64::INFINITY, f64::min);
                *out = (self.trust * (UNSUPPORTED + (1.0 - UNSUPPORTED) * maths::exp(-distance / falloff))) as f32;
            }
        })?;
        let mut confidence = Image::new(width, height, 1)?;
        exec::for_rows(&mut confidence.data, width, job, |y, row| {
            for (x, out) in row.iter_mut().enumerate() {
                *out = coarse.sample((x as f64 + 0.5) / cell.x, (y as f64 + 0.5) / cell.y, 0);
            }
        })?;
        Ok(confidence)
    }
}
