//! Sets the SONAME of the shared library, because rustc sets none: `libluxfer.so.MAJOR`, or `libluxfer.so.0.MINOR`
//! before 1.0; on macOS `libluxfer.MAJOR.dylib`, which programs look for in the folders of their `@rpath`.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let variable = |name| std::env::var(name).unwrap_or_default();
    let (major, minor) = (variable("CARGO_PKG_VERSION_MAJOR"), variable("CARGO_PKG_VERSION_MINOR"));
    let abi = if major == "0" { format!("0.{minor}") } else { major };
    match variable("CARGO_CFG_TARGET_OS").as_str() {
        "linux" => {
            println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libluxfer.so.{abi}");
            // Keep the library in memory after dlclose: threads of the host may still have to run thread-local
            // destructors of Rust's standard library.
            println!("cargo:rustc-cdylib-link-arg=-Wl,-z,nodelete");
        }
        "macos" => println!("cargo:rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libluxfer.{abi}.dylib"),
        _ => {}
    }
}
