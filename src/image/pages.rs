//! Huge pages for large buffers. The first access to each small page costs as much time as hundreds of operations, and
//! ten channels of a megapixel have ten thousand small pages.

use crate::reserve;
use std::alloc::Layout;
use std::mem::MaybeUninit;

/// Size in bytes of a huge page.
pub(crate) const HUGE: usize = 2 << 20;

/// Asks the system for huge pages for a buffer, except at its ends, where no whole huge page fits. This is only a
/// hint, and has an effect on Linux alone.
pub(crate) fn prefer_huge<T>(buffer: &[MaybeUninit<T>]) {
    #[cfg(all(target_os = "linux", not(miri)))]
    {
        let within = buffer.as_ptr_range();
        let start = (within.start as usize).next_multiple_of(HUGE);
        let end = within.end as usize / HUGE * HUGE;
        if start < end {
            // SAFETY: the range is part of one allocation. The advice affects speed only, and it may fail without
            // effect.
            unsafe { libc::madvise(start as *mut libc::c_void, end - start, libc::MADV_HUGEPAGE) };
        }
    }
    #[cfg(not(all(target_os = "linux", not(miri))))]
    let _ = buffer;
}

/// Returns `len` zeros, or `None` if memory is short. The system provides zeroed memory, and clears each page only
/// when a thread first writes to it.
// Length and capacity of the vector are equal, because `layout` has room for exactly `len` numbers.
#[allow(clippy::same_length_and_capacity)]
pub(crate) fn zeros(len: usize) -> Option<Vec<f32>> {
    let layout = Layout::array::<f32>(len).ok().filter(|layout| layout.size() > 0);
    let Some(layout) = layout else { return (len == 0).then(Vec::new) };
    // SAFETY: the size of the layout is not 0. The allocation has memory for `len` numbers with their alignment, and
    // nothing else refers to it; all bits are 0, which is a valid `f32`.
    unsafe {
        let start = reserve::system(layout, true).cast::<f32>();
        if start.is_null() {
            return None;
        }
        prefer_huge(std::slice::from_raw_parts(start.cast::<MaybeUninit<f32>>(), len));
        Some(Vec::from_raw_parts(start, len, len))
    }
}
