//! Memory: lists that may be too large for it, and what makes it fast.
//!
//! Rays touch the finished structure all over the place, and where it is many times larger than what the processor's page tables reach,
//! looking up pages costs as much as reading them. On Linux it is therefore put on huge pages, which the system grants
//! to those who ask.

use crate::error::{Error, ErrorKind, Result};
use rayon::prelude::*;
use std::hint::black_box;
use std::mem::MaybeUninit;

/// All parts one after the other, copied in parallel.
pub(super) fn join<T: Send + Sync + Copy>(parts: &[&[T]]) -> Result<Vec<T>> {
    let len = parts.iter().map(|part| part.len()).sum();
    let mut all = room(len)?;
    let mut rest: &mut [MaybeUninit<T>] = &mut all.spare_capacity_mut()[..len];
    let mut targets = Vec::with_capacity(parts.len());
    for &part in parts {
        let (target, after) = rest.split_at_mut(part.len());
        targets.push((part, target));
        rest = after;
    }
    targets.into_par_iter().for_each(|(part, target)| _ = target.write_copy_of_slice(part));
    // SAFETY: the targets make up the first `len` items and each of them was written.
    unsafe { all.set_len(len) };
    Ok(all)
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

/// The same on huge pages.
fn room<T>(len: usize) -> Result<Vec<T>> {
    let list = reserve::<T>(len)?;
    #[cfg(target_os = "linux")]
    {
        // Whole huge pages inside of it only.
        const HUGE: usize = 2 << 20;
        let start = (list.as_ptr() as usize).next_multiple_of(HUGE);
        let end = (list.as_ptr() as usize + len * size_of::<T>()) / HUGE * HUGE;
        if start < end {
            // SAFETY: the range is part of one allocation. The advice changes nothing that can be observed but speed, and
            // where it is not taken, nothing at all: its result does not matter.
            unsafe { libc::madvise(start as *mut libc::c_void, end - start, libc::MADV_HUGEPAGE) };
        }
    }
    Ok(list)
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
