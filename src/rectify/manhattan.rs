//! Searches for three orthogonal vanishing points jointly with the focal length, if it is unknown. Pairs of lines
//! yield candidate points; pairs of candidates, or a candidate and a line, yield triplets of points. The best triplets
//! are then refined: rotation and focal length together.

use super::focal::USUAL_FOCAL_PER_WIDTH;
use super::sphere::{WeightedLine, project, refine, unproject};
use crate::error::Result;
use crate::exec;
use crate::geometry::linear;
use crate::job::Job;
use crate::maths;
use crate::rng::Rng;
use glam::{DMat3, DVec3};

/// Focal lengths tried in addition to the focal lengths that pairs of candidates imply, in units of half the longer
/// image side: angles of view from 20 to 110 degrees. The bench prints the accuracy of the vanishing points for an
/// unknown and for a known focal length; the difference is the loss by the search for the focal length. [bench vp]
const FOCALS: [f64; 7] = [0.7, 0.95, 1.3, 1.7, 2.2, 3.2, 5.5];

/// Range of focal lengths in the refinement: angles of view from 9.5 to 136 degrees, a wider range than the range of
/// [`FOCALS`]. It prevents steps from a bad start from leading to a degenerate focal length. [convention]
const FOCAL_RANGE: [f64; 2] = [0.4, 12.0];
/// Weight that fixes a given focal length in the refinement, relative to the weight of the lines. [rounding]
const FIXED_WEIGHT: f64 = 1e12;

/// Prior of the focal length in the search. `USUAL_FOCAL`: median in units of half the longer image side. For a
/// landscape photo it equals the median of [`super::focal`]; for a portrait photo it is longer, because that median is
/// a share of the image width. `SEARCH_SPREAD`: standard deviation of the logarithm. \[bench vp:panoramas\]
pub const USUAL_FOCAL: f64 = 2.0 * USUAL_FOCAL_PER_WIDTH;
const SEARCH_SPREAD: f64 = 0.4;

/// Penalty of a triplet whose focal length deviates from the prior by one standard deviation, as a share of the total
/// weight of the lines: the triplet must explain this much more weight than a triplet at the median focal length. The
/// bench prints the accuracy of the vanishing points for an unknown focal length, for which this penalty matters.
/// [bench vp]
const FOCAL_COST: f64 = 0.004;

/// Share of a line's weight that the search for further candidates ignores if a candidate explains the line completely.
/// [bench vp:panoramas]
const EXPLAINED_SHARE: f32 = 0.9;

/// Two candidates are paired at a focal length if the magnitude of the cosine of the angle between their directions is
/// below this: within 9 degrees of a right angle. The focal length is the given one or one of [`FOCALS`], whose steps
/// up to 2.2 are factors of 1.29 to 1.37. Suppose that the directions are at a right angle at the true focal length,
/// and that this focal length lies half a step, a factor of √1.36, from a listed one. At the listed focal length, the
/// cosine is then at most (1.36 - 1) / (1.36 + 1) = 0.15. A smaller limit would miss pairs whose true focal length lies
/// between two listed ones; a larger limit would accept many pairs at both of these. [convention]
const MAX_COSINE: f64 = 0.15;

/// Two triplets are similar if each axis of one is within 1.8 degrees (`MIN_AXIS_COSINE`) of an axis of the other, and
/// if the logarithms of their focal lengths differ by less than `MAX_FOCAL_LOG`. Of similar triplets only the best is
/// refined, since refinement leads all of them to the same maximum; that saves time. [convention]
const MIN_AXIS_COSINE: f64 = 0.9995;
const MAX_FOCAL_LOG: f64 = 0.1;

/// `PAIRS`: number of line pairs drawn. `CANDIDATES`: maximum number of candidates kept. `PARTNERS`: maximum number of
/// lines paired with each candidate. `SEMIFINALISTS`: maximum number of triplets scored a second time. `FINALISTS`:
/// maximum number of triplets refined.
const PAIRS: usize = 800;
const CANDIDATES: usize = 8;
const PARTNERS: usize = 40;
const SEMIFINALISTS: usize = 256;
const FINALISTS: usize = 12;

