//! Waiting for bytes, to the microsecond.

use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};

/// Returns when there is something to read, at the latest after `timeout`.
pub(crate) fn readable(from: &impl AsFd, timeout: Duration) -> io::Result<()> {
    until(&mut [PollFd::new(from, PollFlags::IN)], timeout)
}

/// The same for either of two.
pub(crate) fn either_readable(from: [BorrowedFd<'_>; 2], timeout: Duration) -> io::Result<()> {
    until(&mut from.map(|from| PollFd::from_borrowed_fd(from, PollFlags::IN)), timeout)
}

fn until(any: &mut [PollFd<'_>], timeout: Duration) -> io::Result<()> {
    let timeout = Timespec {
        tv_sec: i64::try_from(timeout.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: i64::from(timeout.subsec_nanos()),
    };
    match poll(any, Some(&timeout)) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}
