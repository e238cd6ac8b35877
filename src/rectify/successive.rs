//! The paper's search for vanishing points (§5.2): RANSAC finds one group of converging lines after another among the
//! remaining lines, and optimises each vanishing point over `(alpha, theta)`.

use super::metric::{Line, visible};
use super::params::{Metric, Params};
use super::sphere::Frame;
use crate::error::Result;
use crate::exec;
use crate::geometry::Segment;
use crate::job::Job;
use crate::maths;
use crate::rng::Rng;
use glam::{DVec2, DVec3};

/// Number of line pairs drawn per vanishing point.
const DRAWS: usize = 600;

/// Maximum distance between an inlier and the vanishing point for each metric, in pixels of an image whose longer side
/// is `LONGER_SIDE` pixels. [bench vp]
const MAX_SEGMENT_DISTANCE: f64 = 1.5;
const MAX_VISIBLE_LINE_DISTANCE: f64 = 8.0;
const LONGER_SIDE: f64 = 640.0;

/// Pattern search for a vanishing point. `FIRST_STEP`: the first step of alpha, as a share of 1 - alpha. `TURN`: the
/// change of theta, in radians, for a step of 1. Both values may be chosen freely, because the search halves its step
/// whenever no neighbouring point is better. [convention]
const FIRST_STEP: f64 = 0.2;
const TURN: f64 = 0.3;
/// The search ends when its step is at most this. This is also the minimum of the factor 1 - alpha in a step of alpha.
/// [rounding]
const LAST_STEP: f64 = 1e-9;

/// Finds at most `count` vanishing points, in homogeneous pixels and in the order of detection.
pub fn search(
    frame: &Frame,
    segments: &[Segment],
    width: usize,
    height: usize,
    count: usize,
    params: &Params,
    job: Job,
) -> Result<Vec<DVec3>> {
    let (w, h) = (width as f64, height as f64);
    let mut lines: Vec<Line> = segments
        .iter()
        .filter_map(|s| match params.metric {
            Metric::Segment => Line::new(s),
            Metric::VisibleLine => visible(s, w, h).and_then(|s| Line::new(&s)),
        })
        .collect();
    let max_distance = match params.metric {
        Metric::Segment => MAX_SEGMENT_DISTANCE,
        Metric::VisibleLine => MAX_VISIBLE_LINE_DISTANCE,
    };
    let limit = w.max(h) / LONGER_SIDE * max_distance;
    let distance = |line: &Line, p: DVec3| match params.metric {
        Metric::Segment => line.endpoint_distance(p),
        Metric::VisibleLine => line.printed_distance(p),
    };

    let mut found = Vec::new();
    for round in 0..count {
        if lines.len() < 2 {
            break;
        }
        // Draw pairs of lines and keep the intersection with which the most lines agree.
        let votes = exec::map(DRAWS, job.part(round as f64 / count as f64, (round + 1) as f64 / count as f64), |k| {
            let mut rng = Rng::new(params.seed, &[round as u64, k as u64]);
            let (a, b) = (lines[rng.below(lines.len())].line, lines[rng.below(lines.len())].line);
            let p = a.cross(b);
            let p = (p.length() > 1e-9).then(|| p.normalize());
            (p.map_or(0, |p| lines.iter().filter(|l| distance(l, p) < limit).count()), p)
        })?;
        let Some((support, Some(start))) = votes.into_iter().rev().max_by_key(|v| v.0) else { break };
        if support < 2 {
            break;
        }
        let group: Vec<Line> = lines.iter().filter(|l| distance(l, start) < limit).copied().collect();
        let loss = |p: DVec3| group.iter().map(|l| distance(l, p).min(limit)).sum::<f64>();
        let point = regress(start, frame.principal, loss);
        let point = if group.len() > 2 { point } else { start };
        lines.retain(|l| distance(l, point) >= limit && distance(l, start) >= limit);
        found.push(point);
    }
    Ok(found)
}

/// Returns the homogeneous point with the polar coordinates `rho = alpha / (1 - alpha)` and `theta` about an origin;
/// `alpha = 1` is at infinity.
pub fn from_alpha(alpha: f64, theta: f64, origin: DVec2) -> DVec3 {
    let w = 1.0 - alpha;
    (maths::direction_at(theta) * alpha + origin * w).extend(w)
}

/// Returns the polar coordinates of a homogeneous point about an origin: `alpha = 1 - 1 / (rho + 1)` and the angle
/// `theta`.
pub fn to_alpha(p: DVec3, origin: DVec2) -> (f64, f64) {
    let away = (p.truncate() - origin * p.z) * if p.z < 0.0 { -1.0 } else { 1.0 };
    let rho = away.length();
    (rho / (rho + p.z.abs()), maths::angle_of(away))
}

/// Minimises the loss by a pattern search over `(alpha, theta)`. The steps of alpha become smaller as alpha approaches
/// 1, because the distance rho grows without bound there.
fn regress(start: DVec3, origin: DVec2, loss: impl Fn(DVec3) -> f64) -> DVec3 {
    let (mut alpha, mut theta) = to_alpha(start, origin);
    let mut best = loss(start);
    let mut point = start;
    let mut step = FIRST_STEP;
    while step > LAST_STEP {
        let alpha_step = (1.0 - alpha).max(LAST_STEP) * step;
        let turn = step * TURN;
        let tries = [(alpha_step, 0.0), (-alpha_step, 0.0), (0.0, turn), (0.0, -turn)];
        let next = tries
            .iter()
            .map(|(da, dt)| ((alpha + da).clamp(0.0, 1.0), theta + dt))
            .map(|(a, t)| (loss(from_alpha(a, t, origin)), a, t))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match next {
            Some((value, a, t)) if value < best => {
                (best, alpha, theta) = (value, a, t);
                point = from_alpha(a, t, origin);
            }
            _ => step *= 0.5,
        }
    }
    point.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_maps_back_and_reaches_infinity() {
        let origin = DVec2::new(320.0, 240.0);
        for p in [DVec3::new(10.0, 20.0, 1.0), DVec3::new(-3000.0, 5.0, -0.5), DVec3::new(0.6, -0.8, 0.0)] {
            let (alpha, theta) = to_alpha(p, origin);
            let back = from_alpha(alpha, theta, origin);
            assert!(back.normalize().cross(p.normalize()).length() < 1e-12);
        }
        assert_eq!(to_alpha(DVec3::X, origin).0, 1.0);
        let (alpha, _) = to_alpha(DVec3::new(320.0, 243.0, 1.0), origin);
        assert!((alpha - (1.0 - 1.0 / 4.0)).abs() < 1e-15);
    }
}
