//! Compares two estimates of the same numbers. Each estimate is the mean of independent runs, whose scatter gives its
//! variance.

/// Two means, their difference `off`, and the size that noise may give the difference.
#[derive(Debug)]
pub struct Difference {
    pub first: f64,
    pub second: f64,
    pub off: f64,
    /// If only noise makes the means differ, the probability is 0.1 % that any difference of all tests exceeds its
    /// interval.
    pub interval: f64,
}

/// Welch's t-test of the value `number` in two sets of rows (one row per run). The interval is corrected for `tests`
/// tests in total (Šidák).
pub fn welch(first: &[Vec<f64>], second: &[Vec<f64>], number: usize, tests: usize) -> Difference {
    let outside = 1.0 - (1.0 - 1e-3f64).powf(1.0 / tests as f64);
    let ((a, va), (b, vb)) = (statistics(first, number), statistics(second, number));
    let parts = va * va / (first.len() as f64 - 1.0) + vb * vb / (second.len() as f64 - 1.0);
    let degrees = (va + vb).powi(2) / parts.max(f64::MIN_POSITIVE);
    let interval = student_quantile(outside, degrees.max(1.0)) * (va + vb).sqrt();
    Difference { first: a, second: b, off: (a - b).abs(), interval }
}

/// Mean, and variance of the mean, of one number over all rows.
pub fn statistics(rows: &[Vec<f64>], number: usize) -> (f64, f64) {
    let n = rows.len() as f64;
    let mean = rows.iter().map(|i| i[number]).sum::<f64>() / n;
    let variance = rows.iter().map(|i| (i[number] - mean).powi(2)).sum::<f64>() / (n - 1.0) / n;
    (mean, variance)
}

/// Two-sided quantile of Student's t distribution: the |t| that is exceeded with probability `outside`, by numerical
/// integration of the tail.
fn student_quantile(outside: f64, degrees: f64) -> f64 {
    // Integrate over the angle whose tangent is t / sqrt(degrees): in this variable, the pdf is a power of the cosine.
    let steps = 20_000;
    let weight = |angle: f64| angle.cos().powf(degrees - 1.0);
    let step = std::f64::consts::FRAC_PI_2 / f64::from(steps);
    let slices: Vec<f64> = (0..steps).map(|i| weight((f64::from(i) + 0.5) * step)).collect();
    let total: f64 = slices.iter().sum();
    let mut tail = 0.0;
    for (i, slice) in slices.iter().enumerate().rev() {
        tail += slice;
        if tail >= outside * total {
            return degrees.sqrt() * (i as f64 * step).tan();
        }
    }
    0.0
}

#[test]
fn quantiles_are_those_of_printed_tables() {
    for (outside, degrees, t) in [(0.05, 23.0, 2.0687), (0.01, 10.0, 3.1693), (0.001, 30.0, 3.6460)] {
        assert!((student_quantile(outside, degrees) / t - 1.0).abs() < 2e-3, "{outside} {degrees}");
    }
}
