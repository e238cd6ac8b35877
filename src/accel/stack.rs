//! The traversal stack of a ray: the children still to be visited.
//!
//! The maximum depth is known once the structure is built, so pushing needs no check of bounds.

use super::lanes::{Lanes, Row, take_lowest};
use super::node::Child;
use std::mem::MaybeUninit;

/// A child on the stack. The low 32 bits hold the reference to the child. The high 32 bits hold the bits of a float:
/// the distance at which the ray enters the child's box. They are 0 in any-hit queries, which do not use the distance.
/// Non-negative floats sort as their bits do, so these integers sort by distance.
pub(super) type Waiting = u64;

/// Number of entries above the top that [`Stack::push_all`] may overwrite.
pub(super) const SLACK: usize = 8;

pub(super) struct Stack<'a> {
    entries: &'a mut [MaybeUninit<Waiting>],
    len: usize,
}

impl<'a> Stack<'a> {
    /// `entries` must have capacity for the maximum depth plus [`SLACK`].
    #[inline(always)]
    pub fn new(entries: &'a mut [MaybeUninit<Waiting>]) -> Self {
        Self { entries, len: 0 }
    }

    /// Removes the child on top. Returns the child and the distance at which the ray enters its box.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<(f32, Child)> {
        let top = self.top()?;
        self.len -= 1;
        Some(top)
    }

    #[inline(always)]
    pub fn top(&self) -> Option<(f32, Child)> {
        let entry = self.read(self.len.checked_sub(1)?);
        Some((f32::from_bits((entry >> 32) as u32), Child::from_bits(entry as u32)))
    }

    /// Pushes the children whose lanes are set in `mask`, in lane order.
    #[inline(always)]
    pub fn push_all<L: Lanes>(&mut self, children: &[u32; 8], mask: u32) {
        debug_assert!(self.len + SLACK <= self.entries.len());
        // SAFETY: `entries` has at least `SLACK` = 8 entries beyond the current depth.
        unsafe { L::pick(children, mask, self.entries.as_mut_ptr().add(self.len).cast()) };
        self.len += mask.count_ones() as usize;
    }

    /// Returns the nearest child among `first` and the lanes in `mask`, and pushes the other children, the nearest of
    /// them on top.
    #[inline(always)]
    pub fn push_all_but_nearest(&mut self, near: &Row, children: &[u32; 8], first: usize, mut mask: u32) -> Child {
        let entry = |lane: usize| u64::from(near.0[lane & 7].to_bits()) << 32 | u64::from(children[lane & 7]);
        let bottom = self.len;
        let mut nearest = entry(first);
        while mask != 0 {
            let other = entry(take_lowest(&mut mask));
            let farther = nearest.max(other);
            nearest = nearest.min(other);
            // Insertion sort: move nearer entries up to free the place of `farther`.
            let mut index = self.len;
            while index > bottom && self.read(index - 1) < farther {
                self.write(index, self.read(index - 1));
                index -= 1;
            }
            self.write(index, farther);
            self.len += 1;
        }
        Child::from_bits(nearest as u32)
    }

    #[inline(always)]
    fn read(&self, index: usize) -> Waiting {
        debug_assert!(index < self.len);
        // SAFETY: every entry below `len` lies within `entries` and was written.
        unsafe { self.entries.get_unchecked(index).assume_init() }
    }

    #[inline(always)]
    fn write(&mut self, index: usize, entry: Waiting) {
        debug_assert!(index < self.entries.len());
        // SAFETY: `entries` has capacity for the maximum depth, which `index` does not exceed.
        unsafe { self.entries.get_unchecked_mut(index).write(entry) };
    }
}
