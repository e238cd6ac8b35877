#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| luxfer_fuzz::distribution(data, luxfer::ffi::LUXFER_DISTRIBUTION_GLDF));
