//! Aligns the photos of a bracket by whole pixels: median threshold bitmaps (Ward, Fast, robust image registration for
//! compositing high dynamic range photographs from handheld exposures, 2003).
//!
//! A bitmap states which pixels are brighter than the median. It hardly depends on the exposure, because a longer
//! exposure brightens the median too. The shift is that for which two bitmaps differ least, found from coarse to fine.
//!
//! Not modelled: rotation, parallax, and fractions of a pixel.

use super::frame::{Frame, light};
use crate::error::Result;
use crate::exec;
use crate::image::{Image, pyramid, try_collect};
use crate::job::Job;

/// Shorter side of the coarsest bitmaps, in pixels, at least.
const MIN_SIDE: usize = 16;

/// Pixels this close to the threshold are left out, because noise may move them across it. [paper §2.1: 4 of 255 codes]
const MARGIN: f32 = 4.0 / 255.0;

/// A shift must reduce the number of differing pixels by this many standard deviations of the number. [convention]
const SIGNIFICANT: f64 = 3.0;

/// Share of the pixels that must lie between the threshold and the clipped or black pixels, at least. [convention]
const CLEARANCE: f64 = 0.02;

/// Encoded values below the first count as black, values from the second on as clipped. The encoding is a square root.
/// [convention]
const USABLE: [f32; 2] = [0.02, 0.97];

/// Number of shifts that each level hands to the next finer one, because coarse levels may mislead. (The paper hands on
/// one.)
const KEPT: usize = 5;

/// Number of bins for finding quantiles of the encoded values, which lie in `[0, 1]`.
const BINS: usize = 1024;

/// Finds the shift of each photo relative to the first in `order`, which is the order of exposure; `max_shift` is the
/// largest shift between neighbours in pixels.
pub fn shifts(frames: &[Frame], order: &[usize], max_shift: usize, job: Job) -> Result<Vec<[isize; 2]>> {
    let mut found = vec![[0; 2]; frames.len()];
    if max_shift == 0 || order.len() < 2 {
        return Ok(found);
    }
    let image = frames[0].image;
    let by_side = (image.width.min(image.height) / MIN_SIDE).max(1).ilog2();
    let levels = max_shift.next_power_of_two().ilog2().min(by_side) as usize;
    let step = 1.0 / order.len() as f64;
    let mut before = pyramid_of(image_of(frames, order[0]), levels, job.part(0.0, step))?;
    for (k, pair) in order.windows(2).enumerate() {
        let job = job.part((k + 1) as f64 * step, ((k + 2) as f64 * step).min(1.0));
        let after = pyramid_of(image_of(frames, pair[1]), levels, job)?;
        let shift = shift_between(&before, &after, max_shift as isize, job)?;
        found[pair[1]] = [0, 1].map(|axis| found[pair[0]][axis] + shift[axis]);
        before = after;
    }
    Ok(found)
}

fn image_of<'a>(frames: &[Frame<'a>], index: usize) -> &'a Image {
    frames[index].image
}

/// The encoded light of a photo, at its own size and halved `levels` times.
fn pyramid_of(image: &Image, levels: usize, job: Job) -> Result<Vec<Image>> {
    let mut encoded = Image::new(image.width, image.height, 1)?;
    exec::for_rows(&mut encoded.data, image.width, job.part(0.0, 0.5), |y, row| {
        for (out, pixel) in row.iter_mut().zip(image.row(y).chunks_exact(image.channels)) {
            *out = light(pixel).clamp(0.0, 1.0).sqrt();
        }
    })?;
    let mut all = pyramid::halvings(&encoded, levels, job.part(0.5, 1.0))?;
    all.insert(0, encoded);
    Ok(all)
}

/// Finds the shift from one photo to another, from the coarsest level to the finest.
fn shift_between(from: &[Image], to: &[Image], max_shift: isize, job: Job) -> Result<[isize; 2]> {
    let Some(quantile) = common_quantile(&from[0], &to[0]) else { return Ok([0; 2]) };
    let mut kept = vec![[0isize; 2]];
    for (from, to) in from.iter().zip(to).skip(1).rev() {
        let bitmaps = [Bitmap::new(from, quantile)?, Bitmap::new(to, quantile)?];
        let found = ranked(&bitmaps, &doubled(&kept), max_shift, job)?;
        kept = found.iter().take(KEPT).map(|(shift, _)| *shift).collect();
    }
    // At full size, go on to the best neighbour as long as it is better.
    let bitmaps = [Bitmap::new(&from[0], quantile)?, Bitmap::new(&to[0], quantile)?];
    let mut best = ranked(&bitmaps, &doubled(&kept), max_shift, job)?[0];
    loop {
        let next = ranked(&bitmaps, &[best.0], max_shift, job)?[0];
        if part(next.1) >= part(best.1) {
            break;
        }
        best = next;
    }
    // The shift must be better than no shift by more than chance.
    let unmoved = difference(&bitmaps, [0; 2]);
    let chance = SIGNIFICANT * (unmoved[0] as f64).sqrt() / unmoved[1].max(1) as f64;
    Ok(if part(best.1) < part(unmoved) - chance { best.0 } else { [0; 2] })
}

