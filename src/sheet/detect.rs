//! Detects alignment marks in a photo: saddles of brightness surrounded by two black and two white quadrants.

use crate::error::Result;
use crate::exec;
use crate::image::{Image, pyramid};
use crate::job::Job;
use crate::maths;
use glam::{DMat2, DVec2};

/// Maximum length, in pixels, of the longer side of the image in which marks are searched for. A larger photo is
/// reduced first.
const MAX_SIDE: usize = 1400;
/// Standard deviations of the blur before the search, in pixels of the reduced image. These scales find marks of four
/// to about forty pixels across. [convention: a scale space in octaves]
const SCALES: [f32; 3] = [1.5, 3.0, 6.0];
/// A saddle is compared with all positions within `NEIGHBOURHOOD` times the standard deviation of the blur. The
/// quadrants around the saddle must show on two circles; `CIRCLES` has their radii in units of this deviation.
/// [bench constants:sheet]
const NEIGHBOURHOOD: f32 = 1.5;
const CIRCLES: [f64; 2] = [1.6, 2.2];
/// Minimum distance between two candidates, in pixels of the reduced image. Several scales find the same mark; of
/// candidates that are closer, only the strongest is kept. [bench constants:sheet]
const MIN_DISTANCE: f64 = 6.0;
/// Maximum number of candidates for marks; the strongest ones are kept.
const MAX_CANDIDATES: usize = 24;
/// Minimum share of the second harmonic (two periods per turn) in the variance of brightness along a circle around a
/// mark. An ideal mark gives two periods of a square wave, with a share of 8 / π² = 0.81. If the sheet is tilted, the
/// edges of the mark may cross at a smaller angle: a mark tilted by 45° has a share of at least 0.75, one tilted by 60°
/// of at least 0.62. The right-angled corner of a black area, which is no mark, gives 0.27. Any value from 0.3 to 0.6
/// separates marks from such corners. [convention]
const MIN_HARMONIC: f64 = 0.55;
/// Minimum amplitude of the second harmonic, which measures the contrast of black and white in encoded brightness.
/// Paper that reflects 80 % with black that reflects 5 % gives 0.13 if it is underexposed by four f-stops. Pixel noise
/// with a standard deviation of 0.03 gives, on the smallest circle (15 pixels), more than 0.05 at one of 30,000
/// positions. Any value from 0.05 to 0.13 separates marks from noise. [convention]
const MIN_CONTRAST: f64 = 0.06;

/// A position that looks like a mark.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Position in pixels of the photo.
    pub at: DVec2,
    strength: f64,
}

/// Finds positions that look like marks, strongest first.
pub fn candidates(grey: &Image, job: Job) -> Result<Vec<Candidate>> {
    let longest = grey.width.max(grey.height);
    let reduced = longest.min(MAX_SIDE) as f64 / longest as f64;
    let side = |n: usize| ((n as f64 * reduced).round() as usize).max(1);
    let small = pyramid::resize(grey, side(grey.width), side(grey.height), job.part(0.0, 0.2))?;
    let scale = DVec2::new(grey.width as f64 / small.width as f64, grey.height as f64 / small.height as f64);
    let mut found: Vec<Candidate> = Vec::new();
    for (k, &sigma) in SCALES.iter().enumerate() {
        let job = job.part(0.2 + 0.25 * k as f64, 0.2 + 0.25 * (k + 1) as f64);
        let blurred = pyramid::blur(&small, sigma, job.part(0.0, 0.5))?;
        for (x, y) in saddles(&blurred, sigma, job.part(0.5, 1.0))? {
            let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let [inner, outer] = CIRCLES.map(|radius| quadrants(&small, at, radius * f64::from(sigma)));
            let strength = inner.min(outer);
            if strength > 0.0 {
                found.push(Candidate { at: at * scale, strength });
            }
        }
    }
    found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    let apart = MIN_DISTANCE * scale.max_element();
    let mut kept: Vec<Candidate> = Vec::new();
    for candidate in found {
        if kept.iter().all(|k| k.at.distance(candidate.at) > apart) && kept.len() < MAX_CANDIDATES {
            kept.push(candidate);
        }
    }
    Ok(kept)
}

