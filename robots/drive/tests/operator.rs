//! The operator protocol against a master.

mod common;

use common::{PLANAR, Run, description};
use proptest::prelude::*;
use shapebot_drive::Master;
use shapebot_drive::crc::crc32;
use shapebot_drive::operator::command::{CHUNK, decode, encode, encode_chunk};
use shapebot_drive::operator::{
    Commanded, Operator, Order, Page, PlanError, PlanStore, Refusal, Tuned, stream,
};
use shapebot_drive::safety::{Request, State};

/// A master under an operator, with one gain of 0 to 500, and what it was told.
struct Told<'m, 't> {
    master: &'m mut Master<'t>,
    gain: Option<f32>,
    watch: Option<bool>,
    heard: u32,
}

impl<'m, 't> Told<'m, 't> {
    fn new(master: &'m mut Master<'t>) -> Self {
        Self { master, gain: None, watch: None, heard: 0 }
    }
}

impl Commanded for Told<'_, '_> {
    fn request(&mut self, request: Request, now: u64) -> bool {
        self.master.request(request, now)
    }

    fn aim(&mut self, heading: f32) {
        self.master.aim(heading);
    }

    fn set_gain(&mut self, index: u8, value: f32) -> bool {
        let within = index == 0 && (0.0..=500.0).contains(&value);
        self.gain = within.then_some(value);
        within
    }

    fn watch(&mut self, on: bool, _now: u64) {
        self.watch = Some(on);
    }

    fn heard(&mut self, _now: u64) {
        self.heard += 1;
    }
}

/// A standing robot, and what it takes from its operator.
fn standing(test: impl FnOnce(&mut Run<'_>, &mut Operator<'_>, u32)) {
    let description = description("ballbot_planar", &PLANAR);
    let tables = description.tables();
    let table = tables.table();
    let mut run = Run::new(&description, &table);
    run.stand();
    let (mut active, mut pending) = ([0; 256], [0; 256]);
    let store = PlanStore::new(&mut active, &mut pending);
    let mut operator = Operator::new(table.fingerprint, store);
    test(&mut run, &mut operator, table.fingerprint);
}

fn take(run: &mut Run<'_>, operator: &mut Operator<'_>, bytes: &[u8]) -> Refusal {
    let now = run.now();
    let taken = operator.receive(bytes, &mut Told::new(&mut run.master), now);
    assert_eq!(operator.refusal(), taken.err().unwrap_or_default());
    operator.refusal()
}

/// "stop" with sequence 7 for the fingerprint 0x01020304, checked by an independent computation of the
/// CRC (Python's `binascii.crc_hqx(bytes, 0xFFFF)`).
#[test]
fn a_command_has_these_bytes() {
    let bytes = encode(Order::Ask(Request::Stop), 7, 0x0102_0304);
    assert_eq!(bytes, [0x02, 0x07, 0, 0, 0, 0, 0xFA, 0x6B]);
    assert_eq!(decode(&bytes, 0x0102_0304), Ok((Order::Ask(Request::Stop), 7)));
    assert_eq!(decode(&bytes, 0x0102_0305), Err(Refusal::Checksum));
    assert_eq!(decode(&bytes[..7], 0x0102_0304), Err(Refusal::Length));
}

#[test]
fn sessions_sequences_and_states_are_kept() {
    standing(|run, operator, key| {
        let ask = |request, sequence| encode(Order::Ask(request), sequence, key);
        assert_eq!(take(run, operator, &ask(Request::Balance, 1)), Refusal::NoSession);
        assert_eq!(take(run, operator, &encode(Order::Hello, 200, key)), Refusal::None);
        assert_eq!(take(run, operator, &ask(Request::Balance, 201)), Refusal::None);
        assert_eq!(run.master.state(), State::Balancing);
        // A replay, one too far ahead, one that the state does not allow.
        assert_eq!(take(run, operator, &ask(Request::Balance, 201)), Refusal::Sequence);
        assert_eq!(take(run, operator, &ask(Request::KeepStation, 220)), Refusal::Sequence);
        assert_eq!(take(run, operator, &ask(Request::Start, 202)), Refusal::State);
        // An old hello does not open the session again.
        assert_eq!(take(run, operator, &encode(Order::Hello, 200, key)), Refusal::Sequence);
        // Each bit matters.
        for bit in 0..64 {
            let mut bytes = ask(Request::KeepStation, 203);
            bytes[bit / 8] ^= 1 << (bit % 8);
            let refusal = take(run, operator, &bytes);
            let expected = if bit == 7 { Refusal::Plan } else { Refusal::Checksum };
            assert_eq!(refusal, expected, "bit {bit}");
        }
        assert_eq!(run.master.state(), State::Balancing);
        // Stopping is taken at any time.
        assert_eq!(take(run, operator, &ask(Request::EmergencyStop, 90)), Refusal::None);
        assert_eq!(run.master.state(), State::FaultDown);
    });
}

