//! Computes the responses of several targets to each of many lamps, from one set of paths per target.

use super::bins::{Bins, Partition};
use super::emission_lamps::EmissionLamps;
use super::estimate::{BATCHES, STUDENT_T, mean, standard_error};
use super::params::{Params, Quantity, TargetGeometry};
use super::sided::Constraint;
use super::target::Sampler;
use super::transport::{Batches, Means, Stop};
use crate::error::{Error, Result};
use crate::image::try_vec;
use crate::job::Job;
use crate::render::World;
use glam::{DVec3, Vec3};

/// Which property of the light has to meet a goal's target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aspect {
    /// Every channel, so that the colour of the light counts.
    Colour,
    /// The luminance alone, for goals in lux.
    Luminance,
}

/// One of several lighting goals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal<'a> {
    pub geometry: TargetGeometry<'a>,
    pub quantity: Quantity,
    /// Mean radiance to achieve, in cd/m² per channel, ≥ 0; for incident light, the illuminance divided by π.
    pub target: Vec3,
    pub aspect: Aspect,
    /// Whether the target of each channel is exact or a limit. With [`Aspect::Luminance`], the three entries must be
    /// equal.
    pub constraint: [Constraint; 3],
    /// Weight of the goal's error, ≥ 0, in comparison with other goals. The error is relative to the brightest channel
    /// of the target; for a black target, to the brightest channel under all lamps.
    pub weight: f64,
}

/// Maximum number of goals. [convention]
pub const MAX_GOALS: usize = 64;
/// Maximum number of lamps × goals. For each pair of a lamp and a goal, [`BATCHES`] colours are stored, and twice as
/// many while results are assembled. [convention]
pub const MAX_PAIRS: usize = 1 << 20;

/// A mean over batches with its standard error, per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub mean: DVec3,
    pub standard_error: DVec3,
}

impl Estimate {
    /// Half-width of the 95 % confidence interval.
    pub fn half_width(&self) -> DVec3 {
        self.standard_error * STUDENT_T
    }

    /// Returns the half-width of the confidence interval relative to the mean, for the channel where it is largest.
    /// Channels without light are ignored.
    pub(super) fn error(&self) -> f64 {
        let relative = self.half_width() / self.mean;
        (0..3).map(|c| relative[c]).filter(|e| e.is_finite()).fold(0.0, f64::max)
    }

    pub(super) fn of(batches: impl Fn(usize) -> DVec3) -> Self {
        let channel = |c: usize| -> [f64; BATCHES] { std::array::from_fn(|b| batches(b)[c]) };
        Self {
            mean: DVec3::from(std::array::from_fn(|c| mean(&channel(c)))),
            standard_error: DVec3::from(std::array::from_fn(|c| standard_error(&channel(c)))),
        }
    }
}

/// The response of each goal to each lamp or group of lamps: the mean radiance of the goal's surface or grid under the
/// light of this lamp or group alone.
#[derive(Clone, Debug)]
pub struct Responses {
    lamps: usize,
    goals: Vec<PerGoal>,
    /// Number of paths traced per goal.
    pub paths: u32,
}

#[derive(Clone, Debug)]
struct PerGoal {
    /// For each batch, the mean radiance of the goal's surface or grid under each lamp alone.
    batches: Vec<Vec<DVec3>>,
    /// For each batch, the mean radiance under all light except the lamps.
    background: Vec<DVec3>,
}

