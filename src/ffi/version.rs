//! Version
//!
//! The macros give the version of this header; the functions give the version of the loaded library. Before 1.0,
//! libraries with equal minor versions are compatible (libluxfer.so.0.2); from 1.0 on, libraries with equal major
//! versions are compatible.
//!
//! A program that loads the library at run time (dlopen, a folder of plug-ins) should check at its start that
//! luxfer_get_version() / 100 == LUXFER_VERSION / 100. From 1.0 on it should check that both versions are equal when
//! divided by 10000 and that the library is not older than the header. luxfer::Context::create of bindings/cpp makes
//! this check.

use std::ffi::c_char;

/// Returns the version of the loaded library as one number, comparable with LUXFER_VERSION. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn luxfer_get_version() -> u32 {
    const fn number(text: &str) -> u32 {
        let (mut value, mut i) = (0, 0);
        while i < text.len() {
            value = 10 * value + (text.as_bytes()[i] - b'0') as u32;
            i += 1;
        }
        value
    }
    const VERSION: u32 = 10_000 * number(env!("CARGO_PKG_VERSION_MAJOR"))
        + 100 * number(env!("CARGO_PKG_VERSION_MINOR"))
        + number(env!("CARGO_PKG_VERSION_PATCH"));
    VERSION
}

/// Returns the version of the loaded library as text, such as "0.2.0". The string is static: never free it. Any
/// thread.
#[unsafe(no_mangle)]
pub extern "C" fn luxfer_get_version_string() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
