//! A block of the texture: the pixels that show nothing yet, and those that patches fill already.

use super::patch_map::NONE;

/// A rectangle of working pixels.
#[derive(Clone, Copy)]
pub struct Rect {
    pub x: usize,
    pub y: usize,
    pub w: usize,
    pub h: usize,
}

/// Pixels of a row of a block, and where in the exemplar the first of them is taken from, one after the other.
#[derive(Clone, Copy)]
pub struct Run {
    pub x: usize,
    pub y: usize,
    pub length: usize,
    pub source: usize,
}

/// A block: its pixels that show nothing yet, and those that show pixels of the exemplar.
pub struct Block {
    pub rect: Rect,
    /// The pixel of the exemplar that each shows, row by row; or [`NONE`].
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
