//! Sums the weighted source samples (taps) of a run of pixels, the last step of resampling.

use super::footprint::RUN;
use super::lanes::{GreyLanes, PixelLanes, RgbLanes, TAPS};
use super::taps::Taps;
use crate::image::Image;
use crate::simd::Level;
use glam::Vec4;

/// The sum of the weighted taps of each pixel of a run, with up to three channels. The remaining lanes are undefined.
pub type TapSums = [Vec4; RUN];

/// Adds the weighted taps of each pixel to the sums. If the image has one or three channels, sums all channels;
/// otherwise sums only the given channel.
#[inline(always)]
pub fn sum(level: Level, source: &Image, channel: usize, taps: &Taps, is_seen: &[bool; RUN], to: &mut TapSums) {
    match (source.channels, level) {
        (1, _) => gather::<GreyLanes>(source, taps, to),
        // SAFETY: `level` is a level that the processor supports.
        #[cfg(target_arch = "x86_64")]
        (3, Level::Avx512) => unsafe { gather_wide(source, taps, to) },
        (3, _) => gather::<RgbLanes>(source, taps, to),
        _ => {
            for i in (0..RUN).filter(|&i| is_seen[i]) {
                one_by_one(source, channel..channel + 1, taps, i, to);
            }
            return;
        }
    }
    if taps.is_inside != *is_seen {
        for i in (0..RUN).filter(|&i| is_seen[i] && !taps.is_inside[i]) {
            one_by_one(source, 0..source.channels, taps, i, to);
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn gather_wide(source: &Image, taps: &Taps, to: &mut TapSums) {
    gather::<super::lanes::RgbLanesAvx512>(source, taps, to);
}

/// Adds the weighted taps of the pixels whose taps all lie inside the source.
#[inline(always)]
fn gather<F: PixelLanes>(source: &Image, taps: &Taps, to: &mut TapSums) {
    match (taps.is_sharp, taps.is_sheared) {
        (true, true) => gather_as::<F>(source, taps, true, true, to),
        (true, false) => gather_as::<F>(source, taps, true, false, to),
        (false, true) => gather_as::<F>(source, taps, false, true, to),
        (false, false) => gather_as::<F>(source, taps, false, false, to),
    }
}

// Plain loops without closures: a closure is a separate function, which the compiler does not inline into code
// compiled for other instruction sets.
#[inline(always)]
fn gather_as<F: PixelLanes>(source: &Image, taps: &Taps, is_sharp: bool, is_sheared: bool, to: &mut TapSums) {
    let (samples, stride) = (&source.data[..], source.row_len());
    assert!(source.channels == F::CHANNELS && samples.len() == source.height * stride);
    for i in 0..RUN {
        if !taps.is_inside[i] {
            continue;
        }
        // Prefetch the two source rows below the taps, which the next row of output pixels probably reads: maps seldom
        // rotate much, and the hardware prefetcher does not predict these reads.
        let below = samples.as_ptr().wrapping_add(taps.start[0][i] + TAPS * stride);
        F::prefetch(below);
        F::prefetch(below.wrapping_add(stride));

        let (mut sum, mut low, mut high) = (F::splat(0.0), F::splat(0.0), F::splat(0.0));
        for j in 0..TAPS {
            let start = if is_sheared { taps.start[j][i] } else { taps.start[0][i] + j * stride };
            debug_assert!(start + F::READ <= samples.len());
            // SAFETY: `is_inside` guarantees that all reads of an image with this number of channels stay inside it.
            let row = unsafe { F::load(samples.as_ptr().add(start)) };
            let weights = if is_sheared { F::spread(&taps.across[j][i]) } else { F::splat(taps.down[i][j]) };
            let weighed = row.mul(weights);
            sum = if j == 0 { weighed } else { sum.add(weighed) };
            if is_sharp {
                (low, high) = if j == 0 { (row, row) } else { (low.min(row), high.max(row)) };
            }
        }
        if !is_sheared {
            sum = sum.mul(F::spread(&taps.across[0][i]));
        }
        let value = sum.sum();
        to[i] += if is_sharp { within(value, low.min_over_pixels(), high.max_over_pixels()) } else { value };
    }
}

/// Clamps `value` to the range of the samples that the filter reads. Otherwise the negative weights of the filter would
/// put a dark ring around a bright lamp. NaN stays NaN.
#[inline(always)]
fn within(value: Vec4, low: Vec4, high: Vec4) -> Vec4 {
    let raised = Vec4::select(value.cmplt(low), low, value);
    Vec4::select(raised.cmpgt(high), high, raised)
}

/// Adds the weighted taps of some channels of pixel `i`. A tap outside the image takes the value of the nearest border
/// pixel.
#[cold]
#[inline(never)]
fn one_by_one(source: &Image, channels: std::ops::Range<usize>, taps: &Taps, i: usize, to: &mut TapSums) {
    let clamp = |at: i32, side: usize| at.clamp(0, side as i32 - 1) as usize;
    for (c, channel) in channels.enumerate() {
        let (mut columns, mut low, mut high) = ([0.0; TAPS], f32::INFINITY, f32::NEG_INFINITY);
        for j in 0..TAPS {
            let row = source.row(clamp(taps.line[i] + j as i32, source.height));
            for (k, column) in columns.iter_mut().enumerate() {
                let value = row[clamp(taps.column[j][i] + k as i32, source.width) * source.channels + channel];
                *column += value * taps.weight(i, j, k);
                (low, high) = (low.min(value), high.max(value));
            }
        }
        let value = Vec4::splat((columns[0] + columns[2]) + (columns[1] + columns[3]));
        to[i][c] += if taps.is_sharp { within(value, Vec4::splat(low), Vec4::splat(high)) } else { value }.x;
    }
}

/// Divides the sums by `parts`, the number of parts into which each footprint was split, and writes them to `out`.
/// With three channels, writes all channels; otherwise writes only the given channel.
#[inline(always)]
pub fn store(sums: &TapSums, parts: usize, channels: usize, channel: usize, mut out: &mut [f32]) {
    let share = 1.0 / parts as f32;
    if channels == 3 {
        for sum in &sums[..out.len() / 3] {
            let lanes = (*sum * share).to_array();
            // The fourth lane is overwritten by the next pixel.
            match out.first_chunk_mut() {
                Some(place) => *place = lanes,
                None => out.copy_from_slice(&lanes[..3]),
            }
            out = &mut out[3..];
        }
    } else {
        for (pixel, sum) in out.chunks_exact_mut(channels).zip(sums) {
            pixel[channel] = sum.x * share;
        }
    }
}
