//! Precision of autocorrelation by Fourier transforms, for a faint pattern on a bright background.

use super::real::Real;
use super::{Study, Way, timed};
use luxfer::rng::Rng;

const LENGTH: usize = 1 << 16;
const PERIOD: usize = 96;

/// Fast Fourier transform in place, for lengths that are powers of two (Cooley and Tukey 1965). The twiddle factors
/// are computed in f64 and rounded.
fn transform<R: Real>(signal: &mut [[R; 2]]) {
    let bits = signal.len().trailing_zeros();
    for i in 0..signal.len() {
        let j = i.reverse_bits() >> (usize::BITS - bits);
        if i < j {
            signal.swap(i, j);
        }
    }
    let mut half = 1;
    while half < signal.len() {
        let factors: Vec<[R; 2]> = (0..half)
            .map(|k| -std::f64::consts::PI * k as f64 / half as f64)
            .map(|angle| [R::of(angle.cos()), R::of(angle.sin())])
            .collect();
        for block in signal.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for ((a, b), [c, s]) in low.iter_mut().zip(high).zip(&factors) {
                let turned = [b[0] * *c - b[1] * *s, b[0] * *s + b[1] * *c];
                *b = [a[0] - turned[0], a[1] - turned[1]];
                *a = [a[0] + turned[0], a[1] + turned[1]];
            }
        }
        half *= 2;
    }
}

/// Circular covariance at every shift, relative to the covariance at shift 0.
fn autocorrelation<R: Real>(values: &[f32]) -> Vec<f64> {
    let mut signal: Vec<[R; 2]> = values.iter().map(|&v| [R::of(f64::from(v)), R::ZERO]).collect();
    transform(&mut signal);
    for z in &mut signal {
        *z = [z[0] * z[0] + z[1] * z[1], R::ZERO];
    }
    transform(&mut signal);
    // Subtract the mean at the end, as the library does for images with a mask.
    let n = values.len() as f64;
    let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
    let covariance = |z: &[R; 2]| z[0].wide() / (n * n) - mean * mean;
    let none = covariance(&signal[0]);
    signal.iter().map(|z| covariance(z) / none).collect()
}

pub fn measure(study: &mut Study) {
    let mut rng = Rng::new(5, &[]);
    let lit = |i: usize| if i % PERIOD < PERIOD / 4 { 0.02 } else { 0.0 };
    let values: Vec<f32> = (0..LENGTH).map(|i| (1.0 + lit(i) + 0.01 * rng.normal()) as f32).collect();
    let (narrow, wide) = (autocorrelation::<f32>(&values), autocorrelation::<f64>(&values));
    let error = narrow.iter().zip(&wide).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    study.add(
        "emission: correlation of a faint pattern with itself",
        "of a correlation, the largest",
        1,
        &mut [
            Way { name: "f32", bytes: 8, error, work: &mut timed(|| autocorrelation::<f32>(&values)) },
            Way { name: "f64", bytes: 16, error: 0.0, work: &mut timed(|| autocorrelation::<f64>(&values)) },
        ],
    );
}
