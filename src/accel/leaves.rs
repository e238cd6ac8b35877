//! The leaves of the binary tree. Each holds one triangle, or two consecutive triangles with nearly the same box. The
//! leaves are ordered by Morton code, so that neighbours in space are neighbours in this order.
//!
//! Meshes store the two halves of a quadrilateral consecutively. Their boxes nearly coincide, so almost every ray that
//! hits one box hits both, and separate leaves would save nothing. Shared leaves halve the work of building the tree.

use super::pages;
use super::tree::half_area;
use crate::error::Result;
use crate::exec;
use crate::image::try_with_capacity;
use crate::job::Job;
use crate::maths;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

/// Triangles per unit of parallel work.
const CHUNK: usize = 4096;
/// Bits per coordinate in a Morton code.
const BITS: u32 = 21;
/// Lower bound of the scene's extent along an axis, relative to its largest extent. It avoids a division by zero if
/// the scene is flat along an axis. [rounding]
const MIN_EXTENT: f64 = 1e-9;

pub(super) struct Leaves {
    /// The leaves. Each holds one or two consecutive triangles, the first of which has the index `first_index`. The
    /// boxes are multiplied by `scale`.
    pub list: Vec<Bvh2Node>,
    /// Morton codes of the box centres, each with its leaf's index in `list`, sorted.
    pub order: Vec<(u64, u32)>,
    /// Factor by which the boxes are multiplied so that their areas do not overflow. It is a power of two, so scaling
    /// is exact.
    pub scale: f32,
    /// Bounds of all leaves, in the scene's own units.
    pub low: Vec3,
    pub high: Vec3,
    /// Number of degenerate triangles, which are left out.
    pub dropped: usize,
}

/// Pairs triangles into leaves, scales their boxes, and sorts the leaves by Morton code.
pub(super) fn gather(triangles: &[[Vec3; 3]], job: Job) -> Result<Leaves> {
    let chunks: Vec<Chunk> = triangles
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(i, chunk)| {
            job.check()?;
            Chunk::gather(chunk, (i * CHUNK) as u32)
        })
        .collect::<Result<_>>()?;
    let low = chunks.iter().fold(Vec3::INFINITY, |low, chunk| low.min(chunk.low.into()));
    let high = chunks.iter().fold(Vec3::NEG_INFINITY, |high, chunk| high.max(chunk.high.into()));
    let dropped = chunks.iter().map(|chunk| chunk.dropped).sum();
    let len = chunks.iter().map(|chunk| chunk.leaves.len()).sum();
    let grid = Grid::over(low, high);

    let mut list = pages::filled(len, Bvh2Node::default(), job)?;
    let mut order = pages::filled(len, (0, 0), job)?;
    let (mut leaves_left, mut order_left, mut first) = (&mut list[..], &mut order[..], 0);
    let mut targets = Vec::with_capacity(chunks.len());
    for chunk in chunks {
        let (leaves, order, len) = (leaves_left, order_left, chunk.leaves.len());
        let (leaves, after) = leaves.split_at_mut(len);
        leaves_left = after;
        let (order, after) = order.split_at_mut(len);
        order_left = after;
        targets.push((first, chunk, leaves, order));
        first += len as u32;
    }
    targets.into_par_iter().try_for_each(|(first, chunk, leaves, order)| {
        job.check()?;
        for (i, ((leaf, place), &unscaled)) in leaves.iter_mut().zip(order).zip(&chunk.leaves).enumerate() {
            *leaf = unscaled;
            leaf.set_aabb(Aabb::new(unscaled.aabb().min * grid.scale, unscaled.aabb().max * grid.scale));
            *place = (grid.code(leaf.aabb()), first + i as u32);
        }
        Ok(())
    })?;
    exec::sort(&mut order, job)?;
    Ok(Leaves { list, order, scale: grid.scale, low, high, dropped })
}

struct Chunk {
    leaves: Vec<Bvh2Node>,
    low: Vec3A,
    high: Vec3A,
    dropped: usize,
}

impl Chunk {
    fn gather(triangles: &[[Vec3; 3]], first: u32) -> Result<Self> {
        let leaves = try_with_capacity(triangles.len())?;
        let mut chunk = Self { leaves, low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY, dropped: 0 };
        // Half the surface area of the previous triangle's box. `None` if there is no previous triangle, or if the
        // previous triangle is degenerate or already in a pair.
        let mut alone: Option<f32> = None;
        for (i, corners) in triangles.iter().enumerate() {
            if !has_area(corners) {
                chunk.dropped += 1;
                alone = None;
                continue;
            }
            let [a, b, c] = corners.map(Vec3A::from);
            let this = Aabb::new(a.min(b).min(c), a.max(b).max(c));
            chunk.low = chunk.low.min(this.min);
            chunk.high = chunk.high.max(this.max);
            let area = half_area(&this);
            // Pair this triangle with the previous one if that lowers the expected cost of a ray. By the surface area
            // heuristic, a pair costs the area of its common box, and two single triangles cost the sum of the areas
            // of their boxes. Require a saving of a quarter. [bench rays]
            if let Some(before) = alone.take()
                && let Some(leaf) = chunk.leaves.last_mut()
                && let both = leaf.aabb().union(&this)
                && half_area(&both) < 0.75 * (area + before)
            {
                *leaf = Bvh2Node::new(both, 2, leaf.first_index);
            } else {
                chunk.leaves.push(Bvh2Node::new(this, 1, first + i as u32));
                alone = Some(area);
            }
        }
        Ok(chunk)
    }
}

fn has_area(corners: &[Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let doubled = (b - a).cross(c - a).length_squared();
    doubled.is_finite() && doubled > 0.0
}

/// The grid of cells to which the Morton codes refer. It has the same number of cells along each axis.
struct Grid {
    scale: f32,
    /// Lower corner of the grid in scaled units.
    low: Vec3A,
    per_unit: Vec3A,
}

impl Grid {
    fn over(low: Vec3, high: Vec3) -> Self {
        let extent = high.as_dvec3() - low.as_dvec3();
        let scale =
            maths::exp2((-maths::log2(extent.max_element().max(f64::MIN_POSITIVE)).ceil()).clamp(-126.0, 126.0));
        let max_cell = DVec3::splat(f64::from((1 << BITS) - 1));
        // Bound the extent from below to avoid a division by zero. If the scene is flat along an axis, all boxes then
        // lie in one layer of cells.
        let per_unit = (max_cell / (extent * scale).max(DVec3::splat(MIN_EXTENT))).as_vec3a();
        Self { scale: scale as f32, low: Vec3A::from(low) * scale as f32, per_unit }
    }

    fn code(&self, scaled: &Aabb) -> u64 {
        let cell = (((scaled.min + scaled.max) * 0.5 - self.low) * self.per_unit).as_uvec3();
        spread(cell.x) << 2 | spread(cell.y) << 1 | spread(cell.z)
    }
}

/// Moves bit `i` of a number to bit `3 i`, for its lowest 21 bits: 0b111 becomes 0b1001001.
fn spread(number: u32) -> u64 {
    let mut bits = u64::from(number & ((1 << BITS) - 1));
    bits = (bits | bits << 32) & 0x1f_0000_0000_ffff;
    bits = (bits | bits << 16) & 0x1f_0000_ff00_00ff;
    bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
    bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
    (bits | bits << 2) & 0x1249_2492_4924_9249
}
