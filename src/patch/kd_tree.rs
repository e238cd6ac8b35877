//! An alternative to PatchMatch: a k-d tree over the channel means of patches (Bentley 1975). A query patch descends to
//! one leaf without backtracking. It is then compared, pixel by pixel, with the patches nearest to this leaf in the
//! order of the leaves.
//!
//! Means carry little information about texture, so the matches are worse than PatchMatch's. In exchange, no iterations
//! and no initial field are needed.

use super::domain::Domain;
use super::field::Field;
use super::position::{pack, unpack};
use super::quantised::QuantisedImage;
use super::search::{Best, Search};
use crate::error::Result;
use crate::exec;
use crate::image::try_vec;
use crate::job::Job;

/// Maximum number of patches in a leaf.
const LEAF: usize = 8;

/// The mean of each channel over each patch of an image.
pub struct Means {
    width: usize,
    lanes: usize,
    data: Vec<i16>,
}

impl Means {
    pub fn new(image: &QuantisedImage, patch: usize, job: Job) -> Result<Self> {
        let (width, height, lanes) = (image.width + 1 - patch, image.height + 1 - patch, image.lanes);
        let mut data = try_vec(width * height * lanes, 0i16)?;
        let area = (patch * patch) as i32;
        exec::for_rows(&mut data, width * lanes, job, |y, row| {
            // Sum `patch` rows into columns, then `patch` neighbouring columns.
            let mut columns = vec![0i32; image.row_len()];
            for samples in image.data[y * image.row_len()..][..patch * image.row_len()].chunks_exact(image.row_len()) {
                columns.iter_mut().zip(samples).for_each(|(c, &s)| *c += i32::from(s));
            }
            for (i, mean) in row.iter_mut().enumerate() {
                *mean = ((0..patch).map(|k| columns[i + k * lanes]).sum::<i32>() / area) as i16;
            }
        })?;
        Ok(Self { width, lanes, data })
    }

    fn of(&self, position: u32) -> &[i16] {
        let (x, y) = unpack(position);
        &self.data[(y * self.width + x) * self.lanes..][..self.lanes]
    }
}

/// The patches of one image in the order of the tree's leaves. In this order, similar patches are mostly close to each
/// other.
pub struct KdTree {
    order: Vec<u32>,
    /// Channel and value of each split; the children of node `i` are `2i + 1` and `2i + 2`.
    splits: Vec<(u8, i16)>,
}

impl KdTree {
    /// Builds the tree over the members of `domain`.
    pub fn new(means: &Means, domain: &Domain, job: Job) -> Result<Self> {
        let mut order = domain.members().to_vec();
        let leaves = order.len().div_ceil(LEAF).max(1).next_power_of_two();
        let mut splits = try_vec(leaves - 1, (0u8, 0i16))?;
        let mut ranges = vec![(0, order.len())];
        for node in 0..splits.len() {
            if node % 64 == 0 {
                job.check()?;
            }
            let (low, high) = ranges[node];
            let members = &mut order[low..high];
            let half = members.len() / 2;
            if !members.is_empty() {
                // Split the channel with the widest range at its median; ties are ordered by position.
                let channel = widest(means, members);
                let key = |&position: &u32| (means.of(position)[channel], position);
                members.select_nth_unstable_by_key(half, key);
                splits[node] = (channel as u8, means.of(members[half])[channel]);
            }
            ranges.push((low, low + half));
            ranges.push((low + half, high));
        }
        Ok(Self { order, splits })
    }

    /// Descends the tree. Returns the index in `order` of the middle of the leaf, near which patches with similar
    /// means lie.
    fn leaf_of(&self, means: &[i16]) -> usize {
        let (mut low, mut high, mut node) = (0, self.order.len(), 0);
        while let Some(&(channel, value)) = self.splits.get(node) {
            let half = low + (high - low) / 2;
            if means[channel as usize] < value {
                (high, node) = (half, 2 * node + 1);
            } else {
                (low, node) = (half, 2 * node + 2);
            }
        }
        low + (high - low) / 2
    }
}

