//! Decides whether the normals guide a run in addition to the light. They do if the strokes of the exemplar follow the
//! shapes of its objects.
//!
//! Guides of light determine how dark the paint is, but hardly in which direction its strokes run: places of equal
//! light can have any slope. The exemplar is divided into blocks, and the direction of the strokes in each block is
//! measured (structure tensor). For a block with a clear direction, two searches look for blocks elsewhere: one
//! compares the light alone, the other one light and normals. Strokes follow the shapes if two conditions hold:
//!
//! - The blocks found by light and normals have directions similar to the block's own direction, compared with all
//!   blocks of other normals. This does not hold for strokes of one direction, and for media without strokes.
//! - The blocks found by light and normals have directions at least as similar to the block's own direction as the
//!   blocks found by light alone. This does not hold if strokes follow the light.
//!
//! A block counts only if the search by light alone finds blocks of other normals; for any other block, the normals
//! change nothing. A comparison of the two searches would not suffice without the first condition: on the single ball
//! of an exemplar, light and normals determine each other, but on the shapes of the target they do not.

use super::guides::{Guide, MAX_CHANNELS, Range, SIMILAR};
use super::params::Input;
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::image::colour::{linear_to_srgb, luminance};
use crate::job::Job;
use crate::maths;
use glam::Vec3;
use std::f32::consts::PI;

/// `BLOCKS`: number of blocks along the longer side of the exemplar. `CELLS`: minimum number of cells along the side of
/// a block. A cell is at least one pixel wide. Directions are measured on the means of cells, because the texture of
/// paper is finer than strokes.
const BLOCKS: usize = 48;
const CELLS: usize = 8;
/// Number of points along the side of a block at which the guides are read.
const POINTS: usize = 4;
/// Number of pixels from which the range of a guide is determined.
const SAMPLES: usize = 4096;
/// `MAX_BLOCKS`: maximum number of blocks among which a search looks. `MAX_SEARCHES`: maximum number of blocks for
/// which searches run. If there are more blocks, only every n-th block is used, with the smallest n that suffices.
const MAX_BLOCKS: usize = 1024;
const MAX_SEARCHES: usize = 256;
/// A block is left out if its light deviates from the block's mean by more than this, as a weighted root mean square of
/// channels in `[0, 1]`: its direction may come from the edge of a shadow. For the normals, the limit is [`SIMILAR`].
/// [bench stylit:directions]
const MAX_DEVIATION: f32 = 0.05;
/// Minimum coherence of a block with a clear direction. The coherence is (λ₁ - λ₂) / (λ₁ + λ₂), where λ₁ ≥ λ₂ are the
/// eigenvalues of the structure tensor. [bench stylit:directions]
const MIN_COHERENCE: f32 = 0.35;
/// Minimum root mean square of the gradient, as change per cell of values encoded for display (white = 1). Rounding to
/// 8 bits causes smaller gradients. [convention]
const MIN_GRADIENT: f32 = 0.01;
/// A block counts as elsewhere if it is more than this number of columns or rows of blocks away: a stroke may run
/// through nearer blocks.
const NEAR: usize = 1;
/// Number of blocks that a search finds.
const FOUND: usize = 4;
/// Strokes follow the shapes only if at least this number of blocks count ([`Directions::count`]).
const MIN_COUNT: usize = 16;
/// Strokes follow the shapes only if [`Directions::by_normals`] is at most this share of [`Directions::spread`].
/// [bench stylit:directions]
const MAX_RATIO: f64 = 0.52;
/// Weight of the normals where strokes follow the shapes, if each guide of light has the weight 1.
/// \[bench stylit:directions\]
pub const NORMALS_WEIGHT: f32 = 1.0;

/// The directions of the exemplar's strokes, as mean angles in degrees over the blocks that count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Directions {
    /// Mean angle between the strokes of a block and the strokes of all blocks elsewhere with other normals.
    pub spread: f64,
    /// Mean angle between the strokes of a block and the strokes of the blocks that are found by the light alone.
    pub by_light: f64,
    /// Mean angle between the strokes of a block and the strokes of the blocks that are found by light and normals.
    pub by_normals: f64,
    /// Number of blocks that count.
    pub count: usize,
}

