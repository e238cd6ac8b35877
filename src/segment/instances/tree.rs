//! The component tree of a photo's brightness (Salembier et al. 1998), built by union-find (Berger et al. 2007). A node
//! of the tree is a connected region of all pixels at or above some brightness level. The parent of a region is the
//! smallest larger region that contains it; the parent's level is lower.
//!
//! Nodes are numbered from the root, parents before children. The root is the whole image.

use crate::error::Result;
use crate::image::{try_collect, try_push, try_vec};
use crate::job::Job;

pub struct Tree {
    /// Parent of each node; the root is its own parent.
    pub parent: Vec<u32>,
    /// For each pixel, the smallest node that contains it.
    pub node_of: Vec<u32>,
    /// All pixels, sorted so that the pixels of each node, children included, are contiguous.
    pixels: Vec<u32>,
    /// For each node, begin and end of its pixels in `pixels`.
    range: Vec<[u32; 2]>,
}

/// Marks pixels that the union-find has not reached yet.
const UNSEEN: u32 = u32::MAX;

impl Tree {
    /// Builds the tree of the pixels above level `floor`; all other pixels belong to the root only. Pixels that share
    /// a side are neighbours.
    pub fn new(levels: &[u16], floor: u16, width: usize, job: Job) -> Result<Self> {
        let order = sorted(levels, floor)?;
        let mut parent = try_vec(levels.len(), UNSEEN)?;
        let mut set = try_vec(levels.len(), UNSEEN)?;

        // From bright to dark, merge each pixel with the regions beside it.
        for (k, &p) in order.iter().enumerate().rev() {
            if k % (1 << 16) == 0 {
                job.check()?;
            }
            let i = p as usize;
            (parent[i], set[i]) = (p, p);
            let x = i % width;
            let beside = [
                (x > 0, 1usize.wrapping_neg()),
                (x + 1 < width, 1),
                (i >= width, width.wrapping_neg()),
                (i + width < levels.len(), width),
            ];
            for (_, step) in beside.into_iter().filter(|(inside, _)| *inside) {
                let n = i.wrapping_add(step);
                if set[n] != UNSEEN {
                    let top = find(&mut set, n as u32);
                    if top != p {
                        parent[top as usize] = p;
                        set[top as usize] = p;
                    }
                }
            }
        }

        // A node is represented by the first of its pixels in `order`, which is one of its darkest. From dark to
        // bright, redirect each parent to the pixel that represents its node.
        for &p in &order {
            let up = parent[p as usize] as usize;
            if levels[parent[up] as usize] == levels[up] {
                parent[p as usize] = parent[up];
            }
        }
        Self::numbered(levels, &order, &parent)
    }

    /// Numbers the nodes, and sorts the pixels by node.
    fn numbered(levels: &[u16], order: &[u32], parents: &[u32]) -> Result<Self> {
        let (mut parent, mut own) = (vec![0u32], vec![0u32]);
        let mut node_of = try_vec(levels.len(), 0u32)?;
        for &p in order {
            let (i, up) = (p as usize, parents[p as usize] as usize);
            if up != i && levels[up] == levels[i] {
                node_of[i] = node_of[up];
            } else {
                node_of[i] = parent.len() as u32;
                try_push(&mut parent, if up == i { 0 } else { node_of[up] })?;
                try_push(&mut own, 0)?;
            }
            own[node_of[i] as usize] += 1;
        }
        own[0] = (levels.len() - order.len()) as u32;

        // Lay out the pixels: a node's own pixels first, then the pixels of its children, one child after the other.
        let mut count = try_collect(own.iter().copied())?;
        for node in (1..count.len()).rev() {
            count[parent[node] as usize] += count[node];
        }
        let mut range = try_vec(count.len(), [0, count[0]])?;
        let mut next = try_vec(count.len(), own[0])?;
        for node in 1..count.len() {
            let start = next[parent[node] as usize];
            next[parent[node] as usize] += count[node];
            range[node] = [start, start + count[node]];
            next[node] = start + own[node];
        }
        let mut free = try_collect(range.iter().map(|r| r[0]))?;
        let mut pixels = try_vec(levels.len(), 0u32)?;
        for (p, &node) in node_of.iter().enumerate() {
            pixels[free[node as usize] as usize] = p as u32;
            free[node as usize] += 1;
        }
        Ok(Self { parent, node_of, pixels, range })
    }

    pub fn len(&self) -> usize {
        self.parent.len()
    }

    /// Adds the value of each node to all its ancestors, so that each value becomes the sum over a subtree.
    pub fn accumulate(&self, values: &mut [f64]) {
        for node in (1..self.len()).rev() {
            values[self.parent[node] as usize] += values[node];
        }
    }

    /// Iterates over a node and its ancestors, without the root.
    pub fn ancestors(&self, node: u32) -> impl Iterator<Item = u32> {
        std::iter::successors(Some(node), |&n| Some(self.parent[n as usize])).take_while(|&n| n != 0)
    }

    /// The pixels of a node, including the pixels of its descendants.
    pub fn pixels(&self, node: u32) -> &[u32] {
        let [from, to] = self.range[node as usize];
        &self.pixels[from as usize..to as usize]
    }
}

