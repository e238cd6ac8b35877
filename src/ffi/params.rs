//! Reads and fills structs of the caller. A struct may exist in several versions, which differ in size; the caller
//! passes the size that its compiler gave the struct.
//!
//! A struct starts with `uint32_t struct_size` and grows only at its end, never into padding. The struct of an older
//! caller is shorter: its missing fields keep their defaults. The struct of a newer caller is longer: it is accepted
//! if all unknown fields are zero.

use crate::error::{Error, Result};

/// Largest size that a struct has in this or any later version. A larger `struct_size` shows that the struct was not
/// initialised.
const MAX_SIZE: usize = 4096;

/// A C struct that exists in several versions.
///
/// # Safety
/// The struct is `repr(C)`, every bit pattern of it is valid, and its first field is `struct_size: u32`.
pub(super) unsafe trait Versioned: Copy {
    /// Name of the C type.
    const NAME: &'static str;
    /// Sizes of the struct in all versions up to this one, in increasing order; the last is `size_of::<Self>()`.
    const SIZES: &'static [usize];
    /// A struct with every field at its default.
    fn defaults() -> Self;
}

/// Implements `Versioned` for a struct of numbers and pointers, from its sizes in all versions and its defaults.
macro_rules! versioned {
    ($type:ident, $sizes:expr, { $($defaults:tt)* }) => {
        const _: () = assert!(std::mem::offset_of!($type, struct_size) == 0);

        // SAFETY: `struct_size` is the first field, and every bit pattern is valid in numbers and pointers.
        unsafe impl $crate::ffi::params::Versioned for $type {
            const NAME: &'static str = stringify!($type);
            const SIZES: &'static [usize] = &$sizes;
            fn defaults() -> Self {
                $($defaults)*
            }
        }
    };
}
pub(super) use versioned;

/// Whether a version of the library, past, present or future, can have a struct `P` of `size` bytes.
fn is_known<P: Versioned>(size: usize) -> bool {
    debug_assert_eq!(P::SIZES.last(), Some(&size_of::<P>()));
    P::SIZES.contains(&size) || (size_of::<P>()..=MAX_SIZE).contains(&size)
}

/// Checks the `size` that a caller passes to a function that fills a struct `P`.
fn check_size<P: Versioned>(size: usize) -> Result<()> {
    if is_known::<P>(size) {
        return Ok(());
    }
    let (name, needed) = (P::NAME, size_of::<P>());
    Err(Error::argument(format!("size is {size}; it must be sizeof({name}), {needed} bytes in this version")))
}

fn not_null<T>(place: *const T, name: &str) -> Result<()> {
    if place.is_null() { Err(Error::argument(format!("the {name} is NULL"))) } else { Ok(()) }
}

/// Fills the caller's struct of `size` bytes with defaults.
pub(super) fn init<P: Versioned>(place: *mut P, size: usize) -> Result<()> {
    not_null(place, P::NAME)?;
    check_size::<P>(size)?;
    write(place, P::defaults(), size);
    Ok(())
}

/// Reads the caller's struct; NULL stands for the defaults.
pub(super) fn read<P: Versioned>(place: *const P) -> Result<P> {
    if place.is_null() { Ok(P::defaults()) } else { read_required(place) }
}

/// Reads the caller's struct; NULL is an error.
pub(super) fn read_required<P: Versioned>(place: *const P) -> Result<P> {
    let size = size_at(place)?;
    let known = size.min(size_of::<P>());
    let mut params = P::defaults();
    // SAFETY: the caller's struct has `size` bytes. At most the size of `P` is copied, and every bit pattern of `P` is
    // valid.
    let tail = unsafe {
        std::ptr::copy_nonoverlapping(place.cast::<u8>(), (&raw mut params).cast::<u8>(), known);
        std::slice::from_raw_parts(place.cast::<u8>().add(known), size - known)
    };
    if tail.iter().any(|&b| b != 0) {
        return Err(Error::argument(format!(
            "{} sets fields that this version does not have; use a newer library or leave them zero",
            P::NAME
        )));
    }
    Ok(params)
}

/// Converts a boolean of the caller, which must be 0 or 1.
pub(super) fn flag(value: u32, name: &str) -> Result<bool> {
    match value {
        0 | 1 => Ok(value == 1),
        _ => Err(Error::argument(format!("{name} is {value}; it must be 0 or 1"))),
    }
}

/// The caller's memory for a report, and the size that the report has in the caller's version of the header.
pub(super) struct Report<P> {
    place: *mut P,
    size: usize,
}

