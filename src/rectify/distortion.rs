//! Lens distortion by the plumb-line test (Brown 1971, "Close-range camera calibration"; Devernay and Faugeras 2001,
//! "Straight lines have to be straight").
//!
//! Model: a lens shows at radius r the point that an ideal lens shows at r (1 - k r² / R²), where R is half the image
//! diagonal. Take coordinates from the image centre, t along a straight line and y across it. The line then appears as
//! a curve y(t) along which `y (1 - k (y² + t²) / R²)` is constant. If the line passes the centre at distance d, its
//! curvature is `y″ = 2 k d / R² / (1 - 3 k d² / R²)`. The quadratic coefficient of the curve, y″ / 2, divided by
//! d / R², therefore yields one estimate of k per traced segment. A robust mean over the many lines of a room rejects
//! mouldings and vaults, which are curved themselves.
//!
//! A line of several pieces (`edge_lines`) is used only if a single parabola fits all of them. The tiles of a ceiling
//! sag between the bars that carry them, so each edge of a tile is curved even without any lens distortion.

use super::edge_lines::{self, Edge};
use super::gradient::{Gradients, SIGMA};
use crate::geometry::Segment;
use crate::geometry::robust::weighted_median;
use crate::maths;
use glam::DVec2;

/// Radial distortion of a lens, expressed as displacement in the corners of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distortion {
    /// The coefficient k of the model: the outward displacement of a corner of the image, as a share of the corner's
    /// distance from the centre. It is negative for barrel distortion.
    pub corner: f64,
    /// Standard deviation of `corner`, including the deviation of real lenses from this model.
    pub error: f64,
    /// Number of traced segments whose estimate of k lies within the biweight's limit around `corner`.
    pub segments: usize,
}

/// A measured distortion may be undone if it is barrel distortion of at least `MIN_UNDONE` and at most `MAX_UNDONE`,
/// and at least `UNDONE_ERRORS` of its standard deviations.
///
/// If errors were normally distributed, undoing any estimate would pay on average as soon as its error is smaller than
/// the spread of distortions among lenses, about 3 %. The limits keep photos of good lenses as they are, and guard
/// against estimates from edges that are curved themselves, whose errors are larger than stated. Wide-angle lenses have
/// barrel distortion, of a few percent. Estimates of pincushion distortion, and of more than `MAX_UNDONE`, were wrong
/// wherever the truth is known. [bench vp:lenses]
const MIN_UNDONE: f64 = 0.02;
const MAX_UNDONE: f64 = 0.1;
const UNDONE_ERRORS: f64 = 2.0;

impl Distortion {
    /// Whether the distortion is of the kind and size that wide-angle lenses have, and unlikely to be 0.
    pub fn should_undo(&self) -> bool {
        let barrel = -self.corner;
        barrel >= MIN_UNDONE.max(UNDONE_ERRORS * self.error) && barrel <= MAX_UNDONE
    }
}

