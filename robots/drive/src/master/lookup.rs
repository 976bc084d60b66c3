//! Whose frame it is.

use super::Master;
use crate::id::{NMT, SYNC};
use crate::table::{DriveTable, MAX_BUSES, MAX_NODES, Pdo};

/// Transmit PDOs of all nodes.
const MAX_INPUTS: usize = 4 * MAX_NODES;

/// Places of [`Inputs`]: twice as many as there are inputs, so that few share one.
const PLACES: usize = 2 * MAX_INPUTS;

/// A transmit PDO.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input<'a> {
    key: u16,
    /// Index of its node.
    pub(super) node: u8,
    /// Its bit among those of its node.
    pub(super) bit: u8,
    pub(super) pdo: &'a Pdo,
}

/// The transmit PDO of each identifier: a hash table.
#[derive(Clone, Debug)]
pub(super) struct Inputs<'a> {
    places: [Option<Input<'a>>; PLACES],
}

impl<'a> Inputs<'a> {
    pub(super) fn of(table: &DriveTable<'a>) -> Self {
        let mut own = Self { places: [None; PLACES] };
        for (node, index) in table.nodes.iter().take(MAX_NODES).zip(0..) {
            for (pdo, at) in node.transmit.iter().take(MAX_INPUTS / MAX_NODES).zip(0..8) {
                let key = key(node.bus, pdo.cob_id);
                own.insert(Input { key, node: index, bit: 1 << at, pdo });
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
    fn insert(&mut self, input: Input<'a>) {
        for attempt in 0..PLACES {
            let Some(place) = self.places.get_mut(Self::place(input.key, attempt)) else { return };
            match place {
                None => {
                    *place = Some(input);
                    return;
                }
                Some(other) if other.key == input.key => return,
                Some(_) => {}
            }
        }
    }

    #[inline(always)]
    pub(super) fn find(&self, bus: usize, id: u16) -> Option<Input<'a>> {
        let bus = u8::try_from(bus).ok().filter(|bus| usize::from(*bus) < MAX_BUSES)?;
        let wanted = key(bus, id);
        for attempt in 0..PLACES {
            let input = (*self.places.get(Self::place(wanted, attempt))?)?;
            if input.key == wanted {
                return Some(input);
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
