//! A rectangular part of a texture.

use crate::error::Result;
use crate::image::Image;

/// A rectangular part of a texture, in texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

impl Tile {
    /// The tile with a margin of `by` texels on each side, clipped to a texture of `width` × `height` texels.
    pub fn widened(self, by: usize, width: usize, height: usize) -> Self {
        let (x, y) = (self.x.saturating_sub(by), self.y.saturating_sub(by));
        let end = |start: usize, side: usize, whole: usize| start.saturating_add(side).saturating_add(by).min(whole);
        Self { x, y, width: end(self.x, self.width, width) - x, height: end(self.y, self.height, height) - y }
    }

    /// Cuts this tile out of an image of the larger tile `around`.
    pub fn cut(self, image: &Image, around: Self) -> Result<Image> {
        let mut out = Image::new(self.width, self.height, image.channels)?;
        let (dx, dy) = (self.x - around.x, self.y - around.y);
        for (y, row) in out.data.chunks_exact_mut(self.width * image.channels).enumerate() {
            let start = ((y + dy) * image.width + dx) * image.channels;
            row.copy_from_slice(&image.data[start..start + row.len()]);
        }
        Ok(out)
    }
}
