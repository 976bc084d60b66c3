//! (in work)
#![forbid(unsafe_code)]
