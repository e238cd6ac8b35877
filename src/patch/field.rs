//! The nearest-neighbour field: a match for each patch of an image.

use super::domain::Domain;
use super::position::{NONE, pack, unpack};
use crate::error::Result;
use crate::image::{try_collect, try_vec};

/// For each patch of one image, its match in another image and the distance between patch and match.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Number of patches along x and y.
    pub width: usize,
    pub height: usize,
    /// Packed positions of the matches, or [`NONE`].
    pub at: Vec<u32>,
    /// Distances. `u32::MAX` marks a patch without a match, and a match that is only an initial position for the search
    /// (a hint).
    pub error: Vec<u32>,
}

impl Field {
    pub fn new(width: usize, height: usize) -> Result<Self> {
        Ok(Self { width, height, at: try_vec(width * height, NONE)?, error: try_vec(width * height, u32::MAX)? })
    }

    /// Returns a copy, or an error if memory is short.
    pub fn try_clone(&self) -> Result<Self> {
        let copy = |list: &[u32]| try_collect(list.iter().copied());
        Ok(Self { at: copy(&self.at)?, error: copy(&self.error)?, ..*self })
    }

    /// Returns a field of hints (initial positions for the search): each patch points to the same relative position
    /// among the patches of `base`.
    pub fn proportional(width: usize, height: usize, base: &Domain) -> Result<Self> {
        let mut field = Self::new(width, height)?;
        for (i, at) in field.at.iter_mut().enumerate() {
            *at = pack((i % width) * base.width / width, (i / width) * base.height / height);
        }
        Ok(field)
    }

    /// Returns the field at twice the resolution. Its matches are hints, initial positions for the search. Each match
    /// is twice the coarse match plus the parity of the fine position, clamped to `base`. If the finer image has more
    /// than twice the patches of the coarse image, the extra patches continue the match of the last coarse patch.
    pub fn upsample(&self, width: usize, height: usize, base: &Domain) -> Result<Self> {
        let mut field = Self::new(width, height)?;
        for (i, at) in field.at.iter_mut().enumerate() {
            let (x, y) = (i % width, i / width);
            let (cx, cy) = ((x / 2).min(self.width - 1), (y / 2).min(self.height - 1));
            let coarse = self.at[cy * self.width + cx];
            if coarse != NONE {
                let (px, py) = unpack(coarse);
                *at = pack((2 * px + x - 2 * cx).min(base.width - 1), (2 * py + y - 2 * cy).min(base.height - 1));
            }
        }
        Ok(field)
    }

    /// Returns the inverse field: for each patch of `base`, the patch of this field that is matched to it, and the
    /// distance between the two. Hints, which have no distance yet, are left out. If several patches share a match,
    /// the closest one is taken (the first, if equal).
    pub fn invert(&self, base: &Domain) -> Result<Self> {
        let mut inverse = Self::new(base.width, base.height)?;
        for (i, (&at, &error)) in self.at.iter().zip(&self.error).enumerate() {
            if at != NONE && error != u32::MAX {
                let (px, py) = unpack(at);
                let j = py * base.width + px;
                if error < inverse.error[j] {
                    inverse.error[j] = error;
                    inverse.at[j] = pack(i % self.width, i / self.width);
                }
            }
        }
        Ok(inverse)
    }

    /// Stores matches and distances computed row by row.
    pub(super) fn set_rows(&mut self, rows: Vec<Vec<(u32, u32)>>) {
        for (i, (at, error)) in rows.into_iter().flatten().enumerate() {
            (self.at[i], self.error[i]) = (at, error);
        }
    }

    /// Returns the sum of the distances of matched patches.
    pub fn energy(&self) -> f64 {
        self.error.iter().filter(|&&e| e != u32::MAX).map(|&e| f64::from(e)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_survives_upsampling_to_odd_sizes_and_inversion() {
        for (w, h) in [(6usize, 5usize), (7, 4), (1, 1), (13, 9)] {
            // With patches of width 5, an image of (w + 4) × (h + 4) pixels has w × h patches. The image of half the
            // size has less than half as many patches along each side.
            let (cw, ch) = (((w + 4) / 2).saturating_sub(4).max(1), ((h + 4) / 2).saturating_sub(4).max(1));
            let coarse_base = Domain::new(cw, ch, 1, None, false).unwrap();
            let base = Domain::new(w, h, 1, None, false).unwrap();
            let coarse = Field::proportional(cw, ch, &coarse_base).unwrap();
            let mut fine = coarse.upsample(w, h, &base).unwrap();
            assert!(fine.at.iter().enumerate().all(|(i, &at)| at == pack(i % w, i / w)));
            fine.error.fill(1);
            assert_eq!(fine.invert(&base).unwrap(), fine);
        }
    }

    #[test]
    fn inversion_keeps_the_closest_and_among_equals_the_first() {
        let base = Domain::new(2, 1, 1, None, false).unwrap();
        let field = Field { width: 4, height: 1, at: vec![0, 0, 0, NONE], error: vec![5, 3, 3, 1] };
        let inverse = field.invert(&base).unwrap();
        assert_eq!((inverse.at, inverse.error), (vec![1, NONE], vec![3, u32::MAX]));
    }
}
