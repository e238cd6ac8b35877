//! Finds vanishing points from line segments (§5.2): up to three orthogonal room directions and, if more are asked
//! for, further directions. Each is refined with the lines assigned to it, and has a covariance.

use super::params::{Params, Search};
use super::sphere::{
    Frame, Refined, RightAngle, WeightedLine, project, refine, refine_near, round_covariance, unproject,
};
use super::{manhattan, successive};
use crate::error::{Error, Result, check_range};
use crate::geometry::Segment;
use crate::job::Job;
use glam::{DMat3, DVec2, DVec3};

/// Maximum number of lines from which vanishing points are found. Any further lines are shorter and are only assigned
/// to the points found.
const MAX_LINES: usize = 2500;

/// Maximum standard deviation of a direction in radians; directions with a larger one are rejected.
/// [bench vp:panoramas]
const MAX_ERROR: f64 = 0.2;
/// Two estimates are of one direction if the cosine of the angle between them is at least this; it corresponds to an
/// angle of 26°. This angle lies between the 90° of two axes and the errors of a direction, of which [`MAX_ERROR`] is
/// the largest. [convention]
const MAX_EQUAL_COSINE: f64 = 0.9;

/// Standard deviations of the priors with which directions are refined. `SQUARENESS`: deviation from a right angle of
/// the angle between two room directions, in radians. `FOCAL_SPREAD`: error of the logarithm of the focal length.
/// [bench vp]
const SQUARENESS: f64 = 0.04;
const FOCAL_SPREAD: f64 = 0.05;

#[derive(Clone, Debug)]
pub struct VanishingPoint {
    /// In homogeneous pixel coordinates, normalised to unit length; the third coordinate is 0 for a point at infinity.
    pub point: DVec3,
    /// Number of segments that run to the point; 0 if the point was derived from the other points or from a
    /// convention.
    pub support: usize,
    /// Root mean square, in radians, of the angle between the point's direction in camera space and the true direction.
    pub error: f64,
    /// Covariance of the point's direction in camera space, in radians squared; its trace is the square of `error`.
    /// For a point far outside the image, the uncertainty along the lines is larger than the uncertainty across them.
    pub covariance: DMat3,
}

/// The vanishing points of a set of segments.
#[derive(Clone, Debug)]
pub struct Vanishing {
    /// The vanishing points in two groups: the first three points found, then any further points. The Manhattan search
    /// finds the points of the orthogonal directions, at most three, first. Each group is sorted by decreasing total
    /// weight of the lines that run to a point.
    pub points: Vec<VanishingPoint>,
    /// For each segment, the index of the point it runs to; `None` if it runs to no point.
    pub members: Vec<Option<usize>>,
    /// For each point, the direction in camera space estimated from its own lines, without priors on right angles, for
    /// a camera with the focal length `focal`.
    pub(super) free: Vec<Refined>,
    /// Focal length, in pixels, with which the directions were estimated: the given one, if any.
    ///
    /// Without a given focal length, the Manhattan search takes the focal length for which the directions are most
    /// nearly orthogonal; it is a weak guess if only one point is finite. The successive search takes
    /// `manhattan::USUAL_FOCAL`.
    pub focal: f64,
}

/// A direction refined with priors on right angles to the other directions (`expected`), and without them (`free`).
#[derive(Clone, Copy)]
struct DirectionEstimate {
    expected: Refined,
    free: Refined,
}

/// Finds at most `count` vanishing points of segments in an image of the given size. Segments of zero length or with
/// non-finite coordinates are ignored. Returns an error if no point can be found.
pub fn from_segments(
    segments: &[Segment],
    width: usize,
    height: usize,
    count: usize,
    params: &Params,
    job: Job,
) -> Result<Vanishing> {
    params.check()?;
    check_range("count of vanishing points", count, 1, 64)?;
    let frame = Frame::new(width, height, params.principal(width, height));
    let mut weighted_lines = frame.weighted_lines(segments);
    weighted_lines.sort_by(|a, b| b.1.weight.total_cmp(&a.1.weight));
    let lines: Vec<WeightedLine> = weighted_lines.iter().take(MAX_LINES).map(|(_, e)| *e).collect();

    let (found, focal) = match params.search {
        Search::Manhattan => {
            let given = params.focal.map(|f| f / frame.scale);
            orthogonal_and_further(&lines, given, count, params.seed, job)?
        }
        Search::Successive => {
            let focal = params.focal.map_or(manhattan::USUAL_FOCAL, |f| f / frame.scale);
            let points = successive::search(&frame, segments, width, height, count, params, job.part(0.0, 0.8))?;
            (points.iter().map(|&p| refine_at(&lines, unproject(frame.from_pixels(p), focal), focal)).collect(), focal)
        }
    };

    let points: Vec<DVec3> = found.iter().map(|r| project(r.expected.direction, focal)).collect();
    let (mut members, support) = assign(&weighted_lines, &points, segments.len());
    // Keep points with at least two lines. The first three points, which the Manhattan search makes orthogonal, stay
    // ahead of the others; both groups are sorted by decreasing weight of their lines.
    let mut order: Vec<usize> = (0..points.len()).filter(|&k| support[k].0 >= 2).collect();
    order.sort_by(|&a, &b| (a >= 3).cmp(&(b >= 3)).then(support[b].1.total_cmp(&support[a].1)));
    order.truncate(count);
    if order.is_empty() {
        return Err(Error::degenerate(format!(
            "no lines found that meet in a vanishing point ({} usable segments): use a photo that shows straight edges \
             of the room in focus",
            weighted_lines.len()
        )));
    }
    for member in &mut members {
        *member = member.and_then(|k: usize| order.iter().position(|&o| o == k));
    }
    let point = |&k: &usize| VanishingPoint {
        point: frame.to_pixels(points[k]),
        support: support[k].0,
        error: found[k].expected.error(),
        covariance: found[k].expected.covariance,
    };
    let points = order.iter().map(point).collect();
    let free = order.iter().map(|&k| found[k].free).collect();
    job.report(1.0);
    Ok(Vanishing { points, members, free, focal: focal * frame.scale })
}

