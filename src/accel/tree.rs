//! The binary tree from which the wide nodes are made: `cluster` builds it, `reinsert` optimises it, `collapse` reads
//! it.

use glam::Vec4Swizzles;
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use std::ops::{Index, IndexMut};

/// Two sibling nodes in one cache line.
#[derive(Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Pair(pub [Bvh2Node; 2]);

/// A binary tree of sibling pairs. Node `2 * i + k` is the `k`-th node of pair `i`, so `node ^ 1` is its sibling. The
/// root is node 1; its sibling, node 0, is unused.
///
/// `prim_count` is 0 for inner nodes and the number of triangles for leaves. `first_index` is the index of the first
/// child of an inner node, or of the first triangle of a leaf.
pub(super) struct Tree {
    pub pairs: Vec<Pair>,
    /// For each pair, the index of its parent node.
    pub parents: Vec<u32>,
}

impl Tree {
    pub const ROOT: u32 = 1;

    /// Number of nodes, including the unused node 0.
    pub fn len(&self) -> usize {
        2 * self.pairs.len()
    }
}

impl Index<u32> for Tree {
    type Output = Bvh2Node;

    #[inline(always)]
    fn index(&self, node: u32) -> &Bvh2Node {
        &self.pairs[node as usize / 2].0[node as usize % 2]
    }
}

impl IndexMut<u32> for Tree {
    #[inline(always)]
    fn index_mut(&mut self, node: u32) -> &mut Bvh2Node {
        &mut self.pairs[node as usize / 2].0[node as usize % 2]
    }
}

/// Half the surface area of a box. In a node, the fourth lane of the bounds holds an integer. As a float it would be
/// denormal and slow the multiplication, so it is replaced by zero.
#[inline(always)]
pub(super) fn half_area(shape: &Aabb) -> f32 {
    let d = (shape.max - shape.min).extend(0.0);
    // glam's dot product adds in another order on ARM.
    let products = d * d.yzxw();
    (products.x + products.z) + products.y
}