impl Directions {
    /// Whether the strokes follow the shapes.
    pub fn follow_shapes(&self) -> bool {
        let predict = self.by_normals <= MAX_RATIO * self.spread && self.by_normals <= self.by_light;
        self.count >= MIN_COUNT && predict
    }
}

/// Returns the guides of a run, and the weight of the normals. The normals are added to the given guides if the strokes
/// of the exemplar follow the shapes. The weight is 0 if they do not, if no normals are given, or if there would be
/// more than [`MAX_CHANNELS`] channels. A later frame of a sequence takes the weight of the previous frame.
pub(super) fn with_normals<'a>(
    input: &Input<'a>,
    source_mask: Option<&[bool]>,
    job: Job,
) -> Result<(Vec<Guide<'a>>, f32)> {
    let mut guides = input.guides.to_vec();
    let channels: usize = guides.iter().map(|g| g.source.channels).sum();
    let has_room = |normals: &Guide| channels + normals.source.channels <= MAX_CHANNELS;
    let (Some(first), Some(normals)) = (input.guides.first(), input.normals.filter(has_room)) else {
        return Ok((guides, 0.0));
    };
    guides.iter().chain([&normals]).try_for_each(|guide| guide.check(first))?;
    let weight = match input.guide_record.filter(|guide_record| guide_record.is_of_frame()) {
        Some(guide_record) => guide_record.normals_weight,
        None if directions(input, &normals, source_mask, job)?.follow_shapes() => normals.weight,
        None => 0.0,
    };
    if weight > 0.0 {
        guides.push(Guide { weight, ..normals });
    }
    Ok((guides, weight))
}

/// Measures the directions of the exemplar's strokes, and how well light and normals predict them. The artwork and the
/// sources of all guides must have one size. `source_mask` says which pixels may be used; all if `None`.
pub fn directions(input: &Input, normals: &Guide, source_mask: Option<&[bool]>, job: Job) -> Result<Directions> {
    let artwork = input.artwork;
    let longer = artwork.width.max(artwork.height).div_ceil(BLOCKS);
    let cell = (longer / CELLS).max(1);
    let side = (longer / cell).max(CELLS) * cell;
    if artwork.width.min(artwork.height) < side {
        return Ok(Directions::default());
    }
    let total: f32 = input.guides.iter().map(|g| g.weight).sum();
    let guides = input.guides.iter().filter(|g| g.weight > 0.0);
    let lights: Vec<Scale> = guides.map(|g| Scale::of(g, g.weight / total)).collect();
    let normals = Scale::of(normals, normals.weight / total);
    let (columns, means) = (artwork.width / side, cells(artwork, cell, job)?);
    let blocks = exec::map(columns * (artwork.height / side), job, |b| {
        let at = [b % columns, b / columns];
        let is_allowed = source_mask.is_none_or(|mask| is_inside(mask, artwork.width, at, side));
        let angle = is_allowed.then(|| angle(&means, at.map(|v| v * side / cell), side / cell)).flatten()?;
        block(&lights, &normals, at, side, angle)
    })?;
    let blocks: Vec<Block> = every(blocks.into_iter().flatten().collect(), MAX_BLOCKS);
    let chosen = every((0..blocks.len()).collect(), MAX_SEARCHES);
    let compared = exec::map(chosen.len(), job, |i| compare(&blocks, &blocks[chosen[i]], normals.share))?;
    let angles: Vec<[f64; 3]> = compared.into_iter().flatten().collect();
    let mean = |k: usize| angles.iter().map(|a| a[k]).sum::<f64>() / angles.len().max(1) as f64;
    Ok(Directions { spread: mean(0), by_light: mean(1), by_normals: mean(2), count: angles.len() })
}

/// Shortens a list of more than `limit` items: keeps every n-th item, with the smallest n that suffices.
fn every<T>(list: Vec<T>, limit: usize) -> Vec<T> {
    let step = list.len().div_ceil(limit).max(1);
    list.into_iter().step_by(step).collect()
}

/// Whether a mask contains all pixels of a block.
fn is_inside(mask: &[bool], width: usize, [column, row]: [usize; 2], side: usize) -> bool {
    let mut starts = (row * side..(row + 1) * side).map(|y| y * width + column * side);
    starts.all(|start| !mask[start..][..side].contains(&false))
}

