//! Memory: lists that may be too large for it, and what makes it fast.
//!
//! Rays touch the finished structure all over the place, and where it is many times larger than what the processor's page tables reach,
//! looking up pages costs as much as reading them. On Linux it is therefore put on huge pages, which the system grants
//! to those who ask.

use crate::error::{Error, ErrorKind, Result};
use rayon::prelude::*;
use std::hint::black_box;
use std::mem::MaybeUninit;
use std::ops::{Deref, DerefMut};

/// Bytes of a huge page.
const HUGE: usize = 2 << 20;
/// Bytes from which on a huge page takes no longer to get than the small ones it replaces.
const WORTH: usize = HUGE / 4;

/// A finished list that starts with a huge page, if it is long enough for one.
pub(super) struct Pages<T> {
    room: Vec<MaybeUninit<T>>,
    first: usize,
    len: usize,
}

impl<T> Default for Pages<T> {
    fn default() -> Self {
        Self { room: Vec::new(), first: 0, len: 0 }
    }
}

impl<T: Send + Sync + Copy> Pages<T> {
    /// All parts one after the other, copied in parallel.
    pub fn join(parts: &[&[T]]) -> Result<Self> {
        let len = parts.iter().map(|part| part.len()).sum();
        let (mut room, first) = room_on_huge_pages(len)?;
        let mut rest = &mut room[first..first + len];
        let mut targets = Vec::with_capacity(parts.len());
        for &part in parts {
            let (target, after) = rest.split_at_mut(part.len());
            targets.push((part, target));
            rest = after;
        }
        targets.into_par_iter().for_each(|(part, target)| _ = target.write_copy_of_slice(part));
        Ok(Self { room, first, len })
    }
}

impl<T> Deref for Pages<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: `join` wrote that many items there.
        unsafe { std::slice::from_raw_parts(self.room.as_ptr().add(self.first).cast(), self.len) }
    }
}

impl<T> DerefMut for Pages<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        // SAFETY: as above.
        unsafe { std::slice::from_raw_parts_mut(self.room.as_mut_ptr().add(self.first).cast(), self.len) }
    }
}

/// Room for a list, and where in it the list is to start. What lies around it is never touched, and so takes no memory.
fn room_on_huge_pages<T>(len: usize) -> Result<(Vec<MaybeUninit<T>>, usize)> {
    const { assert!(HUGE.is_multiple_of(size_of::<T>())) };
    let bytes = len * size_of::<T>();
    // The last page is a huge one too where most of its small ones would be needed.
    let huge = if bytes % HUGE >= WORTH { bytes.next_multiple_of(HUGE) } else { bytes / HUGE * HUGE };
    let around = if huge == 0 { 0 } else { 2 * HUGE / size_of::<T>() };
    let mut room = reserve::<MaybeUninit<T>>(len.saturating_add(around))?;
    // SAFETY: such items need not be initialised.
    unsafe { room.set_len(len + around) };
    if huge == 0 {
        return Ok((room, 0));
    }
    let first = (room.as_ptr() as usize).wrapping_neg() % HUGE / size_of::<T>();
    #[cfg(target_os = "linux")]
    // SAFETY: the range is part of one allocation. The advice changes nothing that can be observed but speed, and where
    // it is not taken, nothing at all: its result does not matter.
    unsafe {
        libc::madvise(room.as_mut_ptr().add(first).cast(), huge, libc::MADV_HUGEPAGE);
    }
    Ok((room, first))
}

/// An error where there is no room for so many bytes.
pub(super) fn expect_room(bytes: usize) -> Result<()> {
    // A reservation that nothing uses might be optimised away, and found possible.
    reserve::<u8>(bytes).map(|room| drop(black_box(room)))
}

/// Asks memory for a number of cache lines from an item on, which will be needed soon.
#[inline(always)]
pub(super) fn prefetch<T>(first: *const T, lines: usize) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..lines {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a hint; it reads nothing, whatever the address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(first.cast::<i8>().wrapping_add(64 * line)) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (first, lines);
}

/// Makes room for a number of items more, or gives an error; lists grow by doubling.
#[inline]
pub(super) fn make_room<T>(list: &mut Vec<T>, more: usize) -> Result<()> {
    if list.capacity() - list.len() >= more {
        return Ok(());
    }
    list.try_reserve(more).map_err(|_| no_room::<T>(list.len() + more))
}

/// An empty list with room for `len` items, or an error.
pub(super) fn reserve<T>(len: usize) -> Result<Vec<T>> {
    let mut list = Vec::new();
    list.try_reserve_exact(len).map_err(|_| no_room::<T>(len))?;
    Ok(list)
}

#[cold]
fn no_room<T>(len: usize) -> Error {
    let mib = (len as f64) * size_of::<T>() as f64 / (1 << 20) as f64;
    Error::new(ErrorKind::OutOfMemory, format!("could not allocate {mib:.1} MiB"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_that_no_machine_has_is_an_error() {
        assert!(expect_room(1 << 20).is_ok());
        for bytes in [1 << 60, usize::MAX] {
            assert_eq!(expect_room(bytes).unwrap_err().kind, ErrorKind::OutOfMemory);
        }
    }
}
