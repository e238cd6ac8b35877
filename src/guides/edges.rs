//! Computes the edges of shapes: changes of material, creases of the surface, and depth discontinuities.

use crate::error::Result;
use crate::exec;
use crate::image::{Image, pyramid};
use crate::job::Job;
use glam::Vec3;

/// Neighbouring pixels form an edge of full strength if 1 minus the cosine between their normals is at least this
/// (about 40°). [bench constants:guides]
const FULL_CREASE: f32 = 0.25;
/// A depth discontinuity is an edge of full strength if the second difference of the depth is at least this share of
/// the depth. [bench constants:guides]
const FULL_STEP: f32 = 0.02;
/// Standard deviation of the blur of the edges, in pixels. Because of the blur, patches beside an edge contain a part
/// of the edge. [bench constants:guides]
const BLUR: f32 = 0.8;
/// Strength below which an edge is noise on a curved surface. [convention]
const WEAK: f32 = 0.2;

/// Returns the strength of the edge at each pixel, in `[0, 1]`.
pub fn edges(normals: &Image, material: &Image, depth: &Image, job: Job) -> Result<Image> {
    let (width, height) = (normals.width, normals.height);
    let mut sharp = Image::new(width, height, 1)?;
    let normal = |x: usize, y: usize| Vec3::from_slice(normals.pixel(x, y));
    exec::for_rows(&mut sharp.data, width, job, |y, row| {
        for (x, edge) in row.iter_mut().enumerate() {
            let around = [
                (x.saturating_sub(1), y),
                ((x + 1).min(width - 1), y),
                (x, y.saturating_sub(1)),
                (x, (y + 1).min(height - 1)),
            ];
            let here = normal(x, y);
            for (i, j) in around {
                let changes = material.pixel(i, j) != material.pixel(x, y);
                let fold = (1.0 - here.dot(normal(i, j))) / FULL_CREASE;
                *edge = edge.max(if changes {
                    1.0
                } else if here == Vec3::ZERO {
                    0.0
                } else {
                    fold
                });
            }
            // Use the second difference of depth: a constant slope is not a discontinuity.
            for pair in around.chunks_exact(2) {
                let (d, a, b) =
                    (depth.pixel(x, y)[0], depth.pixel(pair[0].0, pair[0].1)[0], depth.pixel(pair[1].0, pair[1].1)[0]);
                let step = (a + b - 2.0 * d).abs() / (FULL_STEP * d);
                *edge = if step.is_finite() { edge.max(step) } else { *edge };
            }
            // Suppress weak edges, and rescale the others to [0, 1].
            *edge = ((*edge - WEAK) / (1.0 - WEAK)).clamp(0.0, 1.0);
        }
    })?;
    pyramid::blur(&sharp, BLUR, job)
}
