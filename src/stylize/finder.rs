//! Searches for nearest patches, with PatchMatch or with a k-d tree over patch means.

use super::level::Level;
use super::params::{Finder, Params};
use crate::error::Result;
use crate::job::Job;
use crate::patch::{Domain, Field, KdTree, Means, Search, SearchIteration};

/// Number of patches of the k-d tree that are compared with each patch; more take longer and lower the energy
/// (StyLit, Eq. 3). [bench stylit]
const TRIES: usize = 8;

/// Data that the searches of one iteration share.
pub(super) struct Nearest<'a> {
    level: &'a Level<'a>,
    search_iterations: usize,
    trees: Option<KdTrees>,
}

struct KdTrees {
    source_means: Means,
    target_means: Means,
    source: KdTree,
    target: KdTree,
}

impl<'a> Nearest<'a> {
    pub fn new(level: &'a Level, params: &Params, job: Job) -> Result<Self> {
        let trees = match params.finder {
            Finder::PatchMatch => None,
            Finder::KdTree => {
                let source_means = Means::new(&level.source, level.problem.patch, job)?;
                let target_means = Means::new(&level.target, level.problem.patch, job)?;
                Some(KdTrees {
                    source: KdTree::new(&source_means, &level.allowed, job)?,
                    target: KdTree::new(&target_means, &level.wanted, job)?,
                    source_means,
                    target_means,
                })
            }
        };
        Ok(Self { level, search_iterations: params.search_iterations, trees })
    }

    /// Searches the exemplar for better matches of the target patches. `index` is the number of the call; each call
    /// uses other random numbers.
    pub fn forward(
        &self,
        search: &Search,
        field: &mut Field,
        index: u64,
        job: Job,
        active: impl Fn(usize) -> bool + Sync,
    ) -> Result<()> {
        match &self.trees {
            None => self.iterate(search, field, SearchIteration { index, radius: 64, initial_samples: 4 }, job, active),
            Some(t) => search.look_up(field, &t.source, &t.target_means, TRIES, job, active),
        }
    }

    /// Searches the `free` target patches for better matches of the exemplar patches.
    pub fn reverse(
        &self,
        field: &mut Field,
        free: &Domain,
        index: u64,
        job: Job,
        active: impl Fn(usize) -> bool + Sync,
    ) -> Result<()> {
        let search = self.level.reverse(free);
        match &self.trees {
            None => {
                self.iterate(&search, field, SearchIteration { index, radius: 32, initial_samples: 2 }, job, active)
            }
            Some(t) => search.look_up(field, &t.target, &t.source_means, TRIES, job, active),
        }
    }

    fn iterate(
        &self,
        search: &Search,
        field: &mut Field,
        first: SearchIteration,
        job: Job,
        active: impl Fn(usize) -> bool + Sync,
    ) -> Result<()> {
        for k in 0..self.search_iterations {
            let job =
                job.part(k as f64 / self.search_iterations as f64, (k + 1) as f64 / self.search_iterations as f64);
            search.iterate(field, SearchIteration { index: 100 * first.index + k as u64, ..first }, job, &active)?;
        }
        Ok(())
    }
}
