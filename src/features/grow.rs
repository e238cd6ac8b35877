//! Grows the user's strokes over the surfaces on which they lie (after Adams and Bischof 1994, "Seeded Region
//! Growing").
//!
//! Two classes of strokes compete: positive strokes, on the plane, and negative strokes, on other surfaces. The cost of
//! a path is the largest gradient of colour along it. The cost of a class at a pixel is the lowest cost of a path from
//! its strokes to the pixel. The pixel goes to the class of lower cost, if this cost is small and clearly lower than
//! the cost of the other class. A wall and a ceiling of one colour are thus separated at the seam between them, even if
//! the seam is faint. Pixels behind strong edges go to neither class.

use super::input::PlaneStroke;
use crate::error::Result;
use crate::image::{Image, colour, pyramid, try_collect, try_push, try_vec};
use crate::job::Job;
use glam::Vec3;

/// Longest side in pixels of the reduced image in which strokes grow. The reduction averages noise, and turns the
/// soft shades along a seam into an edge.
const MAX_SIDE: usize = 400;
/// Standard deviation in pixels of the blur before gradients are computed. [convention]
const SIGMA: f32 = 1.0;
/// Strokes grow up to this gradient, in units of CIELAB per pixel of the reduced image. [judged on 58 photos]
const MAX_GRADIENT: f32 = 1.5;
/// The strokes of one class own a pixel if they reach it at less than this share of the cost at which the strokes of
/// the other class reach it. [judged on 58 photos]
const CLEARLY: f32 = 0.7;
/// Edges divide a stroke into parts. A part grows only if it holds at least this share of the stroke, because hurried
/// strokes run over edges by up to a tenth of their length. [bench photos:tune]
const MIN_PART: f64 = 0.2;
/// Blur and widened edges stop strokes about this number of pixels before the edge of their surface. The grown parts
/// are therefore widened by this number.
const MARGIN: usize = 3;
/// Costs are stored as integers from 0 to this maximum, which stands for the gradient `MAX_GRADIENT / CLEARLY` and all
/// steeper ones. No larger cost is needed. A class owns a pixel only if its cost is below the cost of the gradient
/// `MAX_GRADIENT`, which is `CLEARLY` times the maximum. So if the cost of the other class is the maximum, it is
/// clearly larger already.
const LEVELS: usize = u8::MAX as usize;

/// The parts of a photo over which strokes have grown.
#[derive(Clone, Debug)]
pub struct Surfaces {
    /// Size of the reduced image.
    pub width: usize,
    pub height: usize,
    /// For each pixel of the reduced image: whether it lies on the plane of the positive strokes; `None` if unknown.
    pub on_plane: Vec<Option<bool>>,
}

impl Surfaces {
    /// Whether a pixel (`y * width + x`) of a photo of the given size surely lies off the plane; false for pixels
    /// outside the photo.
    pub fn is_off_plane(&self, pixel: usize, [width, height]: [usize; 2]) -> bool {
        let (x, y) = (pixel % width * self.width / width, pixel / width * self.height / height);
        self.on_plane.get(y * self.width + x) == Some(&Some(false))
    }
}

/// Grows the strokes of a photo. `None` unless there are strokes of both classes, because only their competition
/// stops them at a faint seam.
pub fn grow(photo: &Image, strokes: &[PlaneStroke], job: Job) -> Result<Option<Surfaces>> {
    let has = |positive: bool| strokes.iter().any(|s| s.positive == positive && !s.pixels.is_empty());
    if !(has(true) && has(false)) {
        return Ok(None);
    }
    let scale = (MAX_SIDE as f64 / photo.width.max(photo.height) as f64).min(1.0);
    let size = [photo.width, photo.height].map(|n| ((n as f64 * scale).round() as usize).max(1));
    let costs = Costs { of: costs(photo, size, job.part(0.0, 0.8))?, width: size[0] };
    let parts = costs.smooth_parts()?;
    let reached = |positive: bool| -> Result<Vec<u8>> {
        let mut seeds = Vec::new();
        for stroke in strokes.iter().filter(|s| s.positive == positive) {
            add_seeds(stroke, photo, size, &parts, &mut seeds)?;
        }
        costs.lowest(&seeds)
    };
    let (on, off) = (reached(true)?, reached(false)?);
    let owns = |own: u8, other: u8| own < SMOOTH && f32::from(own) < CLEARLY * f32::from(other);
    let label = |(&on, &off): (&u8, &u8)| if owns(on, off) { Some(true) } else { owns(off, on).then_some(false) };
    let mut on_plane = try_collect(on.iter().zip(&off).map(label))?;
    for _ in 0..MARGIN {
        on_plane = widened(&on_plane, size[0])?;
    }
    job.report(1.0);
    Ok(Some(Surfaces { width: size[0], height: size[1], on_plane }))
}