/// `MIN_LENGTH`: minimum length of the segments used. `TRIM`: length left out at each end of a segment, because corners
/// bend edges there. Both are in pixels. The weight of a segment grows with the fifth power of its length: a segment of
/// 30 pixels has 1/400 of the weight of a segment of 100 pixels, so shorter segments would cost time and change little.
/// `TRIM` is 2.5 standard deviations of the Gaussian plus the one pixel that the Scharr derivative reaches.
/// [convention]
const MIN_LENGTH: f64 = 30.0;
const TRIM: f64 = 4.0;
/// Number of pixels on each side of a segment within which its edge is searched for.
const SEARCH_WIDTH: i32 = 4;
/// A segment is used only if its edge is found along at least this share of its length. The results of the bench are
/// equal for all values between 0.35 and 0.98. [bench constants:lens]
const MIN_COVERAGE: f64 = 0.7;
/// Minimum number of traced segments; with fewer segments there is no estimate.
const MIN_SEGMENTS: usize = 12;
/// Error of an edge's position, in pixels, that the residuals of the fitted parabola do not show. Its square is added
/// to the variance of the residuals. The parabola through three samples of a smoothed step is off by up to 0.02 pixels,
/// and along an edge nearly parallel to the pixel rows this error changes so slowly that the residuals do not show it.
/// Without a floor, an edge without residuals would have an infinite weight. [rounding]
const POSITION_FLOOR: f64 = 0.01;
/// A segment is ignored if the root mean square residual of its edge about the fitted parabola is above this, in
/// pixels. [bench constants:lens]
const MAX_RESIDUAL: f64 = 0.25;
/// Limit of Tukey's biweight in standard deviations (95 % efficiency). [convention]
const BIWEIGHT_LIMIT: f64 = 4.685;
/// Assumed number of detected segments per physical line: a line may be detected in several pieces, and a frame has two
/// sides. Segments of one line have dependent errors. The stated error is proportional to the square root of this
/// number. The test prints the quantiles of true over stated error. [bench: `tests/real/rectify.rs`]
const SEGMENTS_PER_LINE: f64 = 2.0;
/// Standard deviation of `Distortion::corner` beyond its sampling error, because real lenses deviate from the model.
/// The value is the root mean square of the estimates for views cut out of panoramas. Their true distortion is 0, apart
/// from errors of stitching. [bench: `tests/real/rectify.rs`]
const MODEL_ERROR: f64 = 0.009;

/// Estimates the distortion of a lens whose optical axis meets the image in `centre`; `None` if there are too few
/// lines.
pub fn measure(gradients: &Gradients, segments: &[Segment], centre: DVec2) -> Option<Distortion> {
    let half_diagonal = 0.5 * DVec2::new(gradients.width as f64, gradients.height as f64).length();
    let edges: Vec<Edge> = segments.iter().filter_map(|s| trace(gradients, s)).collect();
    // Skip lines of several pieces that no single parabola fits: their pieces are curved themselves.
    let lines = edge_lines::lines(&edges).into_iter().filter(|pieces| pieces.len() == 1 || is_parabola(pieces));
    let estimates: Vec<LineEstimate> =
        lines.flatten().filter_map(|edge| LineEstimate::by(edge, centre, half_diagonal)).collect();
    combine(&estimates)
}

/// The estimate of k from one traced segment, with its weight.
#[derive(Clone, Copy, Debug)]
struct LineEstimate {
    /// Estimate of k from the curvature, with the term `3 k d² / R²` neglected.
    corner: f64,
    /// Inverse variance of the estimate.
    weight: f64,
    /// Squared distance of the line from the centre, in units of half the diagonal: (d / R)².
    squared_offset: f64,
}

impl LineEstimate {
    /// Returns the line's estimate of k, corrected for the term `3 k d² / R²` of the curvature; `nearly` is the
    /// approximate k for this term.
    fn at_corner(&self, nearly: f64) -> f64 {
        self.corner * (1.0 - 3.0 * nearly * self.squared_offset)
    }

    fn by(edge: &Edge, centre: DVec2, half_diagonal: f64) -> Option<Self> {
        let across = (edge.b - edge.a).try_normalize()?.perp();
        let distance = across.dot(0.5 * (edge.a + edge.b) - centre);
        let (bend, variance) = parabola(&along([edge.a, edge.b], &edge.points))?;
        let leverage = distance / (half_diagonal * half_diagonal);
        let weight = leverage * leverage / variance;
        let squared_offset = maths::powi(distance / half_diagonal, 2);
        (weight > 0.0).then_some(Self { corner: bend / leverage, weight, squared_offset })
    }
}

/// Whether one parabola fits all pieces of a line.
fn is_parabola(pieces: &[&Edge]) -> bool {
    let [Some(first), Some(last)] = [pieces.first(), pieces.last()] else { return false };
    let points: Vec<DVec2> = pieces.iter().flat_map(|piece| piece.points.iter().copied()).collect();
    parabola(&along([first.a, last.b], &points)).is_some()
}

/// Returns the coordinates of points relative to `a` in pixels: x along the line from `a` to `b`, y across it.
fn along([a, b]: [DVec2; 2], points: &[DVec2]) -> Vec<DVec2> {
    let along = (b - a).normalize_or_zero();
    points.iter().map(|p| DVec2::new(along.dot(p - a), along.perp().dot(p - a))).collect()
}

