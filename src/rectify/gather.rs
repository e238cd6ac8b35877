//! Weighted sums of the samples about the pixels of a run.
//!
//! Four samples side by side of three channels are three vectors, of one channel one. The columns of all pixels are
//! summed before any are added up: by then they lie in memory, where the vectors can be cut anew.

use super::footprint::RUN;
use super::taps::{TAPS, Taps};
use crate::image::Image;
use glam::{Vec4, Vec4Swizzles};

/// Vectors to a pixel.
const PARTS: usize = 3;

/// One more than there are, because the last pixel's last column is read with what follows.
const LENGTH: usize = PARTS * RUN + 1;

/// Weighted sums of each column of samples of each pixel, and the range of the samples, for each channel.
pub struct Sums {
    sum: [Vec4; LENGTH],
    low: [Vec4; LENGTH],
    high: [Vec4; LENGTH],
}

impl Sums {
    pub const EMPTY: Self = Self { sum: [Vec4::ZERO; LENGTH], low: [Vec4::ZERO; LENGTH], high: [Vec4::ZERO; LENGTH] };
}

/// Four samples at once.
#[inline(always)]
fn four(samples: &[f32]) -> Vec4 {
    bytemuck::pod_read_unaligned(bytemuck::cast_slice(&samples[..4]))
}

/// The weights of four columns for vector `k` of the samples of `N` channels.
#[inline(always)]
fn spread<const N: usize>(weights: Vec4, k: usize) -> Vec4 {
    match (N, k) {
        (1, _) => weights,
        (_, 0) => weights.xxxy(),
        (_, 1) => weights.yyzz(),
        _ => weights.zwww(),
    }
}

/// Images of one channel or of three.
#[inline(always)]
fn gather<const N: usize>(
    source: &Image,
    taps: &Taps,
    is_sharp: bool,
    is_sheared: bool,
    is_seen: &[bool; RUN],
    is_first: bool,
    to: &mut Sums,
) {
    for i in 0..RUN {
        if !taps.is_inside[i] {
            if is_seen[i] {
                one_by_one(source, 0..N, taps, i, is_first, to);
            }
            continue;
        }
        let (mut sum, mut low, mut high) = ([Vec4::ZERO; N], [Vec4::INFINITY; N], [Vec4::NEG_INFINITY; N]);
        let line = taps.line[i] as usize;
        for j in 0..TAPS {
            let column = taps.column[if is_sheared { j } else { 0 }][i] as usize;
            let samples = &source.data[N * ((line + j) * source.width + column)..][..N * TAPS];
            let down = taps.down[i][j];
            let weights = if is_sheared { four(&taps.across[j][i]) * down } else { Vec4::splat(down) };
            for k in 0..N {
                let values = four(&samples[4 * k..4 * k + 4]);
                sum[k] += values * if is_sheared { spread::<N>(weights, k) } else { weights };
                if is_sharp {
                    (low[k], high[k]) = (low[k].min(values), high[k].max(values));
                }
            }
        }
        let across = four(&taps.across[0][i]);
        for k in 0..N {
            let at = PARTS * i + k;
            let sum = if is_sheared { sum[k] } else { sum[k] * spread::<N>(across, k) };
            to.sum[at] = if is_first { sum } else { to.sum[at] + sum };
            if is_sharp {
                (to.low[at], to.high[at]) = (low[k], high[k]);
            }
        }
    }
}

