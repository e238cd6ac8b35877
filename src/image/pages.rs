//! Huge pages for large buffers: the first touch of a small page costs the system as much as hundreds of operations, and there
//! are ten thousand of them in ten channels of a megapixel.

/// Asks for huge pages wherever whole ones lie inside a buffer's capacity; a wish, and on Linux only.
pub(crate) fn prefer_huge<T>(buffer: &Vec<T>) {
    #[cfg(target_os = "linux")]
    {
        const HUGE: usize = 2 << 20;
        let start = (buffer.as_ptr() as usize).next_multiple_of(HUGE);
        let end = (buffer.as_ptr() as usize + buffer.capacity() * size_of::<T>()) / HUGE * HUGE;
        if size_of::<T>() > 0 && start < end {
            // SAFETY: the range is part of one allocation. The advice changes nothing that can be observed but speed, and
            // where it is not taken, nothing at all: its result does not matter.
            unsafe { libc::madvise(start as *mut libc::c_void, end - start, libc::MADV_HUGEPAGE) };
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = buffer;
}
