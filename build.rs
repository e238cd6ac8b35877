//! Sets the SONAME of the shared library, because rustc sets none: `libluxfer.so.MAJOR`, or `libluxfer.so.0.MINOR`
//! before 1.0.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("linux") {
        let major = std::env::var("CARGO_PKG_VERSION_MAJOR").unwrap_or_default();
        let minor = std::env::var("CARGO_PKG_VERSION_MINOR").unwrap_or_default();
        let abi = if major == "0" { format!("0.{minor}") } else { major };
        println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libluxfer.so.{abi}");
        // Keep the library in memory after dlclose: threads of the host may still have to run thread-local destructors
        // of Rust's standard library.
        println!("cargo:rustc-cdylib-link-arg=-Wl,-z,nodelete");
    }
}
