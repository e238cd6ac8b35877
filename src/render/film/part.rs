//! A part of a render, and the division of a render into parts.

use super::grid::TILE;
use crate::error::{Error, Result, check_range};
use crate::render::params::Params;
use std::fmt;

/// A part of a render: a rectangle of the image, in pixels from the top-left corner, and a range of the paths of each
/// of its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
    /// Index of the first path (`first`), and number of paths (`samples`).
    pub first: u32,
    pub samples: u32,
}

impl Part {
    /// Returns the part that is the whole image with all paths.
    pub fn whole(params: &Params) -> Self {
        Self { x: 0, y: 0, width: params.width, height: params.height, first: 0, samples: params.samples }
    }

    /// Returns part number `index` of a division into `columns` × `rows` rectangles and `ranges` ranges of paths, all
    /// of about equal size. Rectangles are numbered row by row. All rectangles with the first range come first, then
    /// all rectangles with the second range, and so on.
    pub fn split(params: &Params, [columns, rows, ranges]: [u32; 3], index: u32) -> Result<Self> {
        params.check()?;
        check_range("columns", columns as usize, 1, params.width)?;
        check_range("rows", rows as usize, 1, params.height)?;
        check_range("ranges", ranges, 1, params.samples)?;
        let count = u64::from(columns) * u64::from(rows) * u64::from(ranges);
        check_range("index", u64::from(index), 0, count - 1)?;
        let rectangle = (u64::from(index) % (u64::from(columns) * u64::from(rows))) as u32;
        let range = (u64::from(index) / (u64::from(columns) * u64::from(rows))) as u32;
        let [x, right] = [0, 1].map(|end| bound(params.width, columns, rectangle % columns + end, TILE));
        let [y, bottom] = [0, 1].map(|end| bound(params.height, rows, rectangle / columns + end, TILE));
        let [first, last] = [0, 1].map(|end| bound(params.samples as usize, ranges, range + end, 1) as u32);
        Ok(Self { x, y, width: right - x, height: bottom - y, first, samples: last - first })
    }

    pub fn has(&self, [x, y]: [usize; 2]) -> bool {
        x.wrapping_sub(self.x) < self.width && y.wrapping_sub(self.y) < self.height
    }

    pub fn check(&self, params: &Params) -> Result<()> {
        let within = |start: usize, size: usize, whole: usize| size > 0 && start < whole && size <= whole - start;
        let paths = (self.first as usize, self.samples as usize, params.samples as usize);
        if within(self.x, self.width, params.width)
            && within(self.y, self.height, params.height)
            && within(paths.0, paths.1, paths.2)
        {
            return Ok(());
        }
        Err(Error::argument(format!(
            "the part is {self}; it must have pixels and paths, all of them of an image of {} x {} pixels with samples = {}",
            params.width, params.height, params.samples
        )))
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { x, y, width, height, first, samples } = self;
        let last = first.saturating_add(*samples).saturating_sub(1);
        write!(f, "paths {first} to {last} of the {width} x {height} pixels at ({x}, {y})")
    }
}

/// Returns the start of piece number `piece` when `size` is divided into `count` pieces of about equal size; `size` if
/// `piece` is `count`. If a piece has a size of at least `4 * unit`, the start is rounded down to a multiple of `unit`.
fn bound(size: usize, count: u32, piece: u32, unit: usize) -> usize {
    let exact = (size as u64 * u64::from(piece) / u64::from(count)) as usize;
    if exact == size || size / (count as usize) < 4 * unit { exact } else { exact / unit * unit }
}