#[test]
fn gains_and_watch_are_passed_on_and_only_what_is_sequenced_is_heard() {
    standing(|run, operator, key| {
        let mut robot = Told::new(&mut run.master);
        let mut tell = |order, sequence| {
            let taken = operator.receive(&encode(order, sequence, key), &mut robot, 0);
            (taken, robot.gain.take(), robot.watch.take(), core::mem::take(&mut robot.heard))
        };
        assert_eq!(tell(Order::Hello, 0), (Ok(()), None, None, 1));
        assert_eq!(tell(Order::Gain(0, 320.0), 1), (Ok(()), Some(320.0), None, 1));
        for (sequence, index, value) in
            [(2, 0, 500.1), (3, 0, f32::NAN), (4, 2, 0.0), (5, 0, f32::INFINITY)]
        {
            let told = tell(Order::Gain(index, value), sequence);
            assert_eq!(told, (Err(Refusal::Bounds), None, None, 1));
        }
        assert_eq!(tell(Order::Watch(true), 6), (Ok(()), None, Some(true), 1));
        assert_eq!(tell(Order::Watch(false), 7), (Ok(()), None, Some(false), 1));
        // A sign of life knows the last sequence, and leaves it to who commands.
        assert_eq!(tell(Order::Watch(true), 7), (Ok(()), None, Some(true), 0));
        assert_eq!(tell(Order::Gain(0, 7.0), 8), (Ok(()), Some(7.0), None, 1));
        // Replays, and what anybody can replay.
        assert_eq!(tell(Order::Watch(true), 7), (Err(Refusal::Sequence), None, None, 0));
        assert_eq!(tell(Order::Gain(0, 7.0), 8), (Err(Refusal::Sequence), None, None, 0));
        assert_eq!(tell(Order::Ask(Request::Stop), 7), (Ok(()), None, None, 0));
    });
}

#[test]
fn signs_of_life_do_not_hide_a_refusal() {
    standing(|run, operator, key| {
        take(run, operator, &encode(Order::Hello, 0, key));
        let refused = take(run, operator, &encode(Order::Ask(Request::Start), 1, key));
        assert_eq!(refused, Refusal::State);
        let mut robot = Told::new(&mut run.master);
        for (sequence, taken) in [(1, Ok(())), (0, Err(Refusal::Sequence))] {
            let watch = encode(Order::Watch(true), sequence, key);
            assert_eq!(operator.receive(&watch, &mut robot, 0), taken);
            assert_eq!(operator.refusal(), Refusal::State);
            assert_eq!(operator.sequence(), Some(1));
        }
    });
}

/// A file with the ends of a plan file.
fn plan(len: usize) -> Vec<u8> {
    let mut file: Vec<u8> = b"SBPL".iter().copied().chain(0..).take(len - 4).collect();
    let crc = crc32(&file).to_le_bytes();
    file.extend(crc);
    file
}

fn upload(
    run: &mut Run<'_>,
    operator: &mut Operator<'_>,
    key: u32,
    from: u8,
    file: &[u8],
    crc: u32,
) -> Refusal {
    take(run, operator, &encode(Order::PlanBegin(file.len() as u32), from, key));
    for (index, part) in file.chunks(CHUNK).enumerate() {
        take(run, operator, &encode_chunk(index as u32, part));
    }
    take(run, operator, &encode(Order::PlanEnd(crc), from + 1, key))
}

