//! Precision of the distance between patches of sixteen channels, five pixels wide: in the library's integers, in f32
//! and in half floats.

use super::{Study, Way, timed};
use half::f16;
use half::slice::HalfFloatSliceExt;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::patch::{Kernel, Patch, QuantisedImage, Quantiser};
use luxfer::rng::Rng;

const SIDE: usize = 256;
const PATCH: usize = 5;
const CHANNELS: usize = 16;
const RUN: usize = PATCH * CHANNELS;
const PAIRS: usize = 4096;

/// Sum of squared differences between two rows of samples, with eight partial sums for vector registers.
#[inline(always)]
fn squares(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0f32; 8];
    for (a, b) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += (a - b) * (a - b);
        }
    }
    sums.iter().sum()
}

#[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx2"))]
fn in_f32(data: &[f32], pairs: &[[usize; 2]]) -> Vec<f32> {
    let row = |at: usize| &data[at..at + RUN];
    let rows = |[a, b]: [usize; 2]| (0..PATCH).map(move |r| (a + r * SIDE * CHANNELS, b + r * SIDE * CHANNELS));
    pairs.iter().map(|&pair| rows(pair).map(|(a, b)| squares(row(a), row(b))).sum()).collect()
}

#[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx2,f16c"))]
fn in_halves(data: &[f16], pairs: &[[usize; 2]]) -> Vec<f32> {
    let (mut a, mut b) = ([0f32; RUN], [0f32; RUN]);
    let mut distance = |&[p, q]: &[usize; 2]| {
        let mut sum = 0.0;
        for r in 0..PATCH {
            let [p, q] = [p, q].map(|at| at + r * SIDE * CHANNELS);
            data[p..p + RUN].convert_to_f32_slice(&mut a);
            data[q..q + RUN].convert_to_f32_slice(&mut b);
            sum += squares(&a, &b);
        }
        sum
    };
    pairs.iter().map(&mut distance).collect()
}

fn in_integers(features: &QuantisedImage, pairs: &[[usize; 2]]) -> Vec<u32> {
    let kernel = Kernel::detect();
    let patch = |at: usize| Patch { samples: &features.data[at..], row_len: features.row_len() };
    pairs.iter().map(|&[a, b]| kernel.distance(patch(a), patch(b), RUN, PATCH, u32::MAX)).collect()
}

/// An image of four channels: sine waves with fine noise.
fn image(first: u64) -> Image {
    Image::from_fn(SIDE, SIDE, |x, y| -> [f32; 4] {
        std::array::from_fn(|c| {
            let wave = 0.5 + 0.4 * (0.05 * (x * (c + 1)) as f32 + 0.03 * (first as f32 + 1.0) * y as f32).sin();
            wave + 0.02 * Rng::new(first, &[x as u64, y as u64, c as u64]).next_f32()
        })
    })
    .expect("an image")
}

/// Pairs of random patches; each patch is given by the index of its first sample.
fn random_pairs() -> Vec<[usize; 2]> {
    let mut rng = Rng::new(6, &[]);
    let mut place = || {
        let mut side = || (rng.next_f64() * (SIDE - PATCH) as f64) as usize;
        (side() * SIDE + side()) * CHANNELS
    };
    (0..PAIRS).map(|_| [place(), place()]).collect()
}

pub fn measure(study: &mut Study) {
    #[cfg(target_arch = "x86_64")]
    if !(is_x86_feature_detected!("avx2") && is_x86_feature_detected!("f16c")) {
        println!("# distances of patches: this processor has no AVX2");
        return;
    }
    // The compared images come from 8-bit files or renderings; the values of these test images are exact in f32.
    let images: Vec<Image> = (0..CHANNELS as u64 / 4).map(image).collect();
    let weights = [1.0; CHANNELS];
    let mut features = QuantisedImage::new(SIDE, SIDE, CHANNELS).expect("features");
    for (k, image) in images.iter().enumerate() {
        let quantisers = &Quantiser::for_weights(&weights, PATCH)[4 * k..4 * k + 4];
        features.fill(4 * k, quantisers, image, Monitor::default().job()).expect("features");
    }
    let samples = |i: usize| images.iter().flat_map(move |image| image.pixel(i % SIDE, i / SIDE).iter().copied());
    let narrow: Vec<f32> = (0..SIDE * SIDE).flat_map(samples).collect();
    let halves: Vec<f16> = narrow.iter().map(|&v| f16::from_f32(v)).collect();

    let pairs = random_pairs();
    let exact = |[a, b]: [usize; 2]| {
        let row = |r: usize| (0..RUN).map(move |i| r * SIDE * CHANNELS + i);
        (0..PATCH).flat_map(row).map(|i| (f64::from(narrow[a + i]) - f64::from(narrow[b + i])).powi(2)).sum::<f64>()
    };
    let truth: Vec<f64> = pairs.iter().map(|&pair| exact(pair)).collect();
    let error = |found: &[f64]| {
        found.iter().zip(&truth).map(|(f, t)| if *t > 0.0 { (f / t - 1.0).abs() } else { 0.0 }).fold(0.0, f64::max)
    };
    let unit = Quantiser::unit(&weights, PATCH).powi(2);
    let of_integers: Vec<f64> = in_integers(&features, &pairs).into_iter().map(|d| f64::from(d) / unit).collect();
    // SAFETY: the processor's features were checked above.
    let (of_narrow, of_halves) = unsafe { (in_f32(&narrow, &pairs), in_halves(&halves, &pairs)) };
    let wide = |found: Vec<f32>| found.into_iter().map(f64::from).collect::<Vec<f64>>();
    study.add(
        "stylisation: distances of patches",
        "relative, the largest of 4096",
        1,
        &mut [
            Way {
                name: "halves",
                bytes: 2,
                error: error(&wide(of_halves)),
                // SAFETY: as above.
                work: &mut timed(|| unsafe { in_halves(&halves, &pairs) }),
            },
            Way {
                name: "integers of 16 bits",
                bytes: 2,
                error: error(&of_integers),
                work: &mut timed(|| in_integers(&features, &pairs)),
            },
            Way {
                name: "f32",
                bytes: 4,
                error: error(&wide(of_narrow)),
                // SAFETY: as above.
                work: &mut timed(|| unsafe { in_f32(&narrow, &pairs) }),
            },
        ],
    );
}
