//! Finds connected regions of lit pixels in an image, such as the lamps of a light texture.

use super::{Image, try_vec};
use crate::error::Result;
use glam::{DMat2, DVec2};

/// The 8-connected regions of lit pixels: pixels with a colour channel above 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Regions {
    /// For each pixel, 0 if it is dark, or 1 plus the index of its region. Regions are indexed in the row-major order
    /// of their first pixels.
    pub labels: Vec<u32>,
    pub count: usize,
}

/// Place and extent of a region.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    /// Number of pixels.
    pub area: f64,
    /// Mean of the pixel centres.
    pub centre: DVec2,
    /// Covariance of the positions within the region, each pixel being a square.
    pub covariance: DMat2,
    /// Whether the region touches the border of the image, which may cut it.
    pub is_cut: bool,
}

/// Variance, in square pixels, of a position that is uniformly distributed within a pixel. [convention: exact]
const PIXEL_VARIANCE: f64 = 1.0 / 12.0;

/// Number of pixels that are tested for light at once.
const BLOCK: usize = 64;

impl Regions {
    pub fn of(image: &Image) -> Result<Self> {
        let (width, height) = (image.width, image.height);
        let colours = image.channels.min(3);
        let lit = |i: usize| image.data[i * image.channels..][..colours].iter().any(|&v| v > 0.0);
        // Skip blocks of dark pixels: lamps cover little of an image.
        let blocks = image.data.chunks(BLOCK * image.channels.max(1)).enumerate();
        let lit_blocks = blocks.filter(|(_, pixels)| any_light(pixels, image.channels)).map(|(block, _)| block * BLOCK);
        let mut labels = try_vec(width * height, 0u32)?;
        let mut open = Vec::new();
        let mut count = 0;
        for start in lit_blocks.flat_map(|first| first..(first + BLOCK).min(width * height)) {
            if labels[start] != 0 || !lit(start) {
                continue;
            }
            // Flood-fill the region from its first pixel.
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

    /// Returns the moments of each region; `size` is the size of the image.
    pub fn moments(&self, [width, height]: [usize; 2]) -> Result<Vec<Moments>> {
        let none = Moments { area: 0.0, centre: DVec2::ZERO, covariance: DMat2::ZERO, is_cut: false };
        let mut all = try_vec(self.count, none)?;
        let lit = || self.labels.iter().enumerate().filter(|(_, label)| **label > 0);
        let place = |i: usize| DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        for (i, &label) in lit() {
            let region = &mut all[label as usize - 1];
            let (x, y) = (i % width, i / width);
            region.area += 1.0;
            region.centre += place(i);
            region.is_cut |= x == 0 || y == 0 || x + 1 == width || y + 1 == height;
        }
        all.iter_mut().for_each(|region| region.centre /= region.area);
        for (i, &label) in lit() {
            let region = &mut all[label as usize - 1];
            let off = place(i) - region.centre;
            region.covariance += DMat2::from_cols(off * off.x, off * off.y);
        }
        let pixel = DMat2::from_diagonal(DVec2::splat(PIXEL_VARIANCE));
        all.iter_mut().for_each(|region| region.covariance = region.covariance * region.area.recip() + pixel);
        Ok(all)
    }
}

/// Whether any colour channel of these pixels is above 0. With four or more channels, the first three are colours.
pub fn any_light(pixels: &[f32], channels: usize) -> bool {
    match channels {
        0..=3 => pixels.iter().fold(0.0, |high, v| f32::max(high, *v)) > 0.0,
        _ => pixels.chunks_exact(channels).any(|pixel| pixel[..3].iter().any(|v| *v > 0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_connected_by_sides_and_corners() {
        let rows = ["#...#", ".#..#", ".....", "#.#.."];
        let image = Image::from_fn(5, 4, |x, y| [f32::from(u8::from(rows[y].as_bytes()[x] == b'#'))]).unwrap();
        let regions = Regions::of(&image).unwrap();
        assert_eq!(regions.count, 4);
        let found: Vec<String> = regions.labels.chunks(5).map(|r| r.iter().map(u32::to_string).collect()).collect();
        assert_eq!(found, ["10002", "01002", "00000", "30400"]);
        assert_eq!(Regions::of(&Image::new(3, 2, 3).unwrap()).unwrap().count, 0);
    }

    #[test]
    fn light_is_found_wherever_it_is_and_alpha_is_none() {
        for (channels, colours) in [(1, 1), (2, 2), (3, 3), (4, 3), (6, 3)] {
            let mut image = Image::new(29, 11, channels).unwrap();
            for at in (0..29 * 11).step_by(7) {
                for channel in 0..channels {
                    image.data[at * channels + channel] = 1e-30;
                    let regions = Regions::of(&image).unwrap();
                    let found = usize::from(channel < colours);
                    assert_eq!(regions.count, found, "channel {channel} of {channels}");
                    assert_eq!(regions.labels.iter().position(|l| *l == 1), (found == 1).then_some(at));
                    image.data[at * channels + channel] = -1.0;
                }
            }
        }
    }

    #[test]
    fn moments_are_those_of_the_filled_shape() {
        // A rectangle of 6 × 2 pixels, and a pixel in a corner.
        let image = Image::from_fn(12, 8, |x, y| [f32::from((2..8).contains(&x) && (3..5).contains(&y) || x + y == 0)]);
        let regions = Regions::of(&image.unwrap()).unwrap();
        let [corner, rectangle] = regions.moments([12, 8]).unwrap()[..] else { panic!() };
        assert!(corner.is_cut && !rectangle.is_cut);
        assert_eq!((corner.area, corner.centre), (1.0, DVec2::splat(0.5)));
        assert_eq!((rectangle.area, rectangle.centre), (12.0, DVec2::new(5.0, 4.0)));
        // The variance of a uniform position on a side of length a is a² / 12.
        let exact = DMat2::from_diagonal(DVec2::new(36.0, 4.0) / 12.0);
        assert!(rectangle.covariance.abs_diff_eq(exact, 1e-12), "{:?}", rectangle.covariance);
    }
}
