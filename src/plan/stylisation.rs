//! Plans a stylisation: chooses the most careful settings that fit in a given time, or the quickest settings that
//! reach a given error.

use super::{Clock, Expected, Goal};
use crate::error::Result;
use crate::job::Job;
use crate::stylize::{Input, Params, PilotRuns};

/// A planned stylisation.
#[derive(Clone, Debug, PartialEq)]
pub struct Stylisation {
    pub params: Params,
    /// The expected time and error. The error is the square root of the energy (StyLit, Eq. 3): the root mean square
    /// difference between matched patches in colours and guides.
    pub expected: Expected,
}

/// Plans a stylisation. Changes only the numbers of iterations and search iterations in `params`; ignores
/// `input.previous`.
///
/// # Errors
/// A goal or a setting out of range; the errors of [`crate::stylize::run`].
pub fn stylisation(input: &Input, params: &Params, goal: Goal, clock: Clock, job: Job) -> Result<Stylisation> {
    goal.check()?;
    let (ladder, usual) = ladder(params);
    let mut pilot = PilotRuns::new(input, &ladder, usual, clock, job.part(0.0, 0.6))?;
    // Measure the chosen settings at a higher resolution. Repeat if the prediction then prefers other settings.
    loop {
        let expected = (0..ladder.len()).map(|i| pilot.predict(i));
        let rungs: Vec<_> = expected.map(|t| Expected { seconds: t.seconds, error: t.energy.sqrt() }).collect();
        let best = chosen(&rungs, goal);
        if pilot.is_refined(best) {
            job.report(1.0);
            return Ok(Stylisation { params: ladder[best].clone(), expected: rungs[best] });
        }
        pilot.refine(best, job.part(0.6, 1.0))?;
    }
}

/// Returns a list of settings, in the order from quick to careful, and the index of the reference settings
/// (`Params::fast`) in this list. The settings come from the Pareto front in `benches/stylit.rs`.
fn ladder(params: &Params) -> (Vec<Params>, usize) {
    let rung = |like: &Params| Params {
        iterations: like.iterations,
        coarse_iterations: like.coarse_iterations,
        finest_iterations: like.finest_iterations,
        polish: like.polish,
        search_iterations: like.search_iterations,
        ..params.clone()
    };
    let (fast, full) = (Params::fast(), Params::default());
    let rungs = [
        Params { iterations: 1, coarse_iterations: 2, ..fast.clone() },
        fast,
        Params { polish: 1, ..full.clone() },
        full.clone(),
        Params { iterations: 8, coarse_iterations: 16, polish: 6, ..full },
    ];
    (rungs.iter().map(rung).collect(), 1)
}

/// Returns the index of the settings with the smallest error within the goal's time, or with the shortest time within
/// the goal's error. If no settings reach the goal, returns the index of the settings that come nearest to it.
fn chosen(rungs: &[Expected], goal: Goal) -> usize {
    let indices = 0..rungs.len();
    let quickest = |a: &usize, b: &usize| rungs[*a].seconds.total_cmp(&rungs[*b].seconds);
    let best = |a: &usize, b: &usize| rungs[*a].error.total_cmp(&rungs[*b].error);
    let chosen = match goal {
        Goal::Seconds(budget) => {
            let in_time = indices.clone().filter(|&i| rungs[i].seconds <= budget).min_by(best);
            in_time.or_else(|| indices.min_by(quickest))
        }
        Goal::Error(error) => {
            let near = indices.clone().filter(|&i| rungs[i].error <= error).min_by(quickest);
            near.or_else(|| indices.min_by(best))
        }
    };
    chosen.unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_settings_that_reach_the_goal_are_chosen() {
        let rungs =
            [(1.0, 0.4), (2.0, 0.3), (4.0, 0.31), (8.0, 0.2)].map(|(seconds, error)| Expected { seconds, error });
        for (goal, expected) in [
            (Goal::Seconds(0.5), 0),
            (Goal::Seconds(1.5), 0),
            (Goal::Seconds(5.0), 1),
            (Goal::Seconds(99.0), 3),
            (Goal::Error(0.5), 0),
            (Goal::Error(0.3), 1),
            (Goal::Error(0.25), 3),
            (Goal::Error(0.1), 3),
        ] {
            assert_eq!(chosen(&rungs, goal), expected, "{goal:?}");
        }
    }
}