/// A shift, and the numbers of pixels that differ and that were compared.
type Counted = ([isize; 2], [usize; 2]);

/// Tries no shift, and the shifts `around` with their neighbours; the best first, and of equal ones the smallest.
fn ranked(bitmaps: &[Bitmap; 2], around: &[[isize; 2]], max_shift: isize, job: Job) -> Result<Vec<Counted>> {
    let all = around.iter().flat_map(|shift| STEPS.map(|step| [shift[0] + step[0], shift[1] + step[1]]));
    let mut shifts: Vec<[isize; 2]> = all.filter(|shift| shift.iter().all(|s| s.abs() <= max_shift)).collect();
    shifts.push([0; 2]);
    shifts.sort_by_key(|shift| (shift[0] * shift[0] + shift[1] * shift[1], *shift));
    shifts.dedup();
    let counts = exec::map(shifts.len(), job, |k| difference(bitmaps, shifts[k]))?;
    let compared = counts[0][1];
    let mut found: Vec<Counted> =
        shifts.into_iter().zip(counts).filter(|(_, count)| 2 * count[1] >= compared).collect();
    found.sort_by(|a, b| part(a.1).total_cmp(&part(b.1)));
    Ok(found)
}

fn doubled(shifts: &[[isize; 2]]) -> Vec<[isize; 2]> {
    shifts.iter().map(|shift| shift.map(|s| 2 * s)).collect()
}

/// The part of the compared pixels that differ.
fn part([differing, compared]: [usize; 2]) -> f64 {
    differing as f64 / compared.max(1) as f64
}

/// A shift and its eight neighbours.
const STEPS: [[isize; 2]; 9] = [[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, 1], [1, -1], [-1, -1]];

/// The quantile whose value is neither black nor clipped in two photos: the median if possible. `None` if there is no
/// such quantile.
fn common_quantile(a: &Image, b: &Image) -> Option<f64> {
    let share = |image: &Image, is_in: &dyn Fn(f32) -> bool| {
        image.data.iter().filter(|&&v| is_in(v)).count() as f64 / image.data.len() as f64
    };
    let black = [a, b].map(|image| share(image, &|v| v < USABLE[0])).into_iter().fold(0.0, f64::max);
    let clipped = [a, b].map(|image| share(image, &|v| v >= USABLE[1])).into_iter().fold(0.0, f64::max);
    let (low, high) = (black + CLEARANCE, 1.0 - clipped - CLEARANCE);
    (low < high).then(|| 0.5f64.clamp(low, high))
}

/// Which pixels are brighter than a quantile, and which are far enough from it to count.
struct Bitmap {
    width: usize,
    height: usize,
    /// 1 if the pixel is brighter, otherwise 0.
    above: Vec<u8>,
    /// 1 if the pixel counts, otherwise 0.
    counts: Vec<u8>,
}

impl Bitmap {
    fn new(image: &Image, quantile: f64) -> Result<Self> {
        let threshold = value_at(image, quantile);
        let above = try_collect(image.data.iter().map(|&v| u8::from(v > threshold)))?;
        let counts = try_collect(image.data.iter().map(|&v| u8::from((v - threshold).abs() > MARGIN)))?;
        Ok(Self { width: image.width, height: image.height, above, counts })
    }
}

/// The value below which the part `quantile` of the pixels lies.
fn value_at(image: &Image, quantile: f64) -> f32 {
    let mut bins = [0usize; BINS];
    image.data.iter().for_each(|&v| bins[((v * BINS as f32) as usize).min(BINS - 1)] += 1);
    let wanted = quantile * image.data.len() as f64;
    let mut below = 0;
    let bin = bins.iter().position(|&count| {
        below += count;
        below as f64 >= wanted
    });
    (bin.unwrap_or(BINS - 1) as f32 + 0.5) / BINS as f32
}

/// The number of pixels at which two bitmaps differ, and the number of pixels compared, if pixel `p` of the first shows
/// the same as pixel `p + shift` of the second.
fn difference([a, b]: &[Bitmap; 2], shift: [isize; 2]) -> [usize; 2] {
    let range = |size: usize, shift: isize| {
        let low = (-shift).max(0) as usize;
        low..(size as isize - shift.max(0)).max(low as isize) as usize
    };
    let (columns, rows) = (range(a.width, shift[0]), range(a.height, shift[1]));
    let (mut differing, mut compared) = (0, 0);
    for y in rows {
        let first = y * a.width;
        let other = (y as isize + shift[1]) as usize * b.width;
        let shifted = (columns.start as isize + shift[0]) as usize;
        let of_a = first + columns.start..first + columns.end;
        let of_b = other + shifted..other + shifted + columns.len();
        let bits = a.above[of_a.clone()].iter().zip(&b.above[of_b.clone()]);
        let counting = a.counts[of_a].iter().zip(&b.counts[of_b]);
        let mut row = [0u32; 2];
        for ((p, q), (r, s)) in bits.zip(counting) {
            row[0] += u32::from((p ^ q) & r & s);
            row[1] += u32::from(r & s);
        }
        differing += row[0] as usize;
        compared += row[1] as usize;
    }
    [differing, compared]
}
