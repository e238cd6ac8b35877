//! Solves for the powers of groups of lamps that best meet several lighting goals, within bounds.
//!
//! Radiance is linear in the powers `x`. The best powers minimise `Σ w² ((b + Σ r x − t) / s)²` ("Painting with light",
//! Schoeneman et al. 1993). The outer sum is over goals and channels, the inner sum over groups. For each goal, `w` is
//! the weight, `b` the radiance from all other light, `r` the response to a group, `t` the target and `s` the brightest
//! channel of the target.
//!
//! A small regularisation towards equal powers is added, because the goals may leave some powers open. With one group
//! and one goal, the solution is the closed form of [`super::run`].
//!
//! If a goal is a lower or an upper limit, its residual counts only if the limit is violated ([`Constraint`]).
//!
//! Each residual is the residual of a mean over many paths. Single texels are not compared with the photo, because
//! their noise would bias the powers towards dark.

use super::dimming::Terms;
use super::estimate::{BATCHES, STUDENT_T, mean, standard_error};
use super::responses::{Aspect, Estimate, Goal, Responses};
use super::sided::{self, Constraint, OneSidedLeastSquares};
use super::solution::TargetStatus;
use crate::error::{Error, ErrorKind, Result, check_range};
use crate::exec;
use crate::image::try_vec;
use crate::job::Job;
use glam::DVec3;

/// Luminance of linear RGB ([`crate::image::colour::luminance`]). [convention: ITU-R BT.709]
pub(super) const LUMINANCE: DVec3 = DVec3::new(0.212_639, 0.715_168_7, 0.072_192_3);

/// Maximum number of dimming levels. \[convention\]
pub const MAX_LEVELS: usize = 4096;

/// Maximum weight of a goal; squared weights stay far from overflow. \[convention\]
pub const MAX_WEIGHT: f64 = 1e12;

/// Whether the colour of a group may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// One power for all channels: the colour stays.
    Common,
    /// One power per channel: the colour may change.
    PerChannel,
}

#[derive(Clone, Debug, PartialEq)]
pub struct GroupParams {
    pub colour: Colour,
    /// Maximum multiplier of each group's emission, ≥ 0, may be infinite; empty for no bounds.
    pub max_scale: Vec<f64>,
    /// Available multipliers (dimming levels), each ≥ 0, at most [`MAX_LEVELS`] of them; empty for continuous dimming.
    /// Groups get the levels that together best meet the goals ([`super::dimming`]). The confidence intervals of the
    /// powers then include the difference from the continuous powers.
    pub levels: Vec<f64>,
    /// Weight of the regularisation towards equal powers, relative to the mean squared norm of the rows of the least
    /// squares problem; in `[1e-9, 1e3]`. With a small weight the powers meet the goals, with a large weight they stay
    /// equal.
    pub regularisation: f64,
    /// A goal counts as met if it misses its target by at most this share of the target's brightest channel, plus the
    /// half-width of the 95 % confidence interval; in `[1e-6, 1]`.
    pub tolerance: f64,
}

impl Default for GroupParams {
    fn default() -> Self {
        Self {
            colour: Colour::Common,
            max_scale: Vec::new(),
            levels: Vec::new(),
            regularisation: 1e-6,
            tolerance: 0.01,
        }
    }
}

/// The result for one goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Mean radiance of the goal's surface or grid, in cd/m² per channel.
    pub achieved: DVec3,
    /// Half-widths of the 95 % confidence intervals of `achieved`, for fixed powers.
    pub half_width: DVec3,
    pub status: [TargetStatus; 3],
}

#[derive(Clone, Debug, PartialEq)]
pub struct GroupSolution {
    /// Multipliers of the emission of each group, ≥ 0.
    pub scale: Vec<DVec3>,
    /// Half-widths of the 95 % confidence intervals of `scale`, by the jackknife over batches of paths. A half-width
    /// is 0 if the power is at its bound in all solutions of the jackknife. With dimming levels, the distance between
    /// the chosen level and the continuous power is added.
    pub half_width: Vec<DVec3>,
    pub outcomes: Vec<Outcome>,
    /// The reason why goals of positive weight are missed; `None` if all of them are met. If goals are missed, the
    /// powers are the best within the bounds.
    pub unreachable: Option<String>,
}

