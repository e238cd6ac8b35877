//! From triangles to the finished structure.

use super::costs::Source;
use super::leaves::{self, Leaves};
use super::lines::Lines;
use super::node::Child;
use super::reinsert::Reinsertion;
use super::tree::Tree;
use super::{Accel, SHORT_STACK, cluster, collapse};
use crate::error::{Error, Result};
use crate::job::Job;
use glam::{Vec3, Vec4};

/// Rounds of reinsertion: the share of all nodes, the largest, that each tries to move. More of either gain little.
const ROUNDS: [f32; 3] = [0.1, 0.1, 0.03];

pub(super) fn build(triangles: &[[Vec3; 3]], job: Job) -> Result<Accel> {
    if triangles.len() >= 1 << 31 {
        return Err(Error::argument(format!("scene has {} triangles; at most 2^31 - 1 are allowed", triangles.len())));
    }
    let leaves = leaves::gather(triangles, job)?;
    let mut accel = Accel {
        lines: Lines::default(),
        root: Child::EMPTY,
        low: Vec3::ZERO,
        high: Vec3::ZERO,
        largest: Vec4::ZERO,
        stack_need: SHORT_STACK,
        dropped: leaves.dropped,
        wide_vectors: has_wide_vectors(),
    };
    if leaves.list.is_empty() {
        return Ok(accel);
    }
    (accel.low, accel.high) = (leaves.low, leaves.high);
    accel.largest = leaves.low.abs().max(leaves.high.abs()).extend(0.0);
    job.report(0.1);
    let scale = leaves.scale;
    let tree = binary_tree(leaves, accel.wide_vectors, job.part(0.1, 0.8))?;
    collapse::run(&Source { triangles, tree: &tree, scale }, &mut accel, job)?;
    job.report(1.0);
    Ok(accel)
}

fn has_wide_vectors() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("fma")
        && std::arch::is_x86_feature_detected!("bmi1")
        && std::arch::is_x86_feature_detected!("bmi2")
        && std::arch::is_x86_feature_detected!("lzcnt")
        && std::arch::is_x86_feature_detected!("popcnt");
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}

fn binary_tree(leaves: Leaves, wide: bool, job: Job) -> Result<Tree> {
    let mut tree = cluster::binary_tree(&leaves, wide, job)?;
    drop(leaves);
    job.report(0.4);
    let mut reinsertion = Reinsertion::new(&mut tree)?;
    for least in reinsertion.areas_of_largest(ROUNDS) {
        reinsertion.round(least, job)?;
    }
    job.check()?;
    job.report(1.0);
    Ok(tree)
}
