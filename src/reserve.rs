//! A memory reserve, from which small allocations are served when the system has no memory left.
//!
//! Allocations that grow with the input use fallible functions ([`list`], [`reserve_capacity`]), whose failure becomes
//! `LUXFER_OUT_OF_MEMORY`. Small allocations (names, messages, thread queues, rows in a codec) are infallible: if the
//! system cannot serve one of them, Rust aborts the process, and the host with it. The library therefore keeps a
//! reserve of 8 MiB, which occupies no physical memory until it is used. The reserve serves small allocations that the
//! system cannot serve; every job of the process then ends with an error at its next check. Third-party codecs and new
//! threads cannot handle failed allocations, and need more memory than the reserve has. Before they run,
//! [`can_allocate`] tests whether the system has enough memory.
//!
//! The process can still be aborted in three cases:
//!
//! - Another thread takes the memory right after the test by [`can_allocate`].
//! - The system cannot serve the 48 bytes that the standard library requests directly from the system, bypassing the
//!   reserve. The standard library does so when a thread starts, and when a call of the library first fails on a
//!   thread.
//! - The system cannot serve the memory that its C library requests when a thread first calls this library.
//!
//! Without the feature `reserve`, the program that links the library chooses the allocator.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::UnsafeCell;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Size of the reserve in bytes (`BYTES`), and size in bytes of the largest allocation that the reserve serves
/// (`MAX_ALLOCATION`).
const BYTES: usize = 8 << 20;
const MAX_ALLOCATION: usize = 256 << 10;
/// Size of a block in bytes; the reserve hands out whole blocks.
const BLOCK: usize = 64;
const BLOCKS: usize = BYTES / BLOCK;
/// Largest supported alignment in bytes.
const PAGE: usize = 4096;

#[cfg_attr(feature = "reserve", global_allocator)]
static ALLOCATOR: Allocator = Allocator(Reserve::new());

/// Returns the number of small allocations that the system could not serve since the process began.
pub fn uses() -> u64 {
    ALLOCATOR.0.uses.load(Ordering::Relaxed)
}

/// Returns an empty list with memory for `len` items; `None` if the system has no memory. The list never takes memory
/// from the reserve, because the caller can handle failure.
pub fn list<T>(len: usize) -> Option<Vec<T>> {
    let layout = Layout::array::<T>(len).ok()?;
    if layout.size() == 0 {
        return Some(Vec::new());
    }
    // SAFETY: the layout has a non-zero size.
    let start = unsafe { system(layout, false) };
    // SAFETY: the memory was allocated with the layout of `len` items; the list is empty.
    (!start.is_null()).then(|| unsafe { Vec::from_raw_parts(start.cast(), 0, len) })
}

/// Ensures capacity for `more` further items; returns false if there is no memory. If the capacity grows, it at least
/// doubles.
pub fn reserve_capacity<T>(items: &mut Vec<T>, more: usize) -> bool {
    if items.capacity() - items.len() >= more {
        return true;
    }
    let capacity = items.len().saturating_add(more).max(2 * items.capacity()).max(4);
    // Let the system grow a large list, since it may do so in place, which is faster.
    if capacity.saturating_mul(size_of::<T>()) > MAX_ALLOCATION {
        return items.try_reserve(more).is_ok();
    }
    let Some(mut grown) = list(capacity) else { return false };
    grown.append(items);
    *items = grown;
    true
}

/// Whether the system can allocate this number of bytes now. Call it before code that aborts the process when memory
/// runs out.
pub fn can_allocate(bytes: usize) -> bool {
    // `black_box` keeps the optimiser from removing the allocation, which is otherwise unused.
    std::hint::black_box(list::<u8>(bytes)).is_some()
}

/// Allocates memory that the program's allocator can free; null on failure. The memory comes from the system, never
/// from the reserve. Without the feature `reserve`, it comes from the program's allocator.
///
/// # Safety
/// The layout must have a non-zero size.
pub unsafe fn system(layout: Layout, zeroed: bool) -> *mut u8 {
    // SAFETY: by the contract of this function.
    unsafe {
        match (cfg!(feature = "reserve"), zeroed) {
            (true, true) => System.alloc_zeroed(layout),
            (true, false) => System.alloc(layout),
            (false, true) => std::alloc::alloc_zeroed(layout),
            (false, false) => std::alloc::alloc(layout),
        }
    }
}

/// The system's allocator, with the reserve as fallback.
struct Allocator(Reserve);

