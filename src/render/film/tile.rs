//! The paths of one tile of the image, pass by pass.

use super::block::{Maker, Member, blocks, seed_of};
use super::grid::{AREA, Grid};
use super::pixel::{Pixel, REPLICATIONS, share};
use super::plan::Pass;
use super::worth::Surroundings;
use super::{Eye, paths};
use crate::render::layers::{Kept, Layers};
use crate::render::path::Length;
use crate::render::world::World;
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};

/// Paths of a pixel between two looks at the clock, alone and together with the others of its tile.
const SLICE: u32 = 64;
const SLICE_TOGETHER: u32 = 16;

/// What the paths of all tiles have in common.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    pub world: &'a World,
    pub eye: &'a Eye,
    pub seed: u64,
    pub grid: Grid,
    /// The brightness of the middling tile.
    pub level: Option<DVec3>,
    /// Paths that were left out because their radiance was no finite number.
    pub discarded: &'a AtomicU64,
}

/// A tile in the hands of a worker.
pub struct Tile<'a> {
    setting: Setting<'a>,
    number: usize,
    pixels: &'a mut [Pixel],
    surroundings: Option<Surroundings>,
    /// What is kept of its layers.
    kept: Option<Kept<'a>>,
    maker: Maker<'a>,
}

impl<'a> Tile<'a> {
    pub fn new(setting: Setting<'a>, number: usize, pixels: &'a mut [Pixel], layers: Option<&'a Layers<'a>>) -> Self {
        let surroundings = setting.level.map(|level| Surroundings::of(pixels, level));
        Self { setting, number, pixels, surroundings, kept: layers.map(|l| l.kept(number)), maker: Maker::new(layers) }
    }

    /// Extends the paths of every pixel to what the pass asks for, or until the time is over.
    pub fn extend(&mut self, pass: &Pass, is_over: impl Fn() -> bool) {
        // The first path of each pixel is alone, as coarse passes make it; from then on those of a tile go together.
        for i in 0..AREA {
            let Some((x, y)) = self.setting.grid.place(self.number, i) else { continue };
            let wanted = pass.count(self.number, x, y);
            let alone = if pass.is_dense() { wanted.min(1) } else { wanted };
            while self.pixels[i].count() < alone {
                if is_over() {
                    return;
                }
                self.go_alone(i, [x, y], alone.min(self.pixels[i].count() + SLICE));
            }
        }
        let together = if pass.is_dense() { pass.per_pixel(self.number) as u32 } else { 0 };
        while self.pixels[0].count() < together {
            if is_over() {
                return;
            }
            self.go_together(together.min(self.pixels[0].count() + SLICE_TOGETHER));
        }
    }

    fn length(&self, pixel: usize) -> Length {
        let worth = self.surroundings.as_ref().map(|s| s.worth(&self.pixels[pixel]));
        Length { most: self.setting.eye.most, worth }
    }

    /// Extends the paths of a pixel.
    fn go_alone(&mut self, pixel: usize, at: [usize; 2], count: u32) {
        let length = self.length(pixel);
        let Setting { world, eye, seed, discarded, .. } = self.setting;
        let mut recorder = self.maker.recorders().map(|recorders| &mut recorders[0]);
        self.pixels[pixel].extend(count, |replication, indices| {
            let seed = seed_of(seed, at, replication);
            paths(world, eye, at, length, (seed, indices), recorder.as_deref_mut(), discarded)
        });
        if let (Some(recorder), Some(kept)) = (recorder, &mut self.kept) {
            recorder.keep(kept, pixel);
        }
    }

    /// Extends the paths of all pixels, of which each has as many.
    fn go_together(&mut self, count: u32) {
        let Setting { world, eye, seed, grid, discarded, .. } = self.setting;
        let places: [_; AREA] = std::array::from_fn(|i| grid.place(self.number, i));
        let lengths: [Length; AREA] = std::array::from_fn(|i| self.length(i));
        let before = self.pixels[0].count();
        let discard = |_| {
            discarded.fetch_add(1, Ordering::Relaxed);
        };
        for replication in 0..REPLICATIONS {
            let indices = share(before, replication)..share(count, replication);
            for block in blocks(replication) {
                let there = block.iter().filter_map(|&i| Some((i, places[i]?)));
                let member = |(i, (x, y))| Member::new(i, [x, y], lengths[i], seed, replication);
                let members: Vec<Member> = there.map(member).collect();
                let sums = self.maker.paths(world, eye, &members, indices.clone(), discard);
                for (k, (member, sum)) in members.iter().zip(sums).enumerate() {
                    self.pixels[member.pixel].add(replication, sum);
                    if let (Some(recorders), Some(kept)) = (self.maker.recorders(), &mut self.kept) {
                        recorders[k].keep(kept, member.pixel);
                    }
                }
            }
        }
        (0..AREA).filter(|&i| places[i].is_some()).for_each(|i| self.pixels[i].set_count(count));
    }
}
