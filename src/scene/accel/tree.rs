//! The binary tree, which is built, optimised, and collapsed into wide nodes.

use glam::Vec4Swizzles;
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use std::ops::{Index, IndexMut};

/// Two siblings in one cache line.
#[derive(Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Pair(pub [Bvh2Node; 2]);

/// Node `2 * i + k` is the `k`-th of pair `i`, so `node ^ 1` is its sibling. The sibling of the root is unused.
///
/// `prim_count` is 0 for inner nodes and the number of triangles in leaves; `first_index` is the first of two
/// children, or of the triangles.
pub(super) struct Tree {
    pub pairs: Vec<Pair>,
    /// The parent node of each pair.
    pub parents: Vec<u32>,
}

impl Tree {
    pub const ROOT: u32 = 1;

    /// Number of nodes, including the unused one.
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

/// Half the surface area of a box. The fourth lanes of node boxes hold integers, which as floats are denormal and make
/// a multiplication many times slower. They must be zero in a sum over all lanes.
#[inline(always)]
pub(super) fn half_area(shape: &Aabb) -> f32 {
    let d = (shape.max - shape.min).extend(0.0);
    d.dot(d.yzxw())
}
