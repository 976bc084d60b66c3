//! Linux SocketCAN.

use std::io::ErrorKind;
use std::os::fd::{AsFd, BorrowedFd};
use std::time::{Duration, Instant};

use socketcan::{
    CanErrorFrame, CanFrame, CanSocket, EmbeddedFrame, Frame as _, Socket, SocketOptions,
};

use crate::{Bus, BusError, ErrorState, Frame, Health, Received, wait};

/// Linux: address family not supported.
const EAFNOSUPPORT: i32 = 97;
/// Linux: no such device.
const ENODEV: i32 = 19;
/// Linux: no buffer space available; the interface's queue is full.
const ENOBUFS: i32 = 105;
/// Linux: network is down, as after bus-off.
const ENETDOWN: i32 = 100;

/// Controller problems of an error frame's second byte: error-passive, sending or receiving.
const PASSIVE: u8 = 0x10 | 0x20;
/// Error classes of an error frame's identifier (linux/can/error.h).
const CLASS_CONTROLLER: u32 = 0x004;
const CLASS_BUS_OFF: u32 = 0x040;
const CLASS_RESTARTED: u32 = 0x100;

/// A CAN interface of Linux, for example `can0` or `vcan0`.
#[derive(Debug)]
pub struct SocketBus {
    socket: CanSocket,
    interface: String,
    start: Instant,
    health: Health,
}

impl SocketBus {
    /// Opens an interface that is up already.
    ///
    /// # Errors
    ///
    /// [`BusError::Unavailable`] if the kernel has no SocketCAN or no such interface; [`BusError::Io`].
    pub fn open(interface: &str) -> Result<Self, BusError> {
        let socket = CanSocket::open(interface).map_err(|error| refused(interface, error))?;
        let failed = |error| BusError::io(interface, error);
        socket.set_nonblocking(true).map_err(failed)?;
        socket.set_error_filter_accept_all().map_err(failed)?;
        let interface = interface.to_owned();
        Ok(Self { socket, interface, start: Instant::now(), health: Health::default() })
    }

    /// Notes what an error frame says of the controller.
    fn note(&mut self, error: &CanErrorFrame) {
        let class = error.raw_id();
        let [_, controller, _, _, _, _, transmit, receive] =
            error.data().try_into().unwrap_or([0; 8]);
        self.health.transmit_errors = u32::from(transmit);
        self.health.receive_errors = u32::from(receive);
        if class & CLASS_BUS_OFF != 0 {
            self.health.state = ErrorState::BusOff;
        } else if class & CLASS_RESTARTED != 0 {
            self.health.state = ErrorState::Active;
        } else if class & CLASS_CONTROLLER != 0 {
            let passive = controller & PASSIVE != 0;
            self.health.state = if passive { ErrorState::Passive } else { ErrorState::Active };
        }
    }
}

fn refused(interface: &str, error: std::io::Error) -> BusError {
    let why = match error.raw_os_error() {
        Some(EAFNOSUPPORT) => {
            "this kernel has no SocketCAN (address family AF_CAN): load the modules can and can-raw, \
             or take the bus in virtual time or slcan"
        }
        Some(ENODEV) => {
            "no such CAN interface; `ip link add dev vcan0 type vcan` makes a virtual one"
        }
        _ if error.kind() == ErrorKind::NotFound => "no such CAN interface",
        _ => return BusError::io(interface, error),
    };
    BusError::Unavailable { bus: interface.to_owned(), why: why.to_owned() }
}

impl Bus for SocketBus {
    fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        let outgoing = if frame.is_remote() {
            CanFrame::new_remote(frame.id(), frame.len())
        } else {
            CanFrame::new(frame.id(), frame.bytes())
        };
        let outgoing = outgoing.ok_or(BusError::Unsupported("this frame"))?;
        self.socket.write_frame(&outgoing).map_err(|error| match error.raw_os_error() {
            Some(ENOBUFS) => BusError::QueueFull { waiting: 0 },
            Some(ENETDOWN) => BusError::BusOff,
            _ if error.kind() == ErrorKind::WouldBlock => BusError::QueueFull { waiting: 0 },
            _ => BusError::io(&self.interface, error),
        })
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
        loop {
            match self.socket.read_frame() {
                Ok(CanFrame::Error(error)) => self.note(&error),
                Ok(frame) => {
                    let time = self.now();
                    let frame = if frame.is_remote_frame() {
                        Frame::remote(frame.id(), frame.dlc())
                    } else {
                        Frame::checked(frame.id(), frame.data())
                    };
                    if let Some(frame) = frame {
                        return Ok(Some(Received { frame, time }));
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    let left = deadline.saturating_sub(self.now());
                    if left == 0 {
                        return Ok(None);
                    }
                    // The crate's own time-out counts in milliseconds, and spins through the last one.
                    wait::readable(&self.socket, Duration::from_micros(left))
                        .map_err(|error| BusError::io(&self.interface, error))?;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(BusError::io(&self.interface, error)),
            }
        }
    }

    fn health(&self) -> Health {
        self.health
    }

    fn descriptor(&self) -> Option<BorrowedFd<'_>> {
        Some(self.socket.as_fd())
    }
}

#[cfg(test)]
mod tests {
    use super::SocketBus;
    use crate::BusError;

    #[test]
    fn a_missing_interface_or_kernel_part_is_one_clear_error() {
        let error = SocketBus::open("shapebot9").unwrap_err();
        assert!(matches!(error, BusError::Unavailable { .. }), "{error}");
        assert!(error.to_string().starts_with("shapebot9: "), "{error}");
    }
}
