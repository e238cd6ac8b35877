//! Sub-pixel line segments: pixels of like gradient direction are grown into regions, a line is fitted to each, and what
//! chance could have made is dropped (after LSD, Grompone von Gioi et al. 2010).

use super::gradient::Gradients;
use crate::error::Result;
use crate::geometry::Segment;
use crate::image::try_vec;
use crate::job::Job;
use glam::DVec2;

/// Weakest gradient that counts, in encoded luma per pixel: an edge of about 9 of 255 grey levels. Weaker ones are the
/// texture of floors and plaster, whose chance lines outvote the few real ones of a poorly seen direction.
const WEAKEST: f32 = 0.015;

/// Half-angle within which a pixel joins a region, as in LSD: π / 8.
const TOLERANCE: f64 = std::f64::consts::FRAC_PI_8;

/// Length in pixels of each end of a region that the fit leaves out.
const END: f64 = 2.0;

/// Least share of a region's rectangle that its pixels cover.
const DENSITY: f64 = 0.7;

/// The straight edges of a photo, longest chance-free regions of like gradient direction.
pub fn detect(gradients: &Gradients, job: Job) -> Result<Vec<Segment>> {
    let Gradients { width, height, magnitude, .. } = gradients;
    let seeds = by_falling_magnitude(magnitude)?;
    let mut grower = Grower { gradients, used: try_vec(width * height, false)?, region: Vec::new() };
    let log_tests = 2.5 * ((width * height) as f64).ln();
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

/// Indices of the pixels with a gradient, strongest first: a counting sort over 1024 classes.
fn by_falling_magnitude(magnitude: &[f32]) -> Result<Vec<u32>> {
    const CLASSES: usize = 1024;
    let top = magnitude.iter().fold(WEAKEST, |m, &v| m.max(v));
    let class = |m: f32| CLASSES - 1 - ((m / top * CLASSES as f32) as usize).min(CLASSES - 1);
    let mut start = vec![0usize; CLASSES + 1];
    for &m in magnitude.iter().filter(|&&m| m >= WEAKEST) {
        start[class(m) + 1] += 1;
    }
    for c in 0..CLASSES {
        start[c + 1] += start[c];
    }
    let mut order = try_vec(start[CLASSES], 0u32)?;
    for (i, &m) in magnitude.iter().enumerate().filter(|(_, m)| **m >= WEAKEST) {
        let slot = &mut start[class(m)];
        order[*slot] = i as u32;
        *slot += 1;
    }
    Ok(order)
}

struct Grower<'a> {
    gradients: &'a Gradients,
    used: Vec<bool>,
    /// Pixels of the region being grown.
    region: Vec<u32>,
}

/// A region with the rectangle around it.
struct Found {
    segment: Segment,
    pixels: usize,
    width: f64,
}

impl Found {
    fn density(&self) -> f64 {
        self.pixels as f64 / (self.segment.length() * self.width).max(1.0)
    }

    /// Minus the logarithm of the probability that at least this many pixels of the rectangle agree by chance
    /// (Chernoff's bound of the binomial tail; smoothing makes neighbours agree, so only every second one counts).
    fn log_surprise(&self) -> f64 {
        let share = self.density().min(1.0 - 1e-9);
        let chance = TOLERANCE / std::f64::consts::PI;
        let divergence = share * (share / chance).ln() + (1.0 - share) * ((1.0 - share) / (1.0 - chance)).ln();
        if share > chance { self.pixels as f64 / share / 2.0 * divergence } else { 0.0 }
    }
}

