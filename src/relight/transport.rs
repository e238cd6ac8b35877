//! Transport: the target's mean response to the emission and to all other light, in independent batches.

use super::target::Sampler;
use crate::error::Result;
use crate::exec;
use crate::job::Job;
use crate::render::{self, LightSource, PathSink, World};
use crate::rng::{Rng, hash};
use glam::{DVec3, Vec3};

/// Batches of the estimate. Their spread gives the interval: with 32, Student's t is within 4 % of the normal quantile.
pub(super) const BATCHES: usize = 32;

/// Paths of a batch in the first round; every later round doubles what there is.
const FIRST_ROUND: u32 = 64;

/// Paths of one unit of parallel work, traced between two looks at the cancel request.
const CHUNK: u32 = 256;

/// Sums over the paths of a batch.
#[derive(Clone, Copy, Default)]
struct Sums {
    emitter: DVec3,
    others: DVec3,
    /// Paths that started beside the lamps.
    count: u32,
}

pub(super) struct Batches<'a> {
    world: &'a World,
    points: &'a Sampler<'a>,
    /// For each mesh, whether it belongs to the emission that is solved for.
    of_emitter: Vec<bool>,
    seed: u64,
    sums: [Sums; BATCHES],
    /// Paths traced per batch.
    traced: u32,
}

/// Sorts the light of one path by where it came from.
struct Groups<'a> {
    of_emitter: &'a [bool],
    emitter: Vec3,
    others: Vec3,
}

impl PathSink for Groups<'_> {
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3) {
        match source {
            LightSource::Surface { mesh, .. } if self.of_emitter[mesh as usize] => {
                self.emitter += importance * emission
            }
            _ => self.others += importance * emission,
        }
    }
}

impl<'a> Batches<'a> {
    pub fn new(world: &'a World, points: &'a Sampler<'a>, emitter: usize, seed: u64) -> Self {
        let of_emitter = world.scene().meshes.iter().map(|m| m.material == emitter).collect();
        Self { world, points, of_emitter, seed, sums: [Sums::default(); BATCHES], traced: 0 }
    }

    /// Paths traced so far.
    pub fn paths(&self) -> u32 {
        self.traced.saturating_mul(BATCHES as u32)
    }

    /// Traces as many paths again as there are, but no more than `limit` in all.
    pub fn trace_round(&mut self, limit: u32, job: Job) -> Result<()> {
        let last = (self.traced * 2).max(FIRST_ROUND).min(limit.div_ceil(BATCHES as u32));
        let (first, per_batch) = (self.traced, last - self.traced);
        let chunks = per_batch.div_ceil(CHUNK);
        let share = |paths: u32| f64::from(paths) / f64::from(limit.div_ceil(BATCHES as u32));
        let part = job.part(share(first), share(last));
        let sums = exec::map(BATCHES * chunks as usize, part, |unit| {
            let (batch, chunk) = (unit / chunks as usize, (unit % chunks as usize) as u32);
            let start = first + chunk * CHUNK;
            self.trace(batch, start, (start + CHUNK).min(last))
        })?;
        // In order of the units, so that the sums do not depend on the threads.
        for (unit, sum) in sums.iter().enumerate() {
            let batch = &mut self.sums[unit / chunks as usize];
            batch.emitter += sum.emitter;
            batch.others += sum.others;
            batch.count += sum.count;
        }
        self.traced = last;
        Ok(())
    }

    fn trace(&self, batch: usize, from: u32, to: u32) -> Sums {
        let seed = hash(self.seed, &[batch as u64]);
        let mut rng = Rng::new(seed, &[]);
        let shift = [rng.next_f64(), rng.next_f64()];
        let mut sums = Sums::default();
        for index in from..to {
            let Some(target) = self.points.point(index, shift) else { continue };
            let mut groups = Groups { of_emitter: &self.of_emitter, emitter: Vec3::ZERO, others: Vec3::ZERO };
            render::irradiance(self.world, &target.point, seed, index, &mut groups);
            sums.emitter += (target.factor * groups.emitter).as_dvec3();
            sums.others += (target.factor * groups.others).as_dvec3();
            sums.count += 1;
        }
        sums
    }

    /// Mean response to the emission and to the other lights, of each batch.
    pub fn means(&self) -> [(DVec3, DVec3); BATCHES] {
        self.sums.map(|s| {
            let n = f64::from(s.count.max(1));
            (s.emitter / n, s.others / n)
        })
    }
}