/// Solves for the powers of groups of lamps. `responses` are the responses to the groups ([`Responses::grouped`]).
/// They must have been traced for goals with the same places and quantities; other properties of the goals may differ.
///
/// Returns an `Unreachable` error if no goal gets light from any group. Also fails if parameters are out of range or
/// the job is cancelled.
pub fn solve_groups(responses: &Responses, goals: &[Goal], params: &GroupParams, job: Job) -> Result<GroupSolution> {
    check(responses, goals, params)?;
    let system = System { responses, goals, params };
    let everything = system.means(job)?;
    if everything.rows.iter().flatten().all(|r| *r == DVec3::ZERO) {
        return Err(Error::new(
            ErrorKind::Unreachable,
            "no light of any group finds its way to a goal: they may face away, or everything around may be black; \
             choose other goals or lamps",
        ));
    }
    let whole = system.solve(&everything)?;
    let without = |b| system.solve(&system.means_without(&everything, b));
    let rest = exec::map(BATCHES, job, without)?.into_iter().collect::<Result<Vec<_>>>()?;

    let mut half_width = whole.jackknife(&rest, job)?.colours();
    let whole = whole.colours();
    let scale = if params.levels.is_empty() { whole.clone() } else { system.stepped(&everything, &whole) };
    for (width, (scale, whole)) in half_width.iter_mut().zip(scale.iter().zip(&whole)) {
        *width += (*scale - *whole).abs();
    }
    let outcomes = (0..goals.len()).map(|goal| system.outcome(goal, &scale, job)).collect::<Result<Vec<_>>>()?;
    let unreachable = system.explain(&outcomes, &scale);
    Ok(GroupSolution { scale, half_width, outcomes, unreachable })
}

/// Number of groups processed per task. [convention]
const GROUPS_PER_RUN: usize = 1024;

/// The power of each group: one list for all channels, or one list per channel.
struct Powers(Vec<Vec<f64>>);

impl Powers {
    fn colours(&self) -> Vec<DVec3> {
        match self.0.as_slice() {
            [r, g, b] => r.iter().zip(g).zip(b).map(|((r, g), b)| DVec3::new(*r, *g, *b)).collect(),
            lists => lists.iter().flatten().map(|x| DVec3::splat(*x)).collect(),
        }
    }

    /// Computes the half-widths of the 95 % confidence intervals of all groups by the jackknife
    /// ([`super::estimate::pseudo_values`]). `without` holds, for each batch, the powers solved without this batch.
    /// The pseudo-values are not computed: their standard deviation is `n - 1` times the standard deviation of the
    /// powers in `without`.
    fn jackknife(&self, without: &[Self], job: Job) -> Result<Self> {
        let n = BATCHES as f64;
        let width = |list: usize| {
            let mut widths = try_vec(self.0[list].len(), 0.0)?;
            exec::for_runs(&mut widths, GROUPS_PER_RUN, job, |first, widths| {
                let answers = || without.iter().map(|powers| &powers.0[list][first..]);
                let mut means = [0.0; GROUPS_PER_RUN];
                for answer in answers() {
                    means.iter_mut().zip(answer).for_each(|(mean, power)| *mean += power / n);
                }
                for answer in answers() {
                    let off = answer.iter().zip(&means).map(|(power, mean)| power - mean);
                    widths.iter_mut().zip(off).for_each(|(sum, off)| *sum += off * off);
                }
                widths.iter_mut().for_each(|square| *square = STUDENT_T * (*square * (n - 1.0) / n).sqrt());
            })?;
            Ok(widths)
        };
        (0..self.0.len()).map(width).collect::<Result<_>>().map(Self)
    }
}

