//! The SDO set-up of each node.

use super::Check;
use crate::description::Node;
use crate::source::{NodeSource, TypeSource};
use shapebot_drive::{DataType, Object, Pdo, Role, SdoStep, id};

/// Bit 31 of a PDO's COB-ID: the PDO does not exist.
const INVALID: u32 = 1 << 31;
/// Bit 30 of a transmit PDO's COB-ID: no remote requests.
const NO_RTR: u32 = 1 << 30;

/// Event timer of transmit PDOs that are sent on events, ms: lost ones are repeated.
pub(super) const EVENT_TIMER_MS: u16 = 100;

/// An object of a PDO by the PDO's number and the sub-index.
type Place = fn(u8, u8) -> Object;

const fn write(object: Object, kind: DataType, value: u32) -> SdoStep {
    SdoStep::write(object, kind, value)
}

const fn expect(object: Object, kind: DataType, value: u32) -> SdoStep {
    SdoStep::expect(object, kind, u32::MAX, value)
}

/// Mantissa and exponent of 0x60C2 for a period in µs: mantissa · 10^exponent s.
fn interpolation(period_us: u32) -> Option<(u8, i8)> {
    let (mut value, mut exponent) = (period_us, -6);
    while value > 0 && value.is_multiple_of(10) {
        value /= 10;
        exponent += 1;
    }
    Some((u8::try_from(value).ok().filter(|value| *value > 0)?, exponent))
}

impl Check<'_> {
    /// Writes the set-up of all nodes.
    pub(super) fn set_up(&self, nodes: &mut [Option<Node>]) {
        let period = self.source.timing.period.value;
        for (node, source) in nodes.iter_mut().zip(&self.source.nodes) {
            let (Some(node), Some(kind)) = (node.as_mut(), self.type_of(source)) else { continue };
            let mut steps = identity(kind, source);
            steps.extend(self.cycle(kind, period));
            self.communication(kind, &mut steps);
            if node.role == Role::Drive {
                self.drive(kind, node, &mut steps);
            }
            for set in &kind.sets {
                let clash = steps.iter().any(
                    |step| matches!(step, SdoStep::Write { object, .. } if *object == set.object),
                );
                self.complaints.demand(!clash, &set.spot, || {
                    "this object is written from other keys of the description".to_owned()
                });
                steps.push(write(set.object, set.kind, set.value as u32));
            }
            self.pdo_set_up(kind, node, &mut steps);
            node.setup = steps;
        }
    }

    /// SYNC, its period, and that both objects of the period agree.
    fn cycle(&self, kind: &TypeSource, period: f64) -> Vec<SdoStep> {
        let period_us = super::timing::micros(period);
        let mut steps = vec![
            write(Object::SYNC_COB_ID, DataType::U32, id::SYNC.into()),
            write(Object::CYCLE_PERIOD, DataType::U32, period_us),
        ];
        if kind.role.value != Role::Drive {
            return steps;
        }
        if let Some(said) = &kind.interpolation {
            let own = super::timing::micros(said.value);
            self.complaints.demand(own == period_us, &said.spot, || {
                format!("0x60C2 says {own} us, 0x1006 says {period_us} us: they must agree")
            });
        }
        let Some((value, exponent)) = interpolation(period_us) else {
            let spot = &self.source.timing.period.spot;
            self.complaints.add(
                spot,
                format!("{period_us} us cannot be said in 0x60C2: 1 to 255 times a power of ten"),
            );
            return steps;
        };
        let exponent = u32::from(exponent as u8);
        steps.extend([
            write(Object::INTERPOLATION_VALUE, DataType::U8, value.into()),
            write(Object::INTERPOLATION_EXPONENT, DataType::I8, exponent),
            expect(Object::CYCLE_PERIOD, DataType::U32, period_us),
            expect(Object::INTERPOLATION_VALUE, DataType::U8, value.into()),
            expect(Object::INTERPOLATION_EXPONENT, DataType::I8, exponent),
        ]);
        steps
    }

    /// Heartbeats both ways. A node waits for the master as long as the master waits for it.
    fn communication(&self, kind: &TypeSource, steps: &mut Vec<SdoStep>) {
        let spot = &kind.heartbeat_timeout.spot;
        let master = self.source.timing.heartbeat.value;
        self.complaints.demand(kind.heartbeat_timeout.value > master, spot, || {
            let (found, every) = (kind.heartbeat_timeout.value * 1e3, master * 1e3);
            format!("{found} ms, but the master's heartbeat comes each {every} ms")
        });
        let Some(timeout) = self.whole(&kind.heartbeat_timeout, 1e3, "ms", 1, 65_535) else {
            return;
        };
        let consumer = u32::from(self.source.operator.master.value) << 16 | timeout;
        steps.push(write(Object::CONSUMER_HEARTBEAT, DataType::U32, consumer));
        let producer = self.whole(&kind.heartbeat, 1e3, "ms", 1, 65_535).unwrap_or(0);
        steps.push(write(Object::PRODUCER_HEARTBEAT, DataType::U16, producer));
    }

    fn drive(&self, kind: &TypeSource, node: &Node, steps: &mut Vec<SdoStep>) {
        let (Some(source), Some(motor)) = (&kind.motor, &node.motor) else { return };
        let rated = (source.rated.value * 1e3).round();
        let exact = (source.rated.value * 1e3 - rated).abs() < 1e-6 && rated >= 1.0;
        self.complaints.demand(exact, &source.rated.spot, || {
            let found = super::figure(source.rated.value * 1e3);
            format!("{found} mN*m; 0x6076 holds whole mN*m from 1 up")
        });
        steps.push(expect(Object::RATED_TORQUE, DataType::U32, rated as u32));
        let limit = f64::from(motor.torque_limit) * f64::from(motor.torque_per_count);
        let per_mille = (1000.0 * limit / source.rated.value).round().min(65_535.0) as u32;
        steps.push(write(Object::MAX_TORQUE, DataType::U16, per_mille));
        if motor.sign_in_drive {
            let polarity = if motor.sign < 0 { 0xE0 } else { 0 };
            steps.push(write(Object::POLARITY, DataType::U8, polarity));
        }
        for (object, value) in source.reactions {
            steps.push(write(object, DataType::I16, u32::from(value as u16)));
        }
        steps.push(write(Object::MODE, DataType::I8, u32::from(source.mode as u8)));
    }

    /// Each PDO is switched off, mapped and switched on; those that are not used stay off.
    fn pdo_set_up(&self, kind: &TypeSource, node: &Node, steps: &mut Vec<SdoStep>) {
        let deadline = kind.deadline.as_ref();
        let deadline = deadline.and_then(|said| self.whole(said, 1e3, "ms", 1, 65_535));
        if let Some(said) = deadline.and(kind.deadline.as_ref()) {
            let period = self.source.timing.period.value;
            self.complaints.demand(said.value > period, &said.spot, || {
                let (found, period) = (said.value * 1e3, period * 1e3);
                format!("{found} ms is not above the period of {period} ms")
            });
        }
        for number in 1..=kind.pdo_counts[0] {
            let (parameters, mapping): (Place, Place) =
                (Object::receive_parameters, Object::receive_mapping);
            let unused = node.id.rpdo(number);
            let Some(pdo) = node.receive.iter().find(|pdo| pdo.number == number) else {
                let off = INVALID | u32::from(unused);
                steps.push(write(parameters(number, 1), DataType::U32, off));
                continue;
            };
            map(steps, pdo, 0, parameters, mapping);
            if let Some(deadline) = deadline.filter(|_| pdo.is_synchronous()) {
                steps.push(write(parameters(number, 5), DataType::U16, deadline));
            }
            steps.push(write(parameters(number, 1), DataType::U32, pdo.cob_id.into()));
        }
        for number in 1..=kind.pdo_counts[1] {
            let (parameters, mapping): (Place, Place) =
                (Object::transmit_parameters, Object::transmit_mapping);
            let unused = node.id.tpdo(number);
            let Some(pdo) = node.transmit.iter().find(|pdo| pdo.number == number) else {
                let off = INVALID | NO_RTR | u32::from(unused);
                steps.push(write(parameters(number, 1), DataType::U32, off));
                continue;
            };
            map(steps, pdo, NO_RTR, parameters, mapping);
            if !pdo.is_synchronous() {
                let timer = u32::from(EVENT_TIMER_MS);
                steps.push(write(parameters(number, 5), DataType::U16, timer));
            }
            let on = NO_RTR | u32::from(pdo.cob_id);
            steps.push(write(parameters(number, 1), DataType::U32, on));
        }
    }
}

