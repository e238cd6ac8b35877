//! Predicts, for given settings, the run time and the final energy (the objective function, StyLit, Eq. 3) from pilot
//! runs at reduced resolution.

use super::level::Problem;
use super::multires;
use super::params::{Input, Params};
use crate::error::Result;
use crate::image::Image;
use crate::job::Job;
use crate::maths;
use std::time::Duration;

/// Maximum number of pixels in a pilot run, counted in the smaller of exemplar and target. If the larger of the two
/// were counted, a small exemplar could be reduced to so few patches that the energies would predict the final energy
/// poorly.
const MAX_PIXELS: usize = 128 << 10;
/// Number of resolutions of the pilot runs.
const RESOLUTIONS: usize = 3;

/// Predicted run time of a stylisation in seconds, and predicted energy (StyLit, Eq. 3) of its result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prediction {
    pub seconds: f64,
    /// Energy after the last iteration on the finest level: see [`super::LevelReport::energy`].
    pub energy: f64,
}

/// Maximum of the exponent e in: time per pixel proportional to nᵉ, where n is the number of pixels. The time per pixel
/// grows because larger fields converge more slowly. [bench plan:stylisations]
const MAX_GROWTH: f64 = 0.12;

/// Pilot runs of several settings on one input. `ladder` holds the settings, and `usual` is the index of the reference
/// settings in `ladder`. `preparing` is the time in seconds that it took to form the problem at full resolution.
pub struct PilotRuns<'a> {
    input: Input<'a>,
    ladder: &'a [Params],
    usual: usize,
    clock: &'a (dyn Fn() -> Duration + Sync),
    /// The problem at full resolution, followed by the problems at successively halved resolutions, down to the lowest
    /// resolution used.
    problems: Vec<Problem>,
    preparing: f64,
    /// Measurements at the highest pilot resolution, one per element of `ladder`. The reference settings have one from
    /// the start, other settings after [`Self::refine`]; until then `None`.
    near: Vec<Option<Prediction>>,
    /// Measurements of all settings at the second highest pilot resolution.
    middle: Vec<Prediction>,
    /// Predicted energy of the reference settings at full resolution.
    energy: f64,
}

impl<'a> PilotRuns<'a> {
    /// Runs all settings in `ladder`, which must have the same [`Params::preview`]. Ignores the previous frame and the
    /// motion in `input`. The reference settings, at index `usual`, run at three resolutions. At the highest of these,
    /// the smaller of exemplar and target has 32 to 128 thousand pixels, or all of its pixels if it has fewer. All
    /// other settings run at the middle resolution.
    ///
    /// # Errors
    /// The errors of [`super::run`].
    pub fn new(
        input: &Input<'a>,
        ladder: &'a [Params],
        usual: usize,
        clock: &'a (dyn Fn() -> Duration + Sync),
        job: Job,
    ) -> Result<Self> {
        ladder.iter().try_for_each(Params::check)?;
        let input = Input { previous: None, motion: None, ..*input };

        // Form the problem and all its halves down to the lowest resolution used.
        let start = clock();
        let mut problem = Problem::new(&input, &ladder[usual], job.part(0.0, 0.05))?;
        problem.guide_record = None;
        let mut problems = vec![problem];
        let preparing = clock().saturating_sub(start).as_secs_f64();
        while let Some(last) = problems.last()
            && problems.iter().filter(|p| is_near(p)).count() < RESOLUTIONS
            && last.shortest_side() >= 4 * last.patch
        {
            problems.push(last.halve(job.part(0.05, 0.05))?);
        }

        let (near, middle) = (vec![None; ladder.len()], Vec::new());
        let mut pilot = Self { input, ladder, usual, clock, problems, preparing, near, middle, energy: 0.0 };
        let [nearest, middle, far] = pilot.tried();
        let far = pilot.run(far, usual, job.part(0.05, 0.1))?;
        let near = pilot.run(nearest, usual, job.part(0.1, 0.5))?;
        for i in 0..ladder.len() {
            let share = |i: usize| 0.5 + 0.5 * i as f64 / ladder.len() as f64;
            let predict = pilot.run(middle, i, job.part(share(i), share(i + 1)))?;
            pilot.middle.push(predict);
        }
        pilot.energy = extrapolate([far.energy, pilot.middle[usual].energy, near.energy], nearest);
        pilot.near[usual] = Some(near);
        job.report(1.0);
        Ok(pilot)
    }

    /// Returns the indices of the pilot resolutions in `problems`, the highest resolution first.
    fn tried(&self) -> [usize; RESOLUTIONS] {
        let lowest = self.problems.len() - 1;
        let nearest = self.problems.iter().position(is_near).unwrap_or(lowest);
        [nearest, nearest + 1, nearest + 2].map(|i| i.min(lowest))
    }

