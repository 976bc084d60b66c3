//! The simulated legs: down without being told, up only while the master is there.

use shapebot_drive::DataType;
use shapebot_drive::legs::{COMMAND, LegsCommand, LegsState, STATE};

use crate::device::Device;
use crate::{Access, Dictionary, Mappable, Physical};

/// Time between two positions of moving legs, µs.
const STEP: u64 = 1000;

#[derive(Clone, Debug)]
pub(crate) struct Legs {
    /// From one end to the other, µs.
    travel: u64,
    /// Extension: 1 is on the floor.
    extension: f64,
    moved_at: u64,
    pub(crate) stuck: bool,
    /// The connection is lost, or the node does not run: down, whatever the command says.
    released: bool,
}

impl Legs {
    pub(crate) fn new(travel: u64, dictionary: &mut Dictionary) -> Self {
        let (rw, receive) = (Access::ReadWrite, Mappable::Receive);
        dictionary.number(COMMAND, DataType::U8, 0, rw, receive);
        dictionary.limit(COMMAND, (0, 1));
        let down = i64::from(LegsState::DOWN.0);
        dictionary.number(STATE, DataType::U8, down, Access::Read, Mappable::Transmit);
        Self { travel, extension: 1.0, moved_at: 0, stuck: false, released: true }
    }

    /// The connection is lost or comes back.
    pub(crate) const fn release(&mut self, released: bool) {
        self.released = released;
    }

    fn retracts(&self, device: &Device) -> bool {
        let retract = i64::from(LegsCommand::Retract as u8);
        !self.released && device.is_operational() && device.dictionary.get(COMMAND) == retract
    }

    /// Lets the legs move up to now.
    pub(crate) fn step(&mut self, device: &mut Device, physical: &mut Physical<'_>) {
        let now = physical.now();
        let goal = if self.retracts(device) { 0.0 } else { 1.0 };
        #[expect(clippy::cast_precision_loss, reason = "2⁵³ µs are 285 years")]
        let part = now.saturating_sub(self.moved_at) as f64 / self.travel.max(1) as f64;
        self.moved_at = now;
        let before = self.extension;
        if !self.stuck {
            self.extension += (goal - before).clamp(-part, part);
        }
        #[expect(clippy::float_cmp, reason = "both ends are reached exactly by the clamp")]
        let (moved, arrived) = (self.extension != before, self.extension == goal);
        if moved {
            physical.here().set_legs(self.extension);
        }
        let state = match (arrived, goal > 0.5) {
            _ if self.stuck => LegsState::FAULT,
            (false, _) => LegsState::MOVING,
            (true, true) => LegsState::DOWN,
            (true, false) => LegsState::UP,
        };
        device.dictionary.set(STATE, i64::from(state.0));
    }

    pub(crate) fn next(&self, device: &Device) -> Option<u64> {
        let goal = if self.retracts(device) { 0.0 } else { 1.0 };
        let moving = !self.stuck && (self.extension - goal).abs() > 0.0;
        moving.then_some(self.moved_at + STEP)
    }
}
