//! Sub-pixel line segments (after LSD, Grompone von Gioi et al. 2010): grow regions of similar gradient direction, fit
//! a line to each, and reject regions that could have occurred by chance.

use super::gradient::Gradients;
use crate::error::Result;
use crate::geometry::Segment;
use crate::image::{try_collect, try_vec};
use crate::job::Job;
use crate::maths;
use glam::DVec2;

/// Pixels with a smaller gradient magnitude are ignored. The unit is encoded luma per pixel; the value corresponds to
/// an edge of about 9 of 255 grey levels. [bench vp]
const MIN_GRADIENT: f32 = 0.01;

/// Maximum angle, in radians, between the gradient of a pixel and the mean gradient direction of the region that the
/// pixel joins: π / 8. [convention: LSD]
const TOLERANCE: f64 = std::f64::consts::FRAC_PI_8;

/// Length, in pixels, that the line fit leaves out at each end of a region, but at most a quarter of the region's
/// length. A corner bends the gradient within about one standard deviation of the Gaussian, 1.2 pixels, plus the one
/// pixel that the Scharr derivative reaches. [convention]
const TRIM: f64 = 2.0;

/// A region is dense enough if its pixels cover at least this share of its bounding rectangle. Otherwise it is grown
/// again with a tighter tolerance. If that does not suffice, its pixels far from the seed are cut off. Regions that
/// arise from noise have gaps and cover less. [bench lines]
const MIN_PIXEL_DENSITY: f64 = 0.6;

/// Finds the straight edges of a photo: statistically significant regions of similar gradient direction.
pub fn detect(gradients: &Gradients, job: Job) -> Result<Vec<Segment>> {
    let Gradients { width, height, magnitude, .. } = gradients;
    let seeds = by_falling_magnitude(magnitude)?;
    let used = try_collect(magnitude.iter().map(|m| !(*m >= MIN_GRADIENT)))?;
    let mut grower = Grower { gradients, used, region: Vec::new() };
    let log_tests = 2.5 * maths::ln((width * height) as f64);
    let mut segments = Vec::new();
    for (done, &seed) in seeds.iter().enumerate() {
        if done % 8192 == 0 {
            job.check()?;
            job.report(done as f64 / seeds.len() as f64);
        }
        if grower.used[seed as usize] {
            continue;
        }
        if let Some(found) = grower.straight_region(seed)
            && log_tests < found.log_surprise()
        {
            segments.push(found.segment);
        }
    }
    job.report(1.0);
    Ok(segments)
}

/// Returns the indices of the pixels whose gradient magnitude is at least `MIN_GRADIENT`, strongest first. A counting
/// sort orders them; its bins are so narrow that two pixels of an edge rarely share a bin. Pixels in one bin stay in
/// row-major order.
fn by_falling_magnitude(magnitude: &[f32]) -> Result<Vec<u32>> {
    const CLASSES: usize = 1 << 16;
    let top = magnitude.iter().fold(MIN_GRADIENT, |m, &v| m.max(v));
    let class = |m: f32| CLASSES - 1 - ((m / top * CLASSES as f32) as usize).min(CLASSES - 1);
    let mut start = vec![0usize; CLASSES + 1];
    for &m in magnitude.iter().filter(|&&m| m >= MIN_GRADIENT) {
        start[class(m) + 1] += 1;
    }
    for c in 0..CLASSES {
        start[c + 1] += start[c];
    }
    let mut order = try_vec(start[CLASSES], 0u32)?;
    for (i, &m) in magnitude.iter().enumerate().filter(|(_, m)| **m >= MIN_GRADIENT) {
        let slot = &mut start[class(m)];
        order[*slot] = i as u32;
        *slot += 1;
    }
    Ok(order)
}

/// A pixel of the region being grown.
#[derive(Clone, Copy)]
struct Pixel {
    index: u32,
    column: u32,
    row: u32,
}

impl Pixel {
    fn new(width: usize, index: u32) -> Self {
        Self { index, column: index % width as u32, row: index / width as u32 }
    }

    fn centre(self) -> DVec2 {
        DVec2::new(f64::from(self.column) + 0.5, f64::from(self.row) + 0.5)
    }
}

struct Grower<'a> {
    gradients: &'a Gradients,
    /// Whether a pixel already belongs to a region or its gradient is too weak, as on the image border.
    used: Vec<bool>,
    region: Vec<Pixel>,
}

/// A region's segment, its number of pixels, and the width of its bounding rectangle across the segment.
struct FittedSegment {
    segment: Segment,
    pixels: usize,
    width: f64,
}

impl FittedSegment {
    fn pixel_density(&self) -> f64 {
        self.pixels as f64 / (self.segment.length() * self.width).max(1.0)
    }

    /// Minus the logarithm of a probability: that at least as many pixels of the bounding rectangle agree in gradient
    /// direction as the region has, if all directions are random. The probability is Chernoff's bound of the binomial
    /// tail. 0 if the region covers no more of the rectangle than chance predicts.
    fn log_surprise(&self) -> f64 {
        let share = self.pixel_density().min(1.0 - 1e-9);
        let chance = TOLERANCE / std::f64::consts::PI;
        let divergence = share * maths::ln(share / chance) + (1.0 - share) * maths::ln((1.0 - share) / (1.0 - chance));
        if share > chance { self.pixels as f64 / share * divergence } else { 0.0 }
    }
}

