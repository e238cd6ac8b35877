//! Builds the acceleration structure: sorts triangles into leaves, clusters them, optimises and collapses the tree.

use super::cache_lines::Lines;
use super::costs::Source;
use super::leaves::{self, Leaves};
use super::node::Child;
use super::reinsert::Reinsertion;
use super::traverse::{Accel, SHORT_STACK};
use super::tree::Tree;
use super::{cluster, collapse};
use crate::error::{Error, Result};
use crate::job::Job;
use crate::simd::Level;
use glam::{Vec3, Vec4};

/// Share of all nodes that each round of reinsertion tries to move; a round takes the nodes whose boxes have the
/// largest area. More rounds or larger shares gain little. [bench rays]
const ROUNDS: [f32; 3] = [0.1, 0.1, 0.03];

impl Accel {
    /// Builds the structure. Degenerate triangles (without area or with non-finite corners) cannot be hit: they are
    /// left out and counted. Call this on the library's own thread pool, because the builder runs on the current pool.
    pub fn build(triangles: &[[Vec3; 3]], job: Job) -> Result<Self> {
        if triangles.len() >= 1 << 31 {
            return Err(Error::argument(format!(
                "scene has {} triangles; at most 2^31 - 1 are allowed",
                triangles.len()
            )));
        }
        let leaves = leaves::gather(triangles, job)?;
        let mut accel = Self {
            lines: Lines::default(),
            root: Child::EMPTY,
            low: Vec3::ZERO,
            high: Vec3::ZERO,
            largest: Vec4::ZERO,
            stack_need: SHORT_STACK,
            dropped: leaves.dropped,
            level: Level::widest(),
        };
        if leaves.list.is_empty() {
            return Ok(accel);
        }
        (accel.low, accel.high) = (leaves.low, leaves.high);
        accel.largest = leaves.low.abs().max(leaves.high.abs()).extend(0.0);
        job.report(0.1);
        let scale = leaves.scale;
        let tree = binary_tree(leaves, accel.level, job.part(0.1, 0.8))?;
        collapse::run(&Source { triangles, tree: &tree, scale }, &mut accel, job)?;
        job.check()?;
        job.report(1.0);
        Ok(accel)
    }
}

fn binary_tree(leaves: Leaves, level: Level, job: Job) -> Result<Tree> {
    let mut tree = cluster::binary_tree(&leaves, level, job)?;
    drop(leaves);
    job.report(0.4);
    let mut reinsertion = Reinsertion::new(&mut tree, job)?;
    for min_area in reinsertion.area_thresholds(ROUNDS) {
        reinsertion.round(min_area, job)?;
    }
    job.check()?;
    job.report(1.0);
    Ok(tree)
}
