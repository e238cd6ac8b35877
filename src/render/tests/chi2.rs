//! Pearson's chi-squared test, which compares observed frequencies with stated probabilities.

/// Bins with a smaller expected count are merged with the next bins. [convention]
const MIN_EXPECTED: f64 = 10.0;
/// Probability that at least one of the chi-squared tests of a test function fails by chance. [convention]
const CHANCE: f64 = 1e-3;

/// Asserts that the observed counts of all bins follow the expected counts. The test is one of `tests` tests; the
/// probability that any of these fails by chance is 1/1000 (Šidák 1967). The bins must cover the whole sample space, so
/// that the sum of the expected counts equals the sum of the observed counts up to quadrature errors.
pub(in crate::render) fn assert_follows(expected: &[f64], observed: &[f64], tests: usize, what: &str) {
    let bins = pooled(expected, observed);
    let (total, seen) = bins.iter().fold((0.0, 0.0), |(e, o), bin| (e + bin.0, o + bin.1));
    assert!((total / seen - 1.0).abs() < 2e-3, "{what}: {total} expected in all, {seen} observed");
    if let Some(degrees) = bins.len().checked_sub(1).filter(|&d| d > 0) {
        let sum: f64 = bins.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
        let limit = limit(degrees as f64, tests);
        assert!(sum < limit, "{what}: chi-squared is {sum}, over {limit} ({degrees} degrees of freedom)");
    }
}

/// Merges neighbouring bins until each has at least the expected count `MIN_EXPECTED`; a remainder joins the last bin.
/// Returns pairs of expected and observed counts.
fn pooled(expected: &[f64], observed: &[f64]) -> Vec<(f64, f64)> {
    let (mut bins, mut open) = (Vec::new(), (0.0, 0.0));
    for (&e, &o) in expected.iter().zip(observed) {
        open = (open.0 + e, open.1 + o);
        if open.0 >= MIN_EXPECTED {
            bins.push(std::mem::take(&mut open));
        }
    }
    match bins.last_mut() {
        Some(last) => *last = (last.0 + open.0, last.1 + open.1),
        None => bins.push(open),
    }
    bins
}

/// Returns the critical value of chi-squared for each of `tests` tests (Wilson and Hilferty 1931). The probability
/// that any of them exceeds it by chance is [`CHANCE`].
fn limit(degrees: f64, tests: usize) -> f64 {
    let chance = 1.0 - (1.0 - CHANCE).powf(1.0 / tests as f64);
    let (mut low, mut high) = (1.0, 10.0);
    for _ in 0..60 {
        let z = (low + high) / 2.0;
        if tail(z) > chance { low = z } else { high = z }
    }
    degrees * (1.0 - 2.0 / (9.0 * degrees) + low * (2.0 / (9.0 * degrees)).sqrt()).powi(3)
}

/// Returns the upper tail probability of the standard normal distribution for positive `z`, by the continued fraction
/// of Mills' ratio.
fn tail(z: f64) -> f64 {
    let ratio = (1..=60).rev().fold(z, |f, k| z + f64::from(k) / f);
    (-z * z / 2.0).exp() / (std::f64::consts::TAU.sqrt() * ratio)
}

#[test]
fn limits_are_those_of_tables() {
    // Compare with upper 0.1 % quantiles from tables: 29.588 for 10 degrees of freedom, and 149.449 for 100. With few
    // degrees of freedom, the approximation is off by 0.6 %.
    assert!((limit(10.0, 1) - 29.588).abs() < 0.2 && (limit(100.0, 1) - 149.449).abs() < 0.1);
    assert!((tail(1.959964) - 0.025).abs() < 1e-6);
}

#[test]
fn bins_are_taken_together_and_none_is_lost() {
    let bins = pooled(&[3.0, 8.0, 20.0, 1.0], &[1.0, 2.0, 3.0, 50.0]);
    assert_eq!(bins, [(11.0, 3.0), (21.0, 53.0)]);
    assert_eq!(pooled(&[1.0], &[1.0]), [(1.0, 1.0)]);
}

#[test]
#[should_panic(expected = "chi-squared is")]
fn deviations_of_a_few_percent_are_detected() {
    let observed: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 1050.0 } else { 950.0 }).collect();
    assert_follows(&[1000.0; 100], &observed, 1, "a comb");
}
