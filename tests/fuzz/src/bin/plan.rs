//! Plan files: see [`shapebot_fuzz::plan`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| shapebot_fuzz::plan::check(bytes));