/// Returns the channel whose values have the widest range in a sample of the members.
fn widest(means: &Means, members: &[u32]) -> usize {
    let step = (members.len() / 256).max(1);
    let spread = |channel: usize| {
        let values = members.iter().step_by(step).map(|&p| means.of(p)[channel]);
        let (low, high) = values.fold((i16::MAX, i16::MIN), |(l, h), v| (l.min(v), h.max(v)));
        i32::from(high) - i32::from(low)
    };
    // If several channels have the widest range, take the first one. The padding channels come last and have a range of
    // 0, so they are never chosen.
    (0..means.lanes).rev().max_by_key(|&c| spread(c)).unwrap_or(0)
}

impl Search<'_> {
    /// Compares each active patch with up to `tries` allowed patches, beginning with the patches that are nearest to
    /// the patch's leaf in the order of the leaves. A match is replaced only by a closer one.
    pub fn look_up(
        &self,
        field: &mut Field,
        tree: &KdTree,
        query_means: &Means,
        tries: usize,
        job: Job,
        active: impl Fn(usize) -> bool + Sync,
    ) -> Result<()> {
        let (width, count) = (field.width, tree.order.len());
        let before = &*field;
        let rows = exec::map(field.height, job, |y| {
            let mut row = Vec::with_capacity(width);
            for x in 0..width {
                let i = y * width + x;
                let mut best = Best { at: before.at[i], error: before.error[i], x, y };
                if count > 0 && active(i) {
                    let middle = tree.leaf_of(query_means.of(pack(x, y))).min(count - 1);
                    // Walk outwards on both sides for a bounded number of steps. Skip patches that are not allowed.
                    let mut left = tries;
                    for step in 0..16 * tries {
                        let at = if step % 2 == 0 { middle + step / 2 } else { middle.wrapping_sub(step / 2 + 1) };
                        let Some(&position) = tree.order.get(at) else { continue };
                        let (px, py) = unpack(position);
                        if self.allowed.contains(px, py) {
                            best.try_at(self, px as isize, py as isize);
                            left -= 1;
                            if left == 0 {
                                break;
                            }
                        }
                    }
                }
                row.push((best.at, best.error));
            }
            row
        })?;
        field.set_rows(rows);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Kernel, Quantiser};
    use super::*;
    use crate::image::Image;
    use crate::job::Monitor;
    use crate::rng::Rng;

    #[test]
    fn patches_of_one_image_are_found_in_another_that_contains_them() {
        let quantisers = Quantiser::for_weights(&[1.0, 1.0], 5);
        let job = Monitor::default();
        let mut base = QuantisedImage::new(60, 50, 2).unwrap();
        let noise = Image::from_fn(60, 50, |x, y| {
            let mut rng = Rng::new(1, &[x as u64, y as u64]);
            [rng.next_f32(), rng.next_f32()]
        });
        base.fill(0, &quantisers, &noise.unwrap(), job.job()).unwrap();
        // The query is a rectangle of the base, with its top-left corner at (7, 11).
        let mut query = QuantisedImage::new(30, 20, 2).unwrap();
        for y in 0..20 {
            let from = (y + 11) * base.row_len() + 7 * base.lanes;
            let row = base.data[from..from + query.row_len()].to_vec();
            let to = y * query.row_len();
            query.data[to..to + row.len()].copy_from_slice(&row);
        }
        let allowed = Domain::new(60, 50, 5, None, false).unwrap();
        let tree = KdTree::new(&Means::new(&base, 5, job.job()).unwrap(), &allowed, job.job()).unwrap();
        let means = Means::new(&query, 5, job.job()).unwrap();
        let search =
            Search { query: &query, base: &base, allowed: &allowed, patch: 5, kernel: Kernel::detect(), seed: 1 };
        let mut field = Field::new(26, 16).unwrap();
        search.look_up(&mut field, &tree, &means, 2 * LEAF, job.job(), |_| true).unwrap();
        // A patch whose mean equals the value of a split may lie on the other side of the split: these few patches are
        // missed.
        let found = |(i, &at): (usize, &u32)| at == pack(i % 26 + 7, i / 26 + 11);
        assert!(field.at.iter().enumerate().filter(|&p| found(p)).count() > 26 * 16 * 95 / 100);
        assert!(field.at.iter().zip(&field.error).enumerate().all(|(i, (at, &e))| (e == 0) == found((i, at))));
    }
}