/// Number of longest lines on which all hypotheses (`FEW`) and the semifinalists (`MANY`) are scored.
const FEW: usize = 64;
const MANY: usize = 200;

/// An orthogonal triplet: camera-space directions as columns, the focal length in frame units (half the longer image
/// side), and the score of the triplet.
#[derive(Clone, Copy, Debug)]
pub struct Triplet {
    pub axes: DMat3,
    pub focal: f64,
    pub score: f64,
}

/// Finds the best triplet; `None` if no two distinct lines intersect. The lines must be sorted by decreasing length.
pub fn search(lines: &[WeightedLine], focal: Option<f64>, seed: u64, job: Job) -> Result<Option<Triplet>> {
    let candidates = candidates(lines, focal.unwrap_or(USUAL_FOCAL), CANDIDATES, seed, job.part(0.0, 0.3))?;
    let hypotheses = hypotheses(lines, &candidates, focal);
    // Score all hypotheses on a few lines, rescore the better ones on more lines, and score the finalists on all
    // lines.
    let few = ranked(lines, FEW, hypotheses, job.part(0.3, 0.6))?;
    let ranked = ranked(lines, MANY, few.into_iter().take(SEMIFINALISTS).collect(), job.part(0.6, 0.7))?;
    let mut finalists: Vec<Triplet> = Vec::new();
    for triplet in ranked {
        if finalists.len() == FINALISTS {
            break;
        }
        if finalists.iter().all(|f| !similar(f, &triplet)) {
            finalists.push(triplet);
        }
    }
    let refined = exec::map(finalists.len(), job.part(0.7, 1.0), |i| refine_jointly(lines, finalists[i], focal))?;
    Ok(refined.into_iter().max_by(|a, b| a.score.total_cmp(&b.score)))
}

/// Sorts triplets by decreasing score on the longest lines.
fn ranked(lines: &[WeightedLine], longest: usize, triplets: Vec<Triplet>, job: Job) -> Result<Vec<Triplet>> {
    let longest = &lines[..lines.len().min(longest)];
    let scores = exec::map(triplets.len(), job, |i| score(longest, &triplets[i]))?;
    let mut ranked: Vec<(f64, Triplet)> = scores.into_iter().zip(triplets).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    Ok(ranked.into_iter().map(|(_, triplet)| triplet).collect())
}

/// Returns the vanishing direction with which the largest weight of lines agrees; `None` if no two lines intersect.
pub fn strongest(lines: &[WeightedLine], focal: f64, seed: u64, job: Job) -> Result<Option<DVec3>> {
    Ok(candidates(lines, focal, 1, seed, job)?.first().map(|&p| unproject(p, focal)))
}