/// A guide, with the offset and the factor that map its values to `[0, 1]` for comparisons. Both are determined from a
/// sample of the guide's pixels.
struct Scale<'a> {
    guide: &'a Guide<'a>,
    offset: f32,
    factor: f32,
    /// Weight of the guide divided by the total weight of all guides of light.
    share: f32,
}

impl<'a> Scale<'a> {
    fn of(guide: &'a Guide<'a>, share: f32) -> Self {
        let data = &guide.source.data;
        // Use an odd step: if the numbers of channels and columns are powers of two, it visits all of them.
        let step = (data.len() / SAMPLES) | 1;
        let mut values: Vec<f32> = data.iter().step_by(step).copied().filter(|v| v.is_finite()).collect();
        values.sort_unstable_by(f32::total_cmp);
        let at = |rank: usize| values.get(rank).copied().unwrap_or(0.0);
        let last = values.len().saturating_sub(1);
        let (offset, range) = match guide.range {
            Range::Light => (0.0, at(last * 999 / 1000).max(1.0)),
            Range::Data => (at(0), at(last) - at(0)),
        };
        Self { guide, offset, factor: if range > 0.0 { 1.0 / range } else { 0.0 }, share }
    }

    fn value(&self, [x, y]: [usize; 2], channel: usize) -> f32 {
        let v = ((self.guide.source.pixel(x, y)[channel] - self.offset) * self.factor).clamp(0.0, 1.0);
        if self.guide.range == Range::Light { linear_to_srgb(v) } else { v }
    }

    /// Appends to `means` the mean of each channel over `places`, times the square root of the channel's weight.
    /// Returns the variance over `places`, weighted and summed over the channels. `weight` is the weight of all
    /// channels together.
    fn means(&self, places: &[[usize; 2]], weight: f32, means: &mut Vec<f32>) -> f32 {
        let (channels, count) = (self.guide.source.channels, places.len() as f32);
        let weight = weight / channels as f32;
        let mut variance = 0.0;
        for channel in 0..channels {
            let values = places.iter().map(|place| self.value(*place, channel));
            let (sum, squares) = values.fold((0.0, 0.0), |(sum, squares), v| (sum + v, squares + v * v));
            let mean = sum / count;
            means.push(weight.sqrt() * mean);
            variance += weight * (squares / count - mean * mean);
        }
        variance
    }
}

/// A block with a clear direction of its strokes.
struct Block {
    /// Column and row.
    at: [usize; 2],
    /// Direction across the strokes, in radians modulo π.
    angle: f32,
    /// Means of the guides of light and of the normals over the block; each channel is multiplied by the square root of
    /// its weight. The weights of all channels of light sum to 1, and so do the weights of the channels of the normals.
    light: Vec<f32>,
    normals: Vec<f32>,
}

/// Measures the guides of a block; `None` unless the guides are nearly constant within the block.
fn block(lights: &[Scale], normals: &Scale, at: [usize; 2], side: usize, angle: f32) -> Option<Block> {
    let place = |k: usize, first: usize| first * side + (2 * k + 1) * side / (2 * POINTS);
    let places: Vec<[usize; 2]> =
        (0..POINTS * POINTS).map(|i| [place(i % POINTS, at[0]), place(i / POINTS, at[1])]).collect();
    let mut block = Block { at, angle, light: Vec::new(), normals: Vec::new() };
    let deviation: f32 = lights.iter().map(|light| light.means(&places, light.share, &mut block.light)).sum();
    let bend = normals.means(&places, 1.0, &mut block.normals);
    (deviation <= MAX_DEVIATION * MAX_DEVIATION && bend <= SIMILAR * SIMILAR).then_some(block)
}

/// Returns the mean luminance of each cell, encoded for display.
fn cells(artwork: &Image, cell: usize, job: Job) -> Result<Image> {
    let mut means = Image::new(artwork.width / cell, artwork.height / cell, 1)?;
    let (columns, channels) = (means.width, artwork.channels);
    exec::for_rows(&mut means.data, columns, job, |y, row| {
        for line in y * cell..(y + 1) * cell {
            for (mean, pixels) in row.iter_mut().zip(artwork.row(line).chunks_exact(cell * channels)) {
                *mean += pixels.chunks_exact(channels).map(grey).sum::<f32>();
            }
        }
        row.iter_mut().for_each(|v| *v = linear_to_srgb((*v / (cell * cell) as f32).clamp(0.0, 1.0)));
    })?;
    Ok(means)
}