/// Locates the edge along a segment, once per pixel of length. Each position is the maximum of the gradient across the
/// segment. Only gradients with the polarity of the edge count: neighbouring edges of opposite polarity then do not
/// bias the position. `None` if the segment is shorter than [`MIN_LENGTH`], or if less than [`MIN_COVERAGE`] of its
/// edge is found.
fn trace(gradients: &Gradients, segment: &Segment) -> Option<Edge> {
    let length = segment.length();
    if length < MIN_LENGTH {
        return None;
    }
    let steps = (length - 2.0 * TRIM) as usize;
    // Determine the polarity of the edge from the sum of the gradients along the segment.
    let direction = (segment.b - segment.a) / length;
    let polarity: f64 =
        (0..steps).map(|i| slope(gradients, segment.a + direction * (TRIM + i as f64), direction.perp())).sum();
    let (a, b) = if polarity < 0.0 { (segment.b, segment.a) } else { (segment.a, segment.b) };
    let along = (b - a) / length;
    let across = along.perp();
    let profile = |t: f64| (-SEARCH_WIDTH..=SEARCH_WIDTH).map(move |o| a + along * t + across * f64::from(o));
    let mut points = Vec::new();
    for t in (0..steps).map(|i| TRIM + i as f64) {
        let slopes: Vec<f64> = profile(t).map(|at| slope(gradients, at, across)).collect();
        let Some(best) = (0..slopes.len()).max_by(|&i, &k| slopes[i].total_cmp(&slopes[k])) else { continue };
        // Skip the position if the maximum lies at an end of the profile, or if the gradient has the wrong polarity.
        // Refine other maxima to sub-pixel precision by a parabola.
        let inside = best > 0 && best + 1 < slopes.len() && slopes[best] > 0.0;
        if inside
            && let [before, peak, after] = slopes[best - 1..=best + 1]
            && before + after < 2.0 * peak
        {
            let vertex = 0.5 * (before - after) / (before - 2.0 * peak + after);
            let offset = best as f64 - f64::from(SEARCH_WIDTH) + vertex;
            points.push(a + along * t + across * offset);
        }
    }
    (points.len() as f64 >= MIN_COVERAGE * steps as f64).then_some(Edge { a, b, points })
}

/// Directional derivative of the encoded luma, interpolated between pixels; 0 outside the image.
fn slope(gradients: &Gradients, at: DVec2, direction: DVec2) -> f64 {
    let at = at - 0.5;
    let cell = at.floor();
    let inside = cell.cmpge(DVec2::ZERO).all()
        && cell.x + 1.0 < gradients.width as f64
        && cell.y + 1.0 < gradients.height as f64;
    if !inside {
        return 0.0;
    }
    let (f, first) = (at - cell, cell.y as usize * gradients.width + cell.x as usize);
    let of = |i: usize| {
        let [x, y] = gradients.derivative[i].map(f64::from);
        direction.dot(DVec2::new(x, y))
    };
    let row = |first: usize| of(first) * (1.0 - f.x) + of(first + 1) * f.x;
    row(first) * (1.0 - f.y) + row(first + gradients.width) * f.y
}

