//! One tile of the image in a pass: traces the paths of its pixels, alone or in blocks.

use super::block::{BlockPixel, BlockTracer, blocks, seed_of};
use super::camera_rays::{CameraRays, paths};
use super::grid::{AREA, Grid};
use super::pass::Pass;
use super::pixel::{Pixel, REPLICATIONS, paths_of_replication};
use super::roulette::RouletteWeights;
use crate::render::layers::{Layers, TileTotals};
use crate::render::path::{MAX_BOUNCES, PathLength};
use crate::render::world::World;
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of paths of a pixel between two checks whether to stop (cancellation or the deadline): when pixels are traced
/// alone (`SLICE`), and when they are traced in blocks (`BLOCK_SLICE`). [convention]
const SLICE: u32 = 64;
const BLOCK_SLICE: u32 = 16;

/// The data that is the same for all tiles of a pass.
#[derive(Clone, Copy)]
pub struct TileContext<'a> {
    pub world: &'a World,
    pub camera_rays: &'a CameraRays,
    pub seed: u64,
    pub grid: Grid,
    /// Median, over the tiles of the image, of the mean radiance of a tile, per channel; `None` before the first path.
    pub median_radiance: Option<DVec3>,
    /// Number of paths dropped because their radiance was not finite.
    pub discarded: &'a AtomicU64,
}

/// The state of a tile while one worker thread traces its paths.
pub struct Tile<'a> {
    context: TileContext<'a>,
    number: usize,
    pixels: &'a mut [Pixel],
    roulette: Option<RouletteWeights>,
    /// The sums of the layers (light path expressions and surface attributes) for the pixels of the tile, if there are
    /// layers.
    totals: Option<TileTotals<'a>>,
    tracer: BlockTracer<'a>,
}

impl<'a> Tile<'a> {
    pub fn new(
        context: TileContext<'a>,
        number: usize,
        pixels: &'a mut [Pixel],
        layers: Option<&'a Layers<'a>>,
    ) -> Self {
        let roulette = context.median_radiance.map(|median_radiance| RouletteWeights::of(pixels, median_radiance));
        Self {
            context,
            number,
            pixels,
            roulette,
            totals: layers.map(|l| l.totals(number)),
            tracer: BlockTracer::new(layers),
        }
    }

    /// Traces paths until every pixel has the number of paths that `pass` asks for, or until `is_over` returns true.
    pub fn extend(&mut self, pass: &Pass, is_over: impl Fn() -> bool) {
        // Trace the first path of each pixel alone, and all further paths in blocks. Coarse passes have already traced
        // the first path of some pixels, but blocks need equal numbers of paths in all pixels.
        for i in 0..AREA {
            let Some((x, y)) = self.context.grid.place(self.number, i) else { continue };
            let wanted = pass.count(self.number, x, y);
            let alone = if pass.is_dense() { wanted.min(1) } else { wanted };
            while self.pixels[i].count() < alone {
                if is_over() {
                    return;
                }
                self.extend_pixel(i, [x, y], alone.min(self.pixels[i].count() + SLICE));
            }
        }
        let together = if pass.is_dense() { pass.per_pixel(self.number) as u32 } else { 0 };
        while self.pixels[0].count() < together {
            if is_over() {
                return;
            }
            self.extend_blocks(together.min(self.pixels[0].count() + BLOCK_SLICE));
        }
    }

    fn length(&self, pixel: usize) -> PathLength {
        let roulette_weight = self.roulette.as_ref().map(|s| s.weight(&self.pixels[pixel]));
        PathLength { max_bounces: MAX_BOUNCES, roulette_weight }
    }

    /// Traces paths of a single pixel until it has `count` paths.
    fn extend_pixel(&mut self, pixel: usize, at: [usize; 2], count: u32) {
        let length = self.length(pixel);
        let TileContext { world, camera_rays, seed, discarded, .. } = self.context;
        let mut recorder = self.tracer.recorders().map(|recorders| &mut recorders[0]);
        self.pixels[pixel].extend(count, |replication, indices| {
            let seed = seed_of(seed, at, replication);
            paths(world, camera_rays, at, length, (seed, indices), recorder.as_deref_mut(), discarded)
        });
        if let (Some(recorder), Some(totals)) = (recorder, &mut self.totals) {
            recorder.add_to_totals(totals, pixel);
        }
    }

    /// Traces paths in blocks until every pixel has `count` paths. All pixels must have equal numbers of paths before.
    fn extend_blocks(&mut self, count: u32) {
        let TileContext { world, camera_rays, seed, grid, discarded, .. } = self.context;
        let places: [_; AREA] = std::array::from_fn(|i| grid.place(self.number, i));
        let lengths: [PathLength; AREA] = std::array::from_fn(|i| self.length(i));
        let before = self.pixels[0].count();
        let discard = |_| {
            discarded.fetch_add(1, Ordering::Relaxed);
        };
        for replication in 0..REPLICATIONS {
            let indices = paths_of_replication(before, replication)..paths_of_replication(count, replication);
            for block in blocks(replication) {
                let there = block.iter().filter_map(|&i| Some((i, places[i]?)));
                let member = |(i, (x, y))| BlockPixel::new(i, [x, y], lengths[i], seed, replication);
                let members: Vec<BlockPixel> = there.map(member).collect();
                let sums = self.tracer.paths(world, camera_rays, &members, indices.clone(), discard);
                for (k, (member, sum)) in members.iter().zip(sums).enumerate() {
                    self.pixels[member.pixel].add(replication, sum);
                    if let (Some(recorders), Some(totals)) = (self.tracer.recorders(), &mut self.totals) {
                        recorders[k].add_to_totals(totals, member.pixel);
                    }
                }
            }
        }
        (0..AREA).filter(|&i| places[i].is_some()).for_each(|i| self.pixels[i].set_count(count));
    }
}
