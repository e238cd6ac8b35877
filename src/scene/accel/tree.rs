//! The binary tree: what is built, improved, and made into wide nodes.

use glam::Vec4Swizzles;
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use std::ops::{Index, IndexMut};

/// Two siblings, in one line of the cache.
#[derive(Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Pair(pub [Bvh2Node; 2]);

/// Node `2 * i + k` is the `k`-th of pair `i`, so `node ^ 1` is its sibling. The root's is not used.
///
/// `prim_count` is 0 or the number of triangles in a leaf; `first_index` is the first of two children, or of the triangles.
pub(super) struct Tree {
    pub pairs: Vec<Pair>,
    /// The node that each pair belongs to.
    pub parents: Vec<u32>,
}

impl Tree {
    pub const ROOT: u32 = 1;

    /// Nodes, with the one that is not used.
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

/// Half the surface area of a box. The boxes of nodes have whole numbers in their fourth lanes: as floats these are too
/// small to be normal, which makes a multiplication many times as slow. In a sum over all lanes they have to be zero.
#[inline(always)]
pub(super) fn half_area(shape: &Aabb) -> f32 {
    let d = (shape.max - shape.min).extend(0.0);
    d.dot(d.yzxw())
}