/// Returns the direction across the strokes of a square of `side × side` cells with its corner at `first`, in radians
/// modulo π; `None` if the strokes have no clear direction.
fn angle(cells: &Image, first: [usize; 2], side: usize) -> Option<f32> {
    let at = |x: usize, y: usize| cells.data[y.min(cells.height - 1) * cells.width + x.min(cells.width - 1)];
    // Compute the covariance of the gradient about its mean: the mean gradient comes from shading, not from strokes.
    let [mut x, mut y, mut xx, mut xy, mut yy] = [0.0f32; 5];
    for (x0, y0) in (first[1]..first[1] + side).flat_map(|y| (first[0]..first[0] + side).map(move |x| (x, y))) {
        let dx = 0.5 * (at(x0 + 1, y0) - at(x0.saturating_sub(1), y0));
        let dy = 0.5 * (at(x0, y0 + 1) - at(x0, y0.saturating_sub(1)));
        (x, y, xx, xy, yy) = (x + dx, y + dy, xx + dx * dx, xy + dx * dy, yy + dy * dy);
    }
    let n = (side * side) as f32;
    let (xx, xy, yy) = (xx / n - x * x / (n * n), xy / n - x * y / (n * n), yy / n - y * y / (n * n));
    let coherence = maths::hypot(xx - yy, 2.0 * xy) / (xx + yy);
    let is_clear = coherence >= MIN_COHERENCE && xx + yy >= MIN_GRADIENT * MIN_GRADIENT;
    is_clear.then(|| 0.5 * maths::atan2(2.0 * xy, xx - yy))
}

fn grey(pixel: &[f32]) -> f32 {
    if pixel.len() < 3 { pixel[0] } else { luminance(Vec3::from_slice(pixel)) }
}

/// Returns three mean angles, in degrees, between a block and other blocks: all blocks elsewhere with other normals,
/// the blocks that are found by the light alone, and the blocks that are found by light and normals. `weight` is the
/// weight of the normals. `None` if the blocks found by the light alone have similar normals, or if there are too few
/// blocks.
fn compare(blocks: &[Block], own: &Block, weight: f32) -> Option<[f64; 3]> {
    let (mut by_light, mut by_normals) = (NearestBlocks::new(), NearestBlocks::new());
    let (mut sum, mut count) = (0.0, 0.0);
    for other in blocks.iter().filter(|b| (0..2).any(|k| b.at[k].abs_diff(own.at[k]) > NEAR)) {
        let (light, normals) = (squares(&own.light, &other.light), squares(&own.normals, &other.normals));
        let turn = (own.angle - other.angle).rem_euclid(PI);
        let turn = turn.min(PI - turn);
        if normals > SIMILAR * SIMILAR {
            (sum, count) = (sum + turn, count + 1.0);
        }
        by_light.add(light, [turn, normals.sqrt()]);
        by_normals.add(light + weight * normals, [turn, normals.sqrt()]);
    }
    let ([light_turn, other_normals], [turn, _]) = (by_light.mean()?, by_normals.mean()?);
    (other_normals > SIMILAR).then(|| [sum / count, light_turn, turn].map(|t| f64::from(t).to_degrees()))
}

/// The [`FOUND`] nearest blocks so far, in order of distance: for each block its distance, the angle between the
/// strokes, and the difference of the normals.
struct NearestBlocks([(f32, [f32; 2]); FOUND]);

impl NearestBlocks {
    fn new() -> Self {
        Self([(f32::INFINITY, [0.0; 2]); FOUND])
    }

    fn add(&mut self, distance: f32, values: [f32; 2]) {
        let place = self.0.partition_point(|(d, _)| *d <= distance);
        if place < FOUND {
            self.0[place..].rotate_right(1);
            self.0[place] = (distance, values);
        }
    }

    /// Returns the mean angle between the strokes and the mean difference of the normals; `None` if fewer than
    /// [`FOUND`] blocks were added.
    fn mean(&self) -> Option<[f32; 2]> {
        let mean = |k: usize| self.0.iter().map(|(_, values)| values[k]).sum::<f32>() / FOUND as f32;
        self.0[FOUND - 1].0.is_finite().then(|| [mean(0), mean(1)])
    }
}

fn squares(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}