impl Grower<'_> {
    /// Grows the region around a seed and fits a segment to it. If the region is not dense enough, first tightens the
    /// tolerance of the gradient direction, then cuts off pixels far from the seed. `None` if the region has too few
    /// pixels for a segment, or is wider than it is long.
    fn straight_region(&mut self, seed: u32) -> Option<FittedSegment> {
        self.grow(seed, TOLERANCE);
        let mut found = self.fit()?;
        if found.pixel_density() < MIN_PIXEL_DENSITY {
            self.release();
            self.grow(seed, TOLERANCE / 2.0);
            found = self.fit()?;
        }
        let origin = Pixel::new(self.gradients.width, seed).centre();
        let mut radius = found.segment.a.distance(origin).max(found.segment.b.distance(origin));
        while found.pixel_density() < MIN_PIXEL_DENSITY {
            radius *= 0.75;
            let Self { used, region, .. } = self;
            region.retain(|p| {
                let near = p.centre().distance(origin) <= radius;
                used[p.index as usize] = near;
                near
            });
            found = self.fit()?;
        }
        Some(found)
    }

    fn release(&mut self) {
        for p in &self.region {
            self.used[p.index as usize] = false;
        }
    }

    /// Collects the pixels connected to the seed whose gradients agree with the mean gradient direction of the region.
    /// Adds the neighbours of the region one layer at a time. Each layer is compared with the mean direction of all
    /// layers before it, so that the result does not depend on the order of pixels.
    fn grow(&mut self, seed: u32, tolerance: f64) {
        let Gradients { width, derivative, magnitude, .. } = self.gradients;
        let min_cos = maths::cos(tolerance) as f32;
        self.region.clear();
        self.region.push(Pixel::new(*width, seed));
        self.used[seed as usize] = true;
        let mut sum = [0.0f32; 2];
        let mut ring = 0..1;
        while !ring.is_empty() {
            for p in &self.region[ring.clone()] {
                let i = p.index as usize;
                sum = [sum[0] + derivative[i][0] / magnitude[i], sum[1] + derivative[i][1] / magnitude[i]];
            }
            let min_along = min_cos * (sum[0] * sum[0] + sum[1] * sum[1]).sqrt();
            for next in ring.clone() {
                let Pixel { index, column, row } = self.region[next];
                for (row, first) in
                    [(row - 1, index as usize - width), (row, index as usize), (row + 1, index as usize + width)]
                {
                    for (column, n) in (column - 1..).zip(first - 1..=first + 1) {
                        if self.used[n] {
                            continue;
                        }
                        let d = derivative[n];
                        if d[0] * sum[0] + d[1] * sum[1] >= min_along * magnitude[n] {
                            self.used[n] = true;
                            self.region.push(Pixel { index: n as u32, column, row });
                        }
                    }
                }
            }
            ring = ring.end..self.region.len();
        }
    }

    /// Fits a line by total least squares. Each pixel is weighted by its gradient magnitude; these weights locate an
    /// edge to a fraction of a pixel. The ends are left out, because corners bend the gradient there. `None` if the
    /// region has too few pixels to have a direction, or is wider than it is long.
    fn fit(&self) -> Option<FittedSegment> {
        if self.region.len() < 8 {
            return None;
        }
        let (centre, direction) = self.axis(|_| true)?;
        let (low, high) = self.extent(centre, direction);
        let trim = TRIM.min((high.x - low.x) / 4.0);
        let inner = |p: DVec2| {
            let along = direction.dot(p - centre);
            along >= low.x + trim && along <= high.x - trim
        };
        let (centre, direction) = self.axis(inner).unwrap_or((centre, direction));
        let (low, high) = self.extent(centre, direction);
        let segment = Segment { a: centre + direction * low.x, b: centre + direction * high.x };
        let found = FittedSegment { segment, pixels: self.region.len(), width: high.y - low.y + 1.0 };
        (segment.length() > found.width).then_some(found)
    }

    /// Returns the centroid and the principal direction of the pixels that satisfy `admits`, weighted by gradient
    /// magnitude.
    fn axis(&self, admits: impl Fn(DVec2) -> bool) -> Option<(DVec2, DVec2)> {
        let origin = self.region.first()?.centre();
        let (mut mass, mut sum, mut squares) = (0.0, DVec2::ZERO, [0.0; 3]);
        for pixel in &self.region {
            let p = pixel.centre();
            if admits(p) {
                let (d, w) = (p - origin, f64::from(self.gradients.magnitude[pixel.index as usize]));
                mass += w;
                sum += d * w;
                squares = [squares[0] + w * d.x * d.x, squares[1] + w * d.x * d.y, squares[2] + w * d.y * d.y];
            }
        }
        let mean = sum / mass;
        let [xx, xy, yy] = [
            squares[0] / mass - mean.x * mean.x,
            squares[1] / mass - mean.x * mean.y,
            squares[2] / mass - mean.y * mean.y,
        ];
        (mass > 0.0).then(|| (origin + mean, maths::direction_at(0.5 * maths::atan2(2.0 * xy, xx - yy))))
    }

    /// Returns the minimum and maximum coordinates of the region relative to `centre`: x along the direction, y across
    /// it.
    fn extent(&self, centre: DVec2, direction: DVec2) -> (DVec2, DVec2) {
        self.region.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            let d = p.centre() - centre;
            let at = DVec2::new(direction.dot(d), direction.perp_dot(d));
            (low.min(at), high.max(at))
        })
    }
}