/// Appends to `seeds` the smooth pixels of the reduced image that a stroke covers. Leaves out the pixels in parts of
/// the stroke that hold less than the share [`MIN_PART`] of these smooth pixels.
fn add_seeds(
    stroke: &PlaneStroke,
    photo: &Image,
    [width, height]: [usize; 2],
    parts: &[u32],
    seeds: &mut Vec<usize>,
) -> Result<()> {
    let reduced = |&p: &u32| {
        let (x, y) = (p as usize % photo.width, p as usize / photo.width);
        (y < photo.height).then(|| y * height / photo.height * width + x * width / photo.width)
    };
    let smooth = stroke.pixels.iter().filter_map(reduced).map(|i| (parts[i], i)).filter(|(part, _)| *part != 0);
    let mut smooth = try_collect(smooth)?;
    smooth.sort_unstable();
    let smallest = MIN_PART * smooth.len() as f64;
    for part in smooth.chunk_by(|a, b| a.0 == b.0).filter(|part| part.len() as f64 >= smallest) {
        for &(_, seed) in part {
            try_push(seeds, seed)?;
        }
    }
    Ok(())
}

/// A pixel is smooth if its cost is below this value, the cost of the gradient `MAX_GRADIENT`.
const SMOOTH: u8 = (CLEARLY * LEVELS as f32) as u8;

/// The cost of each pixel of the reduced image, from 0 to `LEVELS`.
struct Costs {
    of: Vec<u8>,
    width: usize,
}

/// Computes the cost of each pixel: the largest gradient of CIELAB at the pixel and its eight neighbours, so that
/// strokes do not pass small gaps in an edge.
fn costs(photo: &Image, [width, height]: [usize; 2], job: Job) -> Result<Vec<u8>> {
    let mut lab = pyramid::resize(photo, width, height, job.part(0.0, 0.7))?.to_rgb()?;
    for pixel in lab.data.chunks_exact_mut(3) {
        colour::linear_to_lab(Vec3::from_slice(pixel)).write_to_slice(pixel);
    }
    let lab = pyramid::blur(&lab, SIGMA, job.part(0.7, 0.8))?;
    let gradient = |i: usize| {
        let (x, y) = (i % width, i / width);
        let across = lab.rgb((x + 1).min(width - 1), y) - lab.rgb(x.saturating_sub(1), y);
        let down = lab.rgb(x, (y + 1).min(height - 1)) - lab.rgb(x, y.saturating_sub(1));
        let slope = 0.5 * (across.length_squared() + down.length_squared()).sqrt();
        (slope / MAX_GRADIENT * f32::from(SMOOTH)) as u8
    };
    let gradients = try_collect((0..width * height).map(gradient))?;
    let largest = |i: usize| {
        let (x, y) = (i % width, i / width);
        let columns = x.saturating_sub(1)..(x + 2).min(width);
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        rows.flat_map(|v| &gradients[v * width..][columns.clone()]).copied().max().unwrap_or(0)
    };
    try_collect((0..width * height).map(largest))
}

impl Costs {
    /// Numbers the connected parts of smooth pixels, from 1 on; 0 stands for the other pixels.
    fn smooth_parts(&self) -> Result<Vec<u32>> {
        let mut parts = try_vec(self.of.len(), 0u32)?;
        let mut open = Vec::new();
        let mut count = 0;
        for start in 0..self.of.len() {
            if self.of[start] >= SMOOTH || parts[start] != 0 {
                continue;
            }
            count += 1;
            parts[start] = count;
            try_push(&mut open, start)?;
            while let Some(i) = open.pop() {
                for n in beside(i, self.width, self.of.len()) {
                    if self.of[n] < SMOOTH && parts[n] == 0 {
                        parts[n] = count;
                        try_push(&mut open, n)?;
                    }
                }
            }
        }
        Ok(parts)
    }

    /// Returns, for each pixel, the lowest cost of a path from a seed; `LEVELS` where no path is cheaper.
    fn lowest(&self, seeds: &[usize]) -> Result<Vec<u8>> {
        let mut lowest = try_vec(self.of.len(), u8::MAX)?;
        // One list of open pixels for each cost. Costs never fall along a path, so each list is emptied once.
        let mut open: Vec<Vec<usize>> = vec![Vec::new(); LEVELS];
        for &seed in seeds {
            if std::mem::replace(&mut lowest[seed], 0) != 0 {
                try_push(&mut open[0], seed)?;
            }
        }
        for cost in 0..LEVELS {
            while let Some(i) = open[cost].pop() {
                if usize::from(lowest[i]) != cost {
                    continue;
                }
                for n in beside(i, self.width, self.of.len()) {
                    let there = self.of[n].max(cost as u8);
                    if there < lowest[n] {
                        lowest[n] = there;
                        try_push(&mut open[usize::from(there)], n)?;
                    }
                }
            }
        }
        Ok(lowest)
    }
}

/// Gives each unknown pixel the label of its known neighbours, unless they differ.
fn widened(labels: &[Option<bool>], width: usize) -> Result<Vec<Option<bool>>> {
    let label = |i: usize| {
        let has = |wanted: bool| beside(i, width, labels.len()).any(|n| labels[n] == Some(wanted));
        labels[i].or_else(|| if has(true) { (!has(false)).then_some(true) } else { has(false).then_some(false) })
    };
    try_collect((0..labels.len()).map(label))
}

/// The up to four neighbours of a pixel in its row and its column.
fn beside(i: usize, width: usize, count: usize) -> impl Iterator<Item = usize> {
    let x = i % width;
    let beside = [(x > 0).then(|| i - 1), (x + 1 < width).then_some(i + 1), i.checked_sub(width), Some(i + width)];
    beside.into_iter().flatten().filter(move |&n| n < count)
}

#[cfg(test)]
#[path = "tests/grow.rs"]
mod tests;
