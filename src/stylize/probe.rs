//! What settings would take and leave, from runs at a part of the resolution.

use super::level::Problem;
use super::{Input, Params, schedule};
use crate::error::Result;
use crate::image::Image;
use crate::job::Job;
use std::time::Duration;

/// Most pixels that anything is tried on, of exemplar or target, whichever is smaller: a small exemplar has fewer patches for its
/// pixels, so what is left at low resolutions would say too little of higher ones.
const NEAR: usize = 128 << 10;
/// How many resolutions are tried.
const RESOLUTIONS: usize = 3;

/// What settings should take, and the energy that they should leave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trial {
    pub seconds: f64,
    /// As the last of [`super::LevelReport::energy`] on the finest level.
    pub energy: f64,
}

/// What stylisations with each of `ladder`, all of the same [`Params::preview`], should take and leave, `input.previous` aside.
/// The one at `usual` is tried at three resolutions, the highest of 32 to 128 thousand pixels, the others at the middle one.
///
/// Work grows with the number of pixels. Energy falls with their size, since paint and guides differ less between neighbours:
/// from one resolution to the next by a power that falls itself, as between those tried. How many times as much
/// one setting takes and leaves as another hardly depends on the resolution.
///
/// # Errors
/// As those of [`super::run`].
pub fn probe(
    input: &Input,
    ladder: &[Params],
    usual: usize,
    clock: &(dyn Fn() -> Duration + Sync),
    job: Job,
) -> Result<Vec<Trial>> {
    ladder.iter().try_for_each(Params::check)?;
    let input = Input { previous: None, motion: None, ..*input };
    let seconds_since = |start: Duration| clock().saturating_sub(start).as_secs_f64();

    // The problem, and all of its halves that are to be tried or lead there.
    let start = clock();
    let mut problems = vec![Problem::new(&input, &ladder[usual], job.part(0.0, 0.05))?];
    let preparing = seconds_since(start);
    let pixels = |image: &Image| image.width * image.height;
    let is_near = |problem: &Problem| pixels(&problem.style).min(pixels(&problem.guides.target)) <= NEAR;
    while let Some(last) = problems.last()
        && problems.iter().filter(|p| is_near(p)).count() < RESOLUTIONS
        && last.shortest_side() >= 4 * last.patch
    {
        problems.push(last.halve(job.part(0.05, 0.05))?);
    }
    let lowest = problems.len() - 1;
    let nearest = problems.iter().position(is_near).unwrap_or(lowest);
    let [middle, far] = [nearest + 1, nearest + 2].map(|i| i.min(lowest));

    let run = |at: usize, params: &Params, job: Job| -> Result<Trial> {
        let start = clock();
        let report = schedule::run(&problems[at], &input, params, &|_| (), job)?.report;
        let energy = report.levels.last().and_then(|l| l.energy.last()).copied().unwrap_or(0.0);
        Ok(Trial { seconds: seconds_since(start), energy })
    };
    let far = run(far, &ladder[usual], job.part(0.05, 0.1))?;
    let near = run(nearest, &ladder[usual], job.part(0.1, 0.5))?;
    let mut others = Vec::new();
    for (i, params) in ladder.iter().enumerate() {
        let share = |i: usize| 0.5 + 0.5 * i as f64 / ladder.len() as f64;
        others.push(run(middle, params, job.part(share(i), share(i + 1)))?);
    }

    // What the usual settings should come to, and the others beside them.
    let [all, tried] = [0, nearest].map(|at| pixels(&problems[at].guides.target) as f64);
    let times = all / tried;
    let energies = [far.energy, others[usual].energy, near.energy];
    let whole = Trial { seconds: near.seconds * times, energy: continued(energies, nearest) };
    let of = |value: f64, usual: f64| if usual > 0.0 { value / usual } else { 1.0 };
    let trial = |other: &Trial| Trial {
        seconds: preparing + whole.seconds * of(other.seconds, others[usual].seconds),
        energy: whole.energy * of(other.energy, others[usual].energy),
    };
    job.report(1.0);
    Ok(others.iter().map(trial).collect())
}

/// The energy so many resolutions above the last of three: from each to the next its logarithm changes as many times as much
/// as it changed the time before (Aitken 1926).
fn continued([far, middle, near]: [f64; 3], steps: usize) -> f64 {
    let step = |from: f64, to: f64| if from > 0.0 && to > 0.0 { (to / from).ln() } else { 0.0 };
    let [before, mut last] = [step(far, middle), step(middle, near)];
    let falls = if before == 0.0 { 1.0 } else { (last / before).clamp(0.5, 1.0) };
    let mut sum = 0.0;
    for _ in 0..steps {
        last *= falls;
        sum += last;
    }
    near * sum.exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energies_go_on_as_they_have_begun() {
        // By a power of the resolution; by one that falls; not at all.
        assert!((continued([64.0, 32.0, 16.0], 3) - 2.0).abs() < 1e-12);
        let falling = 4.0 * (0.5 * (0.64f64).ln() + 0.25 * (0.64f64).ln()).exp();
        assert!((continued([4.0 / 0.64f64.powi(3), 4.0 / 0.64, 4.0], 2) - falling).abs() < 1e-12, "{falling}");
        assert_eq!(continued([3.0, 3.0, 3.0], 4), 3.0);
        assert_eq!(continued([0.0, 0.0, 0.0], 4), 0.0);
        assert_eq!(continued([9.0, 5.0, 7.0], 0), 7.0);
    }
}