/// Intersects random pairs of lines and returns the vanishing points with which the most lines agree, refined, best
/// first. Each further point is scored mainly on the lines that the earlier points leave unexplained.
fn candidates(lines: &[WeightedLine], focal: f64, count: usize, seed: u64, job: Job) -> Result<Vec<DVec3>> {
    let cumulative: Vec<f64> = lines
        .iter()
        .scan(0.0, |sum, e| {
            *sum += e.weight;
            Some(*sum)
        })
        .collect();
    let total = cumulative.last().copied().unwrap_or(0.0);
    let draw = |rng: &mut Rng| cumulative.partition_point(|&c| c <= rng.next_f64() * total).min(lines.len() - 1);
    let points: Vec<DVec3> = (0..if lines.len() < 2 { 0 } else { PAIRS })
        .filter_map(|k| {
            let mut rng = Rng::new(seed, &[k as u64]);
            let (a, b) = (lines[draw(&mut rng)].line.line, lines[draw(&mut rng)].line.line);
            let p = a.cross(b);
            (p.length() > 1e-9).then(|| p.normalize())
        })
        .collect();
    let agreements = exec::map(points.len(), job, |i| -> Vec<f32> {
        lines.iter().map(|e| e.agreement(points[i]) as f32).collect()
    })?;
    let mut weights: Vec<f32> = lines.iter().map(|e| e.weight as f32).collect();
    let mut found: Vec<DVec3> = Vec::new();
    // Weights only decrease, so an earlier score is an upper bound: most points need not be scored again.
    let mut bounds = vec![f32::INFINITY; points.len()];
    for _ in 0..count {
        let mut is_fresh = vec![false; points.len()];
        let strongest = loop {
            let Some((i, _)) = bounds.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) else { break None };
            if is_fresh[i] {
                break Some(i).filter(|&i| bounds[i] > 0.0);
            }
            bounds[i] = agreements[i].iter().zip(&weights).map(|(a, w)| a * w).sum();
            is_fresh[i] = true;
        };
        let Some(best) = strongest else { break };
        let start = unproject(points[best], focal);
        let point = project(refine(lines, start, focal).map_or(start, |r| r.direction), focal);
        for (w, (e, a)) in weights.iter_mut().zip(lines.iter().zip(&agreements[best])) {
            *w *= 1.0 - EXPLAINED_SHARE * a.max(e.agreement(point) as f32);
        }
        found.push(point);
    }
    Ok(found)
}

/// Generates the triplets to be scored: from each pair of candidates, from each candidate with a line that does not run
/// towards it, and from each candidate alone.
fn hypotheses(lines: &[WeightedLine], candidates: &[DVec3], focal: Option<f64>) -> Vec<Triplet> {
    let mut out = Vec::new();
    let given = focal.map(|f| [f]);
    let focals: &[f64] = given.as_ref().map_or(&FOCALS, |f| f);
    let mut push = |a: DVec3, b: DVec3, focal: f64| {
        let b = (b - a * a.dot(b)).normalize_or_zero();
        if b != DVec3::ZERO {
            out.push(Triplet { axes: DMat3::from_cols(a, b, a.cross(b)), focal, score: 0.0 });
        }
    };
    for (i, &p) in candidates.iter().enumerate() {
        // Pair two candidates. The focal length at which their directions are orthogonal is one hypothesis. If a
        // candidate is nearly at infinity, that focal length is unreliable. So also try each listed focal length at
        // which the directions are nearly orthogonal.
        for &q in &candidates[i + 1..] {
            let square = -(p.x * q.x + p.y * q.y) / (p.z * q.z);
            let implied = square.max(0.0).sqrt();
            if focal.is_none() && (FOCALS[0]..=FOCALS[6]).contains(&implied) {
                push(unproject(p, implied), unproject(q, implied), implied);
            }
            for &f in focals {
                let (a, b) = (unproject(p, f), unproject(q, f));
                if a.dot(b).abs() < MAX_COSINE {
                    push(a, b, f);
                }
            }
        }
        // Use the candidate alone, in case all lines run to this one vanishing point.
        let alone = unproject(p, focals[focals.len() / 2]);
        push(alone, alone.any_orthonormal_vector(), focals[focals.len() / 2]);
        // Pair the candidate with a long line that does not run towards it.
        for partner in lines.iter().filter(|e| e.agreement(p) == 0.0).take(PARTNERS) {
            for &f in focals {
                let l = partner.line.line;
                let a = unproject(p, f);
                push(a, a.cross(DVec3::new(l.x, l.y, l.z / f)).normalize_or_zero(), f);
            }
        }
    }
    out
}

/// Returns the weight of the lines that the triplet explains as a share of the total weight, minus the penalty of an
/// unusual focal length.
fn score(lines: &[WeightedLine], triplet: &Triplet) -> f64 {
    let points = [0, 1, 2].map(|k| project(triplet.axes.col(k), triplet.focal));
    let (mut explained, mut total) = (0.0, 0.0);
    for e in lines {
        explained += e.weight * points.iter().map(|&p| e.agreement(p)).fold(0.0, f64::max);
        total += e.weight;
    }
    let unusual = maths::ln(triplet.focal / USUAL_FOCAL) / SEARCH_SPREAD;
    explained / total - FOCAL_COST * unusual * unusual
}

