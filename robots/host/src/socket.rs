//! Operators on a Unix socket.

use crate::Error;
use shapebot_drive::operator::stream::{LONGEST, Reader, encode};
use std::fs::Permissions;
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::fs::{FileTypeExt, PermissionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};

/// Operators at a time; more are turned away.
const OPERATORS: usize = 4;

/// Bytes taken from an operator in a cycle.
const BYTES: usize = 512;

/// Operators on a Unix socket: the frames of [`shapebot_drive::operator`] in records of
/// [`shapebot_drive::operator::stream`]. Nothing here waits.
#[derive(Debug)]
pub struct Socket {
    listener: UnixListener,
    path: PathBuf,
    operators: Vec<(UnixStream, Reader)>,
}

impl Socket {
    /// Makes a socket that only its owner may use. One that is left from another run is replaced.
    ///
    /// # Errors
    ///
    /// [`Error::Io`], also if there is something else at the path.
    pub fn bind(path: &Path) -> Result<Self, Error> {
        let failed = |source| Error::Io { place: path.display().to_string(), source };
        let left = std::fs::symlink_metadata(path).is_ok_and(|data| data.file_type().is_socket());
        if left {
            std::fs::remove_file(path).map_err(failed)?;
        }
        let listener = UnixListener::bind(path).map_err(failed)?;
        std::fs::set_permissions(path, Permissions::from_mode(0o600)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        Ok(Self { listener, path: path.to_owned(), operators: Vec::with_capacity(OPERATORS) })
    }

    /// Passes on the frames that came.
    pub fn serve(&mut self, take: &mut dyn FnMut(&[u8])) {
        self.accept();
        self.operators.retain_mut(|(stream, reader)| listen(stream, reader, take).is_ok());
    }

    fn accept(&mut self) {
        while let Ok((stream, _)) = self.listener.accept() {
            // One that is turned away is closed.
            if self.operators.len() < OPERATORS && stream.set_nonblocking(true).is_ok() {
                self.operators.push((stream, Reader::default()));
            }
        }
    }

    /// Sends a frame to all operators. One that does not read loses frames.
    pub fn tell(&mut self, bytes: &[u8]) {
        let mut record = [0; LONGEST];
        let length = encode(bytes, &mut record);
        let record = record.get(..length).unwrap_or_default();
        self.operators.retain_mut(|(stream, _)| match stream.write(record) {
            Ok(_) => true,
            Err(error) => is_not_now(&error),
        });
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = std::fs::remove_file(&self.path);
    }
}

fn listen(
    stream: &mut UnixStream,
    reader: &mut Reader,
    take: &mut dyn FnMut(&[u8]),
) -> io::Result<()> {
    let mut bytes = [0; BYTES];
    match stream.read(&mut bytes) {
        Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
        Ok(count) => {
            for byte in bytes.iter().take(count) {
                if let Some((frame, length)) = reader.push(*byte) {
                    take(frame.get(..length).unwrap_or_default());
                }
            }
            Ok(())
        }
        Err(error) if is_not_now(&error) => Ok(()),
        Err(error) => Err(error),
    }
}

fn is_not_now(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

#[cfg(test)]
mod tests {
    use super::Socket;
    use shapebot_drive::operator::stream::{LONGEST, Reader, encode};
    use std::io::{Read, Write};
    use std::os::unix::net::UnixStream;

    #[test]
    fn frames_go_both_ways_and_the_path_is_cleared() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("operator");
        let mut socket = Socket::bind(&path).unwrap();
        let mut operator = UnixStream::connect(&path).unwrap();
        let mut record = [0; LONGEST];
        let length = encode(&[1, 2, 3], &mut record);
        operator.write_all(&record[..length]).unwrap();
        let mut frames = Vec::new();
        socket.serve(&mut |frame| frames.push(frame.to_vec()));
        assert_eq!(frames, [[1, 2, 3]]);
        socket.tell(&[4, 5]);
        let mut bytes = [0; 6];
        operator.read_exact(&mut bytes).unwrap();
        let mut reader = Reader::default();
        let heard = bytes.iter().find_map(|byte| reader.push(*byte));
        assert_eq!(heard, Some(([4, 5, 0, 0, 0, 0, 0, 0], 2)));
        // One that is left behind is replaced, anything else is not.
        let again = Socket::bind(&path).unwrap();
        drop((socket, again));
        assert!(!path.exists());
        std::fs::write(&path, "mine").unwrap();
        assert!(Socket::bind(&path).is_err());
    }
}