/// Returns column and row of each saddle of brightness in an image that was blurred by `sigma`. A saddle is a local
/// maximum of at least [`MIN_RESPONSE`] of the response σ⁴ (Ixy² - Ixx Iyy). The response is the negated determinant of
/// the Hessian, normalised for scale.
fn saddles(image: &Image, sigma: f32, job: Job) -> Result<Vec<(usize, usize)>> {
    let (width, height) = (image.width, image.height);
    let mut response = Image::new(width, height, 1)?;
    exec::for_rows(&mut response.data, width, job, |y, row| {
        if y == 0 || y + 1 >= height {
            return;
        }
        let rows = [image.row(y - 1), image.row(y), image.row(y + 1)];
        for x in 1..width.saturating_sub(1) {
            let v = |dx: usize, dy: usize| rows[dy][x + dx - 1];
            let xx = v(0, 1) + v(2, 1) - 2.0 * v(1, 1);
            let yy = v(1, 0) + v(1, 2) - 2.0 * v(1, 1);
            let xy = (v(0, 0) + v(2, 2) - v(2, 0) - v(0, 2)) / 4.0;
            row[x] = (xy * xy - xx * yy) * maths::powi(sigma, 4);
        }
    })?;
    let radius_in_pixels = (NEIGHBOURHOOD * sigma).ceil() as usize;
    let rows = exec::map(height, job, |y| {
        let mut row = Vec::new();
        for (x, &here) in response.row(y).iter().enumerate() {
            if here < MIN_RESPONSE {
                continue;
            }
            let mut around =
                (y.saturating_sub(radius_in_pixels)..(y + radius_in_pixels + 1).min(height)).flat_map(|j| {
                    response.row(j)[x.saturating_sub(radius_in_pixels)..(x + radius_in_pixels + 1).min(width)].iter()
                });
            if around.all(|v| *v <= here) {
                row.push((x, y));
            }
        }
        row
    })?;
    Ok(rows.into_iter().flatten().collect())
}

/// Minimum response of a saddle. An ideal mark with a contrast c of black and white has a response of c² / π² and, in
/// `quadrants`, an amplitude of 2 c / π. So at the amplitude `MIN_CONTRAST` its response is 9e-4. The threshold mainly
/// saves time: any value from 1e-4 to 4e-4 lets every ideal mark through that `quadrants` accepts. [convention]
const MIN_RESPONSE: f32 = 2e-4;

/// Returns how strongly two dark and two bright quadrants alternate on a circle around a position: the amplitude of the
/// second harmonic times its share of the variance. Returns 0 if the amplitude or the share is too small for a mark.
fn quadrants(image: &Image, at: DVec2, radius: f64) -> f64 {
    const STEPS: usize = 32;
    let value = |i: usize| {
        let p = at + radius * maths::direction_at(std::f64::consts::TAU * i as f64 / STEPS as f64);
        f64::from(image.sample(p.x, p.y, 0))
    };
    let values: [f64; STEPS] = std::array::from_fn(value);
    let mean = values.iter().sum::<f64>() / STEPS as f64;
    let power: f64 = values.iter().map(|v| maths::powi(v - mean, 2)).sum::<f64>() / STEPS as f64;
    let mut second = DVec2::ZERO;
    for (i, v) in values.iter().enumerate() {
        second += (v - mean) * maths::direction_at(2.0 * std::f64::consts::TAU * i as f64 / STEPS as f64);
    }
    let amplitude = 2.0 * second.length() / STEPS as f64;
    let share = amplitude * amplitude / 2.0 / power.max(1e-12);
    if share > MIN_HARMONIC && amplitude > MIN_CONTRAST { amplitude * share } else { 0.0 }
}

/// Whether a mark of the given radius, in pixels, surrounds a position.
pub fn is_mark(grey: &Image, at: DVec2, radius: f64) -> bool {
    CIRCLE_SHARES.iter().all(|share| quadrants(grey, at, share * radius) > 0.0)
}

/// Radii of the circles on which the quadrants of a mark of known size must show, in units of its radius. [convention:
/// well inside the mark]
const CIRCLE_SHARES: [f64; 2] = [0.4, 0.7];

/// Refines a saddle to sub-pixel precision (Förstner and Gülch 1987). At the corner q of black and white quadrants, the
/// gradient g at each surrounding point p is perpendicular to p - q. The result minimises Σ w (g · (p - q))², with
/// weights w that fall with the distance |p - q|. `None` if the gradients do not determine q, or if an iteration moves
/// q `radius` pixels or more away from `start`.
pub fn refine(grey: &Image, start: DVec2, radius: f64) -> Option<DVec2> {
    let mut at = start;
    for _ in 0..12 {
        let (mut matrix, mut right) = (DMat2::ZERO, DVec2::ZERO);
        let radius_in_pixels = radius.ceil() as isize;
        for j in -radius_in_pixels..=radius_in_pixels {
            for i in -radius_in_pixels..=radius_in_pixels {
                let offset = DVec2::new(i as f64, j as f64);
                let weight = maths::exp(-2.0 * offset.length_squared() / (radius * radius));
                let p = at + offset;
                let v = |dx: f64, dy: f64| f64::from(grey.sample(p.x + dx, p.y + dy, 0));
                let gradient = DVec2::new(v(1.0, 0.0) - v(-1.0, 0.0), v(0.0, 1.0) - v(0.0, -1.0));
                let outer = DMat2::from_cols(gradient * gradient.x, gradient * gradient.y) * weight;
                matrix += outer;
                right += outer * p;
            }
        }
        if matrix.determinant().abs() < 1e-12 {
            return None;
        }
        let next = matrix.inverse() * right;
        let moved = next.distance(at);
        at = next;
        if !(at.distance(start) < radius) {
            return None;
        }
        if moved < 1e-3 {
            break;
        }
    }
    Some(at)
}
