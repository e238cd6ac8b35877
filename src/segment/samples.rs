//! Draws training samples from strokes: a limited number per class, spread evenly over the strokes. Within a stroke,
//! the pixels with the smallest hash values are drawn.

use super::input::Input;
use super::params::Params;
use super::strokes::Stroke;
use crate::error::{Error, Result};
use crate::image::{reserve_capacity, try_collect, try_vec};
use crate::rng;

/// Where a sample comes from. Cross-validation holds out whole strokes or parts of strokes.
#[derive(Clone, Copy)]
pub struct Origin {
    pub positive: bool,
    /// Index of the sample's stroke. The negative strokes are numbered first, then the positive ones; strokes from
    /// which no sample is drawn are left out.
    pub stroke: usize,
    /// The quarter of the stroke's samples that contains this sample, 0 to 3. The samples are sorted along x if they
    /// extend at least as far along x as along y, else along y.
    pub part: usize,
}

pub struct Samples {
    /// Feature values, sample after sample, `dimension` values per sample.
    pub values: Vec<f64>,
    pub dimension: usize,
    /// The feature channel of each of the `dimension` values.
    pub channels: Vec<usize>,
    pub origins: Vec<Origin>,
    /// Number of strokes of the negative and the positive class.
    pub strokes: [usize; 2],
    /// Number of samples of the negative and the positive class.
    pub counts: [usize; 2],
    pub contradictory: usize,
    pub off_image: usize,
}

/// Number of parts into which cross-validation splits a stroke.
pub const PARTS: usize = 4;
/// Maximum number of pixels that [`unlabelled`] returns.
const MAX_UNLABELLED: usize = 2048;

/// Draws the samples. Where strokes overlap, the later stroke wins.
pub fn draw(input: &Input, channels: &[usize], params: &Params) -> Result<Samples> {
    let features = input.features;
    let Owned { mut pixels_of, contradictory, off_image } = owned(input, params.seed)?;
    let mut samples = Samples {
        values: Vec::new(),
        dimension: channels.len(),
        channels: channels.to_vec(),
        origins: Vec::new(),
        strokes: [0; 2],
        counts: [0; 2],
        contradictory,
        off_image,
    };
    for positive in [false, true] {
        let mut strokes: Vec<&mut Vec<(u64, u32)>> = (input.strokes.iter().zip(&mut pixels_of))
            .filter(|(s, pixels)| s.positive == positive && !pixels.is_empty())
            .map(|(_, pixels)| pixels)
            .collect();
        if strokes.is_empty() {
            let (class, opposite) = if positive { ("positive", "negative") } else { ("negative", "positive") };
            return Err(Error::degenerate(format!(
                "no {class} stroke covers any pixel of the {} x {} image ({} strokes, {off_image} of their pixels off the image, \
                 {contradictory} painted over by the other class): paint at least one {class} stroke besides the {opposite} ones",
                features.width,
                features.height,
                input.strokes.len()
            )));
        }
        let sizes: Vec<usize> = strokes.iter().map(|pixels| pixels.len()).collect();
        for (pixels, share) in strokes.iter_mut().zip(shares(&sizes, params.samples_per_class)) {
            // Keep the pixels with the smallest hashes: a random sample without replacement that does not depend on
            // the order in which the stroke lists its pixels.
            if share < pixels.len() {
                pixels.select_nth_unstable(share);
                pixels.truncate(share);
            }
        }
        for pixels in strokes.iter().filter(|s| !s.is_empty()) {
            let pixels: Vec<u32> = pixels.iter().map(|(_, p)| *p).collect();
            let stroke = samples.strokes[0] + samples.strokes[1];
            for (p, part) in parts(&pixels, features.width) {
                let pixel = &features.data[p as usize * features.channels..][..features.channels];
                samples.values.extend(channels.iter().map(|&c| f64::from(pixel[c])));
                samples.origins.push(Origin { positive, stroke, part });
            }
            samples.counts[usize::from(positive)] += pixels.len();
            samples.strokes[usize::from(positive)] += 1;
        }
    }
    Ok(samples)
}

/// The pixels that belong to each stroke. A pixel under several strokes belongs to the last one.
struct Owned {
    /// For each stroke, its pixels without duplicates, each with the hash by which samples are drawn.
    pixels_of: Vec<Vec<(u64, u32)>>,
    contradictory: usize,
    off_image: usize,
}