/// Switches a PDO off and writes transmission type and mapping.
fn map(steps: &mut Vec<SdoStep>, pdo: &Pdo, flags: u32, parameters: Place, mapping: Place) {
    let off = INVALID | flags | u32::from(pdo.cob_id);
    steps.push(write(parameters(pdo.number, 1), DataType::U32, off));
    steps.push(write(parameters(pdo.number, 2), DataType::U8, pdo.transmission.into()));
    steps.push(write(mapping(pdo.number, 0), DataType::U8, 0));
    for (entry, sub) in pdo.entries().iter().zip(1..) {
        let value = entry.object.mapping(entry.kind);
        steps.push(write(mapping(pdo.number, sub), DataType::U32, value));
    }
    let count = pdo.entries().len() as u32;
    steps.push(write(mapping(pdo.number, 0), DataType::U8, count));
}

/// Device type, vendor, product and serial number, as far as they are known.
fn identity(kind: &TypeSource, node: &NodeSource) -> Vec<SdoStep> {
    let mut steps = Vec::new();
    if kind.role.value == Role::Drive {
        let (object, kind) = (Object::DEVICE_TYPE, DataType::U32);
        steps.push(SdoStep::Expect { object, kind, mask: 0xFFFF, value: 402 });
    }
    for (object, value) in [
        (Object::VENDOR, kind.identity.vendor),
        (Object::PRODUCT, kind.identity.product),
        (Object::SERIAL, node.serial),
    ] {
        steps.extend(value.map(|value| expect(object, DataType::U32, value)));
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::interpolation;

    #[test]
    fn interpolation_periods_are_mantissa_and_power_of_ten() {
        assert_eq!(interpolation(2000), Some((2, -3)));
        assert_eq!(interpolation(1000), Some((1, -3)));
        assert_eq!(interpolation(250), Some((25, -5)));
        assert_eq!(interpolation(1250), Some((125, -5)));
        assert_eq!(interpolation(2560), None);
        assert_eq!(interpolation(1234), None);
    }
}
