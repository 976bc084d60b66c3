//! The straight-line code of each drive's PDOs against its tables: two masters with the same robot, one
//! of which goes through entries and fields.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use shapebot_answers::Nodes;
use shapebot_drive::safety::{Request, State};
use shapebot_drive::{
    Command, CommandTable, DriveTable, Entry, Frame, Master, NodeTable, Pdo, Role, Signal,
};

const DRIVES: [&DriveTable<'static>; 6] = [
    &shapebot_answers::ballbot3d::DRIVE,
    &shapebot_answers::ballbot3d_1khz::DRIVE,
    &shapebot_answers::ballbot3d_arms::DRIVE,
    &shapebot_answers::ballbot_planar::DRIVE,
    &shapebot_answers::cartpole_planar::DRIVE,
    &shapebot_answers::segway_planar::DRIVE,
];

/// The tables of a drive without straight-line code.
struct Interpreted {
    transmit: Vec<Vec<Pdo>>,
    commands: Vec<CommandTable<'static>>,
}

impl Interpreted {
    fn of(table: &DriveTable<'static>) -> Self {
        let pdos = |node: &NodeTable<'static>| node.transmit.iter().map(|pdo| pdo.interpreted());
        let command = |command: &CommandTable<'static>| CommandTable { writer: None, ..*command };
        Self {
            transmit: table.nodes.iter().map(|node| pdos(node).collect()).collect(),
            commands: table.commands.iter().map(command).collect(),
        }
    }

    fn nodes<'a>(&'a self, table: &DriveTable<'a>) -> Vec<NodeTable<'a>> {
        let nodes = table.nodes.iter().zip(&self.transmit);
        nodes.map(|(node, transmit)| NodeTable { transmit, ..*node }).collect()
    }
}

/// All frames that a master sends in a cycle for what came.
fn cycle(master: &mut Master<'_>, came: &[(usize, Frame)], forces: &[f32], now: u64) -> Vec<Frame> {
    let mut sent = Vec::new();
    master.poll(now, &mut |_, frame| sent.push(frame));
    for (bus, frame) in came {
        master.receive(*bus, frame, now + 500);
    }
    master.poll(now + 500, &mut |_, frame| sent.push(frame));
    if master.inputs_due(now + 500) {
        master.measure(now + 500);
        let command = Command::new(forces);
        master.command(&command, now + 500, &mut |_, frame| sent.push(frame));
    }
    sent
}

/// Numbers that a sound robot may send, small where the master would complain. Both drives of a pair go
/// alike, each with the sign of its motor.
fn made_up(node: &NodeTable<'_>, axes: &[i64; 8], entry: &Entry, random: &mut impl Rng) -> i64 {
    let within: f32 = match (entry.signal, node.motor) {
        (Signal::Position, Some(motor)) => {
            return axes[usize::from(motor.axis)] * i64::from(motor.sign);
        }
        (Signal::Coordinate(_) | Signal::Rate(_), _) => 0.01,
        _ => 0.2,
    };
    (random.random_range(-within..within) / entry.scale) as i64
}

#[test]
fn straight_lines_do_what_tables_say() {
    for table in DRIVES {
        assert!(
            table.nodes.iter().flat_map(|node| node.transmit).all(|pdo| pdo.reader().is_some())
        );
        assert!(table.commands.iter().all(|command| command.writer.is_some()));
        let tables = Interpreted::of(table);
        let nodes = tables.nodes(table);
        let interpreted = DriveTable { nodes: &nodes, commands: &tables.commands, ..*table };
        assert_eq!(interpreted, *table);
        let mut masters = [Master::new(table), Master::new(&interpreted)];
        let mut answers = Nodes::new(table);
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let (mut sent, mut moving, mut axes) = (Vec::new(), 0, [0; 8]);
        for at in 0..4000_u64 {
            let now = at * u64::from(table.timing.period_us);
            let mut came: Vec<_> = sent
                .iter()
                .flat_map(|frame| (0..table.buses.len()).map(move |bus| (bus, frame)))
                .filter_map(|(bus, frame)| Some((bus, answers.hear(bus, frame)?)))
                .collect();
            for axis in &mut axes {
                *axis += random.random_range(-60..=60);
            }
            let value =
                |node: usize, entry: &Entry| made_up(&table.nodes[node], &axes, entry, &mut random);
            answers.sample(value, |bus, frame| came.push((bus, frame)));
            // In the end anything, in sound and broken lengths, of nodes that stay alive.
            if at > 3000 {
                for (_, frame) in &mut came {
                    let bytes: [u8; 8] = random.random();
                    let len = if random.random_bool(0.9) { frame.len() } else { 3 };
                    *frame = Frame::new(frame.standard_id().unwrap_or(0), &bytes[..len]);
                }
            }
            came.extend(answers.heartbeats());
            let forces: [f32; 8] = std::array::from_fn(|_| random.random_range(-30.0..30.0));
            let [own, other] = masters.each_mut().map(|it| cycle(it, &came, &forces, now));
            assert_eq!(own, other, "{}, cycle {at}", table.name);
            let [one, two] = &masters;
            assert_eq!(one.measurement(), two.measurement(), "{}, cycle {at}", table.name);
            let drives = |node: &usize| table.nodes[*node].role == Role::Drive;
            for node in (0..table.nodes.len()).filter(drives) {
                assert_eq!(one.statusword(node), two.statusword(node));
                assert_eq!(one.motor_torque(node).to_bits(), two.motor_torque(node).to_bits());
            }
            assert_eq!((one.faults(), one.counters()), (two.faults(), two.counters()));
            let request = match one.state() {
                State::LegsDown => Some(Request::Start),
                _ => None,
            };
            for (master, request) in masters.iter_mut().zip([request; 2]) {
                request.map(|request| master.request(request, now + 600));
            }
            moving += u64::from(masters[0].state() == State::Balancing);
            sent = own;
        }
        assert!(moving > 1000, "{}: {moving} cycles of balancing", table.name);
        assert!(masters[0].faults().any(), "{}: random frames are faults", table.name);
        let alive = (0..table.nodes.len()).filter(|node| masters[0].is_alive(*node)).count();
        assert_eq!(alive, table.nodes.len(), "{}: random frames were read to the end", table.name);
    }
}
