//! Storage for the large lists of the acceleration structure, on huge pages. A lack of memory is returned as an error.
//!
//! Rays access the finished structure at random. If the structure is much larger than the address range of the
//! processor's TLB, each page-table lookup costs as much as the memory access itself. On Linux the structure is
//! therefore allocated on huge pages, which the system grants on request.

use crate::error::Result;
use crate::image::pages::{HUGE, prefer_huge};
use crate::image::{reserve_capacity, try_with_capacity};
use crate::job::Job;
use rayon::prelude::*;
use std::mem::MaybeUninit;
use std::ops::{Deref, DerefMut};

/// A huge page is requested only if the list fills at least this many bytes of it. The system then provides the huge
/// page as fast as the small pages that it replaces.
const MIN_HUGE: usize = HUGE / 4;

/// A finished list. It starts at the boundary of a huge page if it is long enough for one.
pub(super) struct Pages<T> {
    storage: Vec<MaybeUninit<T>>,
    first: usize,
    len: usize,
}

impl<T> Default for Pages<T> {
    fn default() -> Self {
        Self { storage: Vec::new(), first: 0, len: 0 }
    }
}

impl<T: Send + Sync + Copy> Pages<T> {
    /// Concatenates `parts`, copying them in parallel.
    pub fn join(parts: &[&[T]], job: Job) -> Result<Self> {
        let len = parts.iter().map(|part| part.len()).sum();
        let (mut storage, first) = storage_on_huge_pages(len)?;
        let mut rest = &mut storage[first..first + len];
        let mut targets = Vec::with_capacity(parts.len());
        for &part in parts {
            let (target, after) = rest.split_at_mut(part.len());
            targets.push((part, target));
            rest = after;
        }
        targets.into_par_iter().try_for_each(|(part, target)| {
            job.check()?;
            target.iter_mut().zip(part).for_each(|(target, item)| _ = target.write(*item));
            Ok(())
        })?;
        Ok(Self { storage, first, len })
    }
}

impl<T> Deref for Pages<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: `join` initialised `len` items from `first` on.
        unsafe { std::slice::from_raw_parts(self.storage.as_ptr().add(self.first).cast(), self.len) }
    }
}

impl<T> DerefMut for Pages<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        // SAFETY: `join` initialised `len` items from `first` on.
        unsafe { std::slice::from_raw_parts_mut(self.storage.as_mut_ptr().add(self.first).cast(), self.len) }
    }
}

/// Allocates uninitialised storage for a list, and returns it with the index at which the list starts. The items
/// before and after the list are never touched, so they occupy no physical memory.
fn storage_on_huge_pages<T>(len: usize) -> Result<(Vec<MaybeUninit<T>>, usize)> {
    const { assert!(HUGE.is_multiple_of(size_of::<T>())) };
    let bytes = len * size_of::<T>();
    // The list may fill its last huge page only in part. Use a huge page for this rest as well if the rest has at least
    // `MIN_HUGE` bytes.
    let huge = if bytes % HUGE >= MIN_HUGE { bytes.next_multiple_of(HUGE) } else { bytes / HUGE * HUGE };
    let around = if huge == 0 { 0 } else { 2 * HUGE / size_of::<T>() };
    let mut storage = Vec::<MaybeUninit<T>>::new();
    reserve_capacity(&mut storage, len.saturating_add(around))?;
    // SAFETY: the capacity was reserved above, and `MaybeUninit` items need not be initialised.
    unsafe { storage.set_len(len + around) };
    if huge == 0 {
        return Ok((storage, 0));
    }
    let first = (storage.as_ptr() as usize).wrapping_neg() % HUGE / size_of::<T>();
    prefer_huge(&storage[first..first + huge / size_of::<T>()]);
    Ok((storage, first))
}

/// A list of copies of `item`, written in parallel because the first write to each page is slow.
pub(super) fn filled<T: Copy + Send + Sync>(len: usize, item: T, job: Job) -> Result<Vec<T>> {
    let mut list = try_with_capacity(len)?;
    let storage = &mut list.spare_capacity_mut()[..len];
    storage.par_chunks_mut(HUGE / size_of::<T>()).try_for_each(|storage| {
        job.check()?;
        storage.fill(MaybeUninit::new(item));
        Ok(())
    })?;
    // SAFETY: `fill` has initialised all `len` items.
    unsafe { list.set_len(len) };
    Ok(list)
}

/// Prefetches `lines` cache lines, starting at `first`.
#[inline(always)]
pub(super) fn prefetch<T>(first: *const T, lines: usize) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..lines {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch is a hint and valid for any address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(first.cast::<i8>().wrapping_add(64 * line)) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (first, lines);
}
