//! Runs calls.py, which makes the table of functions from the header.

use std::process::Command;

fn main() {
    for source in ["calls.py", "../include/luxfer", "../tests/conformance/script.py", "../bindings/python/generate.py"]
    {
        println!("cargo::rerun-if-changed={source}");
    }
    let made = Command::new("python3").arg("calls.py").output().expect("python3 is needed");
    assert!(made.status.success(), "calls.py: {}", String::from_utf8_lossy(&made.stderr));
    std::fs::write(std::env::var("OUT_DIR").unwrap() + "/table.rs", made.stdout).unwrap();
}
