//! A local socket for one operator at a time.

use shapebot_drive::operator::stream::{LONGEST, Reader, encode};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};

/// Bytes that are read at a time; what comes faster waits.
const READ: usize = 256;

/// A listening Unix socket. Who connects takes the place of who was connected before.
#[derive(Debug)]
pub struct Socket {
    listener: UnixListener,
    path: PathBuf,
    peer: Option<(UnixStream, Reader)>,
}

impl Socket {
    /// Listens at a path, which must not exist.
    ///
    /// # Errors
    ///
    /// What the system says.
    pub fn listen(path: &Path) -> io::Result<Self> {
        let listener = UnixListener::bind(path)?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, path: path.to_owned(), peer: None })
    }

    /// Frames that have come; does not wait.
    pub(super) fn receive(&mut self) -> Vec<Vec<u8>> {
        if let Ok((stream, _)) = self.listener.accept() {
            self.peer = stream.set_nonblocking(true).is_ok().then(|| (stream, Reader::default()));
        }
        let Some((stream, reader)) = &mut self.peer else { return Vec::new() };
        let mut bytes = [0; READ];
        match stream.read(&mut bytes) {
            Ok(0) => self.peer = None,
            Ok(count) => {
                let frames = bytes.iter().take(count).filter_map(|byte| reader.push(*byte));
                return frames.map(|(frame, len)| frame.into_iter().take(len).collect()).collect();
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(_) => self.peer = None,
        }
        Vec::new()
    }

    /// Sends a frame if it can be sent at once.
    pub(super) fn send(&mut self, frame: &[u8]) {
        let Some((stream, _)) = &mut self.peer else { return };
        let mut record = [0; LONGEST];
        let used = encode(frame, &mut record);
        match stream.write(record.get(..used).unwrap_or(&record)) {
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Ok(count) if count == used => {}
            // A record that is cut would put the reader out of step.
            _ => self.peer = None,
        }
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        // A path that cannot be removed is only in the way of the next session, which says so.
        drop(std::fs::remove_file(&self.path));
    }
}