/// Computes by path tracing how much light each lamp contributes to each goal. The lamps are parts of the surfaces
/// with the material `emitter` (texels or pieces of meshes), with the current emission, or they are punctual lights;
/// for punctual lights, `emitter` is ignored. Tracing stops under the conditions of [`super::run`], applied to the
/// light that all lamps together contribute to each goal; the contributions of single lamps have larger errors.
/// `params.quantity` is ignored.
///
/// # Errors
/// Parameters out of range; goals whose surface does not exist or has no area; cancelled.
pub fn lamp_responses(
    world: &World,
    emitter: usize,
    lamps: &EmissionLamps,
    goals: &[Goal],
    params: &Params,
    job: Job,
) -> Result<Responses> {
    params.check()?;
    if goals.is_empty() || goals.len() > MAX_GOALS {
        return Err(Error::argument(format!("there are {} goals; there must be 1 to {MAX_GOALS}", goals.len())));
    }
    if goals.len() * lamps.count() > MAX_PAIRS {
        return Err(Error::argument(format!(
            "there are {} lamps and {} goals; their product may be {MAX_PAIRS} at most",
            lamps.count(),
            goals.len()
        )));
    }
    let scene = world.scene();
    let samplers: Vec<Sampler> =
        goals.iter().map(|goal| Sampler::new(scene, goal.geometry, goal.quantity)).collect::<Result<_>>()?;
    let mut batches: Vec<Batches> = samplers
        .iter()
        .map(|points| Batches::new(world, points, Bins::new(world, emitter, Partition::Lamps(lamps)), params.seed))
        .collect::<Result<_>>()?;
    let stop = Stop::new(params);
    let mut growth = f64::INFINITY;
    loop {
        let share = 1.0 / batches.len() as f64;
        let mut error = 0.0f64;
        for (i, batch) in batches.iter_mut().enumerate() {
            let part = job.part(share * i as f64, (share * (i + 1) as f64).min(1.0));
            batch.trace_round(growth, stop.max_paths, part)?;
            error = error.max(error_of_all(batch));
        }
        let paths = batches[0].paths();
        match stop.growth(error, paths) {
            Some(more) => growth = more,
            None => {
                job.report(1.0);
                let goals = batches.into_iter().map(|b| PerGoal::new(b.into_means())).collect();
                return Ok(Responses { lamps: lamps.count(), goals, paths });
            }
        }
    }
}

/// Returns the relative half-width of the confidence interval of the response to all lamps together.
fn error_of_all(batches: &Batches) -> f64 {
    let sums: Vec<DVec3> = (0..BATCHES).map(|batch| batches.mean_of_bins(batch).sum()).collect();
    Estimate::of(|batch| sums[batch]).error()
}

impl PerGoal {
    fn new(means: Vec<Means>) -> Self {
        let background = means.iter().map(|m| m.others).collect();
        Self { batches: means.into_iter().map(|m| m.bins).collect(), background }
    }
}

impl Responses {
    /// Number of lamps or of groups.
    pub fn lamps(&self) -> usize {
        self.lamps
    }

    pub fn goals(&self) -> usize {
        self.goals.len()
    }

    /// Mean radiance of a goal's surface or grid under one lamp, in cd/m².
    pub fn lamp(&self, goal: usize, lamp: usize) -> Estimate {
        Estimate::of(|batch| self.batch(goal, batch)[lamp])
    }

    /// Mean radiance of a goal's surface or grid under all lamps.
    pub fn all(&self, goal: usize) -> Estimate {
        Estimate::of(|batch| self.batch(goal, batch).iter().sum())
    }

    /// Mean radiance of a goal's surface or grid under all light except the lamps.
    pub fn background(&self, goal: usize) -> Estimate {
        Estimate::of(|batch| self.goals[goal].background[batch])
    }

    /// Responses of a goal to each lamp, in one batch.
    pub(super) fn batch(&self, goal: usize, batch: usize) -> &[DVec3] {
        &self.goals[goal].batches[batch]
    }

    pub(super) fn background_of_batch(&self, goal: usize, batch: usize) -> DVec3 {
        self.goals[goal].background[batch]
    }

    /// Adds up the responses within groups of lamps. `group_of` holds the group of each lamp, less than `groups`.
    ///
    /// # Errors
    /// `InvalidArgument` if the groups do not match the lamps.
    pub fn grouped(&self, group_of: &[u32], groups: usize) -> Result<Self> {
        if group_of.len() != self.lamps {
            return Err(Error::argument(format!("groups are given for {} lamps of {}", group_of.len(), self.lamps)));
        }
        if groups == 0 || groups > self.lamps {
            return Err(Error::argument(format!("there are {groups} groups; there must be 1 to {}", self.lamps)));
        }
        if let Some(group) = group_of.iter().find(|g| **g as usize >= groups) {
            return Err(Error::argument(format!("a lamp is in group {group}; there are {groups}")));
        }
        let gather_batch = |lamps: &Vec<DVec3>| {
            let mut sums = try_vec(groups, DVec3::ZERO)?;
            lamps.iter().zip(group_of).for_each(|(light, group)| sums[*group as usize] += *light);
            Ok(sums)
        };
        let gather = |per: &PerGoal| {
            let batches = per.batches.iter().map(gather_batch).collect::<Result<_>>()?;
            Ok(PerGoal { batches, background: per.background.clone() })
        };
        let goals = self.goals.iter().map(gather).collect::<Result<_>>()?;
        Ok(Self { lamps: groups, goals, paths: self.paths })
    }
}
