//! Sets of patches of an image, for instance of the patches that may be used as matches.

use super::position::pack;
use crate::error::Result;
use crate::image::{try_collect, try_vec, try_with_capacity};

/// A set of patches of one image.
#[derive(Debug)]
pub struct Domain {
    /// Number of patches along x and y.
    pub width: usize,
    pub height: usize,
    member: Vec<bool>,
    /// The members in scan order; may include removed members until [`Domain::compact`] is called.
    list: Vec<u32>,
    count: usize,
}

impl Domain {
    /// Returns the patches of width `patch` in an image of `width × height` pixels that lie entirely inside the mask.
    /// With `any`, patches that only overlap the mask are included. Without a mask, all patches are included.
    pub fn new(width: usize, height: usize, patch: usize, mask: Option<&[bool]>, any: bool) -> Result<Self> {
        let (w, h) = (width + 1 - patch, height + 1 - patch);
        let mut member = try_vec(w * h, true)?;
        if let Some(mask) = mask {
            // Count mask pixels by running sums, along x and then along y.
            let mut along_x = try_vec(w * height, 0u32)?;
            for (out, row) in along_x.chunks_exact_mut(w).zip(mask.chunks_exact(width)) {
                let mut sum = row[..patch - 1].iter().filter(|&&m| m).count() as u32;
                for (x, o) in out.iter_mut().enumerate() {
                    sum += u32::from(row[x + patch - 1]);
                    *o = sum;
                    sum -= u32::from(row[x]);
                }
            }
            let wanted = if any { 1 } else { (patch * patch) as u32 };
            for y in 0..h {
                for x in 0..w {
                    let sum: u32 = (y..y + patch).map(|row| along_x[row * w + x]).sum();
                    member[y * w + x] = sum >= wanted;
                }
            }
        }
        // Members are only ever removed, so this capacity always suffices.
        let list = try_with_capacity(member.iter().filter(|m| **m).count())?;
        let mut domain = Self { width: w, height: h, member, list, count: 0 };
        domain.compact();
        Ok(domain)
    }

    pub fn try_clone(&self) -> Result<Self> {
        let (member, list) = (try_collect(self.member.iter().copied())?, try_collect(self.list.iter().copied())?);
        Ok(Self { member, list, ..*self })
    }

    pub fn len(&self) -> usize {
        self.count
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    #[inline]
    pub fn contains(&self, x: usize, y: usize) -> bool {
        self.member[y * self.width + x]
    }

    #[inline]
    pub fn contains_index(&self, index: usize) -> bool {
        self.member[index]
    }

    /// Removes a member; it remains in the list of [`Domain::members`] until [`Domain::compact`].
    pub fn remove(&mut self, index: usize) {
        self.count -= usize::from(self.member[index]);
        self.member[index] = false;
    }

    pub fn compact(&mut self) {
        self.list.clear();
        let width = self.width;
        let members = self.member.iter().enumerate().filter(|(_, m)| **m);
        self.list.extend(members.map(|(i, _)| pack(i % width, i / width)));
        self.count = self.list.len();
    }

    /// Packed positions of the members in scan order; may include removed members until [`Domain::compact`].
    pub fn members(&self) -> &[u32] {
        &self.list
    }

    /// For each patch, whether it is a member.
    pub fn flags(&self) -> &[bool] {
        &self.member
    }

    /// Converts the set into the list of [`Domain::flags`].
    pub fn into_flags(self) -> Vec<bool> {
        self.member
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_select_patches_that_lie_inside_or_touch() {
        // One pixel of a 7 × 6 image is set: 9 patches of width 3 touch it, all others avoid it.
        let mut mask = vec![false; 42];
        mask[3 * 7 + 3] = true;
        assert_eq!(Domain::new(7, 6, 3, Some(&mask), true).unwrap().len(), 9);
        mask.iter_mut().for_each(|m| *m = !*m);
        let mut inside = Domain::new(7, 6, 3, Some(&mask), false).unwrap();
        assert_eq!(inside.len(), 5 * 4 - 9);
        assert_eq!(inside.members().len(), inside.len());
        inside.remove(0);
        inside.remove(0);
        assert_eq!(inside.len(), 10);
        assert!(!inside.contains(0, 0));
        assert_eq!(Domain::new(7, 6, 3, None, false).unwrap().len(), 20);
    }
}