fn check(responses: &Responses, goals: &[Goal], params: &GroupParams) -> Result<()> {
    if goals.len() != responses.goals() {
        return Err(Error::argument(format!(
            "there are {} goals, but responses of {}",
            goals.len(),
            responses.goals()
        )));
    }
    for goal in goals {
        for channel in goal.target.to_array() {
            check_range("target", channel, 0.0, f32::MAX)?;
        }
        check_range("weight", goal.weight, 0.0, MAX_WEIGHT)?;
        if goal.aspect == Aspect::Luminance && goal.constraint != [goal.constraint[0]; 3] {
            return Err(Error::argument("a goal of luminance has limits that differ between channels; give it one"));
        }
    }
    if params.colour == Colour::PerChannel && goals.iter().any(|g| g.aspect == Aspect::Luminance) {
        return Err(Error::argument(
            "a goal asks for luminance alone, which says nothing about channels that are free: keep the groups' colours",
        ));
    }
    check_range("regularisation", params.regularisation, 1e-9, 1e3)?;
    check_range("tolerance", params.tolerance, 1e-6, 1.0)?;
    if !params.max_scale.is_empty() && params.max_scale.len() != responses.lamps() {
        return Err(Error::argument(format!(
            "bounds are given for {} of {} groups",
            params.max_scale.len(),
            responses.lamps()
        )));
    }
    params.max_scale.iter().try_for_each(|&max| check_range("max_scale", max, 0.0, f64::INFINITY).map(drop))?;
    if params.levels.len() > MAX_LEVELS {
        return Err(Error::argument(format!("there are {} levels; at most {MAX_LEVELS} may be", params.levels.len())));
    }
    params.levels.iter().try_for_each(|&level| check_range("level", level, 0.0, f64::MAX).map(drop))
}

struct System<'a> {
    responses: &'a Responses,
    goals: &'a [Goal<'a>],
    params: &'a GroupParams,
}

/// The equations of all goals: one row per residual.
#[derive(Default)]
struct Equations {
    groups: usize,
    matrix: Vec<f64>,
    right: Vec<f64>,
    constraints: Vec<Constraint>,
}

impl Equations {
    fn solve(&self, upper: &[f64], regularisation: f64) -> Result<Vec<f64>> {
        // Regularise towards equal powers: compute the common power of all lamps that meets the goals best.
        let together: Vec<f64> = self.matrix.chunks_exact(self.groups).map(|row| row.iter().sum()).collect();
        let equal = sided::common_power(&together, &self.right, &self.constraints);
        let preferred: Vec<f64> = upper.iter().map(|u| equal.min(*u)).collect();
        let Self { matrix, right, constraints, .. } = self;
        OneSidedLeastSquares { matrix, right, constraints, regularisation, preferred: &preferred, upper }.solve()
    }
}

/// Responses and backgrounds, averaged over batches.
struct MeanResponses {
    /// For each goal, the response to each group.
    rows: Vec<Vec<DVec3>>,
    background: Vec<DVec3>,
}

