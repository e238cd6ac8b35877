//! Memory for the finished structure.
//!
//! Rays touch it all over the place, and where it is many times larger than what the processor's page tables reach,
//! looking up pages costs as much as reading them. On Linux it is therefore put on huge pages, which the system grants
//! to those who ask.

use crate::error::{Error, ErrorKind, Result};
use rayon::prelude::*;
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

/// An empty list with room for `len` items.
fn room<T>(len: usize) -> Result<Vec<T>> {
    let mut list = Vec::<T>::new();
    list.try_reserve_exact(len).map_err(|_| {
        let mib = (len as f64) * size_of::<T>() as f64 / (1 << 20) as f64;
        Error::new(ErrorKind::OutOfMemory, format!("could not allocate {mib:.1} MiB"))
    })?;
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
