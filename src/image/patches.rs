//! Patches of an image: pixels with light that hang together.

use super::{Image, try_vec};
use crate::error::Result;

/// The 8-connected patches of pixels of which a colour is above 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Patches {
    /// Of each pixel one more than the number of its patch, or 0; patches are numbered by their first pixel, row by row.
    pub labels: Vec<u32>,
    pub count: usize,
}

impl Patches {
    pub fn of(image: &Image) -> Result<Self> {
        let (width, height) = (image.width, image.height);
        let colours = image.channels.min(3);
        let lit = |i: usize| image.data[i * image.channels..][..colours].iter().any(|&v| v > 0.0);
        let mut labels = try_vec(width * height, 0u32)?;
        let mut open = Vec::new();
        let mut count = 0;
        for start in 0..width * height {
            if labels[start] != 0 || !lit(start) {
                continue;
            }
            // Flood the patch from its first pixel.
            count += 1;
            labels[start] = count;
            open.push(start);
            while let Some(i) = open.pop() {
                let (x, y) = (i % width, i / width);
                for ny in y.saturating_sub(1)..=(y + 1).min(height - 1) {
                    for nx in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                        let next = ny * width + nx;
                        if labels[next] == 0 && lit(next) {
                            labels[next] = count;
                            open.push(next);
                        }
                    }
                }
            }
        }
        Ok(Self { labels, count: count as usize })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_hang_together_by_sides_and_corners() {
        let rows = ["#...#", ".#..#", ".....", "#.#.."];
        let image = Image::from_fn(5, 4, |x, y| [f32::from(u8::from(rows[y].as_bytes()[x] == b'#'))]).unwrap();
        let patches = Patches::of(&image).unwrap();
        assert_eq!(patches.count, 4);
        let found: Vec<String> = patches.labels.chunks(5).map(|r| r.iter().map(u32::to_string).collect()).collect();
        assert_eq!(found, ["10002", "01002", "00000", "30400"]);
        assert_eq!(Patches::of(&Image::new(3, 2, 3).unwrap()).unwrap().count, 0);
    }
}
