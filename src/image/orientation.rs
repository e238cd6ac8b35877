//! Turns a photo upright, by the orientation that its file states, while the photo is read.

use crate::error::Result;
use crate::image::Image;

/// The orientation of a stored photo: the value 1 to 8 of the EXIF tag Orientation (JEITA CP-3451, 4.6.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orientation(u8);

impl Default for Orientation {
    fn default() -> Self {
        Self::UPRIGHT
    }
}

impl Orientation {
    /// The file stores the picture upright: its first row is the top row, its first column the leftmost one.
    pub const UPRIGHT: Self = Self(1);

    pub fn new(code: u64) -> Option<Self> {
        (1..=8).contains(&code).then_some(Self(code as u8))
    }

    pub fn code(self) -> u8 {
        self.0
    }

    /// Whether the stored rows are columns of the upright picture.
    pub fn is_transposed(self) -> bool {
        self.0 >= 5
    }

    /// Returns whether to mirror the picture left to right, and whether to mirror it top to bottom. If the picture is
    /// also transposed, it is mirrored afterwards.
    fn mirrors(self) -> [bool; 2] {
        [matches!(self.0, 2 | 3 | 6 | 7), matches!(self.0, 3 | 4 | 7 | 8)]
    }
}

/// An upright image whose pixels are written in the order in which the file stores them.
pub struct Upright {
    pub image: Image,
    /// `start` is the index in `image.data` of the file's first pixel; `steps` are the changes of this index from one
    /// column, and from one row, of the file to the next.
    start: isize,
    steps: [isize; 2],
}

impl Upright {
    /// Allocates the upright image of a stored picture of `width` columns and `height` rows.
    pub fn new(width: usize, height: usize, channels: usize, orientation: Orientation) -> Result<Self> {
        let is_transposed = orientation.is_transposed();
        let image =
            if is_transposed { Image::new(height, width, channels)? } else { Image::new(width, height, channels)? };
        // Write each axis of the upright picture forwards from its first column or row. Write a mirrored axis backwards
        // from its last column or row.
        let ahead = [channels, image.row_len()];
        let ends = [image.width - 1, image.height - 1];
        let (mut start, mut steps) = (0, [0; 2]);
        for (axis, is_mirrored) in orientation.mirrors().into_iter().enumerate() {
            let step = ahead[axis] as isize;
            steps[axis] = if is_mirrored { -step } else { step };
            start += if is_mirrored { step * ends[axis] as isize } else { 0 };
        }
        if is_transposed {
            steps.swap(0, 1);
        }
        Ok(Self { image, start, steps })
    }

    /// Returns the samples of the pixel at column `x` and row `y` of the file.
    #[inline(always)]
    pub fn pixel(&mut self, x: usize, y: usize) -> &mut [f32] {
        let at = (self.start + x as isize * self.steps[0] + y as isize * self.steps[1]) as usize;
        &mut self.image.data[at..at + self.image.channels]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_columns_go_where_the_standard_says() {
        // An upright picture of three columns and two rows, as stored in each orientation. The tag names the side of
        // the scene at which the first row lies, and then the side of the first column.
        let stored: [(&[&str], &str); 8] = [
            (&["abc", "def"], "top, left"),
            (&["cba", "fed"], "top, right"),
            (&["fed", "cba"], "bottom, right"),
            (&["def", "abc"], "bottom, left"),
            (&["ad", "be", "cf"], "left, top"),
            (&["cf", "be", "ad"], "right, top"),
            (&["fc", "eb", "da"], "right, bottom"),
            (&["da", "eb", "fc"], "left, bottom"),
        ];
        for (code, (rows, sides)) in (1..).zip(stored) {
            let orientation = Orientation::new(code).unwrap();
            let mut out = Upright::new(rows[0].len(), rows.len(), 2, orientation).unwrap();
            for (y, row) in rows.iter().enumerate() {
                for (x, letter) in row.bytes().enumerate() {
                    out.pixel(x, y).copy_from_slice(&[letter.into(), 1.0]);
                }
            }
            assert_eq!((out.image.width, out.image.height), (3, 2));
            let letters: Vec<u8> = out.image.data.chunks_exact(2).map(|p| p[0] as u8).collect();
            assert_eq!(letters, b"abcdef", "{sides}");
            assert!(out.image.data.iter().skip(1).step_by(2).all(|&v| v == 1.0));
        }
        assert_eq!([0, 9, 1 << 40].map(Orientation::new), [None; 3]);
    }
}