/// A set of chosen nodes of which none lies inside another.
pub struct Disjoint<'a> {
    tree: &'a Tree,
    is_chosen: Vec<bool>,
    /// Whether a node is chosen or is an ancestor of a chosen node.
    is_around: Vec<bool>,
}

impl<'a> Disjoint<'a> {
    pub fn new(tree: &'a Tree) -> Result<Self> {
        Ok(Self { tree, is_chosen: try_vec(tree.len(), false)?, is_around: try_vec(tree.len(), false)? })
    }

    pub fn try_clone(&self) -> Result<Self> {
        let copy = |flags: &[bool]| try_collect(flags.iter().copied());
        Ok(Self { tree: self.tree, is_chosen: copy(&self.is_chosen)?, is_around: copy(&self.is_around)? })
    }

    pub fn is_around(&self, node: u32) -> bool {
        self.is_around[node as usize]
    }

    /// Whether a node is neither an ancestor nor a descendant of a chosen node, nor chosen itself.
    pub fn admits(&self, node: u32) -> bool {
        !self.is_around(node) && !self.tree.ancestors(node).any(|n| self.is_chosen[n as usize])
    }

    pub fn choose(&mut self, node: u32) {
        self.is_chosen[node as usize] = true;
        self.tree.ancestors(node).for_each(|n| self.is_around[n as usize] = true);
    }
}

/// Sorts the pixels above `floor` by level, then by index (counting sort).
fn sorted(levels: &[u16], floor: u16) -> Result<Vec<u32>> {
    let top = levels.iter().copied().max().unwrap_or(0) as usize;
    let mut next = try_vec(top + 2, 0usize)?;
    levels.iter().filter(|&&l| l > floor).for_each(|&l| next[l as usize + 1] += 1);
    (1..next.len()).for_each(|l| next[l] += next[l - 1]);
    let mut order = try_vec(next[top + 1], 0u32)?;
    for (p, &level) in levels.iter().enumerate().filter(|(_, l)| **l > floor) {
        order[next[level as usize]] = p as u32;
        next[level as usize] += 1;
    }
    Ok(order)
}

/// Finds the representative of a set in the union-find forest, with path halving.
fn find(set: &mut [u32], mut p: u32) -> u32 {
    while set[p as usize] != p {
        let up = set[set[p as usize] as usize];
        set[p as usize] = up;
        p = up;
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::rng::Rng;

    fn noise(width: usize, height: usize) -> Vec<u16> {
        (0..width * height).map(|i| (Rng::new(7, &[i as u64]).next_f32() * 6.0) as u16).collect()
    }

    fn walk(levels: &[u16], level: u16, from: u32, width: usize) -> Vec<u32> {
        let mut reached = vec![from];
        let mut next = 0;
        while let Some(&p) = reached.get(next) {
            next += 1;
            let near =
                |n: u32| n.abs_diff(p) == width as u32 || n.abs_diff(p) == 1 && n / width as u32 == p / width as u32;
            let more = |&n: &u32| levels[n as usize] >= level && near(n) && !reached.contains(&n);
            let more: Vec<u32> = (0..levels.len() as u32).filter(more).collect();
            reached.extend(more);
        }
        reached.sort_unstable();
        reached
    }

    #[test]
    fn nodes_are_the_connected_regions_of_every_level() {
        let (width, height) = (17, 11);
        let levels = noise(width, height);
        let tree = Tree::new(&levels, 0, width, Monitor::default().job()).unwrap();
        for node in 1..tree.len() as u32 {
            assert!(tree.parent[node as usize] < node);
            let mut by_tree = tree.pixels(node).to_vec();
            let level = by_tree.iter().map(|&p| levels[p as usize]).min().unwrap();
            by_tree.sort_unstable();
            assert!(by_tree.iter().all(|&p| tree.ancestors(tree.node_of[p as usize]).any(|n| n == node)));
            // By definition, a node consists of the pixels that a walk over pixels at or above its level reaches.
            let at_level = *by_tree.iter().find(|&&p| levels[p as usize] == level).unwrap();
            assert_eq!(by_tree, walk(&levels, level, at_level, width));
        }
    }

    #[test]
    fn sums_over_nodes_are_sums_over_their_pixels() {
        let (width, height) = (13, 9);
        let levels = noise(width, height);
        let tree = Tree::new(&levels, 1, width, Monitor::default().job()).unwrap();
        let mut area = vec![0.0; tree.len()];
        tree.node_of.iter().for_each(|&n| area[n as usize] += 1.0);
        tree.accumulate(&mut area);
        assert_eq!(area[0], (width * height) as f64);
        for node in 1..tree.len() as u32 {
            assert_eq!(area[node as usize], tree.pixels(node).len() as f64);
        }
    }

    #[test]
    fn flat_and_empty_images_have_a_root_alone() {
        let job = Monitor::default();
        assert_eq!(Tree::new(&[3; 12], 3, 4, job.job()).unwrap().len(), 1);
        assert_eq!(Tree::new(&[3; 12], 2, 4, job.job()).unwrap().len(), 2);
        assert_eq!(Tree::new(&[], 0, 0, job.job()).unwrap().len(), 1);
    }
}
