#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| hatchery_fuzz::worker_message(bytes));