impl Grower<'_> {
    /// The region around a seed, made dense first by a tighter tolerance, then by cutting off what is far from the seed.
    fn straight_region(&mut self, seed: u32) -> Option<Found> {
        self.grow(seed, TOLERANCE);
        let mut found = self.fit()?;
        if found.density() < DENSITY {
            self.release();
            self.grow(seed, TOLERANCE / 2.0);
            found = self.fit()?;
        }
        let origin = self.position(seed);
        let mut radius = found.segment.a.distance(origin).max(found.segment.b.distance(origin));
        while found.density() < DENSITY {
            radius *= 0.75;
            let Self { gradients, used, region } = self;
            region.retain(|&i| {
                let near = position(gradients.width, i).distance(origin) <= radius;
                used[i as usize] = near;
                near
            });
            found = self.fit()?;
        }
        Some(found)
    }

    fn release(&mut self) {
        for &i in &self.region {
            self.used[i as usize] = false;
        }
    }

    fn position(&self, index: u32) -> DVec2 {
        position(self.gradients.width, index)
    }

    /// Collects the pixels connected with the seed whose gradients point the way the region does on average.
    fn grow(&mut self, seed: u32, tolerance: f64) {
        let Gradients { width, height, derivative, magnitude } = self.gradients;
        let least = tolerance.cos() as f32;
        let unit = |i: usize| [derivative[i][0] / magnitude[i], derivative[i][1] / magnitude[i]];
        self.region.clear();
        self.region.push(seed);
        self.used[seed as usize] = true;
        let mut sum = unit(seed as usize);
        let mut next = 0;
        while next < self.region.len() {
            let i = self.region[next] as usize;
            next += 1;
            let (x, y) = (i % width, i / width);
            for ny in y.saturating_sub(1)..(y + 2).min(*height) {
                for nx in x.saturating_sub(1)..(x + 2).min(*width) {
                    let n = ny * width + nx;
                    if self.used[n] || magnitude[n] < WEAKEST {
                        continue;
                    }
                    let d = unit(n);
                    let length = (sum[0] * sum[0] + sum[1] * sum[1]).sqrt();
                    if d[0] * sum[0] + d[1] * sum[1] >= least * length {
                        self.used[n] = true;
                        self.region.push(n as u32);
                        sum = [sum[0] + d[0], sum[1] + d[1]];
                    }
                }
            }
        }
    }

    /// Total least squares through the region, each pixel weighing its gradient: that finds an edge to a fraction of a
    /// pixel. The ends, where corners bend the gradient, have no say. Regions of a few pixels have no direction.
    fn fit(&self) -> Option<Found> {
        if self.region.len() < 8 {
            return None;
        }
        let (centre, direction) = self.axis(|_| true)?;
        let (low, high) = self.extent(centre, direction);
        let trim = END.min((high.x - low.x) / 4.0);
        let inner = |p: DVec2| {
            let along = direction.dot(p - centre);
            along >= low.x + trim && along <= high.x - trim
        };
        let (centre, direction) = self.axis(inner).unwrap_or((centre, direction));
        let (low, high) = self.extent(centre, direction);
        let segment = Segment { a: centre + direction * low.x, b: centre + direction * high.x };
        let found = Found { segment, pixels: self.region.len(), width: high.y - low.y + 1.0 };
        (segment.length() > found.width).then_some(found)
    }

    /// Centroid and principal direction of the pixels that a condition admits.
    fn axis(&self, admits: impl Fn(DVec2) -> bool) -> Option<(DVec2, DVec2)> {
        let origin = self.position(*self.region.first()?);
        let (mut mass, mut sum, mut squares) = (0.0, DVec2::ZERO, [0.0; 3]);
        for &i in &self.region {
            let p = self.position(i);
            if admits(p) {
                let (d, w) = (p - origin, f64::from(self.gradients.magnitude[i as usize]));
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
        (mass > 0.0).then(|| (origin + mean, DVec2::from_angle(0.5 * (2.0 * xy).atan2(xx - yy))))
    }

    /// Least and greatest coordinates of the region along a direction and across it.
    fn extent(&self, centre: DVec2, direction: DVec2) -> (DVec2, DVec2) {
        self.region.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &i| {
            let d = self.position(i) - centre;
            let at = DVec2::new(direction.dot(d), direction.perp_dot(d));
            (low.min(at), high.max(at))
        })
    }
}

/// Centre of a pixel.
fn position(width: usize, index: u32) -> DVec2 {
    let (x, y) = (index as usize % width, index as usize / width);
    DVec2::new(x as f64 + 0.5, y as f64 + 0.5)
}
