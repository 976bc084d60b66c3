//! What is built by cargo within a test, and run. One program: builds in folders of their own go side by
//! side.

mod dropped_in;
mod emulated;
mod foreign;
mod link;
#[cfg(unix)]
mod lockstep;
