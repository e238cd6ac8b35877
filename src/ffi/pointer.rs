//! Checked access to the caller's memory: places for results, strings and arrays, at any alignment. Handles and
//! structs of settings have modules of their own.

use crate::error::{Error, Result};
use std::ffi::{CStr, CString, c_char};

/// A pointer to a place for a result. It is checked not to be null before the work, and written once on success.
#[derive(Clone, Copy)]
pub(super) struct Out<T>(*mut T);

impl<T> Out<T> {
    pub(super) fn new(place: *mut T, name: &str) -> Result<Self> {
        if place.is_null() {
            Err(Error::argument(format!("{name} is NULL; it must point to a place for the result")))
        } else {
            Ok(Self(place))
        }
    }

    pub(super) fn set(self, value: T) {
        // SAFETY: not null, and the caller guarantees that it is writable during the call.
        unsafe { self.0.write_unaligned(value) }
    }
}

/// Writes a result to a place of the caller, unless the pointer is null.
pub(super) fn set_optional<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: not null, and the caller guarantees that it is writable during the call.
        unsafe { place.write_unaligned(value) }
    }
}

/// Returns the stride in bytes of an array of `count` elements, of which 0 stands for the size of an element, and the
/// size of the array. `count` is not 0.
pub(super) fn strided<T>(count: usize, stride: usize, name: &str) -> Result<(usize, usize)> {
    let element = size_of::<T>();
    let stride = if stride == 0 { element } else { stride };
    if stride < element {
        let range = format!("it must be 0 or at least {element} bytes");
        return Err(Error::argument(format!("the stride of {name} is {stride}; {range}")));
    }
    let size = stride.checked_mul(count - 1).and_then(|size| size.checked_add(element));
    let size = size.ok_or_else(|| {
        Error::argument(format!("the count of {name} is {count}; that is more than the address space holds"))
    })?;
    Ok((stride, size))
}

/// Reads the first `N` floats from bytes of the caller, at any alignment. Floats beyond the end of the bytes are 0.
pub(super) fn floats<const N: usize>(bytes: &[u8]) -> [f32; N] {
    let mut values = [0.0; N];
    for (value, raw) in values.iter_mut().zip(bytes.chunks_exact(4)) {
        *value = f32::from_ne_bytes([raw[0], raw[1], raw[2], raw[3]]);
    }
    values
}

/// Reads the first `N` integers from bytes of the caller, at any alignment. Integers beyond the end of the bytes are 0.
pub(super) fn integers<const N: usize>(bytes: &[u8]) -> [i32; N] {
    let mut values = [0; N];
    for (value, raw) in values.iter_mut().zip(bytes.chunks_exact(4)) {
        *value = i32::from_ne_bytes([raw[0], raw[1], raw[2], raw[3]]);
    }
    values
}

/// Reads a zero-terminated string in UTF-8 from the caller's memory.
pub(super) fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str> {
    if text.is_null() {
        return Err(Error::argument(format!("{name} is NULL; it must be a string in UTF-8")));
    }
    // SAFETY: not null, and the caller guarantees that it ends with a zero.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|e| {
        Error::argument(format!("{name} is not valid UTF-8 at byte {}; paths and names are UTF-8", e.valid_up_to()))
    })
}

/// Copies a text into the caller's buffer, zero-terminated and truncated to `capacity` bytes. Unless `needed` is null,
/// it receives the capacity that the whole text needs.
pub(super) fn copy_text(text: &str, buffer: *mut c_char, capacity: usize, needed: *mut usize) -> Result<()> {
    if buffer.is_null() && capacity > 0 {
        return Err(Error::argument(format!("buffer is NULL; it must have capacity = {capacity} bytes")));
    }
    // Truncate between characters.
    let mut len = text.len().min(capacity.saturating_sub(1));
    while !text.is_char_boundary(len) {
        len -= 1;
    }
    if capacity > 0 {
        // SAFETY: not null; `len` + 1 <= `capacity` bytes, which the caller guarantees to be writable.
        unsafe {
            std::ptr::copy_nonoverlapping(text.as_ptr(), buffer.cast(), len);
            buffer.add(len).write(0);
        }
    }
    set_optional(needed, text.len() + 1);
    Ok(())
}

/// Converts a text to a C string; zero bytes in the text are left out.
pub(super) fn c_string(text: &str) -> CString {
    let bytes: Vec<u8> = text.bytes().filter(|&byte| byte != 0).collect();
    CString::new(bytes).unwrap_or_default()
}

/// Returns `len` bytes in the caller's memory, to be read.
pub(super) fn bytes<'a>(data: *const u8, len: usize, name: &str) -> Result<&'a [u8]> {
    check_region(data, len, name)?;
    // SAFETY: not null, no longer than an object can be, and the caller guarantees that it is readable during the
    // call.
    Ok(unsafe { std::slice::from_raw_parts(data, len) })
}

/// Returns `len` bytes in the caller's memory, to be written.
pub(super) fn bytes_mut<'a>(data: *mut u8, len: usize, name: &str) -> Result<&'a mut [u8]> {
    check_region(data, len, name)?;
    // SAFETY: as in `bytes`, and the caller guarantees that the memory is writable.
    Ok(unsafe { std::slice::from_raw_parts_mut(data, len) })
}

fn check_region(data: *const u8, len: usize, name: &str) -> Result<()> {
    if data.is_null() {
        return Err(Error::argument(format!("{name} is NULL; it must point to {len} bytes")));
    }
    let end = (data as usize).checked_add(len);
    if len > isize::MAX as usize || end.is_none() {
        return Err(Error::argument(format!("{name} has {len} bytes; that is more than the address space holds")));
    }
    Ok(())
}
