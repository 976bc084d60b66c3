//! Nodes: PDOs, motors, and what must be in them.

use super::Check;
use super::signals::Way;
use super::timing::micros;
use crate::description::{Axis, Node, Resolution};
use crate::error::Said;
use crate::source::{NodeSource, PdoSource, TypeSource};
use shapebot_drive::{Entry, MotorTable, NodeId, Pdo, Role, Signal, Timing};

/// Bytes of a frame.
const FRAME: usize = 8;

impl Check<'_> {
    /// The nodes, in the file's order; `None` where something is wrong.
    pub(super) fn nodes(
        &self,
        axes: &[Option<Axis>],
        timing: Option<&Timing>,
        resolutions: &mut Vec<Resolution>,
    ) -> Vec<Option<Node>> {
        for kind in &self.source.types {
            let used = self.source.nodes.iter().any(|node| node.kind.value == kind.name.value);
            self.complaints.demand(used, &kind.name.spot, || "no node is of this type".to_owned());
            self.objects_are_mapped(kind);
        }
        let node = |node| self.node(node, axes, timing);
        let nodes: Vec<_> = self.source.nodes.iter().map(node).collect();
        for (node, source) in nodes.iter().zip(&self.source.nodes) {
            if let Some(node) = node {
                self.sensor_resolutions(node, source, resolutions);
            }
        }
        nodes
    }

    /// Objects that are no signal of any PDO are misspelt.
    fn objects_are_mapped(&self, kind: &TypeSource) {
        for object in &kind.objects {
            let name = &object.signal.value;
            let pdos = kind.receive.iter().chain(&kind.transmit);
            let mapped = pdos.flat_map(|pdo| &pdo.entries).any(|entry| entry.value == *name);
            let shared = name == "torque" && !self.source.shared.is_empty();
            self.complaints.demand(mapped || shared, &object.signal.spot, || {
                format!("no PDO of this type has `{name}`")
            });
        }
    }

    fn node(
        &self,
        node: &NodeSource,
        axes: &[Option<Axis>],
        timing: Option<&Timing>,
    ) -> Option<Node> {
        let kinds = self.source.types.iter().map(|kind| kind.name.value.as_str());
        let at = self.index_of("type", &node.kind, kinds)?;
        let kind = &self.source.types[usize::from(at)];
        let bus = self.bus_index(&node.bus)?;
        let id = NodeId::new(node.id.value)?;
        if kind.motor.is_none() {
            for spot in
                [node.sign.as_ref().map(|s| &s.spot), node.sign_in_drive.as_ref().map(|s| &s.spot)]
                    .into_iter()
                    .flatten()
            {
                self.complaints.add(spot, "goes with drives");
            }
        }
        let motor = match kind.motor {
            Some(_) => Some(self.motor(node, axes)?),
            None => None,
        };
        let receive = self.pdos(node, kind, &kind.receive, Way::Receive, id)?;
        let transmit = self.pdos(node, kind, &kind.transmit, Way::Transmit, id)?;
        let heartbeat_ms = self.whole(&kind.heartbeat, 1e3, "ms", 1, 65_535)? as u16;
        let timeout = &kind.heartbeat_timeout;
        self.complaints.demand(timeout.value > kind.heartbeat.value, &timeout.spot, || {
            let (found, every) = (timeout.value * 1e3, kind.heartbeat.value * 1e3);
            format!("{found} ms, but heartbeats come each {every} ms")
        });
        let mut node = Node {
            name: node.name.value.clone(),
            kind: kind.name.value.clone(),
            bus,
            id,
            role: kind.role.value,
            heartbeat_ms,
            heartbeat_timeout_us: micros(timeout.value),
            setup: Vec::new(),
            receive,
            transmit,
            motor,
        };
        self.required_signals(kind, &node);
        // Shared PDOs are added later, and then the set-up is written.
        let _ = timing?;
        node.setup.clear();
        Some(node)
    }

    fn motor(&self, node: &NodeSource, axes: &[Option<Axis>]) -> Option<MotorTable> {
        let (kind, motor) = self.motor_of(node)?;
        let source = self.axis_of(node)?;
        let at =
            axes.iter().position(|a| a.as_ref().is_some_and(|a| a.name == source.name.value))?;
        let axis = axes[at].as_ref()?;
        let ratio = self.ratio_of(source, &axis.unit)?;
        let per_count = self.torque_per_count(kind, motor)?;
        let limit = axis.limit / (axis.drives.len() as f64 * ratio * per_count);
        if node.sign.is_none() {
            self.complaints.add(&node.name.spot, "`sign` is missing: 1 or -1");
        }
        Some(MotorTable {
            axis: at as u8,
            sign: node.sign.as_ref()?.value,
            sign_in_drive: node.sign_in_drive.as_ref().is_some_and(|said| said.value),
            torque_per_count: per_count as f32,
            // Rounded down, but for what is whole up to rounding.
            torque_limit: (limit + 1e-6).floor() as i32,
            counts_per_revolution: motor.counts.value,
            ratio: ratio as f32,
            mode: motor.mode,
        })
    }

    fn pdos(
        &self,
        node: &NodeSource,
        kind: &TypeSource,
        sources: &[PdoSource],
        way: Way,
        id: NodeId,
    ) -> Option<Vec<Pdo>> {
        let (name, cob_id, at): (_, fn(NodeId, u8) -> u16, _) = match way {
            Way::Receive => ("receive", NodeId::rpdo, 0),
            Way::Transmit => ("transmit", NodeId::tpdo, 1),
        };
        let available = usize::from(kind.pdo_counts[at]);
        if sources.len() > available {
            let message = format!("{} {name} PDOs, the device has {available}", sources.len());
            self.complaints.add(&kind.name.spot, message);
            return None;
        }
        let pdos = sources.iter().zip(1..).map(|(source, number)| {
            let entries = source.entries.iter().map(|entry| self.entry(node, kind, entry, way));
            // All entries, so that all complaints are heard.
            let entries: Vec<Option<Entry>> = entries.collect();
            let entries: Vec<Entry> = entries.into_iter().collect::<Option<_>>()?;
            let bytes: usize = entries.iter().map(|entry| entry.kind.bytes()).sum();
            if bytes > FRAME || entries.is_empty() {
                let message = format!("{bytes} bytes; a PDO has 1 to {FRAME}");
                self.complaints.add(&source.spot, message);
                return None;
            }
            Some(Pdo::new(cob_id(id, number), number, source.transmission, &entries))
        });
        let pdos: Vec<Option<Pdo>> = pdos.collect();
        pdos.into_iter().collect()
    }

    /// What the master relies on.
    fn required_signals(&self, kind: &TypeSource, node: &Node) {
        let sends = |wanted: Signal, cyclic: bool| {
            let pdos = node.transmit.iter().filter(|pdo| !cyclic || pdo.is_synchronous());
            pdos.flat_map(Pdo::entries).filter(|entry| entry.signal == wanted).count()
        };
        let demand = |wanted: Signal, cyclic: bool, name: &str| {
            let count = sends(wanted, cyclic);
            let way = if cyclic { " in a synchronous PDO" } else { "" };
            self.complaints.demand(count == 1, &kind.name.spot, || {
                format!("sends `{name}` {count} times{way}, expected once")
            });
        };
        match node.role {
            Role::Drive => {
                demand(Signal::Statusword, true, "statusword");
                demand(Signal::ModeDisplay, true, "mode-display");
                let yaw = self.source.yaw.as_ref().and_then(|yaw| yaw.axis.as_ref());
                let axis =
                    self.source.axes.iter().find(|axis| {
                        axis.drives.value.iter().any(|drive| drive.value == node.name)
                    });
                let is_yaw = yaw.is_some_and(|yaw| axis.is_some_and(|a| a.name.value == yaw.value));
                if !is_yaw {
                    demand(Signal::Position, true, "position");
                }
                self.receives_once(kind, node, Signal::Controlword, "controlword");
            }
            Role::Imu => {
                demand(Signal::Sequence, true, "sequence");
                demand(Signal::Health, true, "health");
            }
            Role::Encoder => {}
            Role::Legs => {
                demand(Signal::LegsState, false, "legs-state");
                self.receives_once(kind, node, Signal::LegsCommand, "legs");
            }
        }
    }

    fn receives_once(&self, kind: &TypeSource, node: &Node, wanted: Signal, name: &str) {
        let entries = node.receive.iter().flat_map(Pdo::entries);
        let count = entries.filter(|entry| entry.signal == wanted).count();
        self.complaints.demand(count == 1, &kind.name.spot, || {
            format!("receives `{name}` {count} times, expected once")
        });
    }

    /// Legs at most once.
    pub(super) fn presence(&self, nodes: &[Option<Node>]) {
        let legs = nodes.iter().flatten().filter(|node| node.role == Role::Legs).count();
        let spot = &self.source.robot.spot;
        self.complaints
            .demand(legs <= 1, spot, || format!("{legs} nodes are legs, at most one can be"));
    }

    /// Steps and ranges of measured signals.
    fn sensor_resolutions(&self, node: &Node, source: &NodeSource, list: &mut Vec<Resolution>) {
        let safety = &self.source.safety;
        for entry in node.transmit.iter().flat_map(Pdo::entries) {
            let lean = |index: u8| self.lean().any(|(lean, _)| lean == usize::from(index));
            let coordinate = |index: u8| &self.model.coordinates[usize::from(index)];
            let (what, unit, needed, wanted): (_, &str, f64, Option<&Said<f64>>) =
                match entry.signal {
                    Signal::Coordinate(at) if lean(at) => {
                        let limit = safety.lean_limit.value;
                        (coordinate(at).name.to_owned(), "rad", limit, safety.lean_step.as_ref())
                    }
                    Signal::Rate(at) if lean(at) => {
                        let name = format!("rate of {}", coordinate(at).name);
                        (name, "rad/s", safety.lean_rate_start, safety.lean_rate_step.as_ref())
                    }
                    Signal::Coordinate(at) => {
                        let c = coordinate(at);
                        let bounds = c.lower.abs().max(c.upper.abs());
                        let needed = if bounds.is_finite() { bounds } else { 0.0 };
                        (c.name.to_owned(), c.unit, needed, None)
                    }
                    Signal::Rate(at) => {
                        let per_second = if coordinate(at).unit == "m" { "m/s" } else { "rad/s" };
                        (format!("rate of {}", coordinate(at).name), per_second, 0.0, None)
                    }
                    Signal::Heading => ("heading".into(), "rad", std::f64::consts::PI, None),
                    Signal::HeadingRate => ("heading rate".into(), "rad/s", 0.0, None),
                    Signal::Yaw => ("yaw".into(), "rad", std::f64::consts::PI, None),
                    _ => continue,
                };
            let step = f64::from(entry.scale).abs();
            let (low, high) = entry.kind.range();
            // The smaller side of zero; an unsigned angle may wrap.
            let side = if low < 0 { high } else { high / 2 };
            let range = step * side as f64;
            self.complaints.demand(needed <= range * (1.0 + 1e-6), &source.kind.spot, || {
                format!(
                    "{what}: the object holds {} {unit}, {} {unit} are needed",
                    super::figure(range),
                    super::figure(needed)
                )
            });
            self.resolution(list, what, [step, range], unit, wanted);
        }
    }
}
