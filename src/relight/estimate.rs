//! Statistics of independent batches: means, confidence intervals, and intervals of derived quantities.

/// Number of batches of an estimate. With 32 batches, the 97.5 % quantile of Student's t is 4 % above the quantile of
/// the normal distribution. \[convention\]
pub const BATCHES: usize = 32;

/// 97.5 % quantile of Student's t with `BATCHES - 1` = 31 degrees of freedom. [convention]
pub(super) const STUDENT_T: f64 = 2.039_513;

pub(super) fn mean(values: &[f64; BATCHES]) -> f64 {
    values.iter().sum::<f64>() / BATCHES as f64
}

/// Standard error of the mean over the batches.
pub(super) fn standard_error(values: &[f64; BATCHES]) -> f64 {
    let centre = mean(values);
    let n = BATCHES as f64;
    (values.iter().map(|v| (v - centre) * (v - centre)).sum::<f64>() / (n - 1.0) / n).sqrt()
}

/// Returns the mean over all batches except one. `mean` is the mean over all batches; `part` is the value of the batch
/// to leave out.
pub(super) fn without(mean: f64, part: f64) -> f64 {
    let n = BATCHES as f64;
    (n * mean - part) / (n - 1.0)
}

/// Computes the pseudo-values of the jackknife over batches (Efron 1982, §2): `n θ − (n − 1) θᵢ`. `whole` is the
/// result θ of all n batches, and `without` holds the results θᵢ with batch i left out. The mean of the pseudo-values
/// is an estimate of the result without the bias of order 1/n. Their variance gives the standard error of this
/// estimate.
pub(super) fn pseudo_values(whole: f64, without: &[f64; BATCHES]) -> [f64; BATCHES] {
    let n = BATCHES as f64;
    without.map(|w| n * whole - (n - 1.0) * w)
}
