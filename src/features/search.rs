//! Searches for the best box over all combinations of candidate sides.
//!
//! The face that a ray meets depends on two of the four sides: a side wall, and either the ceiling or the floor. The
//! score of a box is therefore a sum over the four quadrants of the view (see [`Quadrant`](super::score::Quadrant)).
//! The score of a quadrant is a table over the values of its two sides. This allows an exact optimum over all
//! combinations of many values: for every pair of distances to the left and to the right wall, the best ceiling and
//! the best floor are found independently. The best boxes that clearly differ from each other are then refined on
//! finer grids of values.

use super::box_room::{Face, Layout, faces, facing_axes};
use super::grow::Surfaces;
use super::input::{PlaneStroke, RoomView};
use super::score::Evidence;
use crate::error::{Error, Result};
use crate::exec;
use crate::image::try_collect;
use crate::job::Job;
use crate::maths;
use crate::simd::widest;
use glam::{DMat3, DVec2, DVec3};

/// `PRIOR_SIDE`: expected distance of a wall, ceiling or floor of which the photo shows nothing, in units of the
/// distance to the back wall. It is equal for all sides, so that the result does not depend on the photo's orientation.
/// `PRIOR_COST`: factor on the squared logarithm of the ratio of a side to `PRIOR_SIDE`. [bench features:layouts]
const PRIOR_SIDE: f64 = 0.4;
const PRIOR_COST: f64 = 0.01;
/// Reward if the positive strokes lie on the ceiling, because most lamps do. It decides where the camera looks up and
/// sees no walls: negative strokes on beams then favour a box whose back wall is the plane. Any value from 0.3 to 0.8
/// serves. [bench photos:tune]
const CEILING: f64 = 0.4;
/// For each side, the values `MIN_SIDE × RATIO^k` with `k < GRID` are tried besides the values that the segments
/// suggest. They run from 0.06 to 3.8. Seen from the camera, such a wall meets the back wall at 3° to 75° from the
/// perpendicular to the back wall; photos of rooms show no wider range. `RATIO` may have any value up to 1.1: the
/// refinements then reach every value between two neighbours. [convention]
const MIN_SIDE: f64 = 0.06;
const RATIO: f64 = 1.068;
const GRID: usize = 64;
/// Maximum number of candidate distances that the segments suggest for each side of the box.
const PEAKS: usize = 24;
/// A ray tells two boxes apart if it meets different faces in them, or faces whose distances differ by more than the
/// factor `MIN_RATIO`. Two boxes are clearly different if more than the share `MIN_DIFFERENT_SHARE` of the view's rays
/// tell them apart. [bench features:layouts]
const MIN_DIFFERENT_SHARE: f64 = 0.05;
const MIN_RATIO: f64 = 1.3;
/// Two boxes are compared along a grid of `RAYS × RAYS` rays over the photo.
const RAYS: usize = 9;
/// Maximum number of boxes that are refined.
const STARTS: usize = 6;
/// The trust in the best box. With `n` segments, its upper bound is `1 - exp(-n / TRUST_SEGMENTS)`, because few
/// segments agree with many boxes. The trust is `MIN_TRUST` times this bound if another, clearly different box has the
/// same score. With the lead of the best box over the other box, the trust rises towards the bound; at a lead of
/// `HALF_LEAD`, it has risen by half of the difference. The trust is not calibrated: these values only let it grow with
/// segments and lead. [convention]
const TRUST_SEGMENTS: f64 = 15.0;
const MIN_TRUST: f64 = 0.3;
const HALF_LEAD: f64 = 0.03;
/// `REFINEMENTS`: ratio of neighbouring values of a side in each of the two refinements. `VALUES_EITHER_SIDE`: number
/// of values tried on either side of the current value. Each refinement reaches beyond half a step of the grid before
/// it: 1.006^8 > √`RATIO` and 1.0008^8 > √1.006. [convention]
const REFINEMENTS: [f64; 2] = [1.006, 1.0008];
const VALUES_EITHER_SIDE: i32 = 8;
/// Number of partial maxima that are computed in parallel.
const LANES: usize = 8;

/// The sides of a box, and its score.
type ScoredBox = ([f64; 4], f64);

