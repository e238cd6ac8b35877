//! Storage for the nodes and packets of the acceleration structure in one list of cache lines.
//!
//! The processor's caches hold only the top of the tree. Deeper in the tree, each step of a ray waits for memory, and
//! longer if the step leads to another page of memory. Each node is therefore followed by its packets, and nodes that
//! are likely to be visited together share a page.

use super::node::Node;
use super::packet::Packet;
use super::pages::{self, Pages};
use crate::error::Result;
use crate::image::{reserve_capacity, try_with_capacity};
use crate::job::Job;
use std::ops::DerefMut;

#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Line([u32; 16]);

#[derive(Default)]
pub(super) struct Lines<List = Pages<Line>> {
    list: List,
}

/// A list of cache lines under construction, which can still grow.
pub(super) type Draft = Lines<Vec<Line>>;

/// Types that may be stored in cache lines: they fill whole lines with plain numbers, for which any bits are valid.
///
/// # Safety
/// All fields must be `u32` or `f32`, without padding, and the type must have the alignment of a line.
pub(super) unsafe trait Plain {}
// SAFETY: `Node` consists of eight rows of eight `u32` or `f32`, without padding.
unsafe impl Plain for Node {}
// SAFETY: `Packet` consists of ten rows of eight `f32` or `u32`, without padding.
unsafe impl Plain for Packet {}

const fn lines_of<T>() -> usize {
    assert!(align_of::<T>() == align_of::<Line>());
    size_of::<T>() / size_of::<Line>()
}

impl Draft {
    pub fn with_capacity(len: usize) -> Result<Self> {
        Ok(Self { list: try_with_capacity(len)? })
    }

    /// Appends a node or a packet and returns the number of its first line.
    pub fn push<T: Plain>(&mut self, item: &T) -> Result<usize> {
        let line = self.list.len();
        reserve_capacity(&mut self.list, lines_of::<T>())?;
        // SAFETY: `T` is `Plain`, and it fills `lines_of::<T>()` lines with the alignment of a line.
        self.list.extend_from_slice(unsafe { std::slice::from_raw_parts((&raw const *item).cast(), lines_of::<T>()) });
        Ok(line)
    }
}

impl Lines {
    pub fn join(drafts: &[Draft], job: Job) -> Result<Self> {
        let parts: Vec<&[Line]> = drafts.iter().map(Draft::as_slice).collect();
        Ok(Self { list: Pages::join(&parts, job)? })
    }
}

impl<List: DerefMut<Target = [Line]>> Lines<List> {
    pub fn as_slice(&self) -> &[Line] {
        &self.list
    }

    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Size of all lines in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.list)
    }

    pub fn get_mut<T: Plain>(&mut self, line: usize) -> &mut T {
        let lines = &mut self.list[line..line + lines_of::<T>()];
        // SAFETY: `T` is `Plain`, and it fills `lines_of::<T>()` lines with the alignment of a line.
        unsafe { &mut *lines.as_mut_ptr().cast() }
    }

    /// Returns the value at a line, and panics if the line is not in the list. Any bits are a valid `T`.
    pub fn checked<T: Plain>(&self, line: usize) -> &T {
        let lines = &self.list[line..line + lines_of::<T>()];
        // SAFETY: `T` is `Plain`, and it fills `lines_of::<T>()` lines with the alignment of a line.
        unsafe { &*lines.as_ptr().cast() }
    }

    /// # Safety
    /// A value of type `T` must have been stored at this line.
    #[inline(always)]
    pub unsafe fn get<T: Plain>(&self, line: usize) -> &T {
        debug_assert!(line + lines_of::<T>() <= self.list.len());
        // SAFETY: the caller stored a `T` at this line, so all its lines are in the list.
        unsafe { &*self.at(line).cast() }
    }

    /// Prefetches the node or packet at `line`. It fetches as many cache lines as a packet fills; a node fills one
    /// less.
    #[inline(always)]
    pub fn prefetch(&self, line: usize) {
        pages::prefetch(self.at(line), lines_of::<Packet>());
    }

    #[inline(always)]
    fn at(&self, line: usize) -> *const Line {
        self.list.as_ptr().wrapping_add(line)
    }
}
