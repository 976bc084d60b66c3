//! Node-IDs and the identifiers of the predefined connection set (CiA 301).

/// COB-ID of NMT commands: state changes of all nodes.
pub const NMT: u16 = 0x000;
/// COB-ID of SYNC.
pub const SYNC: u16 = 0x080;
/// COB-ID of time stamps.
pub const TIME: u16 = 0x100;

/// A CANopen node-ID, 1 to 127.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct NodeId(u8);

impl NodeId {
    /// `None` unless 1 to 127.
    #[must_use]
    pub const fn new(id: u8) -> Option<Self> {
        if id >= 1 && id <= 127 { Some(Self(id)) } else { None }
    }

    /// For tables: the nearest node-ID.
    #[must_use]
    pub const fn clamped(id: u8) -> Self {
        match id {
            0 => Self(1),
            1..=127 => Self(id),
            _ => Self(127),
        }
    }

    /// As a number.
    #[must_use]
    pub const fn raw(self) -> u8 {
        self.0
    }

    const fn at(self, base: u16) -> u16 {
        base + self.0 as u16
    }

    /// COB-ID of its emergency messages.
    #[must_use]
    pub const fn emergency(self) -> u16 {
        self.at(0x080)
    }

    /// Predefined COB-ID of its transmit PDO `number`, 1 to 4.
    #[must_use]
    pub const fn tpdo(self, number: u8) -> u16 {
        self.at(0x080 + 0x100 * clamp_pdo(number))
    }

    /// Predefined COB-ID of its receive PDO `number`, 1 to 4.
    #[must_use]
    pub const fn rpdo(self, number: u8) -> u16 {
        self.at(0x100 + 0x100 * clamp_pdo(number))
    }

    /// COB-ID of what its SDO server sends.
    #[must_use]
    pub const fn sdo_response(self) -> u16 {
        self.at(0x580)
    }

    /// COB-ID of what its SDO server receives.
    #[must_use]
    pub const fn sdo_request(self) -> u16 {
        self.at(0x600)
    }

    /// COB-ID of its boot-up message and heartbeats.
    #[must_use]
    pub const fn heartbeat(self) -> u16 {
        self.at(0x700)
    }
}

const fn clamp_pdo(number: u8) -> u16 {
    match number {
        0 | 1 => 1,
        2 | 3 => number as u16,
        _ => 4,
    }
}

/// What an 11-bit identifier stands for in the predefined connection set. PDOs may be anywhere else
/// too: tables say where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// NMT command.
    Nmt,
    /// SYNC.
    Sync,
    /// Time stamp.
    Time,
    /// Emergency message of a node.
    Emergency(NodeId),
    /// SDO response of a node.
    SdoResponse(NodeId),
    /// SDO request to a node.
    SdoRequest(NodeId),
    /// Boot-up or heartbeat of a node.
    Heartbeat(NodeId),
    /// A PDO, or nothing known.
    Other,
}

impl Function {
    /// From an identifier.
    #[must_use]
    pub fn of(id: u16) -> Self {
        let node = NodeId::new((id & 0x7F) as u8);
        match (id & !0x7F, node) {
            (0x000, None) => Self::Nmt,
            (0x080, None) => Self::Sync,
            (0x100, None) => Self::Time,
            (0x080, Some(node)) => Self::Emergency(node),
            (0x580, Some(node)) => Self::SdoResponse(node),
            (0x600, Some(node)) => Self::SdoRequest(node),
            (0x700, Some(node)) => Self::Heartbeat(node),
            _ => Self::Other,
        }
    }
}

/// Whether CiA 301 keeps an identifier for something else than PDOs.
#[must_use]
pub const fn is_restricted(id: u16) -> bool {
    matches!(id,
        0x000..=0x07F | 0x080 | 0x081..=0x0FF | 0x100 | 0x101..=0x180 | 0x581..=0x5FF | 0x601..=0x67F
        | 0x6E0..=0x7FF)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_those_of_the_predefined_connection_set() {
        let node = NodeId::new(5).unwrap();
        let found = [
            node.emergency(),
            node.tpdo(1),
            node.rpdo(1),
            node.tpdo(2),
            node.rpdo(2),
            node.tpdo(4),
            node.rpdo(4),
            node.sdo_response(),
            node.sdo_request(),
            node.heartbeat(),
        ];
        let expected = [0x085, 0x185, 0x205, 0x285, 0x305, 0x485, 0x505, 0x585, 0x605, 0x705];
        assert_eq!(found, expected);
        assert_eq!(Function::of(0x705), Function::Heartbeat(node));
        assert_eq!(Function::of(0x080), Function::Sync);
        assert_eq!(Function::of(0x085), Function::Emergency(node));
        assert_eq!(Function::of(0x185), Function::Other);
        assert_eq!(Function::of(0x700), Function::Other);
        assert!(NodeId::new(0).is_none() && NodeId::new(128).is_none());
    }
}