/// Finds three orthogonal directions jointly with the focal length, and then further directions. Returns the focal
/// length too.
fn orthogonal_and_further(
    lines: &[WeightedLine],
    given: Option<f64>,
    count: usize,
    seed: u64,
    job: Job,
) -> Result<(Vec<DirectionEstimate>, f64)> {
    let Some(triplet) = manhattan::search(lines, given, seed, job.part(0.0, 0.8))? else {
        return Ok((Vec::new(), given.unwrap_or(manhattan::USUAL_FOCAL)));
    };
    let focal = triplet.focal;
    let mut found = refine_freely(lines, &[0, 1, 2].map(|k| triplet.axes.col(k)), focal);
    // Find further directions from the lines that do not run towards any direction found so far.
    while found.len() < count && !found.is_empty() {
        let points: Vec<DVec3> = found.iter().map(|r| project(r.expected.direction, focal)).collect();
        let rest: Vec<WeightedLine> =
            lines.iter().filter(|e| points.iter().all(|&p| e.agreement(p) == 0.0)).copied().collect();
        let Some(start) = manhattan::strongest(&rest, focal, seed, job.part(0.8, 0.9))? else { break };
        let Some(point) = refine(&rest, start, focal).filter(|r| r.error() < MAX_ERROR) else { break };
        found.push(DirectionEstimate { expected: point, free: point });
    }
    Ok((found, focal))
}

/// Returns the direction unchanged, with the covariance that the lines imply. If the lines do not determine a point,
/// the standard deviation of the direction is [`MAX_ERROR`].
fn refine_at(lines: &[WeightedLine], direction: DVec3, focal: f64) -> DirectionEstimate {
    let covariance =
        refine(lines, direction, focal).map_or_else(|| round_covariance(direction, MAX_ERROR), |r| r.covariance);
    let point = Refined { direction, covariance };
    DirectionEstimate { expected: point, free: point }
}

/// Assigns every segment to the point it agrees with best. Returns the index of the point for each segment, and the
/// number and the total weight of the lines of each point.
fn assign(lines: &[(usize, WeightedLine)], points: &[DVec3], count: usize) -> (Vec<Option<usize>>, Vec<(usize, f64)>) {
    let mut members = vec![None; count];
    let mut support = vec![(0usize, 0.0f64); points.len()];
    for (index, e) in lines {
        let best = points.iter().map(|&p| e.agreement(p)).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((k, _)) = best.filter(|b| b.1 > 0.0) {
            members[*index] = Some(k);
            support[k] = (support[k].0 + 1, support[k].1 + e.weight);
        }
    }
    (members, support)
}

/// Refines each direction with the lines that agree with it better than with the other directions. Then refines each
/// direction once more with the prior that it is at right angles to the other directions, which helps if a direction
/// has few lines. Drops directions that fewer than two lines determine, directions with an error above `MAX_ERROR`,
/// and directions that have drifted into another direction.
fn refine_freely(lines: &[WeightedLine], axes: &[DVec3], focal: f64) -> Vec<DirectionEstimate> {
    let mut current: Vec<Refined> =
        axes.iter().map(|&direction| Refined { direction, covariance: DMat3::ZERO }).collect();
    for _ in 0..3 {
        let groups = nearest(lines, &current, focal);
        current = current.iter().zip(&groups).filter_map(|(r, group)| refine(group, r.direction, focal)).collect();
    }
    let groups = nearest(lines, &current, focal);
    let squared: Vec<DirectionEstimate> = (0..current.len())
        .map(|i| {
            let from = current[i];
            let expected: Vec<RightAngle> = (0..current.len())
                .filter(|&j| j != i)
                .map(|j| {
                    let (to, error) = (current[j].direction, current[j].error());
                    let by_focal = 2.0 * from.direction.z * to.z * FOCAL_SPREAD;
                    RightAngle { to, variance: SQUARENESS * SQUARENESS + error * error + by_focal * by_focal }
                })
                .collect();
            DirectionEstimate {
                expected: refine_near(&groups[i], from.direction, focal, &expected).unwrap_or(from),
                free: from,
            }
        })
        .collect();
    let mut kept: Vec<DirectionEstimate> = Vec::new();
    for found in squared {
        let r = &found.expected;
        let apart = kept.iter().all(|k| k.expected.direction.dot(r.direction).abs() < MAX_EQUAL_COSINE);
        if apart && r.error() < MAX_ERROR {
            kept.push(found);
        }
    }
    kept
}

/// Returns for each direction the lines that agree with it better than with any other direction. Lines that agree with
/// no direction are left out.
fn nearest(lines: &[WeightedLine], directions: &[Refined], focal: f64) -> Vec<Vec<WeightedLine>> {
    let points: Vec<DVec3> = directions.iter().map(|r| project(r.direction, focal)).collect();
    let mut groups = vec![Vec::new(); points.len()];
    for e in lines {
        let best = points.iter().map(|&p| e.agreement(p)).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((k, _)) = best.filter(|b| b.1 > 0.0) {
            groups[k].push(*e);
        }
    }
    groups
}

impl Params {
    /// Returns the principal point in pixels: the given one, or else the image centre.
    pub fn principal(&self, width: usize, height: usize) -> DVec2 {
        self.principal.unwrap_or(DVec2::new(width as f64, height as f64) / 2.0)
    }
}
