//! Whose frame it is.

use super::{Master, key};
use crate::id::{NMT, SYNC};
use crate::table::{MAX_BUSES, Role};

impl Master<'_> {
    pub(super) fn legs_node(&self) -> Option<usize> {
        self.table.nodes.iter().position(|node| node.role == Role::Legs)
    }

    pub(super) fn node_index(&self, bus: usize, id: crate::NodeId) -> Option<usize> {
        self.table.nodes.iter().position(|node| node.id == id && usize::from(node.bus) == bus)
    }

    pub(super) fn find_input(&self, bus: usize, id: u16) -> Option<(usize, usize)> {
        let used = self.lookup.get(..self.lookup_len)?;
        let bus = u8::try_from(bus).ok().filter(|bus| usize::from(*bus) < MAX_BUSES)?;
        let wanted = key(bus, id);
        let at = used.binary_search_by_key(&wanted, |(key, ..)| *key).ok()?;
        used.get(at).map(|(_, node, pdo)| (usize::from(*node), usize::from(*pdo)))
    }

    /// Whether the frame is one for [`crate::operator`].
    pub(super) fn is_operators(&self, bus: usize, id: u16) -> bool {
        let operator = &self.table.operator;
        id == operator.command && usize::from(operator.bus) == bus
    }

    /// Whether only the master sends this identifier.
    pub(super) fn is_ours(&self, bus: usize, id: u16) -> bool {
        let command = |command: &crate::CommandTable<'_>| {
            command.cob_id == id && usize::from(command.bus) == bus
        };
        let request = |node: &crate::NodeTable<'_>| {
            node.id.sdo_request() == id && usize::from(node.bus) == bus
        };
        matches!(id, NMT | SYNC)
            || id == self.table.operator.master.heartbeat()
            || self.table.commands.iter().any(command)
            || self.table.nodes.iter().any(request)
    }
}
