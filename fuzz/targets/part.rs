#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| luxfer_fuzz::part(data));