#[test]
fn plans_are_uploaded_checked_and_swapped_at_rest() {
    standing(|run, operator, key| {
        let file = plan(101);
        take(run, operator, &encode(Order::Hello, 0, key));
        assert_eq!(upload(run, operator, key, 1, &file, crc32(&file)), Refusal::None);
        assert_eq!(operator.plans().pending(), Some(&file[..]));
        assert_eq!(operator.plans().swap(State::Tracking, |_| true), Err(PlanError::State));
        assert_eq!(operator.plans().swap(State::StationKeeping, |_| false), Err(PlanError::State));
        assert_eq!(operator.plans().swap(State::StationKeeping, |_| true), Ok(()));
        assert_eq!(operator.plans().active(), Some(&file[..]));
        assert_eq!(operator.plans().pending(), None);
        // A wrong announcement, a flipped bit, a missing part, one that is too long.
        assert_eq!(upload(run, operator, key, 3, &file, 1), Refusal::Plan);
        let mut broken = file.clone();
        broken[50] ^= 4;
        assert_eq!(upload(run, operator, key, 5, &broken, crc32(&broken)), Refusal::Plan);
        take(run, operator, &encode(Order::PlanBegin(101), 7, key));
        take(run, operator, &encode_chunk(0, &file[..7]));
        assert_eq!(take(run, operator, &encode_chunk(2, &file[14..21])), Refusal::Plan);
        assert_eq!(
            take(run, operator, &encode(Order::PlanEnd(crc32(&file)), 8, key)),
            Refusal::Plan
        );
        assert_eq!(take(run, operator, &encode(Order::PlanBegin(257), 9, key)), Refusal::Plan);
        assert_eq!(take(run, operator, &encode_chunk(0, &file[..7])), Refusal::Plan);
        // The plan in use is what it was.
        assert_eq!(operator.plans().active(), Some(&file[..]));
    });
}

#[test]
fn telemetry_tells_all_pages() {
    standing(|run, operator, _| {
        run.forces = vec![10.0];
        let mut seen = [false; 13];
        let tuned = Tuned { factors: [0.6, 1.25, 1.0, 0.854], watch: true };
        for _ in 0..60 {
            run.pass(10_000);
            let bytes =
                operator.telemetry(&run.master, &tuned).expect("a page each ten milliseconds");
            assert_eq!(operator.telemetry(&run.master, &tuned), None);
            seen[usize::from(bytes[0])] = true;
            let page = Page::decode(&bytes).expect("a page");
            assert_eq!(page.encode(), bytes);
            match page {
                Page::Status { state, fault, .. } => {
                    assert_eq!((State::of(state), fault), (Some(run.master.state()), 0));
                }
                Page::Forces { group: 0, forces } => assert_eq!(forces[0], 1000),
                Page::Tuned { percent, watch } => {
                    assert_eq!((percent, watch), ([60, 125, 100, 85], 1));
                }
                _ => {}
            }
        }
        assert_eq!(seen, [true; 13]);
    });
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    /// Records are found again after any noise that is no record itself.
    #[test]
    fn streams_are_read_after_noise(noise in proptest::collection::vec(any::<u8>(), 0..40), bytes in any::<[u8; 8]>()) {
        let mut reader = stream::Reader::default();
        for byte in noise {
            reader.push(byte);
        }
        let mut record = [0; stream::LONGEST];
        let len = stream::encode(&bytes, &mut record);
        prop_assert_eq!(len, 12);
        // What the noise began may swallow one record, not two.
        let found = record.iter().chain(&record).filter_map(|byte| reader.push(*byte)).last();
        prop_assert_eq!(found, Some((bytes, 8)));
    }

    #[test]
    fn no_bytes_make_it_panic(frames in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..10), 1..60)) {
        let description = description("ballbot_planar", &PLANAR);
        let tables = description.tables();
        let table = tables.table();
        let mut master = Master::new(&table);
        let (mut active, mut pending) = ([0; 64], [0; 64]);
        let store = PlanStore::new(&mut active, &mut pending);
        let mut operator = Operator::new(table.fingerprint, store);
        let hello = encode(Order::Hello, 0, table.fingerprint);
        let _ = operator.receive(&hello, &mut Told::new(&mut master), 0);
        for (index, frame) in frames.iter().enumerate() {
            let _ = operator.receive(frame, &mut Told::new(&mut master), index as u64);
            prop_assert_ne!(master.state(), State::Enabling);
        }
        let _ = Page::decode(&frames[0]);
    }
}