/// Fits a least-squares parabola to the points, by polynomials that are orthogonal on the points. Returns its quadratic
/// coefficient and the variance of that coefficient. `None` if there are fewer than 8 points, or if their root mean
/// square residual is not below [`MAX_RESIDUAL`].
fn parabola(points: &[DVec2]) -> Option<(f64, f64)> {
    let count = points.len() as f64;
    if points.len() < 8 {
        return None;
    }
    let mean = points.iter().sum::<DVec2>() / count;
    let first = |p: &DVec2| p.x - mean.x;
    let sums = points.iter().fold((0.0, 0.0), |(s, c), p| (s + maths::powi(first(p), 2), c + maths::powi(first(p), 3)));
    let second = |p: &DVec2| maths::powi(first(p), 2) - sums.1 / sums.0 * first(p) - sums.0 / count;
    let part = |of: &dyn Fn(&DVec2) -> f64| {
        let (dot, square) = points.iter().fold((0.0, 0.0), |(d, s), p| (d + of(p) * p.y, s + maths::powi(of(p), 2)));
        (dot / square, square)
    };
    let ((tilt, _), (bend, square)) = (part(&first), part(&second));
    let residual = |p: &DVec2| p.y - mean.y - tilt * first(p) - bend * second(p);
    let noise = points.iter().map(|p| maths::powi(residual(p), 2)).sum::<f64>() / (count - 3.0);
    // Gaussian smoothing correlates neighbouring samples. `shared` is their correlation length in pixels: the number of
    // samples that count as one.
    let shared = 2.0 * std::f64::consts::PI.sqrt() * f64::from(SIGMA);
    let variance = (noise + POSITION_FLOOR * POSITION_FLOOR) * shared / square;
    (noise < MAX_RESIDUAL * MAX_RESIDUAL && variance > 0.0 && variance.is_finite()).then_some((bend, variance))
}

/// Number of iterations of the M-estimate.
const ROUNDS: usize = 20;

/// Returns the value of k that most segments support: an M-estimate started at the weighted median. `None` if fewer
/// than [`MIN_SEGMENTS`] segments support it.
fn combine(estimates: &[LineEstimate]) -> Option<Distortion> {
    if estimates.len() < MIN_SEGMENTS {
        return None;
    }
    let median = weighted_median(estimates.iter().map(|s| (s.corner, s.weight.sqrt())).collect()).unwrap_or(0.0);
    let start = Distortion { corner: median, error: f64::INFINITY, segments: 0 };
    let found = (0..ROUNDS).fold(start, |found, _| m_estimate_step(estimates, found.corner));
    (found.segments >= MIN_SEGMENTS && found.corner.is_finite() && found.error.is_finite()).then_some(found)
}

