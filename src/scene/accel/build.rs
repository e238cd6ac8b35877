//! Builds the binary tree and collapses it into wide nodes.

use super::node::{Child, Node};
use super::packet::Packet;
use super::{Accel, SHORT_STACK};
use crate::error::{Error, Result};
use crate::image::try_vec;
use crate::job::Job;
use crate::rng;
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// Triangles a leaf holds at most: one packet.
const LEAF: u32 = 4;

pub(super) fn build(triangles: &[[Vec3; 3]], job: Job) -> Result<Accel> {
    if triangles.len() >= 1 << 31 {
        return Err(Error::argument(format!("scene has {} triangles; at most 2^31 - 1 are allowed", triangles.len())));
    }
    // Leave out what cannot be hit.
    let kept: Vec<u32> = (0..triangles.len() as u32).filter(|&i| has_area(&triangles[i as usize])).collect();
    let mut accel = Accel {
        nodes: Vec::new(),
        packets: Vec::new(),
        root: Child::EMPTY,
        low: Vec3::ZERO,
        high: Vec3::ZERO,
        stack_need: SHORT_STACK,
        dropped: triangles.len() - kept.len(),
        wide_vectors: has_wide_vectors(),
    };
    if kept.is_empty() {
        return Ok(accel);
    }
    job.check()?;
    let tree = binary_tree(triangles, &kept, job)?;
    job.report(0.7);
    Collapse::new(triangles, &kept, &tree)?.run(&mut accel, job)?;
    job.report(1.0);
    Ok(accel)
}

fn has_wide_vectors() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}

fn has_area(corners: &[Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let doubled = (b - a).cross(c - a).length_squared();
    doubled.is_finite() && doubled > 0.0
}

/// The boxes a tree is built from are each enlarged by a random amount of up to 1/1000 of their extent.
///
/// On regular grids, which the walls of rooms are, all merges of neighbours cost the same; the builder's way of breaking
/// those ties makes trees that are 6 to 20 times slower to traverse. Unequal boxes leave no ties. Only the builder sees
/// them: the boxes of the collapsed tree are tight.
fn jittered_box(corners: &[Vec3; 3], index: u32) -> Aabb {
    let low = corners[0].min(corners[1]).min(corners[2]);
    let high = corners[0].max(corners[1]).max(corners[2]);
    let amount = (rng::mix(u64::from(index) + 1) >> 40) as f32 / (1 << 24) as f32;
    let grow = Vec3::splat((high - low).max_element() * amount * 1e-3);
    Aabb::new((low - grow).into(), (high + grow).into())
}

fn binary_tree(triangles: &[[Vec3; 3]], kept: &[u32], job: Job) -> Result<Bvh2> {
    let boxes: Vec<Aabb> = kept.iter().map(|&i| jittered_box(&triangles[i as usize], i)).collect();
    let indices = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        &boxes,
        indices,
        SortPrecision::U64,
        2,
    );
    job.check()?;
    job.report(0.4);
    ReinsertionOptimizer::default().run(&mut tree, 0.05, None);
    job.check()?;
    Ok(tree)
}

/// Turns a binary tree into wide nodes from the root down; the tight bounds and sizes of all subtrees come first.
struct Collapse<'a> {
    triangles: &'a [[Vec3; 3]],
    kept: &'a [u32],
    tree: &'a Bvh2,
    low: Vec<Vec3>,
    high: Vec<Vec3>,
    count: Vec<u32>,
}

impl<'a> Collapse<'a> {
    fn new(triangles: &'a [[Vec3; 3]], kept: &'a [u32], tree: &'a Bvh2) -> Result<Self> {
        let n = tree.nodes.len();
        let mut this = Self {
            triangles,
            kept,
            tree,
            low: try_vec(n, Vec3::INFINITY)?,
            high: try_vec(n, Vec3::NEG_INFINITY)?,
            count: try_vec(n, 0)?,
        };
        // Parents before children, then children before parents.
        let mut order = vec![0usize];
        let mut at = 0;
        while at < order.len() {
            let node = &tree.nodes[order[at]];
            if !node.is_leaf() {
                let first = node.first_index as usize;
                order.extend([first, first + 1]);
            }
            at += 1;
        }
        for &index in order.iter().rev() {
            this.bound(index);
        }
        Ok(this)
    }

    fn bound(&mut self, index: usize) {
        let node = &self.tree.nodes[index];
        let first = node.first_index as usize;
        if node.is_leaf() {
            for slot in first..first + node.prim_count as usize {
                for corner in self.triangles[self.kept[self.tree.primitive_indices[slot] as usize] as usize] {
                    self.low[index] = self.low[index].min(corner);
                    self.high[index] = self.high[index].max(corner);
                }
            }
            self.count[index] = node.prim_count;
        } else {
            self.low[index] = self.low[first].min(self.low[first + 1]);
            self.high[index] = self.high[first].max(self.high[first + 1]);
            self.count[index] = self.count[first] + self.count[first + 1];
        }
    }

    fn half_area(&self, index: usize) -> f32 {
        let d = self.high[index] - self.low[index];
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    fn run(&self, accel: &mut Accel, job: Job) -> Result<()> {
        (accel.low, accel.high) = (self.low[0], self.high[0]);
        if self.count[0] <= LEAF {
            accel.root = self.packet(0, accel);
            return Ok(());
        }
        accel.root = Child::of_node(0);
        accel.nodes.push(Node::empty());
        // (binary node, wide node, entries that can wait when it is visited)
        let mut open = vec![(0usize, 0usize, 0usize)];
        let mut need = 0;
        while let Some((from, to, waiting)) = open.pop() {
            if accel.nodes.len() % 4096 == 0 {
                job.check()?;
            }
            let (children, len) = self.gather(from);
            need = need.max(waiting + len);
            for (lane, &child) in children[..len].iter().enumerate() {
                let target = if self.count[child] <= LEAF {
                    self.packet(child, accel)
                } else {
                    accel.nodes.push(Node::empty());
                    open.push((child, accel.nodes.len() - 1, waiting + len - 1));
                    Child::of_node(accel.nodes.len() - 1)
                };
                accel.nodes[to].set(lane, self.low[child], self.high[child], target);
            }
        }
        accel.stack_need = need;
        Ok(())
    }

    /// Up to eight descendants that together make up a node: the largest box is opened until there is no more room.
    fn gather(&self, from: usize) -> ([usize; 8], usize) {
        let mut members = [from; 8];
        let mut len = 1;
        while len < 8 {
            let largest = (0..len)
                .filter(|&i| self.count[members[i]] > LEAF)
                .max_by(|&i, &j| self.half_area(members[i]).total_cmp(&self.half_area(members[j])));
            let Some(i) = largest else { break };
            let first = self.tree.nodes[members[i]].first_index as usize;
            members[i] = first;
            members[len] = first + 1;
            len += 1;
        }
        (members, len)
    }

    fn packet(&self, subtree: usize, accel: &mut Accel) -> Child {
        let mut ids = Vec::with_capacity(LEAF as usize);
        let mut open = vec![subtree];
        while let Some(index) = open.pop() {
            let node = &self.tree.nodes[index];
            let first = node.first_index as usize;
            if node.is_leaf() {
                ids.extend(
                    (first..first + node.prim_count as usize)
                        .map(|slot| self.kept[self.tree.primitive_indices[slot] as usize]),
                );
            } else {
                open.extend([first, first + 1]);
            }
        }
        accel.packets.push(Packet::new(self.triangles, &ids));
        Child::of_packet(accel.packets.len() - 1)
    }
}