/// Any channels of pixel `i`, the border of the image extended.
#[cold]
#[inline(never)]
fn one_by_one(source: &Image, channels: std::ops::Range<usize>, taps: &Taps, i: usize, is_first: bool, to: &mut Sums) {
    let count = channels.len();
    let Sums { sum, low, high } = to;
    let [sum, low, high] = [sum, low, high].map(|v| &mut bytemuck::cast_slice_mut::<Vec4, f32>(v)[4 * PARTS * i..]);
    let clamp = |at: i32, side: usize| at.clamp(0, side as i32 - 1) as usize;
    for k in 0..TAPS {
        for (c, channel) in channels.clone().enumerate() {
            let (mut column, mut least, mut most) = (0.0, f32::INFINITY, f32::NEG_INFINITY);
            for j in 0..TAPS {
                let row = if taps.is_sheared { j } else { 0 };
                let x = clamp(taps.column[row][i] + k as i32, source.width);
                let value = source.row(clamp(taps.line[i] + j as i32, source.height))[x * source.channels + channel];
                (least, most) = (least.min(value), most.max(value));
                column += value * (taps.across[row][i][k] * taps.down[i][j]);
            }
            let at = count * k + c;
            sum[at] = if is_first { column } else { sum[at] + column };
            (low[at], high[at]) = (least, most);
        }
    }
}

/// Adds the samples of all channels of an image of one or three, else of one of them; the first sum takes the place of
/// what was there.
#[inline(always)]
pub fn sum(source: &Image, channel: usize, taps: &Taps, is_seen: &[bool; RUN], is_first: bool, to: &mut Sums) {
    match (source.channels, taps.is_sharp, taps.is_sheared) {
        (1, sharp, sheared) => gather::<1>(source, taps, sharp, sheared, is_seen, is_first, to),
        (3, true, true) => gather::<3>(source, taps, true, true, is_seen, is_first, to),
        (3, true, false) => gather::<3>(source, taps, true, false, is_seen, is_first, to),
        (3, false, true) => gather::<3>(source, taps, false, true, is_seen, is_first, to),
        (3, false, false) => gather::<3>(source, taps, false, false, is_seen, is_first, to),
        _ => {
            for i in (0..RUN).filter(|&i| is_seen[i]) {
                one_by_one(source, channel..channel + 1, taps, i, is_first, to);
            }
        }
    }
}

/// The four columns of a pixel, for each of three channels.
#[inline(always)]
fn columns(of: &[Vec4; LENGTH], i: usize) -> [Vec4; TAPS] {
    let flat: &[f32] = &bytemuck::cast_slice(of)[4 * PARTS * i..][..4 * PARTS + 1];
    [four(flat), four(&flat[3..]), four(&flat[6..]), four(&flat[9..])]
}

/// `value` within the range of the samples, so that a lamp throws no ring of negative light; NaN stays.
#[inline(always)]
fn within(value: Vec4, low: Vec4, high: Vec4) -> Vec4 {
    let raised = Vec4::select(value.cmplt(low), low, value);
    Vec4::select(raised.cmpgt(high), high, raised)
}

/// Writes the means of `parts` sums to the pixels that are seen: three channels, or one of any number.
#[inline(always)]
pub fn store(
    sums: &Sums,
    parts: usize,
    is_sharp: bool,
    is_seen: &[bool; RUN],
    channels: usize,
    channel: usize,
    out: &mut [f32],
) {
    let share = 1.0 / parts as f32;
    if channels == 3 {
        for (i, pixel) in out.chunks_exact_mut(3).enumerate().filter(|(i, _)| is_seen[*i]) {
            let [a, b, c, d] = columns(&sums.sum, i);
            let mut value = ((a + b) + (c + d)) * share;
            if is_sharp {
                let [a, b, c, d] = columns(&sums.low, i);
                let low = a.min(b).min(c.min(d));
                let [a, b, c, d] = columns(&sums.high, i);
                value = within(value, low, a.max(b).max(c.max(d)));
            }
            (pixel[0], pixel[1], pixel[2]) = (value.x, value.y, value.z);
        }
    } else {
        for (i, pixel) in out.chunks_exact_mut(channels).enumerate().filter(|(i, _)| is_seen[*i]) {
            let [a, b, c, d] = sums.sum[PARTS * i].to_array();
            let value = ((a + b) + (c + d)) * share;
            let (low, high) = (sums.low[PARTS * i].min_element(), sums.high[PARTS * i].max_element());
            pixel[channel] = if is_sharp && value < low {
                low
            } else if is_sharp && value > high {
                high
            } else {
                value
            };
        }
    }
}
