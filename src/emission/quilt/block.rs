//! A block of the texture: its empty pixels, and the pixels that earlier patches have filled.

use super::patch_map::NONE;

/// A rectangle of the texture in working pixels, the pixels at the reduced size of the synthesis. `x` and `y` are its
/// first column and row.
#[derive(Clone, Copy)]
pub struct Rect {
    pub x: usize,
    pub y: usize,
    pub w: usize,
    pub h: usize,
}

/// A run of adjacent pixels in a row of a block, which starts at the texture's pixel (`x`, `y`). `source` is the index
/// of the exemplar pixel that the first pixel of the run shows; the next pixel shows the exemplar pixel `source` + 1,
/// and so on. In a run of empty pixels, `source` is [`NONE`].
#[derive(Clone, Copy)]
pub struct Run {
    pub x: usize,
    pub y: usize,
    pub length: usize,
    pub source: usize,
}

/// A block of the texture. `empty` and `filled` list its pixels as runs: pixels without a patch, and pixels that show
/// pixels of the exemplar.
pub struct Block {
    pub rect: Rect,
    /// For each pixel of the block, row by row, the index of the exemplar pixel that it shows, or [`NONE`].
    pub known: Vec<u32>,
    pub empty: Vec<Run>,
    pub filled: Vec<Run>,
}

/// Total number of pixels in the given runs.
pub fn count(runs: &[Run]) -> usize {
    runs.iter().map(|r| r.length).sum()
}

impl Block {
    pub fn add(&mut self, run: Run) {
        let runs = if run.source == NONE as usize { &mut self.empty } else { &mut self.filled };
        runs.push(run);
    }
}
