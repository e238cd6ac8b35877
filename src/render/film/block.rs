//! Blocks of pixels whose paths share secondary vertices (see `shared`).
//!
//! A replication is one of the four point sequences of a pixel. A block covers 4 × 2 pixels of a tile, or 2 × 4 pixels
//! in every second replication. The errors of the pixels of a block are correlated. A pixel shares its 4 × 2 block and
//! its 2 × 4 block with partly different neighbours, so the mean over the replications shows no pattern of blocks. The
//! division into blocks depends only on the replication and the position in the image.

use super::camera_rays::CameraRays;
use super::grid::{AREA, TILE};
use crate::render::layers::{Layers, Recorder};
use crate::render::path::PathLength;
use crate::render::sampler::Sampler;
use crate::render::shared::{self, MAX_SHARED, Scratch, Start};
use crate::render::tape::{LpeTape, SumTape};
use crate::render::world::World;
use crate::rng;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Number of blocks in one tile.
const BLOCKS: usize = AREA / MAX_SHARED;
/// Longer side of a block in pixels.
const LONGER_SIDE: usize = 4;

/// A pixel of a block, with the length limit and the seed of its paths in one replication (point sequence).
pub struct BlockPixel {
    /// Index of the pixel in its tile.
    pub pixel: usize,
    /// Column and row of the pixel in the image.
    pub at: [usize; 2],
    pub length: PathLength,
    seed: u64,
}

impl BlockPixel {
    /// Builds the data of the pixel at `at` for one replication. `pixel` is its index in the tile, `length` is the
    /// length limit of its paths, and `seed` is the seed of the image, from which the seed of its paths is derived.
    pub fn new(pixel: usize, at: [usize; 2], length: PathLength, seed: u64, replication: u32) -> Self {
        Self { pixel, at, length, seed: seed_of(seed, at, replication) }
    }
}

/// Returns the seed of one replication (point sequence) of the pixel at `at`. `seed` is the seed of the image.
pub fn seed_of(seed: u64, at: [usize; 2], replication: u32) -> u64 {
    rng::mix(rng::hash(seed, &at.map(|v| v as u64)) ^ u64::from(replication))
}

/// Returns, for each block of a tile, the indices of its pixels in the tile. A block has 4 × 2 pixels in the even
/// replications (point sequences), and 2 × 4 pixels in the odd ones.
pub fn blocks(replication: u32) -> [[usize; MAX_SHARED]; BLOCKS] {
    let wide = replication.is_multiple_of(2);
    let (width, height) =
        if wide { (LONGER_SIDE, MAX_SHARED / LONGER_SIDE) } else { (MAX_SHARED / LONGER_SIDE, LONGER_SIDE) };
    let across = TILE / width;
    std::array::from_fn(|block| {
        let (left, top) = (block % across * width, block / across * height);
        std::array::from_fn(|i| (top + i / width) * TILE + left + i % width)
    })
}

/// Traces the paths of blocks of pixels, one block at a time.
pub struct BlockTracer<'a> {
    starts: Vec<Start>,
    scratch: Scratch<SumTape>,
    /// If the film has layers (images of light path expressions or of surface attributes): a recorder for each pixel of
    /// a block, and the scratch memory for replaying recorded paths.
    recorders: Option<(Vec<Recorder<'a>>, Scratch<LpeTape<'a>>)>,
}

impl<'a> BlockTracer<'a> {
    pub fn new(layers: Option<&'a Layers>) -> Self {
        let recorders = layers.map(|l| (l.recorders(), l.scratch()));
        Self { starts: Vec::with_capacity(MAX_SHARED), scratch: Scratch::default(), recorders }
    }

    /// Returns the recorders, one for each pixel of a block; `None` if the film has no layers.
    pub fn recorders(&mut self) -> Option<&mut [Recorder<'a>]> {
        self.recorders.as_mut().map(|(recorders, _)| &mut recorders[..])
    }

    /// Traces paths for the pixels `members` of a block: in each pixel, the paths with the numbers `indices` of one
    /// replication (point sequence). Returns the sum of the paths' radiance for each pixel. If there are recorders,
    /// each records the paths of its pixel. Paths whose radiance is not finite are dropped; for each, `discarded` is
    /// called with the pixel's index in `members`.
    pub fn paths(
        &mut self,
        world: &World,
        camera_rays: &CameraRays,
        members: &[BlockPixel],
        indices: Range<u32>,
        mut discarded: impl FnMut(usize),
    ) -> [DVec3; MAX_SHARED] {
        let mut sums = [DVec3::ZERO; MAX_SHARED];
        for index in indices {
            self.starts.clear();
            self.starts
                .extend(members.iter().map(|m| camera_rays.start(world, m.at, m.length, Sampler::new(m.seed, index))));
            let radiances = match &mut self.recorders {
                None => {
                    let mut observers = [SumTape(Vec3::ZERO); MAX_SHARED];
                    shared::trace(world, &mut self.starts, &mut observers[..members.len()], &mut self.scratch);
                    observers.map(|w| w.0)
                }
                Some((recorders, scratch)) => {
                    let recorders = &mut recorders[..members.len()];
                    recorders.iter_mut().for_each(Recorder::start);
                    shared::trace(world, &mut self.starts, recorders, scratch);
                    let mut radiances = [Vec3::ZERO; MAX_SHARED];
                    radiances.iter_mut().zip(recorders).for_each(|(radiance, r)| *radiance = r.end_path());
                    radiances
                }
            };
            for (member, (sum, radiance)) in sums.iter_mut().zip(radiances).take(members.len()).enumerate() {
                if radiance.is_finite() {
                    *sum += radiance.as_dvec3();
                } else {
                    discarded(member);
                }
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::super::pixel::REPLICATIONS;
    use super::*;

    #[test]
    fn blocks_have_every_pixel_of_a_tile_once() {
        for replication in 0..REPLICATIONS {
            let mut seen = [0; AREA];
            blocks(replication).iter().flatten().for_each(|&pixel| seen[pixel] += 1);
            assert_eq!(seen, [1; AREA]);
        }
        assert_eq!((blocks(0)[1], blocks(1)[1]), ([4, 5, 6, 7, 12, 13, 14, 15], [2, 3, 10, 11, 18, 19, 26, 27]));
    }
}
