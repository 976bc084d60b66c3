//! Serial ports and pseudo-terminals whose reads and writes do not block.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::path::Path;
use std::time::Duration;

use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr};

use crate::slcan::Wait;
use crate::{BusError, wait};

/// A serial port, or one side of a pseudo-terminal, in raw mode.
#[derive(Debug)]
pub struct Serial {
    file: File,
    path: String,
    /// The other side of a pseudo-terminal, held open so that programs may come and go.
    _peer: Option<OwnedFd>,
}

impl Serial {
    /// Opens a serial port with a baud rate; pseudo-terminals do not care about the rate.
    ///
    /// # Errors
    ///
    /// [`BusError::Io`] with the path.
    pub fn open(path: &Path, baud: u32) -> Result<Self, BusError> {
        let place = path.display().to_string();
        let failed = |error: rustix::io::Errno| BusError::io(&place, error.into());
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let fd = open(path, flags, Mode::empty()).map_err(failed)?;
        make_raw(&fd, Some(baud)).map_err(failed)?;
        tcflush(&fd, QueueSelector::IOFlush).map_err(failed)?;
        Ok(Self { file: File::from(fd), path: place, _peer: None })
    }

    /// A new pseudo-terminal. Another program opens [`Serial::path`] as its serial port.
    ///
    /// # Errors
    ///
    /// [`BusError::Io`].
    pub fn pseudo_terminal() -> Result<Self, BusError> {
        let failed = |error: rustix::io::Errno| BusError::io("pseudo-terminal", error.into());
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let controller = openpt(flags).map_err(failed)?;
        grantpt(&controller).map_err(failed)?;
        unlockpt(&controller).map_err(failed)?;
        let name = ptsname(&controller, Vec::new()).map_err(failed)?;
        let path = name.to_string_lossy().into_owned();
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let peer = open(path.as_str(), flags, Mode::empty()).map_err(failed)?;
        make_raw(&peer, None).map_err(failed)?;
        let status = rustix::fs::fcntl_getfl(&controller).map_err(failed)?;
        rustix::fs::fcntl_setfl(&controller, status | OFlags::NONBLOCK).map_err(failed)?;
        Ok(Self { file: File::from(controller), path, _peer: Some(peer) })
    }

    /// Path of the port; for a pseudo-terminal that of the side that others open.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }
}

fn make_raw(fd: &OwnedFd, baud: Option<u32>) -> rustix::io::Result<()> {
    let mut settings = tcgetattr(fd)?;
    settings.make_raw();
    if let Some(baud) = baud {
        settings.set_speed(baud)?;
    }
    tcsetattr(fd, OptionalActions::Now, &settings)
}

impl Read for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.file.read(buffer)
    }
}

impl Write for Serial {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.file.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Wait for Serial {
    fn wait(&self, timeout: Duration) -> io::Result<()> {
        wait::readable(&self.file, timeout)
    }

    fn descriptor(&self) -> Option<BorrowedFd<'_>> {
        Some(self.file.as_fd())
    }
}
