//! Decodes bytes into calls of the C ABI, with valid and invalid handles. A call must return a status that calls may
//! return, and write its handle if and only if it succeeds. libFuzzer reports panics and what AddressSanitizer finds.

use crate::check;
use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_void};
use std::mem::offset_of;
use std::time::Duration;

include!(concat!(env!("OUT_DIR"), "/table.rs"));

/// Size in bytes of the memory behind every pointer: zeros, or the input's bytes repeated. It is larger than any call
/// with truthful sizes needs.
const BUFFER_BYTES: usize = 1 << 16;
/// Maximum number of calls that one input makes.
const MAX_CALLS: usize = 100;
/// Factor by which work takes longer under Miri.
const SLOWER: u64 = if cfg!(miri) { 200 } else { 1 };

/// A struct that begins with its size (`struct_size`), and its members with their offsets.
struct Record {
    size: usize,
    init: Option<fn(*mut u8) -> luxfer_status>,
    members: &'static [(usize, Member)],
}

enum Member {
    /// Size of the number in bytes, and its exclusive upper bound; 0 if it has none.
    Number(usize, u64),
    Text,
    Memory,
    Record(&'static Record),
}

/// Decodes the arguments of calls: the remaining input, and the memory and handles of the calls so far.
struct Arguments<'a> {
    input: &'a [u8],
    memory: Vec<Box<[u64]>>,
    texts: Vec<CString>,
    /// The handles by kind; a handle occurs once for each of its references.
    handles: BTreeMap<&'static str, Vec<*mut u8>>,
    /// `places`: where the current call writes the handles that it creates, with their kinds. `retained`: the handle
    /// that the current call retains. Both are added to `handles` if the call succeeds.
    places: Vec<(&'static str, *mut u64)>,
    retained: Option<(&'static str, *mut u8)>,
    /// Remaining time for waits.
    patience: Duration,
}

/// Decodes the bytes into calls, makes these calls, and releases all handles.
pub fn calls(input: &[u8]) {
    let mut a = Arguments {
        input,
        memory: Vec::new(),
        texts: Vec::new(),
        handles: BTreeMap::new(),
        places: Vec::new(),
        retained: None,
        patience: Duration::from_millis(200 * SLOWER),
    };
    for _ in 0..MAX_CALLS {
        if a.input.len() < 2 {
            break;
        }
        let (name, call) = CALLS[usize::from(a.number::<u16>()) % CALLS.len()];
        let status = call(&mut a);
        a.settle(name, check(name, status));
    }
    a.release();
}

impl Arguments<'_> {
    fn bytes(&mut self, count: usize) -> &[u8] {
        let (bytes, rest) = self.input.split_at(count.min(self.input.len()));
        self.input = rest;
        bytes
    }

    /// Reads a number of the parameter's type; bytes after the end of the input are 0.
    fn number<T: Copy>(&mut self) -> T {
        let mut buffer = [0u64; 2];
        let bytes = self.bytes(size_of::<T>());
        // SAFETY: every parameter that is not a pointer is a plain number of at most 8 bytes.
        unsafe {
            std::ptr::copy_nonoverlapping(bytes.as_ptr(), buffer.as_mut_ptr().cast(), bytes.len());
            buffer.as_ptr().cast::<T>().read()
        }
    }

    /// Reads a count below `limit`, for which the memory suffices, or one with the highest bit set, which no memory
    /// can hold.
    fn below<T: TryFrom<u64>>(&mut self, limit: u64) -> T {
        let number = if size_of::<T>() == 8 { self.number() } else { u64::from(self.number::<u32>()) };
        T::try_from(if number >> 63 == 1 { number } else { number % limit }).ok().expect("it fits")
    }

    /// Reads the milliseconds to wait for a job: at most 100, and at most the remaining time for waits.
    fn patience(&mut self) -> i32 {
        let time = Duration::from_millis(SLOWER * u64::from(self.number::<u32>().min(100))).min(self.patience);
        self.patience -= time;
        time.as_millis() as i32
    }

    /// Returns a pointer that is not a handle if `byte` stands for one: NULL, memory of zeros, or an odd address.
    fn stranger(&mut self, byte: u8) -> Option<*mut u8> {
        match byte {
            250 => Some(std::ptr::null_mut()),
            251 => Some(self.buffer().cast()),
            252 => Some(self.buffer().wrapping_byte_add(1).cast()),
            _ => None,
        }
    }

    /// Reads a handle of this kind or of another kind, NULL, or a pointer that is not a handle.
    fn handle(&mut self, kind: &'static str) -> *mut u8 {
        let byte = self.number::<u8>();
        if let Some(stranger) = self.stranger(byte) {
            return stranger;
        }
        let mut others = self.handles.iter().filter(|(other, _)| **other != kind).flat_map(|(_, handles)| handles);
        match (byte, self.handles.get(kind)) {
            (253.., _) => others.next().copied().unwrap_or_default(),
            (_, Some(handles)) if !handles.is_empty() => handles[usize::from(byte) % handles.len()],
            _ => std::ptr::null_mut(),
        }
    }

    /// Reads the kind and the index of a handle; `Err` holds a pointer that is not a handle.
    fn pick(&mut self) -> Result<(&'static str, usize), *mut u8> {
        let byte = self.number::<u8>();
        if let Some(stranger) = self.stranger(byte) {
            return Err(stranger);
        }
        let all = || self.handles.iter().flat_map(|(kind, handles)| (0..handles.len()).map(|i| (*kind, i)));
        all().nth(usize::from(byte) % all().count().max(1)).ok_or(std::ptr::null_mut())
    }

    /// Reads a handle of any kind.
    fn any(&mut self) -> *mut u8 {
        self.pick().map_or_else(|stranger| stranger, |(kind, place)| self.handles[kind][place])
    }

    /// Reads the argument of `luxfer_retain`.
    fn retained(&mut self) -> *mut u8 {
        let picked = self.pick().map(|(kind, place)| (kind, self.handles[kind][place]));
        self.retained = picked.ok();
        picked.map_or_else(|stranger| stranger, |(_, handle)| handle)
    }

    /// Reads the argument of `luxfer_release`, and removes the reference from `handles`.
    fn given_back(&mut self) -> *mut u8 {
        match self.pick() {
            Ok((kind, place)) => self.handles.get_mut(kind).expect("it was picked").remove(place),
            Err(stranger) => stranger,
        }
    }

    /// Returns where a call writes the handle that it creates.
    fn made(&mut self, kind: &'static str) -> *mut u64 {
        let place = self.buffer();
        self.places.push((kind, place));
        place
    }

    /// Ends a call: checks that it has written its handles if and only if it succeeded, and adds them to `handles`.
    fn settle(&mut self, name: &str, succeeded: bool) {
        for (kind, place) in std::mem::take(&mut self.places) {
            // SAFETY: the place lies in `memory`, which lives as long as `self`.
            let handle = unsafe { *place } as *mut u8;
            assert_eq!(succeeded, !handle.is_null(), "{name}: its handle and its status");
            if succeeded {
                self.handles.entry(kind).or_default().push(handle);
            }
        }
        if let Some((kind, handle)) = self.retained.take().filter(|_| succeeded) {
            self.handles.entry(kind).or_default().push(handle);
        }
    }

    /// Allocates `BUFFER_BYTES` bytes of zeros.
    fn buffer(&mut self) -> *mut u64 {
        self.memory.push(vec![0; BUFFER_BYTES / 8].into());
        self.memory.last_mut().expect("just pushed").as_mut_ptr()
    }

    /// Reads a length and as many bytes, and returns memory in which these bytes repeat; NULL for the largest length.
    fn memory(&mut self) -> *mut c_void {
        let length = self.number::<u16>();
        if length == u16::MAX {
            return std::ptr::null_mut();
        }
        let content = self.bytes(length.into()).to_vec();
        let buffer = self.buffer().cast::<u8>();
        if !content.is_empty() {
            // SAFETY: `buffer` has just allocated these bytes.
            let buffer = unsafe { std::slice::from_raw_parts_mut(buffer, BUFFER_BYTES) };
            for piece in buffer.chunks_mut(content.len()) {
                piece.copy_from_slice(&content[..piece.len()]);
            }
        }
        buffer.cast()
    }

    fn text(&mut self) -> *const c_char {
        let length = self.number::<u16>();
        if length == u16::MAX {
            return std::ptr::null();
        }
        let content = self.bytes(length.into()).iter().copied().take_while(|&byte| byte != 0).collect::<Vec<u8>>();
        self.texts.push(CString::new(content).expect("it ends before the first zero"));
        self.texts.last().expect("just pushed").as_ptr()
    }

    fn path(&mut self) -> *const c_char {
        let byte = self.number::<u8>();
        if byte == u8::MAX { std::ptr::null() } else { PATHS[usize::from(byte) % PATHS.len()].as_ptr() }
    }

    /// Reads a struct: NULL, or zeros or default values, with some members replaced by values from the input.
    fn record(&mut self, record: &'static Record) -> *mut u8 {
        let base = self.number::<u8>() % 3;
        if base == 0 {
            return std::ptr::null_mut();
        }
        let place = self.buffer().cast::<u8>();
        match (base, record.init) {
            (1, _) => {}
            (2, Some(init)) => {
                init(place);
            }
            // SAFETY: the allocated memory is longer than any struct, and the first member of a struct is its size.
            _ => unsafe { place.cast::<u32>().write(record.size as u32) },
        }
        for _ in 0..self.number::<u8>() % 32 {
            let (offset, member) = &record.members[usize::from(self.number::<u8>()) % record.members.len()];
            let value: Vec<u8> = match member {
                Member::Number(4, limit @ 1..) => self.below::<u32>(*limit).to_ne_bytes().into(),
                Member::Number(_, limit @ 1..) => self.below::<u64>(*limit).to_ne_bytes().into(),
                Member::Number(size, 0) => self.bytes(*size).into(),
                Member::Text => (self.text() as usize).to_ne_bytes().into(),
                Member::Memory => (self.memory() as usize).to_ne_bytes().into(),
                Member::Record(inner) => (self.record(inner) as usize).to_ne_bytes().into(),
            };
            // SAFETY: members lie within their struct.
            unsafe { std::ptr::copy_nonoverlapping(value.as_ptr(), place.add(*offset), value.len()) };
        }
        place
    }

    fn progress(&mut self) -> luxfer_progress_fn {
        extern "C" fn go(_: *mut c_void, _: f64) -> i32 {
            0
        }
        extern "C" fn cancel(_: *mut c_void, _: f64) -> i32 {
            1
        }
        [None, Some(go as _), Some(cancel as _)][usize::from(self.number::<u8>() % 3)]
    }

    fn write(&mut self) -> luxfer_write_fn {
        extern "C" fn take(_: *mut c_void, _: *const c_void, _: usize) -> i32 {
            0
        }
        extern "C" fn refuse(_: *mut c_void, _: *const c_void, _: usize) -> i32 {
            1
        }
        [None, Some(take as _), Some(refuse as _)][usize::from(self.number::<u8>() % 3)]
    }

    fn work(&mut self) -> luxfer_work_fn {
        extern "C" fn succeed(_: *mut c_void) -> luxfer_status {
            LUXFER_OK
        }
        extern "C" fn fail(_: *mut c_void) -> luxfer_status {
            LUXFER_FORMAT
        }
        [None, Some(succeed as _), Some(fail as _)][usize::from(self.number::<u8>() % 3)]
    }

    /// Releases all remaining handles; each of these calls must succeed.
    fn release(&mut self) {
        for (kind, handles) in std::mem::take(&mut self.handles) {
            for handle in handles {
                // SAFETY: the handle is alive, because this reference to it has not been released.
                let status = unsafe { luxfer_release(handle.cast()) };
                assert!(check("luxfer_release", status), "luxfer_release of a live {kind}");
            }
        }
    }
}