fn similar(a: &Triplet, b: &Triplet) -> bool {
    let close = |d: DVec3| (0..3).any(|k| b.axes.col(k).dot(d).abs() > MIN_AXIS_COSINE);
    (0..3).all(|k| close(a.axes.col(k))) && maths::ln(a.focal / b.focal).abs() < MAX_FOCAL_LOG
}

/// Refines the axes and the focal length of a roughly known camera, so that more lines run to its vanishing points.
pub fn polished(lines: &[WeightedLine], axes: DMat3, focal: f64) -> Triplet {
    refine_jointly(lines, Triplet { axes, focal, score: 0.0 }, None)
}

/// Refines a triplet by at most 8 Gauss-Newton steps, jointly in a rotation vector and the logarithm of the focal
/// length; the lines are reweighted before each step. Returns the best of `start` and all steps, with its score.
/// A given `focal` stays fixed.
fn refine_jointly(lines: &[WeightedLine], start: Triplet, focal: Option<f64>) -> Triplet {
    let mut best = Triplet { score: score(lines, &start), ..start };
    let mut current = best;
    for _ in 0..8 {
        let mut normal = [[0.0; 4]; 4];
        let mut right = [0.0; 4];
        let mut scale = 0.0;
        let points = [0, 1, 2].map(|k| project(current.axes.col(k), current.focal));
        for e in lines {
            let Some((k, agreement)) =
                (0..3).map(|k| (k, e.agreement(points[k]))).max_by(|a, b| a.1.total_cmp(&b.1)).filter(|b| b.1 > 0.0)
            else {
                continue;
            };
            // The residual is the sine of the angle between the line l and the direction from its midpoint to the
            // vanishing point p = (dx, dy, dz / f) of the axis d. It equals l · p divided by the distance of p from the
            // midpoint. Compute the derivative of `l · p` with respect to the rotation vector and ln f, and treat the
            // distance as constant.
            let (l, d, p) = (e.line.line, current.axes.col(k), points[k]);
            let distance = (p.truncate() - e.line.centre * p.z).length();
            if distance < 1e-9 {
                continue;
            }
            let g = DVec3::new(l.x, l.y, l.z / current.focal) / distance;
            let by_rotation = d.cross(g);
            let by_focal = -l.z * p.z / distance;
            let derivative = [by_rotation.x, by_rotation.y, by_rotation.z, by_focal];
            let sine = l.dot(p) / distance;
            let weight = agreement * agreement * e.weight * e.stiffness;
            scale += agreement * agreement * e.weight;
            for r in 0..4 {
                for c in 0..4 {
                    normal[r][c] += weight * derivative[r] * derivative[c];
                }
                right[r] -= weight * derivative[r] * sine;
            }
        }
        // Add the prior of the focal length as a weak observation. A given focal length stays fixed by a large
        // diagonal term.
        let firmness = if focal.is_some() { FIXED_WEIGHT } else { 0.01 / (SEARCH_SPREAD * SEARCH_SPREAD) } * scale;
        normal[3][3] += firmness;
        if focal.is_none() {
            right[3] -= firmness * maths::ln(current.focal / USUAL_FOCAL);
        }
        for (r, row) in normal.iter_mut().enumerate() {
            row[r] += 1e-9 * scale;
        }
        let Some(step) = linear::solve(normal, right) else { break };
        let rotation = DMat3::from_quat(maths::rotation_by(DVec3::new(step[0], step[1], step[2])));
        let focal = if focal.is_some() {
            current.focal
        } else {
            (current.focal * maths::exp(step[3])).clamp(FOCAL_RANGE[0], FOCAL_RANGE[1])
        };
        current = Triplet { axes: rotation * current.axes, focal, score: 0.0 };
        current.score = score(lines, &current);
        if current.score > best.score {
            best = current;
        }
        if step.iter().all(|s| s.abs() < 1e-9) {
            break;
        }
    }
    best
}
