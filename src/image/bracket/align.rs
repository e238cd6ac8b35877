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

/// Minimum length, in pixels, of the shorter side of the coarsest bitmaps.
const MIN_SIDE: usize = 16;

/// Pixels whose value differs from the threshold by at most this are left out, because noise may move them across the
/// threshold. [paper §2.1: 4 of 255 codes]
const MARGIN: f32 = 4.0 / 255.0;

/// A shift is accepted if it reduces the number of differing pixels by more than this many standard deviations of that
/// number. [convention]
const SIGNIFICANT: f64 = 3.0;

/// Minimum share of the pixels with values between the black pixels and the threshold, and minimum share with values
/// between the threshold and the clipped pixels. [convention]
const CLEARANCE: f64 = 0.02;

/// Range of the usable encoded values, which are the square roots of the light. Values below the first number count as
/// black, values from the second number on as clipped. [convention]
const USABLE: [f32; 2] = [0.02, 0.97];

/// Number of best shifts that each level passes to the next finer level, because coarse levels may mislead. (The paper
/// passes only one.)
const KEPT: usize = 5;

/// Number of bins for finding quantiles of the encoded values, which lie in `[0, 1]`.
const BINS: usize = 1024;

/// Finds the shift of each photo, in pixels, relative to the first photo in `order`. `order` lists the photos by
/// exposure. `max_shift` is the largest shift between two photos that are neighbours in `order`, in pixels; if it is 0,
/// all shifts are 0.
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

/// Returns the encoded light of a photo at full size, then at 1/2, 1/4, … of this size: up to `levels` reduced copies.
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

/// Finds the shift from one photo to another, from the coarsest level to the finest. The shift is 0 if the photos have
/// no common threshold ([`common_quantile`]), or if no shift is significantly better than 0.
fn shift_between(from: &[Image], to: &[Image], max_shift: isize, job: Job) -> Result<[isize; 2]> {
    let Some(quantile) = common_quantile(&from[0], &to[0]) else { return Ok([0; 2]) };
    let mut kept = vec![[0isize; 2]];
    for (from, to) in from.iter().zip(to).skip(1).rev() {
        let bitmaps = [Bitmap::new(from, quantile)?, Bitmap::new(to, quantile)?];
        let found = ranked(&bitmaps, &doubled(&kept), max_shift, job)?;
        kept = found.iter().take(KEPT).map(|(shift, _)| *shift).collect();
    }
    // At full size, move to the best neighbouring shift as long as this lowers the share of differing pixels.
    let bitmaps = [Bitmap::new(&from[0], quantile)?, Bitmap::new(&to[0], quantile)?];
    let mut best = ranked(&bitmaps, &doubled(&kept), max_shift, job)?[0];
    loop {
        let next = ranked(&bitmaps, &[best.0], max_shift, job)?[0];
        if part(next.1) >= part(best.1) {
            break;
        }
        best = next;
    }
    // Accept the best shift only if it is better than no shift by more than chance.
    let unmoved = difference(&bitmaps, [0; 2]);
    let chance = SIGNIFICANT * (unmoved[0] as f64).sqrt() / unmoved[1].max(1) as f64;
    Ok(if part(best.1) < part(unmoved) - chance { best.0 } else { [0; 2] })
}

/// A shift, with two numbers of pixels: pixels that differ under this shift, and pixels that were compared.
type Counted = ([isize; 2], [usize; 2]);

/// Counts the differing pixels for no shift, for the shifts `around`, and for the eight neighbours of each of them.
/// Returns the shifts in ascending order of the share of differing pixels; of equal shares, the smallest shift comes
/// first. Leaves out shifts that compare less than half as many pixels as no shift does.
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

/// Returns the share of the compared pixels that differ.
fn part([differing, compared]: [usize; 2]) -> f64 {
    differing as f64 / compared.max(1) as f64
}

/// Steps from a shift to itself and to its eight neighbours, in pixels.
const STEPS: [[isize; 2]; 9] = [[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, 1], [1, -1], [-1, -1]];

/// Returns the quantile that serves as the threshold in both photos: the median or, if its value is black or clipped in
/// a photo, the nearest quantile whose value is neither. `None` if there is no such quantile.
fn common_quantile(a: &Image, b: &Image) -> Option<f64> {
    let share = |image: &Image, is_in: &dyn Fn(f32) -> bool| {
        image.data.iter().filter(|&&v| is_in(v)).count() as f64 / image.data.len() as f64
    };
    let black = [a, b].map(|image| share(image, &|v| v < USABLE[0])).into_iter().fold(0.0, f64::max);
    let clipped = [a, b].map(|image| share(image, &|v| v >= USABLE[1])).into_iter().fold(0.0, f64::max);
    let (low, high) = (black + CLEARANCE, 1.0 - clipped - CLEARANCE);
    (low < high).then(|| 0.5f64.clamp(low, high))
}

/// For each pixel, whether it is brighter than a threshold (a quantile of the photo's values), and whether it differs
/// enough from the threshold to be compared.
struct Bitmap {
    width: usize,
    height: usize,
    /// 1 if the pixel is brighter than the threshold, otherwise 0.
    above: Vec<u8>,
    /// 1 if the pixel is compared, otherwise 0.
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

/// Returns the value below which the share `quantile` of the pixels lies, accurate to half a bin.
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

/// Compares pixel `p` of the first bitmap with pixel `p + shift` of the second. Returns the number of pixels that
/// differ, and the number of pixels that were compared.
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
