//! Measures how similar the lamp shapes on a plane are to each other in fronto-parallel view, for a given tilt of the
//! plane.

use super::tilt::Tilt;
use crate::geometry::Radial;
use crate::geometry::robust::weighted_median;
use crate::maths;
use glam::{DMat2, DVec2};

/// Standard deviation, in photo pixels, of the position of a region's border, caused by blur and bloom.
/// [bench photos:tune]
const BORDER_ERROR: f64 = 0.7;
/// Standard deviation of the relative differences in length or width among lamps of one kind. [bench photos:tune]
const VARIETY: f64 = 0.08;
/// Only this number of the largest regions is used: more regions take time and add no certainty. [bench photos:tune]
pub const MAX_SHAPES: usize = 32;
/// Cost of the assumption that all lamps are elongated by the same ratio in the same direction. The cost is needed
/// because this assumption adds two parameters, and most lamps are as long as they are wide. [bench photos:tune]
const STRETCH_COST: f64 = 6.0;
/// Limit of the ratio of a shape's squared deviation to the variance of the deviation. Beyond this limit, the cost of
/// the shape grows more slowly, because the shape is probably of another kind. [convention]
const OUTLIER: f64 = 4.0;

/// `BLOOMS`: widths of bloom (the bright margin around overexposed lamps) that are tried, in units of [`BLOOM_UNIT`].
/// `BLOOM_SPREAD`: prior standard deviation of the width, in the same unit. Bloom lengthens the semi-axes of all
/// regions by its width. [bench photos:tune]
const BLOOMS: [f64; 6] = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0];
const BLOOM_SPREAD: f64 = 1.5;
/// Unit of bloom as a share of the photo's longer side: one pixel in a photo of 640 pixels. [convention]
pub const BLOOM_UNIT: f64 = 1.0 / 640.0;
/// Lower bound of the semi-axes of a region after its bloom is removed, in photo pixels; shorter semi-axes are raised
/// to this. [convention]
const MIN_SEMIAXIS: f64 = 0.5;

/// A region of the mask that shows a complete shape, that is, a lamp inside the photo.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Centre of the region relative to the principal point, in pixels of the photo that an ideal lens would take.
    centre: DVec2,
    /// For each width in [`BLOOMS`], the covariance of the positions of the region's pixels in the photo that an ideal
    /// lens would take. Bloom of this width was first removed from the region in the actual photo.
    covariances: [DMat2; BLOOMS.len()],
    /// Standard deviation of the `log_size` (`size_error`) and of the `stretch` (`stretch_error`) of the region's
    /// [`Form`].
    size_error: f64,
    stretch_error: f64,
}

/// Size and stretch of an ellipse whose standard deviations along its axes are a ≥ b. `log_size` is ln(a b). `stretch`
/// is a vector of length ln(a / b), at twice the angle of the long axis.
#[derive(Clone, Copy, Debug)]
struct Form {
    log_size: f64,
    stretch: DVec2,
}

/// Returns the variances along the principal axes of a covariance, largest first, and the unit vector at twice the
/// angle of the first axis.
fn axes(c: DMat2) -> ([f64; 2], DVec2) {
    let (mean, half, cross) = (0.5 * (c.x_axis.x + c.y_axis.y), 0.5 * (c.x_axis.x - c.y_axis.y), c.x_axis.y);
    let spread = maths::hypot(half, cross);
    ([mean + spread, (mean - spread).max(f64::EPSILON * mean)], DVec2::new(half, cross).normalize_or_zero())
}

/// Returns the covariance of a uniform ellipse after its semi-axes are shortened by `width`, but not below
/// [`MIN_SEMIAXIS`].
fn without_border(covariance: DMat2, width: f64) -> DMat2 {
    let (variances, double_angle) = axes(covariance);
    let [a, b] = variances.map(|variance| maths::powi((2.0 * variance.sqrt() - width).max(MIN_SEMIAXIS) / 2.0, 2));
    let (mean, spread) = (0.5 * (a + b), 0.5 * (a - b) * double_angle);
    DMat2::from_cols(DVec2::new(mean + spread.x, spread.y), DVec2::new(spread.y, mean - spread.x))
}

