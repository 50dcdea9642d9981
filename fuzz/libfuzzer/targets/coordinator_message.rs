//! libFuzzer brings the bytes to the body `coordinator_message`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| hatchery_fuzz::coordinator_message(bytes));
