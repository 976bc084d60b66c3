//! A simulated sensor node: IMU or encoder.

use shapebot_drive::{DataType, Object};

use crate::device::Device;
use crate::{Access, Dictionary, Mappable, Physical, Quantity};

/// What a sensor puts into an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// A quantity; one count of the object is `scale` of it, in SI units and with its sign.
    Quantity {
        /// What is measured.
        quantity: Quantity,
        /// SI units per count.
        scale: f64,
    },
    /// A counter of samples.
    Sequence,
    /// Zero while the sensor is sound.
    Health,
}

/// An object of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// Where it is in the dictionary.
    pub object: Object,
    /// Its type.
    pub kind: DataType,
    /// What it holds.
    pub reading: Reading,
}

/// Faults of a sensor that can be injected, as switches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SensorFaults {
    /// No new samples: values and counter stay.
    pub(crate) stale: bool,
    /// Values that are not numbers: the smallest of the type, as sensors mark them.
    pub(crate) invalid: bool,
    /// What it says of its health.
    pub(crate) health: u8,
}

#[derive(Clone, Debug)]
pub(crate) struct Sensor {
    channels: Vec<Channel>,
    sequence: i64,
    pub(crate) faults: SensorFaults,
}

impl Sensor {
    pub(crate) fn new(channels: &[Channel], dictionary: &mut Dictionary) -> Self {
        for channel in channels {
            let (read, transmit) = (Access::Read, Mappable::Transmit);
            dictionary.number(channel.object, channel.kind, 0, read, transmit);
        }
        Self { channels: channels.to_vec(), sequence: 0, faults: SensorFaults::default() }
    }

    pub(crate) fn sample(&mut self, device: &mut Device, physical: &mut Physical<'_>) {
        if self.faults.stale {
            return;
        }
        self.sequence = self.sequence.wrapping_add(1);
        for channel in &self.channels {
            let (low, high) = channel.kind.range();
            let number = match channel.reading {
                Reading::Quantity { .. } if self.faults.invalid => low,
                Reading::Quantity { quantity, scale } => {
                    let counts = (physical.here().measure(quantity) / scale).round();
                    // One above the mark of a value that is not a number.
                    count(counts, if low < 0 { low + 1 } else { low }, high)
                }
                Reading::Sequence => low + self.sequence.rem_euclid(high - low + 1),
                Reading::Health => i64::from(self.faults.health),
            };
            device.dictionary.set(channel.object, number);
        }
    }
}

/// A number of counts within a range; what is not a number is the mark below it.
#[expect(clippy::cast_possible_truncation, reason = "`as` saturates, then the range holds")]
fn count(counts: f64, low: i64, high: i64) -> i64 {
    if counts.is_nan() { low - 1 } else { (counts as i64).clamp(low, high) }
}
