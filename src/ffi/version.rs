//! Version
//!
//! The macros say what this header was made for, the functions what library is loaded. Before 1.0 libraries of one minor
//! version are compatible (libluxfer.so.0.1); from 1.0 on those of one major version.
//!
//! A program that meets its library at run time (dlopen, a folder of plug-ins) asks at its start whether
//! luxfer_version() / 100 == LUXFER_VERSION / 100; from 1.0 on, whether the two are equal when divided by 10000 and the
//! library is not the older one. luxfer::Context::create of bindings/cpp does.

use std::ffi::c_char;

/// The version of the loaded library, comparable with LUXFER_VERSION. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn luxfer_version() -> u32 {
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

/// The version of the loaded library as text, such as "0.1.0". The string is static: never free it. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn luxfer_version_string() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
