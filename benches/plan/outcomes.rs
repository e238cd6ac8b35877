//! Ratios between actual and predicted values, for `benches/plan.rs` and `tests/plan.rs`.

use luxfer::image::Image;

#[derive(Default)]
pub struct Outcomes {
    pub times: Vec<f64>,
    pub errors: Vec<f64>,
}

/// Share of the ratios that are within 25 % of 1.
pub fn within(ratios: &[f64]) -> f64 {
    ratios.iter().filter(|r| (*r - 1.0).abs() <= 0.25).count() as f64 / ratios.len().max(1) as f64
}

pub fn mean(image: &Image) -> f64 {
    image.data.iter().map(|&v| f64::from(v)).sum::<f64>() / image.data.len() as f64
}

/// Root mean square error of two pictures with independent errors, relative to their mean.
pub fn error_of(a: &Image, b: &Image) -> f64 {
    let square = a.data.iter().zip(&b.data).map(|(&a, &b)| f64::from(a - b).powi(2)).sum::<f64>();
    (square / a.data.len() as f64 / 2.0).sqrt() / (0.5 * (mean(a) + mean(b)))
}
