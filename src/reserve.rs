//! Memory for small things in a process that has none left.
//!
//! What grows with the input is asked of the system in ways that can fail ([`list`], [`make_room`]), and becomes
//! `LUXFER_OUT_OF_MEMORY`. Small things (names, messages, the queues of threads, rows in a codec) are not: where the system has
//! no room for one of them, Rust ends the process, and the host with it. So the library keeps a few MiB that no page of memory
//! stands behind until they are used. Small things that find no room elsewhere are put there, and all jobs of the process end as
//! soon as they see that one was. Before codecs of others and new threads, which take more than that and cannot do without,
//! [`has_room`] tells whether the system has it.
//!
//! Left to end the process: that such room is taken by others in between; 48 bytes that the standard library asks of the system
//! itself when a thread starts, or first fails in the library; and what the system's own library needs when a thread first
//! comes to this one.
//!
//! Without the feature `reserve` the library leaves the choice of an allocator to the program that it is part of.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::UnsafeCell;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Bytes of the reserve, and the most that a thing in it takes.
const BYTES: usize = 8 << 20;
const SMALL: usize = 256 << 10;
/// They are given out in blocks.
const BLOCK: usize = 64;
const BLOCKS: usize = BYTES / BLOCK;
/// The largest alignment there is.
const PAGE: usize = 4096;

#[cfg_attr(feature = "reserve", global_allocator)]
static ALLOCATOR: Allocator = Allocator(Reserve::new());

/// How often the system had no room for a small thing since the process began.
pub fn uses() -> u64 {
    ALLOCATOR.0.uses.load(Ordering::Relaxed)
}

/// An empty list with room for so many items, or none: never of the reserve, since whoever asks can do without.
pub fn list<T>(len: usize) -> Option<Vec<T>> {
    let layout = Layout::array::<T>(len).ok()?;
    if layout.size() == 0 {
        return Some(Vec::new());
    }
    // SAFETY: the layout has a size.
    let start = unsafe { system(layout, false) };
    // SAFETY: what is allocated has the layout of so many items; the list has none of them yet.
    (!start.is_null()).then(|| unsafe { Vec::from_raw_parts(start.cast(), 0, len) })
}

/// Makes room for a number of items more, or says that there is none; lists grow by doubling.
pub fn make_room<T>(items: &mut Vec<T>, more: usize) -> bool {
    if items.capacity() - items.len() >= more {
        return true;
    }
    let most = items.len().saturating_add(more).max(2 * items.capacity()).max(4);
    // What is too large for the reserve may be moved by the system, which is faster.
    if most.saturating_mul(size_of::<T>()) > SMALL {
        return items.try_reserve(more).is_ok();
    }
    let Some(mut grown) = list(most) else { return false };
    grown.append(items);
    *items = grown;
    true
}

/// Whether the system has so many bytes now, which code that ends the process otherwise is about to take.
pub fn has_room(bytes: usize) -> bool {
    // An allocation that nobody looks at need not take place.
    std::hint::black_box(list::<u8>(bytes)).is_some()
}

/// Memory of the system's, which the allocator of the program takes back; null if there is none.
///
/// # Safety
/// The layout has a size.
pub unsafe fn system(layout: Layout, zeroed: bool) -> *mut u8 {
    // SAFETY: what is asked of callers.
    unsafe {
        match (cfg!(feature = "reserve"), zeroed) {
            (true, true) => System.alloc_zeroed(layout),
            (true, false) => System.alloc(layout),
            (false, true) => std::alloc::alloc_zeroed(layout),
            (false, false) => std::alloc::alloc(layout),
        }
    }
}

/// The system's memory; after it, the reserve.
struct Allocator(Reserve);

