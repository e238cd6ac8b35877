//! A block of the texture: its empty pixels, and the pixels that patches have already filled.

use super::patch_map::NONE;

/// A rectangle of working pixels.
#[derive(Clone, Copy)]
pub struct Rect {
    pub x: usize,
    pub y: usize,
    pub w: usize,
    pub h: usize,
}

/// Adjacent pixels in a row of a block, and the pixel of the exemplar that the first of them shows; the others show the
/// pixels that follow it.
#[derive(Clone, Copy)]
pub struct Run {
    pub x: usize,
    pub y: usize,
    pub length: usize,
    pub source: usize,
}

/// A block: its empty pixels, and its filled pixels, which show pixels of the exemplar.
pub struct Block {
    pub rect: Rect,
    /// For each pixel of the block, row by row, the pixel of the exemplar that it shows; or [`NONE`].
    pub known: Vec<u32>,
    pub empty: Vec<Run>,
    pub filled: Vec<Run>,
}

/// Number of pixels in some runs.
pub fn count(runs: &[Run]) -> usize {
    runs.iter().map(|r| r.length).sum()
}

impl Block {
    pub fn add(&mut self, run: Run) {
        let runs = if run.source == NONE as usize { &mut self.empty } else { &mut self.filled };
        runs.push(run);
    }
}
