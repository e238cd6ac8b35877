//! Pyramid levels, each with half the resolution of the next finer one.

use crate::error::Result;
use crate::image::{Image, pyramid, try_collect};
use crate::job::Job;

/// Returns the side of an image after `level` halvings; at least 1.
pub fn level_size(side: usize, level: usize) -> usize {
    (side >> level).max(1)
}

/// Returns the number of levels on which the shortest side has at least `smallest` pixels; between 1 and `wanted`.
pub fn level_count(shortest_side: usize, smallest: usize, wanted: usize) -> usize {
    (1..wanted.max(1)).take_while(|&l| level_size(shortest_side, l) >= smallest).count() + 1
}

/// Halves an image by 2 × 2 averages (area averages if a side is odd).
pub fn halve(image: &Image, job: Job) -> Result<Image> {
    pyramid::resize(image, level_size(image.width, 1), level_size(image.height, 1), job)
}

/// Halves a mask: a pixel is set if all pixels that it covers are set; with `any`, if at least one of them is set.
pub fn halve_mask(mask: &[bool], width: usize, height: usize, any: bool) -> Result<Vec<bool>> {
    let (w, h) = (level_size(width, 1), level_size(height, 1));
    let span = |i: usize, n: usize, of: usize| i * of / n..((i + 1) * of).div_ceil(n);
    try_collect((0..w * h).map(|i| {
        let mut below = span(i / w, h, height).flat_map(|y| span(i % w, w, width).map(move |x| mask[y * width + x]));
        if any { below.any(|m| m) } else { below.all(|m| m) }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_stop_before_the_image_is_smaller_than_asked() {
        assert_eq!(level_count(912, 25, 6), 6);
        assert_eq!(level_count(912, 25, 20), 6);
        assert_eq!(level_count(912, 25, 3), 3);
        assert_eq!(level_count(1, 25, 6), 1);
        assert_eq!((level_size(5, 1), level_size(1, 4)), (2, 1));
    }

    #[test]
    fn masks_shrink_by_all_or_any() {
        let mask = [true, true, false, true, true, true, false, false, false];
        assert_eq!(halve_mask(&mask, 3, 3, false).unwrap(), [false]);
        assert_eq!(halve_mask(&mask, 3, 3, true).unwrap(), [true]);
    }
}