impl System<'_> {
    /// Returns the means over all batches.
    fn means(&self, job: Job) -> Result<MeanResponses> {
        let n = BATCHES as f64;
        let mean = |goal: usize| {
            let mut means = try_vec(self.responses.lamps(), DVec3::ZERO)?;
            exec::for_runs(&mut means, GROUPS_PER_RUN, job, |first, means| {
                for b in 0..BATCHES {
                    means.iter_mut().zip(&self.responses.batch(goal, b)[first..]).for_each(|(s, r)| *s += *r);
                }
                means.iter_mut().for_each(|s| *s /= n);
            })?;
            Ok(means)
        };
        let background = |goal| (0..BATCHES).map(|b| self.responses.background_of_batch(goal, b)).sum::<DVec3>() / n;
        let goals = 0..self.goals.len();
        Ok(MeanResponses {
            rows: goals.clone().map(mean).collect::<Result<_>>()?,
            background: goals.map(background).collect(),
        })
    }

    /// Returns the means over all batches but one.
    fn means_without(&self, all: &MeanResponses, batch: usize) -> MeanResponses {
        // Clamp the mean without the batch to 0, because rounding may make it negative.
        let rest = |mean: &DVec3, part: DVec3| {
            let n = BATCHES as f64;
            ((*mean * n - part) / (n - 1.0)).max(DVec3::ZERO)
        };
        let row = |(goal, row): (usize, &Vec<DVec3>)| {
            row.iter().zip(self.responses.batch(goal, batch)).map(|(mean, part)| rest(mean, *part)).collect()
        };
        let other = |(goal, mean): (usize, &DVec3)| rest(mean, self.responses.background_of_batch(goal, batch));
        MeanResponses {
            rows: all.rows.iter().enumerate().map(row).collect(),
            background: all.background.iter().enumerate().map(other).collect(),
        }
    }

    fn solve(&self, measured: &MeanResponses) -> Result<Powers> {
        let upper = self.upper();
        self.by_channels(|channels| self.equations(measured, channels).solve(&upper, self.params.regularisation))
    }

    /// Replaces the powers by the dimming levels that together best meet the goals ([`super::dimming`]).
    fn stepped(&self, measured: &MeanResponses, whole: &[DVec3]) -> Vec<DVec3> {
        let upper = self.upper();
        let mut levels = self.params.levels.clone();
        levels.sort_by(f64::total_cmp);
        let round = |channels: &[usize]| {
            let x: Vec<f64> = whole.iter().map(|x| x[channels[0]]).collect();
            let Equations { matrix, right, constraints, .. } = &self.equations(measured, channels);
            Ok(Terms { matrix, right, constraints }.round(&x, &levels, &upper))
        };
        // `by_channels` cannot fail here, because `round` never does.
        self.by_channels(round).map_or_else(|_| whole.to_vec(), |powers| powers.colours())
    }

    /// Returns the maximum power of each group; infinite if no bounds are given.
    fn upper(&self) -> Vec<f64> {
        if self.params.max_scale.is_empty() {
            vec![f64::INFINITY; self.responses.lamps()]
        } else {
            self.params.max_scale.clone()
        }
    }

    /// Calls `solve` once for all channels together, or once for each channel, as `params.colour` says. Collects the
    /// powers.
    fn by_channels(&self, solve: impl Fn(&[usize]) -> Result<Vec<f64>>) -> Result<Powers> {
        let channels: &[&[usize]] = match self.params.colour {
            Colour::Common => &[&[0, 1, 2]],
            Colour::PerChannel => &[&[0], &[1], &[2]],
        };
        channels.iter().map(|channels| solve(channels)).collect::<Result<_>>().map(Powers)
    }

    /// Sets up the equations of all goals for the given channels.
    fn equations(&self, measured: &MeanResponses, channels: &[usize]) -> Equations {
        let mut equations = Equations { groups: self.responses.lamps(), ..Equations::default() };
        for ((goal, row), background) in self.goals.iter().zip(&measured.rows).zip(&measured.background) {
            let target = goal.target.as_dvec3();
            let terms: Vec<(DVec3, Constraint)> = match goal.aspect {
                Aspect::Colour => channels.iter().map(|&c| (DVec3::AXES[c], goal.constraint[c])).collect(),
                Aspect::Luminance => vec![(LUMINANCE, goal.constraint[0])],
            };
            // Divide the residuals of a goal by the brightest channel of its target, or of the radiance under all lamps
            // if the target is black. If both are black, the goal has no weight.
            let bright = target.max_element();
            let size = if bright > 0.0 { bright } else { row.iter().sum::<DVec3>().max_element() };
            let weight = if size > 0.0 { goal.weight / size } else { 0.0 };
            for (part, constraint) in terms {
                equations.matrix.extend(row.iter().map(|r| r.dot(part) * weight));
                equations.right.push((target - background).dot(part) * weight);
                equations.constraints.push(constraint);
            }
        }
        equations
    }

    fn outcome(&self, goal: usize, scale: &[DVec3], job: Job) -> Result<Outcome> {
        let light = exec::map(BATCHES, job, |b| {
            let lamps = self.responses.batch(goal, b).iter().zip(scale).map(|(r, x)| r * x).sum::<DVec3>();
            lamps + self.responses.background_of_batch(goal, b)
        })?;
        let light = |b: usize| light[b];
        let all = Estimate::of(light);
        let goal_of = &self.goals[goal];
        let target = goal_of.target.as_dvec3();
        let brightest = target.max_element();
        let judge = |part: DVec3, constraint: Constraint| {
            let batches: [f64; BATCHES] = std::array::from_fn(|b| light(b).dot(part));
            let miss = constraint.miss(mean(&batches) - target.dot(part));
            let allowed = self.params.tolerance * brightest + STUDENT_T * standard_error(&batches);
            let dark = (0..BATCHES).all(|b| self.responses.batch(goal, b).iter().all(|r| r.dot(part) == 0.0));
            match () {
                () if miss.abs() <= allowed => TargetStatus::Met,
                () if miss > 0.0 => TargetStatus::TooBright,
                () if dark => TargetStatus::Dark,
                () => TargetStatus::TooDim,
            }
        };
        let status = match goal_of.aspect {
            Aspect::Colour => std::array::from_fn(|c| judge(DVec3::AXES[c], goal_of.constraint[c])),
            Aspect::Luminance => [judge(LUMINANCE, goal_of.constraint[0]); 3],
        };
        Ok(Outcome { achieved: all.mean, half_width: all.half_width(), status })
    }

    /// Explains why goals of positive weight are missed; `None` if all goals of positive weight are met.
    fn explain(&self, outcomes: &[Outcome], scale: &[DVec3]) -> Option<String> {
        let missed: Vec<usize> = (0..outcomes.len())
            .filter(|&g| self.goals[g].weight > 0.0 && outcomes[g].status.iter().any(|r| *r != TargetStatus::Met))
            .collect();
        let &first = missed.first()?;
        let outcome = &outcomes[first];
        let channel = outcome.status.iter().position(|r| *r != TargetStatus::Met)?;
        let side = match self.goals[first].constraint[channel] {
            Constraint::Exactly => "",
            Constraint::AtLeast => "at least ",
            Constraint::AtMost => "at most ",
        };
        let (name, part) = match self.goals[first].aspect {
            Aspect::Colour => (["red", "green", "blue"][channel], DVec3::AXES[channel]),
            Aspect::Luminance => ("luminance", LUMINANCE),
        };
        let off = scale.iter().all(|x| x[channel] == 0.0);
        let full = !self.params.max_scale.is_empty()
            && scale.iter().zip(&self.params.max_scale).all(|(x, max)| x[channel] >= *max);
        let why = match outcome.status[channel] {
            TargetStatus::Dark => "no light of these lamps finds its way there",
            TargetStatus::TooBright if off => {
                "the other lights alone are brighter: dim or remove them, or raise the target"
            }
            TargetStatus::TooDim if full => "all groups are at their largest power: allow more, or lower the target",
            _ if self.goals.iter().all(|g| g.aspect == Aspect::Luminance) => {
                "the goals ask for different things of the same groups: divide them further, or weigh the goals"
            }
            _ => match self.params.colour {
                Colour::Common => {
                    "the goals ask for different things of the same groups, or for a colour that the groups do not have: \
                     divide them further, free their colours, or weigh the goals"
                }
                Colour::PerChannel => {
                    "the goals ask for different things of the same groups: divide them further, or weigh the goals"
                }
            },
        };
        Some(format!(
            "goal {first} asks for {side}{:.4} cd/m² in {name} and gets {:.4}: {why} ({} of {} goals are missed)",
            self.goals[first].target.as_dvec3().dot(part),
            outcome.achieved.dot(part),
            missed.len(),
            outcomes.len()
        ))
    }
}
