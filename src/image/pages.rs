//! Huge pages for large buffers: the first touch of a small page costs the system as much as hundreds of operations,
//! and there are ten thousand of them in ten channels of a megapixel.

use crate::reserve;
use std::alloc::Layout;
use std::mem::MaybeUninit;

/// Bytes of a huge page.
pub(crate) const HUGE: usize = 2 << 20;

/// Asks for huge pages wherever whole ones lie inside a part of a buffer; a wish, and on Linux only.
pub(crate) fn prefer_huge<T>(room: &[MaybeUninit<T>]) {
    #[cfg(all(target_os = "linux", not(miri)))]
    {
        let within = room.as_ptr_range();
        let start = (within.start as usize).next_multiple_of(HUGE);
        let end = within.end as usize / HUGE * HUGE;
        if start < end {
            // SAFETY: the range is part of one allocation. The advice changes nothing that can be observed but speed,
            // and where it is not taken, nothing at all: its result does not matter.
            unsafe { libc::madvise(start as *mut libc::c_void, end - start, libc::MADV_HUGEPAGE) };
        }
    }
    #[cfg(not(all(target_os = "linux", not(miri))))]
    let _ = room;
}

/// Zeros, or `None` where there is no room for so many: fresh memory is zero as it comes, so that the system clears
/// each page only when it is first written to, and for the thread that does.
pub(crate) fn zeros(len: usize) -> Option<Vec<f32>> {
    let layout = Layout::array::<f32>(len).ok().filter(|layout| layout.size() > 0);
    let Some(layout) = layout else { return (len == 0).then(Vec::new) };
    // SAFETY: the layout has a size. What is allocated belongs to nobody else, has room for `len` numbers, aligned as
    // they are, and all of them are written: no bits are 0.
    unsafe {
        let start = reserve::system(layout, true).cast::<f32>();
        if start.is_null() {
            return None;
        }
        prefer_huge(std::slice::from_raw_parts(start.cast::<MaybeUninit<f32>>(), len));
        Some(Vec::from_raw_parts(start, len, len))
    }
}