    fn run(&self, at: usize, settings: usize, job: Job) -> Result<Prediction> {
        let start = (self.clock)();
        let report = multires::run(&self.problems[at], None, &self.input, &self.ladder[settings], &|_| (), job)?.report;
        let energy = report.levels.last().and_then(|l| l.energy.last()).copied().unwrap_or(0.0);
        Ok(Prediction { seconds: (self.clock)().saturating_sub(start).as_secs_f64(), energy })
    }

    /// Runs the settings with the index `settings` at the highest pilot resolution, unless this was done before.
    ///
    /// # Errors
    /// The errors of [`super::run`].
    pub fn refine(&mut self, settings: usize, job: Job) -> Result<()> {
        if self.near[settings].is_none() {
            self.near[settings] = Some(self.run(self.tried()[0], settings, job)?);
        }
        Ok(())
    }

    /// Whether the settings with the index `settings` have been run at the highest pilot resolution.
    pub fn is_refined(&self, settings: usize) -> bool {
        self.near[settings].is_some()
    }

    /// Predicts time and energy at full resolution of the settings with the index `settings`.
    ///
    /// - Time grows linearly with the number of pixels, or by a slightly higher power if the settings converge slowly.
    ///   The power is estimated from the two higher pilot resolutions.
    /// - Energy falls as pixels become smaller, because neighbouring pixels of paint and guides differ less. The
    ///   factor by which it falls from one resolution to the next approaches 1 and is extrapolated from the pilot runs
    ///   of the reference settings.
    /// - The ratio of the energies of two settings hardly depends on the resolution.
    pub fn predict(&self, settings: usize) -> Prediction {
        let [all, tried, middle] =
            [0, self.tried()[0], self.tried()[1]].map(|at| pixels(&self.problems[at].guides.target) as f64);
        let ratio = |value: f64, usual: f64| if usual > 0.0 { value / usual } else { 1.0 };
        // If the settings ran only at the middle resolution, compute their time and energy at this resolution relative
        // to the reference settings. Assume the same ratios at the highest pilot resolution.
        let usual = self.near[self.usual].unwrap_or_default();
        let [here, its_usual] = [settings, self.usual].map(|i| self.middle[i]);
        let near = self.near[settings].unwrap_or(Prediction {
            seconds: usual.seconds * ratio(here.seconds, its_usual.seconds),
            energy: usual.energy * ratio(here.energy, its_usual.energy),
        });
        let more = maths::ln(ratio(tried, middle));
        let growth = if more > 0.0 { maths::ln(ratio(near.seconds, here.seconds)) / more - 1.0 } else { 0.0 };
        let seconds = near.seconds * maths::powf(ratio(all, tried), 1.0 + growth.clamp(0.0, MAX_GROWTH));
        Prediction { seconds: self.preparing + seconds, energy: self.energy * ratio(near.energy, usual.energy) }
    }
}

fn pixels(image: &Image) -> usize {
    image.width * image.height
}

fn is_near(problem: &Problem) -> bool {
    pixels(&problem.style).min(pixels(&problem.guides.target)) <= MAX_PIXELS
}

/// Extrapolates the energies at three resolutions by `steps` further resolutions. Each change of the energy's logarithm
/// from one resolution to the next is a constant fraction of the previous change (Aitken 1926). The fraction is the
/// ratio of the two measured changes, limited to `[0.5, 1]`.
fn extrapolate([far, middle, near]: [f64; 3], steps: usize) -> f64 {
    let step = |from: f64, to: f64| if from > 0.0 && to > 0.0 { maths::ln(to / from) } else { 0.0 };
    let [before, mut last] = [step(far, middle), step(middle, near)];
    let falls = if before == 0.0 { 1.0 } else { (last / before).clamp(0.5, 1.0) };
    let mut sum = 0.0;
    for _ in 0..steps {
        last *= falls;
        sum += last;
    }
    near * maths::exp(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energies_go_on_as_they_have_begun() {
        // The energy falls by a constant factor, by factors that approach 1, or not at all.
        assert!((extrapolate([64.0, 32.0, 16.0], 3) - 2.0).abs() < 1e-12);
        let falling = 4.0 * (0.5 * (0.64f64).ln() + 0.25 * (0.64f64).ln()).exp();
        assert!((extrapolate([4.0 / 0.64f64.powi(3), 4.0 / 0.64, 4.0], 2) - falling).abs() < 1e-12, "{falling}");
        assert_eq!(extrapolate([3.0, 3.0, 3.0], 4), 3.0);
        assert_eq!(extrapolate([0.0, 0.0, 0.0], 4), 0.0);
        assert_eq!(extrapolate([9.0, 5.0, 7.0], 0), 7.0);
    }
}
