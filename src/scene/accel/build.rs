//! From triangles to the finished structure.

use super::collapse;
use super::costs::Source;
use super::lines::Lines;
use super::node::Child;
use super::reinsert::Reinsertion;
use super::{Accel, SHORT_STACK, pages, units};
use crate::error::{Error, Result};
use crate::job::Job;
use glam::{Vec3, Vec4};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// Bytes that the builder of the binary tree takes per leaf, with a margin: boxes (32) and indices (4); two lists of nodes
/// and the sort keys (32 each); two nodes per leaf (64) with their parents and marks (10).
const BUILDER_BYTES: usize = 256;

/// Nodes that the first round of reinsertion tries to move, within limits of 8 and 16 % of all: more make a better
/// tree, but take their time.
const REINSERTED: f32 = 13_000.0;
/// Units from which on the structure is larger than caches. There each node that a ray is saved saves it a wait for
/// memory, so that as many are tried as in small scenes.
const BEYOND_CACHES: usize = 1 << 19;
/// Rounds of reinsertion, as shares of the first; the largest nodes are tried in every one. More of them gain nothing.
const ROUNDS: [f32; 3] = [1.0, 0.2, 0.1];

pub(super) fn build(triangles: &[[Vec3; 3]], job: Job) -> Result<Accel> {
    if triangles.len() >= 1 << 31 {
        return Err(Error::argument(format!("scene has {} triangles; at most 2^31 - 1 are allowed", triangles.len())));
    }
    let units = units::gather(triangles, job)?;
    let mut accel = Accel {
        lines: Lines::default(),
        root: Child::EMPTY,
        low: Vec3::ZERO,
        high: Vec3::ZERO,
        largest: Vec4::ZERO,
        stack_need: SHORT_STACK,
        dropped: units.dropped,
        wide_vectors: has_wide_vectors(),
    };
    if units.list.is_empty() {
        return Ok(accel);
    }
    (accel.low, accel.high) = (units.low, units.high);
    accel.largest = units.low.abs().max(units.high.abs()).extend(0.0);
    job.report(0.1);
    // The builder's own allocations end the process where they fail.
    pages::expect_room(units.list.len().saturating_mul(BUILDER_BYTES))?;
    let tree = binary_tree(&units.boxes(triangles)?, job.part(0.1, 0.8))?;
    collapse::run(&Source { triangles, units: &units.list, tree: &tree }, &mut accel, job)?;
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

fn binary_tree(boxes: &[Aabb], job: Job) -> Result<Bvh2> {
    // With these indices a leaf of the tree tells its unit itself.
    let indices = (0..boxes.len() as u32).collect();
    let mut tree =
        PlocBuilder::with_capacity(boxes.len()).build(PlocSearchDistance::Low, boxes, indices, SortPrecision::U64, 0);
    job.check()?;
    job.report(0.7);
    let nodes = tree.nodes.len();
    let share = if boxes.len() < BEYOND_CACHES { (REINSERTED / boxes.len() as f32).clamp(0.08, 0.16) } else { 0.16 };
    let mut reinsertion = Reinsertion::new(&mut tree)?;
    for round in ROUNDS {
        reinsertion.round((nodes as f32 * share * round) as usize, job)?;
    }
    job.check()?;
    job.report(1.0);
    Ok(tree)
}
