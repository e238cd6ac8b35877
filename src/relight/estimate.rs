//! What independent batches say: means, intervals, and intervals of what is calculated from them.

/// Batches of an estimate. Their spread gives the interval: with 32, Student's t is within 4 % of the normal quantile.
pub const BATCHES: usize = 32;

/// 97.5 % quantile of Student's t with `BATCHES - 1` = 31 degrees of freedom.
pub(super) const STUDENT_T: f64 = 2.039_513;

pub(super) fn mean(values: &[f64; BATCHES]) -> f64 {
    values.iter().sum::<f64>() / BATCHES as f64
}

/// Of the mean.
pub(super) fn standard_error(values: &[f64; BATCHES]) -> f64 {
    let centre = mean(values);
    let n = BATCHES as f64;
    (values.iter().map(|v| (v - centre) * (v - centre)).sum::<f64>() / (n - 1.0) / n).sqrt()
}

/// The mean of all batches but one.
pub(super) fn without(mean: f64, part: f64) -> f64 {
    let n = BATCHES as f64;
    (n * mean - part) / (n - 1.0)
}

/// The jackknife over batches: from an answer calculated from all of them, and the answers without each, the answer
/// without the bias of order 1/n, and what each batch alone says, whose mean that is (Efron 1982, §2).
pub(super) fn pseudo_values(whole: f64, without: &[f64; BATCHES]) -> [f64; BATCHES] {
    let n = BATCHES as f64;
    without.map(|w| n * whole - (n - 1.0) * w)
}
