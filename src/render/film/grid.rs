//! Tiles of an image: the order in which pixels are kept.

/// Side of a tile in pixels: the unit of work, and of the decision where more paths go.
pub const TILE: usize = 8;
/// Pixels of a tile.
pub const AREA: usize = TILE * TILE;

/// An image cut into tiles, row by row; those at the right and lower border stick out of it.
#[derive(Clone, Copy)]
pub struct Grid {
    pub width: usize,
    pub height: usize,
}

impl Grid {
    pub fn across(&self) -> usize {
        self.width.div_ceil(TILE)
    }

    pub fn down(&self) -> usize {
        self.height.div_ceil(TILE)
    }

    pub fn tiles(&self) -> usize {
        self.across() * self.down()
    }

    /// Column and row of the first pixel of a tile.
    pub fn corner(&self, tile: usize) -> (usize, usize) {
        (tile % self.across() * TILE, tile / self.across() * TILE)
    }

    /// Column and row of a pixel of a tile, if the image has it.
    pub fn place(&self, tile: usize, pixel: usize) -> Option<(usize, usize)> {
        let (left, top) = self.corner(tile);
        let (x, y) = (left + pixel % TILE, top + pixel / TILE);
        (x < self.width && y < self.height).then_some((x, y))
    }

    /// The tile of a pixel and its number in it.
    pub fn locate(&self, x: usize, y: usize) -> (usize, usize) {
        (y / TILE * self.across() + x / TILE, y % TILE * TILE + x % TILE)
    }

    /// How many pixels of a tile the image has.
    pub fn area(&self, tile: usize) -> usize {
        let part = |at: usize, size: usize| TILE.min(size - at * TILE);
        part(tile % self.across(), self.width) * part(tile / self.across(), self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_has_one_place() {
        for (width, height) in [(1, 1), (8, 8), (17, 9), (3, 40)] {
            let grid = Grid { width, height };
            let mut seen = vec![0; width * height];
            for tile in 0..grid.tiles() {
                let places: Vec<_> = (0..AREA).filter_map(|i| grid.place(tile, i).map(|p| (i, p))).collect();
                assert_eq!(places.len(), grid.area(tile));
                for (i, (x, y)) in places {
                    assert_eq!(grid.locate(x, y), (tile, i));
                    seen[y * width + x] += 1;
                }
            }
            assert!(seen.iter().all(|&n| n == 1));
        }
    }
}
