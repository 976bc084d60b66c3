//! Node-IDs and COB-IDs are unique on each bus.

use super::Check;
use crate::description::{Command, Node};
use crate::error::Spot;
use shapebot_drive::id;
use std::collections::BTreeMap;

/// What uses an identifier, and where it was said.
struct User {
    what: String,
    spot: Spot,
    is_pdo: bool,
}

impl Check<'_> {
    pub(super) fn unique(&self, nodes: &[Option<Node>], commands: &[Command]) {
        for bus in 0..self.source.buses.len() {
            self.node_ids(bus);
            let mut taken: BTreeMap<u16, User> = BTreeMap::new();
            for (id, user) in self.users(bus, nodes, commands) {
                if user.is_pdo && id::is_restricted(id) {
                    let message = format!("{}: CiA 301 restricts COB-ID 0x{id:03X}", user.what);
                    self.complaints.add(&user.spot, message);
                }
                if let Some(first) = taken.get(&id) {
                    let message =
                        format!("COB-ID 0x{id:03X} is that of {} and of {}", first.what, user.what);
                    self.complaints.add(&user.spot, message);
                } else {
                    taken.insert(id, user);
                }
            }
        }
    }

    fn node_ids(&self, bus: usize) {
        let on_bus = |name: &str| self.source.buses[bus].name.value == name;
        let master = &self.source.operator.master;
        let mut taken = BTreeMap::from([(master.value, "the master")]);
        for node in self.source.nodes.iter().filter(|node| on_bus(&node.bus.value)) {
            let id = node.id.value;
            if let Some(first) = taken.insert(id, &node.name.value) {
                let message = format!("node-ID {id} is that of `{first}` too");
                self.complaints.add(&node.id.spot, message);
            }
        }
    }

    fn users(&self, bus: usize, nodes: &[Option<Node>], commands: &[Command]) -> Vec<(u16, User)> {
        let mut users = Vec::new();
        let mut add = |id, what: String, spot: &Spot, is_pdo| {
            users.push((id, User { what, spot: spot.clone(), is_pdo }));
        };
        let operator = &self.source.operator;
        add(id::NMT, "NMT".into(), &operator.master.spot, false);
        add(id::SYNC, "SYNC".into(), &operator.master.spot, false);
        let master = 0x700 + u16::from(operator.master.value);
        add(master, "the master's heartbeat".into(), &operator.master.spot, false);
        if operator.bus.value == self.source.buses[bus].name.value {
            add(operator.command.value, "operator commands".into(), &operator.command.spot, true);
            add(operator.telemetry.value, "telemetry".into(), &operator.telemetry.spot, true);
        }
        for (node, source) in nodes.iter().zip(&self.source.nodes) {
            let Some(node) = node.as_ref().filter(|node| usize::from(node.bus) == bus) else {
                continue;
            };
            let spot = &source.id.spot;
            for (id, what) in [
                (node.id.emergency(), "the emergency message"),
                (node.id.sdo_request(), "the SDO request"),
                (node.id.sdo_response(), "the SDO response"),
                (node.id.heartbeat(), "the heartbeat"),
            ] {
                add(id, format!("{what} of `{}`", node.name), spot, false);
            }
            for pdo in &node.transmit {
                add(pdo.cob_id, format!("TPDO {} of `{}`", pdo.number, node.name), spot, true);
            }
        }
        let shared = |id| self.source.shared.iter().find(|shared| shared.cob_id.value == id);
        for command in commands.iter().filter(|command| usize::from(command.bus) == bus) {
            let spot = shared(command.cob_id).map_or(&operator.master.spot, |s| &s.cob_id.spot);
            add(command.cob_id, command.name.clone(), spot, true);
        }
        users
    }
}