// SAFETY: memory belongs to the system or to the reserve, which recognises its own blocks by their address.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller guarantees what `System.alloc` requires of the layout.
        let start = unsafe { System.alloc(layout) };
        if start.is_null() { self.0.take(layout) } else { start }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as in `alloc`.
        let start = unsafe { System.alloc_zeroed(layout) };
        if !start.is_null() {
            return start;
        }
        let start = self.0.take(layout);
        if !start.is_null() {
            // SAFETY: the allocation has this many bytes and is not shared yet.
            unsafe { start.write_bytes(0, layout.size()) };
        }
        start
    }

    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        match self.0.block_of(start) {
            Some(block) => self.0.give_back(block),
            // SAFETY: memory outside the reserve belongs to the system.
            None => unsafe { System.dealloc(start, layout) },
        }
    }

    unsafe fn realloc(&self, start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        if self.0.block_of(start).is_none() {
            // SAFETY: as in `alloc`; on failure the old allocation is unchanged.
            let moved = unsafe { System.realloc(start, layout, size) };
            if !moved.is_null() {
                return moved;
            }
        }
        // SAFETY: the caller guarantees that the size is valid for a layout; both allocations are at least as large as
        // the copy.
        unsafe {
            let moved = self.alloc(Layout::from_size_align_unchecked(size, layout.align()));
            if !moved.is_null() {
                start.copy_to_nonoverlapping(moved, size.min(layout.size()));
                self.dealloc(start, layout);
            }
            moved
        }
    }
}

#[repr(C, align(4096))]
struct Storage([u8; BYTES]);

struct Reserve {
    storage: UnsafeCell<Storage>,
    /// For each block, the number of blocks in the allocation that begins there; 0 if no allocation begins there.
    lengths: UnsafeCell<[u16; BLOCKS]>,
    /// Spin lock that guards `lengths`.
    busy: AtomicBool,
    uses: AtomicU64,
}

// SAFETY: `lengths` is accessed only in `with_lengths`, by one thread at a time; `storage` only by the owners of
// allocations.
unsafe impl Sync for Reserve {}

impl Reserve {
    const fn new() -> Self {
        Self {
            storage: UnsafeCell::new(Storage([0; BYTES])),
            lengths: UnsafeCell::new([0; BLOCKS]),
            busy: AtomicBool::new(false),
            uses: AtomicU64::new(0),
        }
    }

    /// Allocates the first free run of blocks that is long enough; null if the request is too large or no run
    /// suffices.
    fn take(&self, layout: Layout) -> *mut u8 {
        if layout.size() > MAX_ALLOCATION || layout.align() > PAGE {
            return null_mut();
        }
        self.uses.fetch_add(1, Ordering::Relaxed);
        let (count, step) = (layout.size().div_ceil(BLOCK).max(1), layout.align().div_ceil(BLOCK));
        let first = self.with_lengths(|lengths| {
            // Search for a run of free blocks, which extends from `first` to `end`.
            let (mut first, mut end) = (0, 0);
            while end < first + count && end < BLOCKS {
                match lengths[end] {
                    0 => end += 1,
                    taken => {
                        end += usize::from(taken);
                        first = end.next_multiple_of(step);
                    }
                }
            }
            (first + count <= BLOCKS).then(|| {
                lengths[first] = count as u16;
                first
            })
        });
        // SAFETY: the block lies inside the reserve.
        first.map_or(null_mut(), |first| unsafe { self.storage.get().cast::<u8>().add(first * BLOCK) })
    }

    /// Returns the index of the block at an address; `None` if the address is outside the reserve.
    fn block_of(&self, start: *mut u8) -> Option<usize> {
        let offset = start.addr().wrapping_sub(self.storage.get().addr());
        (offset < BYTES).then_some(offset / BLOCK)
    }

    fn give_back(&self, block: usize) {
        self.with_lengths(|lengths| lengths[block] = 0);
    }