fn owned(input: &Input, seed: u64) -> Result<Owned> {
    let pixels = input.features.width * input.features.height;
    // For each pixel, the index of the last stroke that covers it. The highest bit is set if strokes of both classes
    // cover the pixel.
    const NONE: u32 = u32::MAX >> 1;
    const CONTRADICTED: u32 = !NONE;
    let mut owner = try_vec(pixels, NONE)?;
    let (mut contradictory, mut off_image) = (0, 0);
    for (s, stroke) in input.strokes.iter().enumerate() {
        for &p in &stroke.pixels {
            let Some(slot) = owner.get_mut(p as usize) else {
                off_image += 1;
                continue;
            };
            let (last, mut flag) = (*slot & NONE, *slot & CONTRADICTED);
            if last != NONE && flag == 0 && input.strokes[last as usize].positive != stroke.positive {
                flag = CONTRADICTED;
                contradictory += 1;
            }
            *slot = s as u32 | flag;
        }
    }
    // Collect the pixels of each stroke without duplicates, with their hashes.
    let mut own = |(s, stroke): (usize, &Stroke)| {
        try_collect(stroke.pixels.iter().filter_map(|&p| {
            let slot = owner.get_mut(p as usize).filter(|slot| **slot & NONE == s as u32)?;
            *slot = NONE;
            Some((rng::hash(seed, &[u64::from(p)]), p))
        }))
    };
    let pixels_of = input.strokes.iter().enumerate().map(&mut own).collect::<Result<Vec<Vec<(u64, u32)>>>>()?;
    Ok(Owned { pixels_of, contradictory, off_image })
}

/// The pixels under the strokes, by class. A pixel under several strokes belongs to the last one.
pub struct Ownership {
    /// Pixels of each positive stroke.
    pub positive: Vec<Vec<u32>>,
    /// Pixels of all negative strokes together.
    pub negative: Vec<u32>,
    pub contradictory: usize,
    pub off_image: usize,
}

/// Assigns each pixel to the last stroke that covers it.
pub fn ownership(input: &Input) -> Result<Ownership> {
    let Owned { pixels_of, contradictory, off_image } = owned(input, 0)?;
    let (mut positive, mut negative) = (Vec::new(), Vec::new());
    for (stroke, pixels) in input.strokes.iter().zip(&pixels_of) {
        if stroke.positive {
            positive.push(try_collect(pixels.iter().map(|&(_, p)| p))?);
        } else {
            reserve_capacity(&mut negative, pixels.len())?;
            negative.extend(pixels.iter().map(|&(_, p)| p));
        }
    }
    Ok(Ownership { positive, negative, contradictory, off_image })
}

/// Returns the features of up to [`MAX_UNLABELLED`] pixels spread over the region to be segmented, whether a stroke
/// covers them or not: `channels.len()` values per pixel.
pub fn unlabelled(input: &Input, channels: &[usize]) -> Vec<f64> {
    let features = input.features;
    // The step must not divide the width: otherwise only a few columns would be sampled.
    let step = (features.width * features.height).div_ceil(MAX_UNLABELLED) | 1;
    let step = if features.width.is_multiple_of(step) && step > 1 { step + 2 } else { step };
    let looked_at = |p: &usize| input.region.is_none_or(|w| w.data[*p] > 0.5);
    (0..features.width * features.height)
        .step_by(step)
        .filter(looked_at)
        .flat_map(|p| channels.iter().map(move |&c| f64::from(features.data[p * features.channels + c])))
        .collect()
}

/// Distributes `total` samples in equal shares over strokes of the given sizes in pixels. If a stroke has fewer pixels
/// than its share, the samples that it cannot supply are taken from larger strokes.
fn shares(sizes: &[usize], total: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by_key(|&i| (sizes[i], i));
    let mut shares = vec![0; sizes.len()];
    let mut left = total;
    for (k, &i) in order.iter().enumerate() {
        shares[i] = sizes[i].min(left.div_ceil(sizes.len() - k));
        left -= shares[i];
    }
    shares
}

/// Sorts the pixels of a stroke along x if the stroke is wider than high, else along y. Returns each pixel with the
/// quarter of the sorted list that it lies in, 0 to 3.
fn parts(pixels: &[u32], width: usize) -> impl Iterator<Item = (u32, usize)> {
    let position = |p: u32| (p as usize % width, p as usize / width);
    let extent = |f: fn((usize, usize)) -> usize| {
        let values = || pixels.iter().map(|&p| f(position(p)));
        values().max().unwrap_or(0) - values().min().unwrap_or(0)
    };
    let is_wide = extent(|p| p.0) >= extent(|p| p.1);
    let mut sorted = pixels.to_vec();
    sorted.sort_unstable_by_key(|&p| if is_wide { (position(p).0, p) } else { (position(p).1, p) });
    let count = sorted.len();
    sorted.into_iter().enumerate().map(move |(k, p)| (p, k * PARTS / count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_even_and_use_what_small_strokes_leave() {
        assert_eq!(shares(&[100, 100], 50), [25, 25]);
        assert_eq!(shares(&[1000, 10, 1000], 310), [150, 10, 150]);
        assert_eq!(shares(&[3, 2], 100), [3, 2]);
        assert_eq!(shares(&[5, 5, 5], 1).iter().sum::<usize>(), 1);
    }

    #[test]
    fn a_stroke_has_four_parts_along_its_length() {
        let pixels: Vec<u32> = (0..20).flat_map(|y| [y * 50 + 7, y * 50 + 8]).collect();
        assert!(parts(&pixels, 50).all(|(p, part)| (p / 50 / 5) as usize == part));
        assert_eq!(parts(&[3], 50).collect::<Vec<_>>(), [(3, 0)]);
    }
}