impl<P: Versioned> Report<P> {
    pub(super) fn new(place: *mut P, size: usize) -> Result<Self> {
        not_null(place, P::NAME)?;
        check_size::<P>(size)?;
        Ok(Self { place, size })
    }

    /// Writes the fields of the report that the caller's version has. Fields that this version does not know become
    /// zero.
    pub(super) fn set(self, report: P) {
        write(self.place, report, self.size);
    }
}

/// The checked `struct_size` of the caller's struct.
fn size_at<P: Versioned>(place: *const P) -> Result<usize> {
    not_null(place, P::NAME)?;
    // SAFETY: not null; every version of the struct starts with this field.
    let size = unsafe { place.cast::<u32>().read_unaligned() } as usize;
    if is_known::<P>(size) {
        return Ok(size);
    }
    let (name, needed) = (P::NAME, size_of::<P>());
    Err(Error::argument(format!(
        "{name}.struct_size is {size}; call {name}_init with sizeof the struct, {needed} bytes in this version"
    )))
}

fn write<P: Versioned>(place: *mut P, value: P, size: usize) {
    let known = size.min(size_of::<P>());
    // SAFETY: the caller's struct has `size` bytes, and `size` was checked to be at most `MAX_SIZE`.
    unsafe {
        std::ptr::copy_nonoverlapping((&raw const value).cast::<u8>(), place.cast::<u8>(), known);
        place.cast::<u8>().add(known).write_bytes(0, size - known);
        place.cast::<u32>().write_unaligned(size as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[repr(C)]
    #[derive(Clone, Copy)]
    struct Sample {
        struct_size: u32,
        first: u32,
        second: u64,
    }

    // SAFETY: the fields are plain integers.
    unsafe impl Versioned for Sample {
        const NAME: &'static str = "sample";
        const SIZES: &'static [usize] = &[8, 16];
        fn defaults() -> Self {
            Self { struct_size: 16, first: 1, second: 2 }
        }
    }

    /// Memory of a caller, larger than any struct: `size` in the first four bytes, then bytes 0xaa.
    fn memory(size: u32) -> Vec<u8> {
        let mut bytes = vec![0xaa; 2 * MAX_SIZE];
        bytes[..4].copy_from_slice(&size.to_ne_bytes());
        bytes
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes minutes where every step is interpreted")]
    fn only_sizes_of_some_version_are_taken() {
        for size in 0..2 * MAX_SIZE {
            let mut bytes = memory(size as u32);
            let accepted = size == 8 || (16..=MAX_SIZE).contains(&size);
            assert_eq!(init::<Sample>(bytes.as_mut_ptr().cast(), size).is_ok(), accepted, "{size}");
            if accepted {
                assert_eq!(bytes[..4], (size as u32).to_ne_bytes());
                assert!(bytes[size.min(16)..size].iter().all(|&b| b == 0) && bytes[size..].iter().all(|&b| b == 0xaa));
            } else {
                assert_eq!(bytes, memory(size as u32), "nothing is written on failure");
            }
        }
    }

    #[test]
    fn an_old_struct_gets_defaults_and_a_new_one_must_not_ask_for_more() {
        let mut bytes = memory(8);
        let old: Sample = read(bytes.as_ptr().cast()).unwrap();
        assert_eq!((old.first, old.second), (0xaaaa_aaaa, 2));

        bytes[..4].copy_from_slice(&24u32.to_ne_bytes());
        assert!(read::<Sample>(bytes.as_ptr().cast()).is_err());
        bytes[16..24].fill(0);
        assert_eq!(read::<Sample>(bytes.as_ptr().cast()).unwrap().second, 0xaaaa_aaaa_aaaa_aaaa);
        assert_eq!(read::<Sample>(std::ptr::null()).unwrap().second, 2);
    }

    #[test]
    fn a_report_fits_the_caller() {
        for size in [8usize, 16, 40] {
            let mut bytes = memory(0);
            Report::new(bytes.as_mut_ptr().cast::<Sample>(), size).unwrap().set(Sample::defaults());
            assert_eq!(bytes[..8], [(size as u32).to_ne_bytes(), 1u32.to_ne_bytes()].concat());
            assert!(bytes[size..].iter().all(|&b| b == 0xaa));
        }
        assert!(Report::new(memory(0).as_mut_ptr().cast::<Sample>(), 12).is_err());
        assert!(Report::<Sample>::new(std::ptr::null_mut(), 16).is_err());
    }
}
