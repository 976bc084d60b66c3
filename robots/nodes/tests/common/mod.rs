//! A master by hand: frames written as bytes, from the tables of CiA 301 and 402.
#![allow(dead_code, reason = "each test uses its part")]

use shapebot_bus::{Frame, VirtualBus};
use shapebot_drive::NodeId;
use shapebot_nodes::{DriveSettings, Network, Node, NodeKind, NodeSettings, Plant, Rotors};

pub(crate) fn node_id(id: u8) -> NodeId {
    NodeId::new(id).unwrap()
}

pub(crate) fn drive(id: u8, motor: usize) -> Node {
    let kind = NodeKind::Drive(DriveSettings { motor, ..DriveSettings::default() });
    Node::new(&NodeSettings::new("simulated drive", node_id(id), kind))
}

/// A network with drives 1 to `count` over free rotors of 0.01 kg·m².
pub(crate) fn drives(count: u8) -> Network<Rotors> {
    let nodes = (1..=count).map(|id| (0, drive(id, usize::from(id) - 1))).collect();
    let bus = VirtualBus::new(1_000_000, 0);
    Network::new(vec![bus], nodes, Rotors::new(usize::from(count), 0.01))
}

/// What a master does, over one bus.
pub(crate) trait ByHand {
    fn time(&self) -> u64;
    fn put(&mut self, id: u16, bytes: &[u8]);
    /// All frames up to a time.
    fn until(&mut self, time: u64) -> Vec<Frame>;

    /// All frames of the next so many microseconds.
    fn pass(&mut self, micros: u64) -> Vec<Frame> {
        self.until(self.time() + micros)
    }

    fn request(&mut self, node: u8, bytes: [u8; 8]) -> [u8; 8] {
        self.put(0x600 + u16::from(node), &bytes);
        let answers = self.pass(2000);
        let id = Some(0x580 + u16::from(node));
        let answer = answers.iter().find(|frame| frame.standard_id() == id);
        answer.and_then(Frame::exactly).expect("an SDO answer")
    }

    /// Writes `size` bytes; the abort code if there is one.
    fn write(&mut self, node: u8, at: (u16, u8), value: u32, size: u8) -> Result<(), u32> {
        let [low, high] = at.0.to_le_bytes();
        let [a, b, c, d] = value.to_le_bytes();
        let answer = self.request(node, [0x23 | ((4 - size) << 2), low, high, at.1, a, b, c, d]);
        let code = u32::from_le_bytes([answer[4], answer[5], answer[6], answer[7]]);
        if answer[0] == 0x60 { Ok(()) } else { Err(code) }
    }

    fn read(&mut self, node: u8, at: (u16, u8)) -> Result<u32, u32> {
        let [low, high] = at.0.to_le_bytes();
        let answer = self.request(node, [0x40, low, high, at.1, 0, 0, 0, 0]);
        let value = u32::from_le_bytes([answer[4], answer[5], answer[6], answer[7]]);
        if answer[0] == 0x80 { Err(value) } else { Ok(value) }
    }

    /// PDOs in the predefined places: torque and controlword in; statusword, position, actual torque
    /// out; both with each SYNC. Mode 10, cycle 2 ms, deadline 10 ms.
    fn set_up(&mut self, node: u8) {
        let id = u32::from(node);
        let steps = [
            (0x1400, 1, 0x8000_0200 + id, 4),
            (0x1400, 2, 1, 1),
            (0x1400, 5, 10, 2),
            (0x1600, 0, 0, 1),
            (0x1600, 1, 0x6071_0010, 4),
            (0x1600, 2, 0x6040_0010, 4),
            (0x1600, 0, 2, 1),
            (0x1400, 1, 0x200 + id, 4),
            (0x1800, 1, 0xC000_0180 + id, 4),
            (0x1800, 2, 1, 1),
            (0x1A00, 0, 0, 1),
            (0x1A00, 1, 0x6041_0010, 4),
            (0x1A00, 2, 0x6064_0020, 4),
            (0x1A00, 3, 0x6077_0010, 4),
            (0x1A00, 0, 3, 1),
            (0x1800, 1, 0x4000_0180 + id, 4),
            (0x1006, 0, 2000, 4),
            (0x60C2, 1, 2, 1),
            (0x60C2, 2, 0xFD, 1),
            (0x6060, 0, 10, 1),
        ];
        for (index, sub, value, size) in steps {
            self.write(node, (index, sub), value, size).unwrap_or_else(|code| {
                panic!("{index:#06x}:{sub} = {value:#x}: abort {code:#010x}")
            });
        }
    }

    /// One cycle of 2 ms: SYNC, then a torque and a controlword for each node from 1 on; what came
    /// in as (statusword, position, actual torque).
    fn cycle(&mut self, commands: &[(i16, u16)]) -> Vec<Option<(u16, i32, i16)>> {
        let end = self.time() + 2000;
        self.put(0x080, &[]);
        let mut frames = self.until(end - 1000);
        for ((torque, controlword), node) in commands.iter().zip(1_u16..) {
            let [a, b] = torque.to_le_bytes();
            let [c, d] = controlword.to_le_bytes();
            self.put(0x200 + node, &[a, b, c, d]);
        }
        frames.extend(self.until(end));
        let answer = |node: u16| {
            let frame = frames.iter().find(|f| f.standard_id() == Some(0x180 + node))?;
            let [a, b, c, d, e, f, g, h] = frame.exactly::<8>()?;
            let position = i32::from_le_bytes([c, d, e, f]);
            Some((u16::from_le_bytes([a, b]), position, i16::from_le_bytes([g, h])))
        };
        (1..=commands.len() as u16).map(answer).collect()
    }
}

impl<P: Plant> ByHand for Network<P> {
    fn time(&self) -> u64 {
        shapebot_bus::Bus::now(self)
    }

    fn put(&mut self, id: u16, bytes: &[u8]) {
        self.send(0, &Frame::new(id, bytes)).unwrap();
    }

    fn until(&mut self, time: u64) -> Vec<Frame> {
        std::iter::from_fn(|| self.receive(time)).map(|(_, received)| received.frame).collect()
    }
}

/// Set up, started and enabled.
pub(crate) fn enabled(count: u8) -> Network<Rotors> {
    let mut network = drives(count);
    network.pass(30_000);
    (1..=count).for_each(|node| network.set_up(node));
    network.put(0x000, &[1, 0]);
    for controlword in [0x06, 0x07, 0x0F, 0x0F] {
        network.cycle(&vec![(0, controlword); usize::from(count)]);
    }
    let states = network.cycle(&vec![(0, 0x0F); usize::from(count)]);
    for state in states {
        assert_eq!(state.unwrap().0 & 0x6F, 0x27, "operation enabled");
    }
    network
}

/// Torque on each rotor, N·m.
pub(crate) fn torques(network: &Network<Rotors>, count: usize) -> Vec<f64> {
    (0..count).map(|motor| network.plant().torque(motor)).collect()
}

/// Emergency codes among frames, with the node.
pub(crate) fn emergencies(frames: &[Frame]) -> Vec<(u16, u16)> {
    let of = |frame: &Frame| {
        let node = frame.standard_id()?.checked_sub(0x080).filter(|n| (1..128).contains(n))?;
        let [low, high, ..] = frame.exactly::<8>()?;
        Some((node, u16::from_le_bytes([low, high])))
    };
    frames.iter().filter_map(of).collect()
}