/// Returns the result of one step of the M-estimate: the weighted mean over the segments within the biweight's limit
/// around `corner`. The standard deviation of the mean follows from the scatter of these segments and from
/// [`MODEL_ERROR`].
fn m_estimate_step(estimates: &[LineEstimate], corner: f64) -> Distortion {
    let off = estimates.iter().map(|s| ((s.corner - corner).abs() * s.weight.sqrt(), 1.0)).collect();
    let limit = BIWEIGHT_LIMIT * (1.4826 * weighted_median(off).unwrap_or(0.0)).max(1.0);
    let (mut weights, mut sum, mut squares, mut segments) = (0.0, 0.0, 0.0, 0);
    for s in estimates {
        let off = s.at_corner(corner) - corner;
        let residual = off * s.weight.sqrt() / limit;
        let agreement = maths::powi((1.0 - residual * residual).max(0.0), 2);
        weights += agreement * s.weight;
        sum += agreement * s.weight * s.at_corner(corner);
        squares += maths::powi(agreement * s.weight * off, 2).max(maths::powi(agreement, 2) * s.weight);
        segments += usize::from(agreement > 0.0);
    }
    Distortion {
        corner: sum / weights,
        error: maths::hypot((SEGMENTS_PER_LINE * squares).sqrt() / weights, MODEL_ERROR),
        segments,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{gradient, segments};
    use super::*;
    use crate::image::Image;
    use crate::job::Monitor;
    use crate::rng::Rng;

    /// A boarded wall seen obliquely through a distorting lens, with noise. The boards in the lower part run
    /// horizontally.
    fn photo(k: f64, [width, height]: [usize; 2], seed: u64) -> Image {
        let centre = 0.5 * DVec2::new(width as f64, height as f64);
        let half_diagonal = centre.length();
        Image::from_fn(width, height, |x, y| {
            let mut sum = 0.0;
            for s in 0..9 {
                let at = DVec2::new(x as f64 + (s % 3) as f64 / 3.0, y as f64 + (s / 3) as f64 / 3.0) + 1.0 / 6.0;
                let shown = (at - centre) / half_diagonal;
                let p = shown * (1.0 - k * shown.length_squared());
                let depth = 1.0 + 0.4 * p.x + 0.15 * p.y;
                let wall = DVec2::new(p.x + 0.1 * p.y, p.y) / depth * 9.0;
                let board = if p.y < 0.1 { wall.x } else { wall.y };
                sum += if board.rem_euclid(1.0) < 0.3 { 0.1 } else { 0.5 };
            }
            [(sum / 9.0 + 0.01 * Rng::new(seed, &[x as u64, y as u64]).normal()) as f32; 3]
        })
        .unwrap()
    }

    fn measured(photo: &Image) -> Option<Distortion> {
        let monitor = Monitor::default();
        let luma = gradient::encoded_luma(photo, monitor.job()).unwrap();
        let gradients = gradient::gradients(&luma, monitor.job()).unwrap();
        let segments = segments::detect(&gradients, monitor.job()).unwrap();
        measure(&gradients, &segments, 0.5 * DVec2::new(photo.width as f64, photo.height as f64))
    }

    #[test]
    fn the_bend_of_a_lens_is_found_within_its_error() {
        for k in [-0.06, -0.02, 0.0, 0.015, 0.04] {
            for (size, seed) in [([600, 400], 1), ([360, 480], 2)] {
                let found = measured(&photo(k, size, seed)).unwrap();
                println!("k {k}: {found:?}");
                assert!((found.corner - k).abs() < 0.002, "k {k}: {found:?}");
                assert!(found.error < 0.01, "k {k}: {found:?}");
            }
        }
    }

    /// A photo whose upper half shows a ceiling of tiles. The edges of the tiles sag by 1.2 pixels between the bars
    /// that carry the tiles.
    #[test]
    fn tiles_that_sag_between_their_bars_are_no_distortion() {
        let tiles = Image::from_fn(640, 480, |x, y| {
            let samples = (0..9).map(|s| {
                let at = DVec2::new(x as f64 + (s % 3) as f64 / 3.0, y as f64 + (s / 3) as f64 / 3.0) + 1.0 / 6.0;
                let across = (at.x / 160.0).fract() - 0.5;
                let edge = (at.y - 1.2 * (1.0 - 4.0 * across * across)).rem_euclid(40.0);
                if at.y < 230.0 && (edge < 6.0 || at.x.rem_euclid(160.0) < 6.0) { 0.1 } else { 0.5 }
            });
            [(samples.sum::<f64>() / 9.0 + 0.01 * Rng::new(4, &[x as u64, y as u64]).normal()) as f32; 3]
        });
        let tiles = tiles.unwrap();
        let found = measured(&tiles);
        assert!(found.is_none_or(|found| found.corner.abs() < 3.0 * found.error && found.error < 0.02), "{found:?}");
        // Cross-check: if the pieces of the lines are not joined, the sag of the tiles looks like distortion.
        let monitor = Monitor::default();
        let luma = gradient::encoded_luma(&tiles, monitor.job()).unwrap();
        let gradients = gradient::gradients(&luma, monitor.job()).unwrap();
        let segments = segments::detect(&gradients, monitor.job()).unwrap();
        let (centre, half_diagonal) = (DVec2::new(320.0, 240.0), 400.0);
        let edges = segments.iter().filter_map(|s| trace(&gradients, s));
        let pieces: Vec<LineEstimate> =
            edges.filter_map(|edge| LineEstimate::by(&edge, centre, half_diagonal)).collect();
        assert!(combine(&pieces).is_some_and(|of_pieces| of_pieces.corner.abs() > 0.05), "{:?}", combine(&pieces));
    }

    #[test]
    fn pictures_without_lines_give_no_estimate() {
        let noise = |x: usize, y: usize| [Rng::new(3, &[x as u64, y as u64]).next_f32(); 3];
        let noise = Image::from_fn(200, 200, noise).unwrap();
        assert_eq!(measured(&noise), None);
        assert_eq!(measured(&Image::from_fn(3, 3, |_, _| [0.5; 3]).unwrap()), None);
    }
}