/// Finds the box that agrees best with the segments and strokes of a view, and with the surfaces over which the strokes
/// have grown. Returns an error if the room axes are not orthogonal unit vectors.
pub fn find(room: &RoomView, surfaces: Option<&Surfaces>, size: [usize; 2], job: Job) -> Result<Layout> {
    let axes = facing_axes(room.perspective);
    let orthogonality = (axes.transpose() * axes - DMat3::IDENTITY).to_cols_array();
    if !orthogonality.iter().all(|v| v.abs() < 1e-3) {
        return Err(Error::argument("room.perspective.axes must be orthogonal unit columns; see Perspective"));
    }
    let evidence = Evidence::gather(room, surfaces, &axes, size, job.part(0.0, 0.1))?;

    let values: [Vec<f64>; 4] = std::array::from_fn(|side| {
        let mut all = evidence.candidates(side, PEAKS);
        all.extend((0..GRID).map(|k| MIN_SIDE * maths::powi(RATIO, k as i32)));
        all
    });
    let coarse = Tables::new(&evidence, values, job.part(0.1, 0.4))?.best(job.part(0.4, 0.7))?;
    let view = rays(room, &axes, size);
    let mut starts: Vec<ScoredBox> = Vec::new();
    for found in &coarse {
        if starts.len() < STARTS && starts.iter().all(|s| differ(&view, &s.0, &found.0)) {
            starts.push(*found);
        }
    }

    // Refine each box on finer grids.
    let mut tops = Vec::with_capacity(starts.len());
    for start in starts {
        let mut top = start;
        for step in REFINEMENTS {
            let values = top
                .0
                .map(|side| (-VALUES_EITHER_SIDE..=VALUES_EITHER_SIDE).map(|k| side * maths::powi(step, k)).collect());
            let found = Tables::new(&evidence, values, job.part(0.7, 0.7))?.best(job.part(0.7, 0.7))?;
            top = found[0];
        }
        tops.push(top);
    }
    tops.sort_by(|a, b| b.1.total_cmp(&a.1));
    let best = tops[0];

    // Compute the confidence from the number of segments, and from the lead over the best box that clearly differs.
    let runner_up = |all: &[ScoredBox]| {
        let other = all.iter().find(|other| differ(&view, &other.0, &best.0));
        other.map_or(f64::NEG_INFINITY, |other| other.1)
    };
    let runner_up = runner_up(&tops).max(runner_up(&coarse));
    let lead = (best.1 - runner_up).max(0.0);
    let evidence_weight = 1.0 - maths::exp(-(evidence.len() as f64) / TRUST_SEGMENTS);
    job.report(1.0);
    Ok(Layout {
        sides: best.0,
        score: evidence.score(&best.0),
        trust: evidence_weight * (MIN_TRUST + (1.0 - MIN_TRUST) * lead / (lead + HALF_LEAD)),
    })
}

/// The strokes on one of several planes of a photo, and the surfaces over which they have grown.
pub struct PlaneEvidence<'a> {
    pub strokes: &'a [PlaneStroke<'a>],
    pub surfaces: Option<&'a Surfaces>,
}

/// Finds one box for several planes. The strokes of each plane lie on one face of the box, and the planes may lie on
/// different faces. The candidates are the best boxes of the single planes; the box is the candidate with which the
/// segments and the strokes of all planes agree best. Ignores `room.strokes`. The order of the planes does not matter.
pub fn find_common(room: &RoomView, planes: &[PlaneEvidence], size: [usize; 2], job: Job) -> Result<Layout> {
    let axes = facing_axes(room.perspective);
    let share = 1.0 / planes.len().max(1) as f64;
    let (mut candidates, mut evidence) = (Vec::new(), Vec::new());
    for (k, plane) in planes.iter().enumerate() {
        let part = job.part(share * k as f64, (share * (k + 1) as f64).min(1.0));
        let room = RoomView { strokes: plane.strokes, ..*room };
        candidates.push(find(&room, plane.surfaces, size, part)?);
        evidence.push(Evidence::gather(&room, plane.surfaces, &axes, size, part)?);
    }
    // Add up the strokes in ascending order, so that the sum does not depend on the order of the planes.
    let agreement = |layout: &Layout| {
        let mut strokes: Vec<f64> = evidence.iter().map(|plane| plane.strokes_on_best_face(&layout.sides)).collect();
        strokes.sort_by(f64::total_cmp);
        layout.score - layout.sides.map(prior_cost).iter().sum::<f64>() + strokes.iter().sum::<f64>()
    };
    let rank = |layout: &Layout| (agreement(layout), layout.sides, layout.trust);
    let best = candidates.into_iter().max_by(|a, b| {
        let ((a, a_sides, a_trust), (b, b_sides, b_trust)) = (rank(a), rank(b));
        let sides = || a_sides.iter().zip(&b_sides).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
        a.total_cmp(&b).then_with(|| sides().unwrap_or(a_trust.total_cmp(&b_trust)))
    });
    best.ok_or_else(|| Error::argument("there is no plane; give the strokes of at least one"))
}

/// Cost of the distance of one side, by the prior.
fn prior_cost(side: f64) -> f64 {
    PRIOR_COST * maths::powi(maths::ln(side / PRIOR_SIDE), 2)
}

/// Returns rays over the whole photo, in room axes.
fn rays(room: &RoomView, axes: &DMat3, [width, height]: [usize; 2]) -> Vec<DVec3> {
    let to_room = axes.transpose();
    let places = |n: usize| (0..RAYS).map(move |i| (i as f64 + 0.5) / RAYS as f64 * n as f64);
    let points = places(height).flat_map(|y| places(width).map(move |x| DVec2::new(x, y)));
    points.map(|p| to_room * room.perspective.ray(p)).collect()
}

