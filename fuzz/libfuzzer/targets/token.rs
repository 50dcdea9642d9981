//! libFuzzer brings the bytes to the body `token`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| hatchery_fuzz::token(bytes));
