//! Frames of the master, and receive PDOs that several drives share.

use super::Check;
use crate::description::{Axis, Command, Node};
use crate::error::Spot;
use crate::source::{SharedSource, TypeSource};
use shapebot_drive::{DataType, Entry, Field, Pdo, Signal, Source};

/// A field of a shared PDO: the axis and the drives that take it.
struct SharedField {
    axis: usize,
    kind: DataType,
    /// Indices of nodes.
    listeners: Vec<usize>,
}

impl Check<'_> {
    /// All frames of the master; shared PDOs and set-ups are added to the nodes.
    pub(super) fn commands(
        &self,
        nodes: &mut [Option<Node>],
        axes: &[Option<Axis>],
    ) -> Vec<Command> {
        let mut commands = Vec::new();
        for shared in &self.source.shared {
            commands.extend(self.shared(shared, nodes, axes));
        }
        for (index, node) in nodes.iter().enumerate() {
            let Some(node) = node else { continue };
            let own = node.receive.iter().filter(|pdo| pdo.cob_id == node.id.rpdo(pdo.number));
            commands.extend(own.map(|pdo| own_command(index, node, pdo)));
        }
        self.torque_is_received_once(nodes);
        self.set_up(nodes);
        commands
    }

    fn torque_is_received_once(&self, nodes: &[Option<Node>]) {
        for (node, source) in nodes.iter().zip(&self.source.nodes) {
            let Some(node) = node.as_ref().filter(|node| node.motor.is_some()) else { continue };
            let torques = node.receive.iter().filter(|pdo| pdo.is_synchronous());
            let torques = torques.flat_map(Pdo::entries);
            let count = torques.filter(|entry| entry.signal == Signal::Torque).count();
            self.complaints.demand(count == 1, &source.name.spot, || {
                format!("receives `torque` {count} times in synchronous PDOs, expected once")
            });
        }
    }

    fn shared(
        &self,
        shared: &SharedSource,
        nodes: &mut [Option<Node>],
        axes: &[Option<Axis>],
    ) -> Option<Command> {
        let bus = self.bus_index(&shared.bus)?;
        let fields = self.shared_fields(shared, axes)?;
        let bytes: usize = fields.iter().map(|field| field.kind.bytes()).sum();
        if bytes > 8 {
            let message = format!("{} fields are {bytes} bytes, a frame has 8", fields.len());
            self.complaints.add(&shared.spot, message);
            return None;
        }
        for (at, field) in fields.iter().enumerate() {
            for listener in &field.listeners {
                self.listen(shared, &fields, at, *listener, nodes)?;
            }
        }
        let field = |field: &SharedField| Field {
            kind: field.kind,
            source: Source::Torque { axis: field.axis as u8, sign: 1 },
        };
        Some(Command {
            name: "shared torques".to_owned(),
            bus,
            cob_id: shared.cob_id.value,
            cyclic: true,
            fields: fields.iter().map(field).collect(),
        })
    }

    fn shared_fields(
        &self,
        shared: &SharedSource,
        axes: &[Option<Axis>],
    ) -> Option<Vec<SharedField>> {
        let field = |name: &crate::error::Said<String>| {
            let of_node = self.source.nodes.iter().position(|node| node.name.value == name.value);
            let find = |wanted: &dyn Fn(&Axis) -> bool| {
                axes.iter().position(|axis| axis.as_ref().is_some_and(wanted))
            };
            let axis = match of_node {
                Some(node) => find(&|axis| axis.drives.contains(&(node as u8))),
                None => find(&|axis| axis.name == name.value),
            };
            let Some(axis) = axis else {
                let what = "is neither a drive nor an axis; a shared PDO has torques alone";
                self.complaints.add(&name.spot, format!("`{}` {what}", name.value));
                return None;
            };
            let drives = &axes[axis].as_ref()?.drives;
            let listeners = match of_node {
                Some(node) => vec![node],
                None => drives.iter().map(|drive| usize::from(*drive)).collect(),
            };
            let (kind, _) = self.motor_of(&self.source.nodes[*listeners.first()?])?;
            let (_, kind) = self.entry_type(kind, Signal::Torque, "torque")?;
            Some(SharedField { axis, kind, listeners })
        };
        let fields: Vec<Option<_>> = shared.fields.iter().map(field).collect();
        fields.into_iter().collect()
    }

    /// Adds the PDO to a drive that takes field `at` of it.
    fn listen(
        &self,
        shared: &SharedSource,
        fields: &[SharedField],
        at: usize,
        listener: usize,
        nodes: &mut [Option<Node>],
    ) -> Option<()> {
        let source = &self.source.nodes[listener];
        let kind = self.type_of(source)?;
        let node = nodes[listener].as_mut()?;
        self.sharing_conditions(shared, kind, node, &source.name.spot, fields.len());
        let torque = crate::error::Said { value: "torque".to_owned(), spot: shared.spot.clone() };
        let own = self.entry(source, kind, &torque, super::signals::Way::Receive)?;
        let entry = |(index, field): (usize, &SharedField)| {
            if index == at { own } else { Entry::gap(field.kind) }
        };
        let entries: Vec<Entry> = fields.iter().enumerate().map(entry).collect();
        let number = node.receive.len() as u8 + 1;
        if number > kind.pdo_counts[0] {
            let message = format!("no receive PDO is left of {}", kind.pdo_counts[0]);
            self.complaints.add(&source.name.spot, message);
            return None;
        }
        node.receive.push(Pdo::new(shared.cob_id.value, number, 1, &entries));
        Some(())
    }

    /// The sign is in the drive, controlwords have a PDO of their own, other fields are gaps.
    fn sharing_conditions(
        &self,
        shared: &SharedSource,
        kind: &TypeSource,
        node: &Node,
        spot: &Spot,
        fields: usize,
    ) {
        let id = shared.cob_id.value;
        self.complaints.demand(node.motor.is_some_and(|motor| motor.sign_in_drive), spot, || {
            format!("hears the shared PDO 0x{id:03X}: `sign-in = \"drive\"` is needed (0x607E)")
        });
        let mut own = node.receive.iter().flat_map(Pdo::entries);
        self.complaints.demand(own.any(|entry| entry.signal == Signal::Controlword), spot, || {
            format!(
                "hears the shared PDO 0x{id:03X} of {fields} torques, which has no room for a \
                 controlword: it takes a receive PDO of its own with `controlword`"
            )
        });
        self.complaints.demand(kind.dummy_mapping || fields == 1, &kind.name.spot, || {
            format!(
                "the shared PDO 0x{id:03X} has {} fields for others: `dummy-mapping = true` is needed",
                fields - 1
            )
        });
        let bus = self.bus_index(&shared.bus);
        self.complaints.demand(bus == Some(node.bus), spot, || {
            format!("is not on bus `{}` of the shared PDO 0x{id:03X}", shared.bus.value)
        });
    }
}

/// The frame for a receive PDO that one node has for itself.
fn own_command(index: usize, node: &Node, pdo: &Pdo) -> Command {
    let source = |entry: &Entry| match (entry.signal, node.motor) {
        (Signal::Controlword, _) => Source::Controlword { node: index as u8 },
        (Signal::Mode, _) => Source::Mode { node: index as u8 },
        (Signal::Torque, Some(motor)) => {
            Source::Torque { axis: motor.axis, sign: motor.master_sign() }
        }
        (Signal::LegsCommand, _) => Source::Legs,
        _ => Source::Zero,
    };
    let field = |entry: &Entry| Field { kind: entry.kind, source: source(entry) };
    Command {
        name: format!("RPDO {} of {}", pdo.number, node.name),
        bus: node.bus,
        cob_id: pdo.cob_id,
        cyclic: pdo.is_synchronous(),
        fields: pdo.entries().iter().map(field).collect(),
    }
}