fn differ(view: &[DVec3], a: &[f64; 4], b: &[f64; 4]) -> bool {
    let is_other = |ray: &&DVec3| {
        let ((face, there), (other, here)) = (faces(a, **ray)[0], faces(b, **ray)[0]);
        face != other || there > here * MIN_RATIO || here > there * MIN_RATIO
    };
    view.iter().filter(is_other).count() as f64 > MIN_DIFFERENT_SHARE * view.len() as f64
}

/// The score of each quadrant, as a table over the values of its two sides: rows for the wall, columns for the ceiling
/// or floor. `parts` holds one set of four tables for each face that may be the plane of the strokes.
struct Tables {
    values: [Vec<f64>; 4],
    parts: Vec<[Vec<f64>; 4]>,
}

impl Tables {
    fn new(evidence: &Evidence, values: [Vec<f64>; 4], job: Job) -> Result<Self> {
        // Without positive strokes, one set of tables suffices. Otherwise each face may be the plane on which these
        // strokes lie, and gets its own set of tables.
        let planes = if evidence.has_plane { &Face::ALL[..] } else { &Face::ALL[..1] };
        // The box as a whole gets the reward, so each quadrant gets a quarter of it.
        let reward = |face: Face| if evidence.has_plane && face == Face::Ceiling { 0.25 * CEILING } else { 0.0 };
        // Each task fills one row of the table of one quadrant.
        let rows = [0, 1, 2, 3].map(|part| values[part % 2].len());
        let tasks: Vec<(usize, usize)> = (0..4).flat_map(|part| (0..rows[part]).map(move |row| (part, row))).collect();
        let filled = exec::map(tasks.len(), job, |task| {
            let (part, row) = tasks[task];
            let (wall, level) = (part % 2, 2 + part / 2);
            let quadrant = &evidence.quadrants[part];
            let at = values[wall][row];
            let entry = |&height: &f64| {
                // Each side of the box belongs to two quadrants, so each quadrant counts half of the prior cost of the
                // side.
                let prior = -0.5 * (prior_cost(at) + prior_cost(height));
                let lines = quadrant.lines(1.0 / at, 1.0 / height) + prior;
                let strokes = quadrant.strokes(1.0 / at, 1.0 / height);
                let here = |face: Face| match face {
                    Face::Left | Face::Right if face as usize == wall => strokes[0],
                    Face::Ceiling | Face::Floor if face as usize == level => strokes[1],
                    Face::Back => strokes[2],
                    _ => 0.0,
                };
                Face::ALL.map(|face| lines + here(face) + reward(face))
            };
            values[level].iter().map(entry).collect::<Vec<_>>()
        })?;
        let mut parts: Vec<[Vec<f64>; 4]> = planes.iter().map(|_| Default::default()).collect();
        for ((part, _), row) in tasks.iter().zip(&filled) {
            for (plane, tables) in parts.iter_mut().enumerate() {
                tables[*part].extend(row.iter().map(|entry| entry[plane]));
            }
        }
        Ok(Self { values, parts })
    }

    /// Returns the best box for every pair of distances to the left and to the right wall, sorted by decreasing score.
    fn best(&self, job: Job) -> Result<Vec<ScoredBox>> {
        let [lefts, rights, tops, bottoms] = self.values.each_ref().map(Vec::len);
        let found = exec::map(lefts, job, |left| -> Vec<ScoredBox> {
            let of_right = |right: usize| {
                let best = self.parts.iter().map(|[lt, rt, lb, rb]| {
                    let top = (&lt[left * tops..][..tops], &rt[right * tops..][..tops]);
                    let bottom = (&lb[left * bottoms..][..bottoms], &rb[right * bottoms..][..bottoms]);
                    (largest_sum(top.0, top.1) + largest_sum(bottom.0, bottom.1), [top, bottom])
                });
                let (value, [top, bottom]) = best.reduce(|a, b| if b.0 > a.0 { b } else { a }).expect("a plane");
                let level = |side: usize, (a, b): (&[f64], &[f64])| self.values[side][largest_sum_at(a, b)];
                ([self.values[0][left], self.values[1][right], level(2, top), level(3, bottom)], value)
            };
            (0..rights).map(of_right).collect()
        })?;
        let mut found = try_collect(found.into_iter().flatten())?;
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(found)
    }
}

widest! {
/// Returns the largest sum of two items at equal positions of the lists.
fn largest_sum(a: &[f64], b: &[f64]) -> f64 {
    let mut largest = [f64::NEG_INFINITY; LANES];
    let (a, b) = (a.chunks(LANES), b.chunks(LANES));
    for (a, b) in a.zip(b) {
        for ((maximum, a), b) in largest.iter_mut().zip(a).zip(b) {
            let sum = a + b;
            *maximum = if sum > *maximum { sum } else { *maximum };
        }
    }
    largest.into_iter().fold(f64::NEG_INFINITY, f64::max)
}
}

fn largest_sum_at(a: &[f64], b: &[f64]) -> usize {
    let sums = a.iter().zip(b).map(|(a, b)| a + b).enumerate();
    sums.reduce(|a, b| if b.1 > a.1 { b } else { a }).map_or(0, |(at, _)| at)
}
