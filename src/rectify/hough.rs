//! The paper's line detector (§5.1): a Hough transform in which each edge pixel votes only for lines perpendicular to
//! its gradient, within a few degrees. The maxima of the accumulator are the lines; each line is cut into the pieces
//! that edge pixels cover.

use super::gradient::Gradients;
use crate::error::Result;
use crate::geometry::Segment;
use crate::image::try_vec;
use crate::job::Job;
use crate::maths;
use glam::DVec2;
use std::f64::consts::PI;

/// Number of angle bins of the accumulator over half a turn: one per half degree.
const ANGLES: usize = 360;

/// `MIN_VOTES`: minimum votes of an accumulator maximum, as a share of the image's shorter side in pixels, but never
/// less than 8 votes. `MAX_LINES`: maximum number of lines returned. The bench prints the accuracy of the vanishing
/// points from Hough lines. [bench vp]
const MIN_VOTES: f64 = 0.06;
const MAX_LINES: usize = 600;

/// Half-size, in angle bins and distance bins, of the neighbourhood for non-maximum suppression.
const SUPPRESSED: (usize, usize) = (4, 4);

/// `MAX_DISTANCE`: maximum distance of an edge pixel from its line. `MAX_GAP`: maximum gap that a piece of a line
/// bridges. Both are in pixels. The bench prints the accuracy of the vanishing points from Hough lines. [bench vp]
const MAX_DISTANCE: f64 = 1.5;
const MAX_GAP: f64 = 6.0;
/// Minimum length of a piece of a line, as a share of half the image's diagonal and in pixels. Shorter pieces have no
/// reliable direction. [convention]
const MIN_LENGTH_SHARE: f64 = 0.02;
const MIN_LENGTH: f64 = 8.0;

/// A line `cos(theta) x + sin(theta) y = rho`, where x and y are pixels relative to the image centre, and `theta` is
/// in `[0, pi)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    pub rho: f64,
    pub theta: f64,
    pub votes: u32,
}