    /// Calls `work` with the lengths of all allocations, under the spin lock. `work` must not allocate or panic.
    /// Spinning is acceptable, because the lock is held rarely and briefly.
    fn with_lengths<T>(&self, work: impl FnOnce(&mut [u16; BLOCKS]) -> T) -> T {
        while self.busy.swap(true, Ordering::Acquire) {
            std::hint::spin_loop();
        }
        // SAFETY: the lock excludes all other threads.
        let value = work(unsafe { &mut *self.lengths.get() });
        self.busy.store(false, Ordering::Release);
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(size: usize, align: usize) -> Layout {
        Layout::from_size_align(size, align).unwrap()
    }

    fn give_back(reserve: &Reserve, start: *mut u8) {
        reserve.give_back(reserve.block_of(start).expect("it is of the reserve"));
    }

    #[test]
    fn blocks_lie_apart_aligned_and_within_the_reserve() {
        static RESERVE: Reserve = Reserve::new();
        let mut held: Vec<(usize, *mut u8)> = Vec::new();
        let mut rng = crate::rng::Rng::new(1, &[]);
        let mut refused = 0;
        // Under the interpreter Miri (tests/miri.sh), each round takes a thousand times as long.
        let rounds = if cfg!(miri) { 600 } else { 20_000 };
        for _ in 0..rounds {
            let size = 1 + (rng.next_f32().powi(4) * MAX_ALLOCATION as f32) as usize;
            let align = 1 << (rng.next_f32() * 12.99) as u32;
            let start = RESERVE.take(layout(size, align));
            if start.is_null() {
                refused += 1;
            } else {
                assert!(start.addr().is_multiple_of(align), "{align}");
                let (low, high) = (start.addr(), start.addr() + size);
                assert!(held.iter().all(|&(size, other)| high <= other.addr() || other.addr() + size <= low));
                assert!(RESERVE.block_of(start).is_some() && RESERVE.block_of(start.wrapping_add(size - 1)).is_some());
                held.push((size, start));
            }
            if held.len() > 200 || start.is_null() {
                let (_, start) = held.swap_remove((rng.next_f32() * held.len() as f32) as usize);
                give_back(&RESERVE, start);
            }
        }
        assert!(refused > 0 && refused < rounds / 2, "{refused} of {rounds}");
        // No block leaks: after all allocations are freed, the whole reserve can be allocated again.
        held.into_iter().for_each(|(_, start)| give_back(&RESERVE, start));
        let all: Vec<_> = (0..BYTES / MAX_ALLOCATION).map(|_| RESERVE.take(layout(MAX_ALLOCATION, PAGE))).collect();
        assert!(all.iter().all(|start| !start.is_null()));
        assert!(RESERVE.take(layout(1, 1)).is_null());
    }

    #[test]
    fn lists_have_the_requested_capacity() {
        let mut items = list::<u32>(3).unwrap();
        assert!(items.capacity() >= 3 && items.is_empty());
        for item in 0..200_000 {
            assert!(reserve_capacity(&mut items, 1));
            let storage = items.as_ptr();
            items.push(item);
            assert_eq!(items.as_ptr(), storage);
        }
        assert!(items.iter().zip(0..).all(|(item, i)| *item == i));
        assert!(list::<u32>(0).is_some() && list::<()>(9).is_some() && can_allocate(1 << 16));
        assert!(
            list::<u32>(usize::MAX).is_none()
                && !can_allocate(usize::MAX / 2)
                && !reserve_capacity(&mut items, usize::MAX / 4)
        );
        assert_eq!(items.len(), 200_000);
    }

    #[test]
    fn large_requests_are_refused_and_not_counted() {
        static RESERVE: Reserve = Reserve::new();
        assert!(RESERVE.take(layout(MAX_ALLOCATION + 1, 1)).is_null() && RESERVE.take(layout(1, 2 * PAGE)).is_null());
        assert_eq!(RESERVE.uses.load(Ordering::Relaxed), 0);
        assert!(!RESERVE.take(layout(MAX_ALLOCATION, PAGE)).is_null());
        assert_eq!(RESERVE.uses.load(Ordering::Relaxed), 1);
        assert_eq!(RESERVE.block_of((&raw const RESERVE).cast_mut().cast::<u8>().wrapping_sub(1)), None);
    }

    #[test]
    fn growing_an_allocation_keeps_its_contents() {
        static ALLOCATOR: Allocator = Allocator(Reserve::new());
        // SAFETY: the layouts equal the layouts of the preceding calls.
        unsafe {
            let start = ALLOCATOR.0.take(layout(100, 8));
            (0..100).for_each(|i| start.add(i).write(i as u8));
            // The allocation moves to the system, which has memory now and is tried first.
            let moved = ALLOCATOR.realloc(start, layout(100, 8), 5000);
            assert_eq!(ALLOCATOR.0.block_of(moved), None);
            assert!((0..100).all(|i| moved.add(i).read() == i as u8));
            ALLOCATOR.dealloc(moved, layout(5000, 8));
        }
        assert_eq!(ALLOCATOR.0.with_lengths(|lengths| lengths[0]), 0);
    }
}
