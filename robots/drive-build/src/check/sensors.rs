//! Coordinates without a motor are measured, each once.

use super::Check;
use crate::description::Node;
use shapebot_drive::{Pdo, Signal};

impl Check<'_> {
    pub(super) fn sensors(&self, nodes: &[Option<Node>]) {
        if nodes.iter().any(Option::is_none) {
            // What is missing may be in the node that could not be read.
            return;
        }
        let count = |wanted: Signal| {
            let pdos = nodes.iter().flatten().flat_map(|node| &node.transmit);
            let sent = pdos.filter(|pdo| pdo.is_synchronous()).flat_map(Pdo::entries);
            sent.filter(|entry| entry.signal == wanted).count()
        };
        let spot = &self.source.robot.spot;
        for (index, coordinate) in self.model.coordinates.iter().enumerate() {
            let name = coordinate.name;
            let measured = count(Signal::Coordinate(index as u8));
            let rates = count(Signal::Rate(index as u8));
            let expected = usize::from(!coordinate.actuated);
            self.complaints.demand(measured == expected, spot, || {
                let kind = if coordinate.actuated { "has a motor" } else { "has no motor" };
                format!(
                    "coordinate `{name}` {kind} and is sent by {measured} sensors, expected {expected}"
                )
            });
            let lean = self.lean().any(|(lean, _)| lean == index);
            let enough = if lean { rates == 1 } else { rates <= 1 };
            self.complaints.demand(enough, spot, || {
                format!("`{name}-rate` is sent by {rates} sensors, expected 1")
            });
        }
    }
}
