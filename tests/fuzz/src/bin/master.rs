//! The CANopen master: see [`shapebot_fuzz::master`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| shapebot_fuzz::master::check(bytes));