impl Shape {
    /// The shape of a region with this centre and covariance in the photo; both `centre` and `lens` are relative to the
    /// principal point.
    pub fn new(centre: DVec2, covariance: DMat2, lens: &Radial, bloom_unit: f64) -> Self {
        let mut covariances = BLOOMS.map(|bloom| without_border(covariance, bloom * bloom_unit));
        if !lens.is_none() {
            let derivative = lens.derivative(centre);
            covariances = covariances.map(|c| derivative * c * derivative.transpose());
        }
        // The variances of a uniform ellipse are a quarter of its squared semi-axes.
        let [a, b] = axes(covariance).0.map(|variance| BORDER_ERROR / (2.0 * variance.sqrt()));
        let (size_error, stretch_error) =
            (maths::hypot(a + b, VARIETY), maths::hypot(0.5 * maths::hypot(a, b), VARIETY));
        Self { centre: lens.ideal(centre), covariances, size_error, stretch_error }
    }

    /// Returns the form of the shape on the plane at distance 1 from the camera. `None` if the ray to the shape misses
    /// the plane or meets it at too small an angle.
    fn on_plane(&self, tilt: &Tilt, bloom: usize) -> Option<Form> {
        let (_, jacobian) = tilt.project(self.centre)?;
        let ([long, short], angle) = axes(jacobian * self.covariances[bloom] * jacobian.transpose());
        Some(Form { log_size: 0.5 * maths::ln(long * short), stretch: angle * (0.5 * maths::ln(long / short)) })
    }
}

/// Returns how much the shapes on a plane differ from each other: minus twice the logarithm of the likelihood that
/// they have equal size and form. Infinite if the camera sees a shape beyond the plane's horizon or at too small an
/// angle.
pub fn cost(shapes: &[Shape], tilt: &Tilt) -> f64 {
    min_cost(shapes, tilt, 1)
}

/// Like [`cost`], but faster: tries only every third width of bloom.
pub fn rough_cost(shapes: &[Shape], tilt: &Tilt) -> f64 {
    min_cost(shapes, tilt, 3)
}

fn min_cost(shapes: &[Shape], tilt: &Tilt, step: usize) -> f64 {
    let cost = |bloom: usize| maths::powi(BLOOMS[bloom] / BLOOM_SPREAD, 2) + cost_without(shapes, tilt, bloom);
    (0..BLOOMS.len()).step_by(step).map(cost).fold(f64::INFINITY, f64::min)
}

/// Computes the cost of the shapes after bloom of the width `BLOOMS[bloom]` is removed from them.
fn cost_without(shapes: &[Shape], tilt: &Tilt, bloom: usize) -> f64 {
    let mut forms = Vec::with_capacity(shapes.len());
    for shape in shapes {
        let Some(form) = shape.on_plane(tilt, bloom) else { return f64::INFINITY };
        forms.push((form, shape));
    }
    let median = |value: &dyn Fn(&Form) -> f64| {
        let weighted = forms.iter().map(|(form, shape)| (value(form), maths::powi(shape.size_error, -2)));
        weighted_median(weighted.collect()).unwrap_or(0.0)
    };
    let log_size = median(&|form| form.log_size);
    let stretch = DVec2::new(median(&|form| form.stretch.x), median(&|form| form.stretch.y));
    let by_size: f64 =
        forms.iter().map(|(form, shape)| robust(maths::powi((form.log_size - log_size) / shape.size_error, 2))).sum();
    let by_stretch = |common: DVec2| -> f64 {
        let square =
            |form: &Form, shape: &Shape| (form.stretch - common).length_squared() / maths::powi(shape.stretch_error, 2);
        forms.iter().map(|(form, shape)| robust(square(form, shape))).sum()
    };
    by_size + by_stretch(DVec2::ZERO).min(by_stretch(stretch) + STRETCH_COST)
}

/// Returns the cost of a shape; `square` is its squared deviation divided by the variance. From about [`OUTLIER`] on,
/// the cost grows more slowly than `square` (Cauchy's function).
fn robust(square: f64) -> f64 {
    OUTLIER * maths::ln_1p(square / OUTLIER)
}
