//! Whose frame it is.

use super::Master;
use crate::id::{NMT, SYNC};
use crate::table::{DriveTable, MAX_BUSES, MAX_NODES};

/// Transmit PDOs of all nodes.
const MAX_INPUTS: usize = 4 * MAX_NODES;

/// Places of [`Inputs`]: twice as many as there are inputs, so that few share one.
const PLACES: usize = 2 * MAX_INPUTS;

/// Node and PDO of each identifier: a hash table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs {
    /// Key, node, PDO.
    places: [(u16, u8, u8); PLACES],
}

impl Inputs {
    /// No key: buses are fewer.
    const EMPTY: u16 = u16::MAX;

    pub(super) fn of(table: &DriveTable<'_>) -> Self {
        let mut own = Self { places: [(Self::EMPTY, 0, 0); PLACES] };
        for (node, index) in table.nodes.iter().take(MAX_NODES).zip(0..) {
            for (pdo, at) in node.transmit.iter().take(MAX_INPUTS / MAX_NODES).zip(0..) {
                own.insert(key(node.bus, pdo.cob_id), index, at);
            }
        }
        own
    }

    /// The place that is looked at in the `attempt`th attempt.
    const fn place(key: u16, attempt: usize) -> usize {
        // The node-ID is in the low bits, the number of the PDO and the bus above.
        ((key ^ (key >> 6)) as usize + attempt) & (PLACES - 1)
    }

    /// The first of several with one key stays.
    fn insert(&mut self, key: u16, node: u8, pdo: u8) {
        for attempt in 0..PLACES {
            let Some(place) = self.places.get_mut(Self::place(key, attempt)) else { return };
            if place.0 == key {
                return;
            }
            if place.0 == Self::EMPTY {
                *place = (key, node, pdo);
                return;
            }
        }
    }

    /// Node and PDO.
    pub(super) fn find(&self, bus: usize, id: u16) -> Option<(usize, usize)> {
        let bus = u8::try_from(bus).ok().filter(|bus| usize::from(*bus) < MAX_BUSES)?;
        let wanted = key(bus, id);
        for attempt in 0..PLACES {
            let (key, node, pdo) = *self.places.get(Self::place(wanted, attempt))?;
            if key == wanted {
                return Some((node.into(), pdo.into()));
            }
            if key == Self::EMPTY {
                return None;
            }
        }
        None
    }
}

const fn key(bus: u8, cob_id: u16) -> u16 {
    (bus as u16) << 11 | (cob_id & 0x7FF)
}

impl Master<'_> {
    pub(super) fn node_index(&self, bus: usize, id: crate::NodeId) -> Option<usize> {
        self.table.nodes.iter().position(|node| node.id == id && usize::from(node.bus) == bus)
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
