//! slcan over pseudo-terminals, and against any bytes.
#![cfg(unix)]

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

use proptest::prelude::*;
use shapebot_bus::serial::Serial;
use shapebot_bus::slcan::codec::{self, Decoder, Token};
use shapebot_bus::slcan::{Adapter, Wait};
use shapebot_bus::{Bus, BusError, ErrorState, Frame, Slcan};

/// A new pseudo-terminal; `None`, after a line that says so, where there are none.
fn terminal() -> Option<Serial> {
    let error = match Serial::pseudo_terminal() {
        Ok(terminal) => return Some(terminal),
        Err(error) => error,
    };
    let required = std::env::var("SHAPEBOT_REQUIRE").unwrap_or_default();
    let listed = |word: &str| matches!(word.trim(), "pty" | "all");
    assert!(!required.split(',').any(listed), "SHAPEBOT_REQUIRE wants `pty`: {error}");
    let _ = writeln!(io::stderr(), "skipped (pty): {error}");
    None
}

fn pair() -> Option<(Slcan<Serial>, Adapter<Serial>)> {
    let terminal = terminal()?;
    let port = Serial::open(Path::new(terminal.path()), 115_200).unwrap();
    let adapter = Adapter::new(terminal, "adapter");
    Some((Slcan::open(port, "host", 1_000_000).unwrap(), adapter))
}

fn soon(bus: &impl Bus) -> u64 {
    bus.now() + 200_000
}

#[test]
fn frames_go_both_ways_over_a_pseudo_terminal() {
    let Some((mut host, mut adapter)) = pair() else { return };
    assert!(adapter.receive(adapter.now() + 20_000).unwrap().is_none());
    assert!(adapter.is_open());
    assert_eq!(adapter.bitrate(), 1_000_000);
    let id = shapebot_drive::extended(0x1ABC_DEF0).unwrap();
    let frames = [
        Frame::new(0x080, &[]),
        Frame::new(0x201, &[0x0F, 0, 0xFF, 0x7F]),
        Frame::checked(id, &[1, 2, 3, 4, 5, 6, 7, 8]).unwrap(),
        Frame::remote(id, 4).unwrap(),
    ];
    for frame in &frames {
        host.send(frame).unwrap();
        assert_eq!(adapter.receive(soon(&adapter)).unwrap().unwrap().frame, *frame);
        adapter.send(frame).unwrap();
        assert_eq!(host.receive(soon(&host)).unwrap().unwrap().frame, *frame);
    }
    assert_eq!((host.refused(), host.unreadable()), (0, 0));
}

#[test]
fn status_and_refusals_come_back() {
    let Some((mut host, mut adapter)) = pair() else { return };
    host.ask_status().unwrap();
    adapter.send(&Frame::new(1, &[])).unwrap();
    assert!(adapter.receive(adapter.now() + 20_000).unwrap().is_none());
    assert!(host.receive(host.now() + 20_000).unwrap().is_none());
    assert_eq!(host.health().state, ErrorState::Active);
    assert_eq!((host.refused(), adapter.lost()), (0, 1));
    // Another program takes over the open channel.
    let path = adapter.port().path().to_owned();
    let mut again = Slcan::attach(Serial::open(Path::new(&path), 115_200).unwrap(), "again");
    again.send(&Frame::new(0x080, &[])).unwrap();
    let received = adapter.receive(soon(&adapter)).unwrap().unwrap();
    assert_eq!(received.frame, Frame::new(0x080, &[]));
}

#[test]
fn a_closed_channel_loses_frames_and_a_bad_bit_rate_is_an_error() {
    let Some(closed) = terminal() else { return };
    let mut adapter = Adapter::new(closed, "adapter");
    adapter.send(&Frame::new(1, &[])).unwrap();
    assert_eq!(adapter.lost(), 1);
    let Some(other) = terminal() else { return };
    assert!(matches!(Slcan::open(other, "x", 123), Err(BusError::Unsupported(_))));
    let error = Serial::open(Path::new("/no/such/port"), 115_200).unwrap_err();
    assert!(error.to_string().starts_with("/no/such/port: "), "{error}");
}