// SAFETY: memory is the system's, or of the reserve, which tells its own from others by their addresses.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: what holds of the layout here is asked for there.
        let start = unsafe { System.alloc(layout) };
        if start.is_null() { self.0.take(layout) } else { start }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        let start = unsafe { System.alloc_zeroed(layout) };
        if !start.is_null() {
            return start;
        }
        let start = self.0.take(layout);
        if !start.is_null() {
            // SAFETY: it has so many bytes, of this thing alone.
            unsafe { start.write_bytes(0, layout.size()) };
        }
        start
    }

    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        match self.0.block_of(start) {
            Some(block) => self.0.give_back(block),
            // SAFETY: what is not of the reserve is the system's.
            None => unsafe { System.dealloc(start, layout) },
        }
    }

    unsafe fn realloc(&self, start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        if self.0.block_of(start).is_none() {
            // SAFETY: as above; what comes back null has changed nothing.
            let moved = unsafe { System.realloc(start, layout, size) };
            if !moved.is_null() {
                return moved;
            }
        }
        // SAFETY: the caller sees to it that the size is one of a layout; both things are as large as is copied.
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
struct Room([u8; BYTES]);

struct Reserve {
    room: UnsafeCell<Room>,
    /// Number of blocks of the thing that begins at a block; 0 where none begins.
    lengths: UnsafeCell<[u16; BLOCKS]>,
    /// Whether a thread is at the lengths.
    busy: AtomicBool,
    uses: AtomicU64,
}

// SAFETY: `lengths` are reached by `with_lengths` only, one thread at a time; `room` only by those it was given out to.
unsafe impl Sync for Reserve {}

impl Reserve {
    const fn new() -> Self {
        Self {
            room: UnsafeCell::new(Room([0; BYTES])),
            lengths: UnsafeCell::new([0; BLOCKS]),
            busy: AtomicBool::new(false),
            uses: AtomicU64::new(0),
        }
    }

    /// Room for a small thing where the first is free; null for others, and if there is none.
    fn take(&self, layout: Layout) -> *mut u8 {
        if layout.size() > SMALL || layout.align() > PAGE {
            return null_mut();
        }
        self.uses.fetch_add(1, Ordering::Relaxed);
        let (count, step) = (layout.size().div_ceil(BLOCK).max(1), layout.align().div_ceil(BLOCK));
        let first = self.with_lengths(|lengths| {
            // The run of free blocks from `first`, as far as it has been looked at.
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
        // SAFETY: the block lies in the room.
        first.map_or(null_mut(), |first| unsafe { self.room.get().cast::<u8>().add(first * BLOCK) })
    }

    /// The block that a thing begins at, if it is in the reserve.
    fn block_of(&self, start: *mut u8) -> Option<usize> {
        let offset = start.addr().wrapping_sub(self.room.get().addr());
        (offset < BYTES).then_some(offset / BLOCK)
    }

    fn give_back(&self, block: usize) {
        self.with_lengths(|lengths| lengths[block] = 0);
    }

    /// Nothing in `work` may allocate or panic. It is short, and seldom done, so others wait for it without sleeping.
    fn with_lengths<T>(&self, work: impl FnOnce(&mut [u16; BLOCKS]) -> T) -> T {
        while self.busy.swap(true, Ordering::Acquire) {
            std::hint::spin_loop();
        }
        // SAFETY: no other thread is here.
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
    fn things_lie_apart_aligned_and_within_the_room() {
        static RESERVE: Reserve = Reserve::new();
        let mut held: Vec<(usize, *mut u8)> = Vec::new();
        let mut rng = crate::rng::Rng::new(1, &[]);
        let mut refused = 0;
        // Interpreted, as by tests/miri.sh, each takes a thousand times as long.
        let rounds = if cfg!(miri) { 600 } else { 20_000 };
        for _ in 0..rounds {
            let size = 1 + (rng.next_f32().powi(4) * SMALL as f32) as usize;
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
        // Nothing was lost: when all is back, all of it can be had again.
        held.into_iter().for_each(|(_, start)| give_back(&RESERVE, start));
        let all: Vec<_> = (0..BYTES / SMALL).map(|_| RESERVE.take(layout(SMALL, PAGE))).collect();
        assert!(all.iter().all(|start| !start.is_null()));
        assert!(RESERVE.take(layout(1, 1)).is_null());
    }

    #[test]
    fn lists_have_the_room_they_are_asked_for() {
        let mut items = list::<u32>(3).unwrap();
        assert!(items.capacity() >= 3 && items.is_empty());
        for item in 0..200_000 {
            assert!(make_room(&mut items, 1));
            let room = items.as_ptr();
            items.push(item);
            assert_eq!(items.as_ptr(), room);
        }
        assert!(items.iter().zip(0..).all(|(item, i)| *item == i));
        assert!(list::<u32>(0).is_some() && list::<()>(9).is_some() && has_room(1 << 16));
        assert!(
            list::<u32>(usize::MAX).is_none() && !has_room(usize::MAX / 2) && !make_room(&mut items, usize::MAX / 4)
        );
        assert_eq!(items.len(), 200_000);
    }

    #[test]
    fn what_is_not_small_is_refused_and_no_use() {
        static RESERVE: Reserve = Reserve::new();
        assert!(RESERVE.take(layout(SMALL + 1, 1)).is_null() && RESERVE.take(layout(1, 2 * PAGE)).is_null());
        assert_eq!(RESERVE.uses.load(Ordering::Relaxed), 0);
        assert!(!RESERVE.take(layout(SMALL, PAGE)).is_null());
        assert_eq!(RESERVE.uses.load(Ordering::Relaxed), 1);
        assert_eq!(RESERVE.block_of((&raw const RESERVE).cast_mut().cast::<u8>().wrapping_sub(1)), None);
    }

    #[test]
    fn what_grows_keeps_what_it_holds() {
        static ALLOCATOR: Allocator = Allocator(Reserve::new());
        // SAFETY: layouts are those of the calls before.
        unsafe {
            let start = ALLOCATOR.0.take(layout(100, 8));
            (0..100).for_each(|i| start.add(i).write(i as u8));
            // The system has room now, and is asked first.
            let moved = ALLOCATOR.realloc(start, layout(100, 8), 5000);
            assert_eq!(ALLOCATOR.0.block_of(moved), None);
            assert!((0..100).all(|i| moved.add(i).read() == i as u8));
            ALLOCATOR.dealloc(moved, layout(5000, 8));
        }
        assert_eq!(ALLOCATOR.0.with_lengths(|lengths| lengths[0]), 0);
    }
}
