//! The same board with its clock at the other end of the serial lines: for a simulation that is as slow
//! as it likes.
//!
//! Each bus is a UART that speaks slcan. A tick begins when the host has asked for the status flags (`F`)
//! on every line; what it sent before belongs to that tick. All frames of the tick go out before the
//! answers to `F`.

use super::Board;
use super::mps2_an386::{Serial, Uart};
use shapebot_bus::slcan::codec::{Command, Decoder, Token, command, encode, encode_status};
use shapebot_drive::{Fault, Frame};

/// Frames of a tick at most; more are lost, as in a controller with a short queue.
const ROOM: usize = 64;

/// A line and what it said.
struct Line {
    uart: Uart,
    decoder: Decoder,
    /// The host has asked for the flags in this tick.
    asked: bool,
}

impl Line {
    /// Takes bytes until the host asks for the flags, or none are left; passes on frames.
    fn listen(&mut self, mut pass: impl FnMut(Frame)) {
        while !self.asked {
            let Some(byte) = self.uart.read() else { return };
            let Some(Token::Line(line)) = self.decoder.push(byte) else { continue };
            match command(&line) {
                Ok(Command::Send(frame)) => pass(frame),
                Ok(Command::Status) => self.asked = true,
                _ => {}
            }
        }
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            // The emulated line takes everything in the end.
            while !self.uart.write(*byte) {}
        }
    }
}

/// The board with a bus behind each of its first two UARTs, and no clock of its own.
pub struct Lockstep {
    lines: [Line; 2],
    queue: [Option<(usize, Frame)>; ROOM],
    taken: usize,
    len: usize,
    now: u64,
    tick: u32,
}

impl Lockstep {
    /// Ticks of `tick` µs. `None` if the board is in use already.
    #[must_use]
    pub fn new(tick: u32) -> Option<Self> {
        let line = |uart| Line { uart, decoder: Decoder::default(), asked: false };
        let lines = [line(Uart::take()?), line(Uart::take_second()?)];
        Some(Self { lines, queue: [None; ROOM], taken: 0, len: 0, now: 0, tick })
    }
}

impl Board for Lockstep {
    fn wait(&mut self) {
        (self.taken, self.len) = (0, 0);
        while self.lines.iter().any(|line| !line.asked) {
            let (queue, len) = (&mut self.queue, &mut self.len);
            for (bus, line) in self.lines.iter_mut().enumerate() {
                line.listen(|frame| {
                    if let Some(place) = queue.get_mut(*len) {
                        *place = Some((bus, frame));
                        *len += 1;
                    }
                });
            }
        }
        self.now += u64::from(self.tick);
    }

    fn now(&self) -> u64 {
        self.now
    }

    fn receive(&mut self) -> Option<(usize, Frame)> {
        let next = self.queue.get(..self.len)?.get(self.taken).copied().flatten();
        self.taken += usize::from(next.is_some());
        next
    }

    fn send(&mut self, bus: usize, frame: &Frame) -> bool {
        let Some(line) = self.lines.get_mut(bus) else { return false };
        line.write(encode(frame, None).as_bytes());
        true
    }

    /// Serial lines have no controllers whose state could be asked.
    fn fault(&self) -> Option<Fault> {
        None
    }

    fn alive(&mut self) {
        for line in &mut self.lines {
            line.asked = false;
            line.write(encode_status(0).as_bytes());
        }
    }
}
