//! libFuzzer brings the bytes to the body `worker_message`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| hatchery_fuzz::worker_message(bytes));
