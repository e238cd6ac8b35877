//! Precision of the sum of a pixel's paths: a million paths, most of them dim, a few very bright.

use super::real::Real;
use super::{Study, Way, timed};
use luxfer::rng::Rng;

const PATHS: usize = 1 << 20;
/// Number of paths that are summed before the sum is added to a pixel.
const SLICE: usize = 8;

/// Mean of the paths: sums slices in `S` and adds the sums of slices in `T`.
fn mean<S: Real, T: Real>(paths: &[f32]) -> f64 {
    let slice = |paths: &[f32]| paths.iter().map(|&p| S::of(f64::from(p))).sum::<S>();
    let sum: T = paths.chunks(SLICE).map(|paths| T::of(slice(paths).wide())).sum();
    sum.wide() / paths.len() as f64
}

pub fn measure(study: &mut Study) {
    let mut rng = Rng::new(1, &[]);
    let paths: Vec<f32> = (0..PATHS).map(|_| (1.5 * rng.normal()).exp() as f32).collect();
    // Compute the reference: a pairwise sum in f64 of the sorted values.
    let mut sums: Vec<f64> = paths.iter().map(|&p| f64::from(p)).collect();
    sums.sort_by(f64::total_cmp);
    while sums.len() > 1 {
        sums = sums.chunks(2).map(|pair| pair.iter().sum()).collect();
    }
    let truth = sums[0] / PATHS as f64;
    let error = |mean: f64| (mean / truth - 1.0).abs();
    let (narrow, mixed, wide) = (mean::<f32, f32>, mean::<f64, f32>, mean::<f64, f64>);
    study.add(
        "rendering: a pixel's sum of 2^20 paths",
        "relative, of the mean",
        1,
        &mut [
            Way { name: "f32", bytes: 4, error: error(narrow(&paths)), work: &mut timed(|| narrow(&paths)) },
            Way {
                name: "f32, slices of 8 in f64",
                bytes: 4,
                error: error(mixed(&paths)),
                work: &mut timed(|| mixed(&paths)),
            },
            Way { name: "f64", bytes: 8, error: error(wide(&paths)), work: &mut timed(|| wide(&paths)) },
        ],
    );
}
