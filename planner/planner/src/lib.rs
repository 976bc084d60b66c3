//! (in work)
#![no_std]
#![forbid(unsafe_code)]
