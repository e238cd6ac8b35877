//! Turns strokes into evidence about the room. Each cell of a grid yields at most one sample of the strokes on the
//! plane and one of the other strokes, so that neither brush width nor the number of strokes affects the result. The
//! surfaces over which strokes have grown yield samples too, with weights in proportion to their areas.

use super::grow::Surfaces;
use super::input::RoomView;
use crate::error::Result;
use crate::image::{try_collect, try_vec};
use crate::job::Job;
use glam::{DMat3, DVec2, DVec3};

/// Number of cells along each side of the photo. It is odd, so that no pixel centre lies on the boundary of two cells:
/// along a side of n pixels, the centre x + 1/2 lies (2 x + 1) `CELLS` / (2 n) cells from the border, and the odd
/// numerator is no multiple of 2 n. A mirrored photo therefore has mirrored cells.
const CELLS: usize = 15;

/// One sample of the strokes within a grid cell: of the strokes on the plane, or of the other strokes.
pub struct StrokeSample {
    /// Ray through the mean of the strokes' pixels in the cell, in room axes.
    pub ray: DVec3,
    /// True for strokes on the plane, false for strokes elsewhere.
    pub positive: bool,
    /// Weight; the weights of all samples with the same value of `positive` add up to one.
    pub weight: f64,
}

/// Samples the strokes of a view. Pixels outside the image are ignored; pixels covered by strokes on the plane and by
/// other strokes count for both.
pub fn stroke_samples(
    room: &RoomView,
    to_room: &DMat3,
    [width, height]: [usize; 2],
    job: Job,
) -> Result<Vec<StrokeSample>> {
    let mut cells = try_vec(2 * CELLS * CELLS, (DVec2::ZERO, 0.0))?;
    for stroke in room.strokes {
        job.check()?;
        for pixel in stroke.pixels.iter().map(|&p| p as usize).filter(|p| *p < width * height) {
            let (x, y) = (pixel % width, pixel / width);
            let cell = [(2 * x + 1) * CELLS / (2 * width), (2 * y + 1) * CELLS / (2 * height)];
            let (sum, count) = &mut cells[2 * (cell[1] * CELLS + cell[0]) + usize::from(stroke.positive)];
            *sum += DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            *count += 1.0;
        }
    }
    let painted = |positive: bool| cells.iter().skip(usize::from(positive)).step_by(2).filter(|c| c.1 > 0.0);
    let counts = [false, true].map(|positive| painted(positive).count());
    let stroke_samples = [false, true].into_iter().flat_map(|positive| {
        painted(positive).map(move |(sum, count)| {
            let ray = *to_room * room.perspective.ray(sum / *count);
            StrokeSample { ray, positive, weight: 1.0 / counts[usize::from(positive)] as f64 }
        })
    });
    Ok(stroke_samples.filter(|sample| sample.ray.is_finite()).collect())
}

/// Samples the surfaces over which strokes have grown: at most one sample for each grid cell and each kind of surface,
/// at the mean position of its pixels. The weight of a sample is in proportion to its number of pixels.
pub fn surface_samples(
    surfaces: &Surfaces,
    room: &RoomView,
    to_room: &DMat3,
    [width, height]: [usize; 2],
) -> Result<Vec<StrokeSample>> {
    let (columns, rows) = (surfaces.width, surfaces.height);
    let pixel = DVec2::new(width as f64 / columns as f64, height as f64 / rows as f64);
    let mut cells = try_vec(2 * CELLS * CELLS, (DVec2::ZERO, 0.0))?;
    let known = surfaces.on_plane.iter().enumerate().filter_map(|(i, on_plane)| Some((i, (*on_plane)?)));
    for (i, positive) in known {
        let (x, y) = (i % columns, i / columns);
        let cell = [(2 * x + 1) * CELLS / (2 * columns), (2 * y + 1) * CELLS / (2 * rows)];
        let (sum, count) = &mut cells[2 * (cell[1] * CELLS + cell[0]) + usize::from(positive)];
        *sum += DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * pixel;
        *count += 1.0;
    }
    let area = |positive: bool| cells.iter().skip(usize::from(positive)).step_by(2).map(|cell| cell.1).sum::<f64>();
    let areas = [area(false), area(true)];
    let occupied = cells.iter().enumerate().filter(|(_, cell)| cell.1 > 0.0);
    let samples = occupied.map(|(i, (sum, count))| {
        let ray = *to_room * room.perspective.ray(sum / *count);
        StrokeSample { ray, positive: i % 2 == 1, weight: count / areas[i % 2] }
    });
    try_collect(samples.filter(|sample| sample.ray.is_finite()))
}