#[test]
fn a_host_that_does_not_read_costs_bounded_memory() {
    let Some((_host, mut adapter)) = pair() else { return };
    assert!(adapter.receive(adapter.now() + 20_000).unwrap().is_none());
    for _ in 0..100_000 {
        adapter.send(&Frame::new(0x181, &[0; 8])).unwrap();
    }
    // The terminal and the adapter's outbox hold some thousand bytes, 22 a frame.
    assert!(adapter.lost() > 98_000, "{}", adapter.lost());
}

/// A port that holds bytes in memory.
#[derive(Debug, Default)]
struct Memory {
    input: VecDeque<u8>,
    output: Vec<u8>,
}

impl Read for Memory {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.input.is_empty() {
            Err(io::ErrorKind::WouldBlock.into())
        } else {
            self.input.read(buffer)
        }
    }
}

impl Write for Memory {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.output.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Wait for Memory {
    fn wait(&self, _: Duration) -> io::Result<()> {
        std::thread::sleep(Duration::from_micros(50));
        Ok(())
    }
}

fn conversation(input: &[u8]) -> (Vec<Frame>, String) {
    let memory = Memory { input: input.iter().copied().collect(), output: Vec::new() };
    let mut adapter = Adapter::new(memory, "memory");
    let mut frames = Vec::new();
    while let Some(received) = adapter.receive(0).unwrap() {
        frames.push(received.frame);
    }
    (frames, String::from_utf8(adapter.port().output.clone()).unwrap())
}

#[test]
fn an_adapter_answers_as_the_manual_says() {
    // Not open: refused. Bit rate, open, twice open, frame, status, version, close, refused again.
    let (frames, answers) = conversation(b"t0800\rS6\rO\rO\rS6\rt08021122\rF\rV\rC\rt0800\rt9\r");
    assert_eq!(frames, [Frame::new(0x080, &[0x11, 0x22])]);
    assert_eq!(answers, "\x07\r\r\x07\x07z\rF00\rV1013\r\r\x07\x07");
}

#[test]
fn listening_only_refuses_to_send() {
    let (frames, answers) = conversation(b"L\rt0800\r");
    assert!(frames.is_empty());
    assert_eq!(answers, "\r\x07");
}

proptest! {
    #[test]
    fn any_bytes_are_taken_and_lines_stay_short(bytes in proptest::collection::vec(any::<u8>(), 0..2000)) {
        let mut decoder = Decoder::default();
        for byte in &bytes {
            if let Some(Token::Line(line)) = decoder.push(*byte) {
                prop_assert!(line.as_bytes().len() <= 30);
                let _ = codec::command(&line);
                let _ = codec::reply(&line);
            }
        }
        conversation(&bytes.iter().map(|b| b & 0x7F).collect::<Vec<_>>());
    }

    #[test]
    fn any_line_of_frame_letters_is_a_frame_or_an_error(text in "[tTrR][0-9A-Fa-f]{0,30}") {
        let mut decoder = Decoder::default();
        let tokens: Vec<_> = format!("{text}\r").bytes().filter_map(|b| decoder.push(b)).collect();
        if let [Token::Line(line)] = tokens[..] && let Ok(codec::Command::Send(frame)) = codec::command(&line) {
            let (letter, digits) = text.split_at(1);
            let expected = format!("{letter}{}\r", digits.to_ascii_uppercase());
            let again = codec::encode(&frame, None);
            prop_assert_eq!(again.as_bytes(), expected.as_bytes());
        }
    }

    #[test]
    fn frames_survive_the_line(id in 0..0x800_u16, data in proptest::collection::vec(any::<u8>(), 0..=8)) {
        let frame = Frame::new(id, &data);
        let mut decoder = Decoder::default();
        let line = codec::encode(&frame, None);
        let tokens: Vec<_> = line.as_bytes().iter().filter_map(|b| decoder.push(*b)).collect();
        let [Token::Line(line)] = tokens[..] else { panic!("one line") };
        prop_assert_eq!(codec::command(&line), Ok(codec::Command::Send(frame)));
    }
}
