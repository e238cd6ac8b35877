//! The leaves of the binary tree: non-degenerate triangles, paired where two form a quadrilateral, sorted so that
//! neighbours in space are neighbours in the list.
//!
//! Meshes store the two halves of a quadrilateral consecutively. Their boxes nearly coincide, so separating them saves
//! no ray; a shared leaf halves the work of building.

use super::pages;
use super::tree::half_area;
use crate::error::Result;
use crate::exec;
use crate::image::try_with_capacity;
use crate::job::Job;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

/// Triangles per unit of parallel work.
const CHUNK: usize = 4096;
/// Bits of each coordinate in a Morton code.
const BITS: u32 = 21;
/// Lower bound of the extent of a scene scaled to unit size; a flat scene has one layer of cells [rounding].
const MIN_EXTENT: f64 = 1e-9;

pub(super) struct Leaves {
    /// The leaves. Each holds one or two triangles, starting at `first_index`. Boxes are scaled by `scale`.
    pub list: Vec<Bvh2Node>,
    /// Morton codes of the centres with their indices in the list, sorted.
    pub order: Vec<(u64, u32)>,
    /// Scale of the coordinates that prevents overflow of areas: a power of two, which is exact.
    pub scale: f32,
    /// Bounds of all leaves, in the scene's own units.
    pub low: Vec3,
    pub high: Vec3,
    /// Number of triangles without area, which are left out.
    pub dropped: usize,
}

/// Sorts the triangles into leaves.
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
        // Half the surface area of the previous triangle's box, if it is not paired yet.
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
            // A pair is tested whenever its common box is hit, single triangles whenever their own boxes are: pair
            // them if that is cheaper.
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

/// The grid of cells that Morton codes index: the same number of cells along each axis.
struct Grid {
    scale: f32,
    /// In scaled units, as are the cells.
    low: Vec3A,
    per_unit: Vec3A,
}

impl Grid {
    fn over(low: Vec3, high: Vec3) -> Self {
        let extent = high.as_dvec3() - low.as_dvec3();
        let scale = (-extent.max_element().max(f64::MIN_POSITIVE).log2().ceil()).clamp(-126.0, 126.0).exp2();
        let max_cell = DVec3::splat(f64::from((1 << BITS) - 1));
        // A scene that is flat along an axis has one layer there.
        let per_unit = (max_cell / (extent * scale).max(DVec3::splat(MIN_EXTENT))).as_vec3a();
        Self { scale: scale as f32, low: Vec3A::from(low) * scale as f32, per_unit }
    }

    fn code(&self, scaled: &Aabb) -> u64 {
        let cell = (((scaled.min + scaled.max) * 0.5 - self.low) * self.per_unit).as_uvec3();
        spread(cell.x) << 2 | spread(cell.y) << 1 | spread(cell.z)
    }
}

/// Spreads the lowest 21 bits of a number, inserting two zeros after each.
fn spread(number: u32) -> u64 {
    let mut bits = u64::from(number & ((1 << BITS) - 1));
    bits = (bits | bits << 32) & 0x1f_0000_0000_ffff;
    bits = (bits | bits << 16) & 0x1f_0000_ff00_00ff;
    bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
    bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
    (bits | bits << 2) & 0x1249_2492_4924_9249
}
