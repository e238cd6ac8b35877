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

    /// Cuts this tile out of an image of the larger tile `around`. If this tile fills at least half of the image, the
    /// result reuses the memory of the image. To allocate a new image for each tile would cost as much time as a
    /// quarter of the rendering.
    pub fn cut(self, mut image: Image, around: Self) -> Result<Image> {
        let row = self.width * image.channels;
        let (dx, dy) = (self.x - around.x, self.y - around.y);
        let (width, channels) = (image.width, image.channels);
        let source = |y: usize| {
            let start = ((y + dy) * width + dx) * channels;
            start..start + row
        };
        if 2 * row * self.height < image.data.len() {
            let mut out = Image::new(self.width, self.height, channels)?;
            let rows = out.data.chunks_exact_mut(row).enumerate();
            rows.for_each(|(y, out)| out.copy_from_slice(&image.data[source(y)]));
            return Ok(out);
        }
        // Each row moves towards the start of the data, so it overwrites no row that has yet to be moved.
        (0..self.height).for_each(|y| image.data.copy_within(source(y), y * row));
        image.data.truncate(row * self.height);
        Ok(Image { width: self.width, height: self.height, ..image })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_is_cut_out_of_a_slightly_and_of_a_much_larger_one() {
        let of = |tile: Tile| {
            let value = |x: usize, y: usize| (100 * (tile.y + y) + tile.x + x) as f32;
            Image::from_fn(tile.width, tile.height, |x, y| [value(x, y), -value(x, y)]).unwrap()
        };
        let tile = Tile { x: 10, y: 20, width: 9, height: 8 };
        for by in [0, 1, 2, 7, 30] {
            let around = tile.widened(by, 60, 50);
            assert_eq!(tile.cut(of(around), around).unwrap(), of(tile), "{by} texels around");
        }
    }
}