/// Returns the maxima of the accumulator, most votes first. Each edge pixel votes for the angles within `band` radians
/// of its gradient direction.
pub fn peaks(gradients: &Gradients, edges: &[u32], band: f64, job: Job) -> Result<Vec<Peak>> {
    let (width, height) = (gradients.width, gradients.height);
    let centre = DVec2::new(width as f64, height as f64) / 2.0;
    let max_rho = centre.length().ceil() as usize + 1;
    let rows = 2 * max_rho + 1;
    let mut votes = try_vec(ANGLES * rows, 0u32)?;
    let table: Vec<DVec2> = (0..ANGLES).map(|k| maths::direction_at(k as f64 * PI / ANGLES as f64)).collect();
    let half_band = (band / PI * ANGLES as f64).round() as isize;
    for (done, &i) in edges.iter().enumerate() {
        if done % 16_384 == 0 {
            job.check()?;
        }
        let [dx, dy] = gradients.derivative[i as usize];
        let direction = (maths::atan2(f64::from(dy), f64::from(dx)) / PI * ANGLES as f64).round() as isize;
        let p = position(width, i) - centre;
        for k in direction - half_band..=direction + half_band {
            let k = k.rem_euclid(ANGLES as isize) as usize;
            let rho = table[k].dot(p).round() as isize + max_rho as isize;
            votes[k * rows + rho as usize] += 1;
        }
    }

    // Find the local maxima. The accumulator wraps around in angle with the sign of rho flipped.
    let min_votes = ((MIN_VOTES * width.min(height) as f64) as u32).max(8);
    let mut found: Vec<(u32, usize, usize)> = Vec::new();
    for k in 0..ANGLES {
        job.check()?;
        for r in 0..rows {
            let v = votes[k * rows + r];
            if v < min_votes {
                continue;
            }
            let is_maximum = (-(SUPPRESSED.0 as isize)..=SUPPRESSED.0 as isize).all(|dk| {
                let nk = k as isize + dk;
                let mirrored = nk < 0 || nk >= ANGLES as isize;
                let nk = nk.rem_euclid(ANGLES as isize) as usize;
                (-(SUPPRESSED.1 as isize)..=SUPPRESSED.1 as isize).all(|dr| {
                    let nr = r as isize + dr;
                    let nr = if mirrored { rows as isize - 1 - nr } else { nr };
                    let Some(&other) = (0..rows as isize).contains(&nr).then(|| &votes[nk * rows + nr as usize]) else {
                        return true;
                    };
                    // Break ties in favour of the bin with the lower index.
                    other < v || (other == v && nk * rows + nr as usize >= k * rows + r)
                })
            });
            if is_maximum {
                found.push((v, k, r));
            }
        }
    }
    found.sort_by(|a, b| b.0.cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    found.truncate(MAX_LINES);
    let peak = |(votes, k, r): (u32, usize, usize)| Peak {
        rho: r as f64 - max_rho as f64,
        theta: k as f64 * PI / ANGLES as f64,
        votes,
    };
    Ok(found.into_iter().map(peak).collect())
}

/// Cuts each line into the pieces that edge pixels of similar gradient direction cover, and refits each piece by least
/// squares. Lines with more votes come first. An edge pixel counts only for the first line of which it covers a piece.
pub fn pieces(gradients: &Gradients, edges: &[u32], peaks: &[Peak], band: f64, job: Job) -> Result<Vec<Segment>> {
    let centre = DVec2::new(gradients.width as f64, gradients.height as f64) / 2.0;
    let min_agreement = maths::cos((2.0 * band).max(5f64.to_radians()));
    let min_length = (MIN_LENGTH_SHARE * centre.length()).max(MIN_LENGTH);
    let mut taken = try_vec(edges.len(), false)?;
    let mut segments = Vec::new();
    for (done, peak) in peaks.iter().enumerate() {
        job.check()?;
        job.report(done as f64 / peaks.len() as f64);
        let normal = maths::direction_at(peak.theta);
        let mut support: Vec<(f64, usize)> = Vec::new();
        for (slot, &i) in edges.iter().enumerate().filter(|(slot, _)| !taken[*slot]) {
            let p = position(gradients.width, i) - centre;
            if (normal.dot(p) - peak.rho).abs() > MAX_DISTANCE {
                continue;
            }
            let [dx, dy] = gradients.derivative[i as usize];
            let gradient = DVec2::new(f64::from(dx), f64::from(dy)).normalize();
            if normal.dot(gradient).abs() >= min_agreement {
                support.push((normal.perp_dot(p), slot));
            }
        }
        support.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for run in support.chunk_by(|a, b| b.0 - a.0 <= MAX_GAP) {
            let length = run[run.len() - 1].0 - run[0].0;
            // Require edge pixels along at least two thirds of a piece.
            if length < min_length || (run.len() as f64) < length * 2.0 / 3.0 {
                continue;
            }
            let points: Vec<DVec2> = run.iter().map(|&(_, slot)| refined_position(gradients, edges[slot])).collect();
            segments.push(fit(&points));
            run.iter().for_each(|&(_, slot)| taken[slot] = true);
        }
    }
    Ok(segments)
}

/// Returns the whole visible part of each line; the paper uses these lines, not their pieces.
pub fn whole_lines(gradients: &Gradients, peaks: &[Peak]) -> Vec<Segment> {
    let size = DVec2::new(gradients.width as f64, gradients.height as f64);
    let line = |peak: &Peak| {
        let normal = maths::direction_at(peak.theta);
        let foot = size / 2.0 + normal * peak.rho;
        super::metric::visible(&Segment { a: foot, b: foot + normal.perp() }, size.x, size.y)
    };
    peaks.iter().filter_map(line).collect()
}

fn position(width: usize, index: u32) -> DVec2 {
    DVec2::new((index as usize % width) as f64 + 0.5, (index as usize / width) as f64 + 0.5)
}

/// Returns the sub-pixel position of an edge pixel: the vertex of the parabola through three gradient magnitudes along
/// the image axis nearest to the gradient direction.
fn refined_position(gradients: &Gradients, index: u32) -> DVec2 {
    let i = index as usize;
    let [dx, dy] = gradients.derivative[i];
    let (axis, stride) = if dx.abs() >= dy.abs() { (DVec2::X, 1) } else { (DVec2::Y, gradients.width) };
    let m = |i: usize| f64::from(gradients.magnitude[i]);
    // Edge pixels never lie on the border.
    let (before, here, after) = (m(i - stride), m(i), m(i + stride));
    let bend = before - 2.0 * here + after;
    let offset = if bend < 0.0 { ((before - after) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 };
    position(gradients.width, index) + axis * offset
}

/// Fits a segment to points by total least squares. The points are sorted along the line.
fn fit(points: &[DVec2]) -> Segment {
    let centre = points.iter().sum::<DVec2>() / points.len() as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for d in points.iter().map(|&p| p - centre) {
        (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
    }
    let direction = maths::direction_at(0.5 * maths::atan2(2.0 * xy, xx - yy));
    let along = |p: DVec2| centre + direction * direction.dot(p - centre);
    Segment { a: along(points[0]), b: along(points[points.len() - 1]) }
}
