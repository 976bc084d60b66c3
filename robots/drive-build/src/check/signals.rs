//! Signals by their names: object, type, unit, scale.

use super::Check;
use crate::error::{Said, suggestion};
use crate::source::{NodeSource, ObjectSource, TypeSource, Unit};
use crate::unit::quantity;
use shapebot_drive::{DataType, Entry, Object, Role, Signal, legs};

/// Which way a signal goes, as seen from the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// In a receive PDO.
    Receive,
    /// In a transmit PDO.
    Transmit,
}

/// What a signal's numbers measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Measure {
    /// Nothing: bits and codes.
    Code,
    /// Torque at the motor's shaft.
    Torque,
    /// Encoder.
    Position,
    /// Encoder, per second.
    Velocity,
    /// SI unit of a measured quantity.
    Si(&'static str),
}

/// A signal that every model has.
struct Known {
    name: &'static str,
    signal: Signal,
    way: Way,
    role: Option<Role>,
    /// Object if the description does not say.
    object: Option<(Object, DataType)>,
    measure: Measure,
}

const fn known(
    name: &'static str,
    signal: Signal,
    way: Way,
    role: Option<Role>,
    object: Option<(Object, DataType)>,
    measure: Measure,
) -> Known {
    Known { name, signal, way, role, object, measure }
}

/// Roles are who may send or receive it.
const KNOWN: [Known; 16] = {
    use DataType::{I8, I16, I32, U8, U16};
    use Measure::{Code, Position, Si, Torque, Velocity};
    use Way::{Receive, Transmit};
    const DRIVE: Option<Role> = Some(Role::Drive);
    const LEGS: Option<Role> = Some(Role::Legs);
    [
        known(
            "controlword",
            Signal::Controlword,
            Receive,
            DRIVE,
            Some((Object::CONTROLWORD, U16)),
            Code,
        ),
        known("mode", Signal::Mode, Receive, DRIVE, Some((Object::MODE, I8)), Code),
        known("torque", Signal::Torque, Receive, DRIVE, Some((Object::TARGET_TORQUE, I16)), Torque),
        known(
            "statusword",
            Signal::Statusword,
            Transmit,
            DRIVE,
            Some((Object::STATUSWORD, U16)),
            Code,
        ),
        known(
            "mode-display",
            Signal::ModeDisplay,
            Transmit,
            DRIVE,
            Some((Object::MODE_DISPLAY, I8)),
            Code,
        ),
        known(
            "error",
            Signal::ErrorRegister,
            Transmit,
            None,
            Some((Object::ERROR_REGISTER, U8)),
            Code,
        ),
        known(
            "position",
            Signal::Position,
            Transmit,
            DRIVE,
            Some((Object::POSITION, I32)),
            Position,
        ),
        known(
            "velocity",
            Signal::Velocity,
            Transmit,
            DRIVE,
            Some((Object::VELOCITY, I32)),
            Velocity,
        ),
        known(
            "torque-actual",
            Signal::ActualTorque,
            Transmit,
            DRIVE,
            Some((Object::ACTUAL_TORQUE, I16)),
            Torque,
        ),
        known("legs", Signal::LegsCommand, Receive, LEGS, Some((legs::COMMAND, U8)), Code),
        known("legs-state", Signal::LegsState, Transmit, LEGS, Some((legs::STATE, U8)), Code),
        known("heading", Signal::Heading, Transmit, None, None, Si("rad")),
        known("heading-rate", Signal::HeadingRate, Transmit, None, None, Si("rad/s")),
        known("yaw", Signal::Yaw, Transmit, None, None, Si("rad")),
        known("sequence", Signal::Sequence, Transmit, None, None, Code),
        known("health", Signal::Health, Transmit, None, None, Code),
    ]
};

/// A signal in a PDO of a node, with its object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resolved {
    pub(crate) signal: Signal,
    pub(crate) object: Object,
    pub(crate) kind: DataType,
    measure: Measure,
}

impl Check<'_> {
    /// The entry of a name in a PDO of a node.
    pub(super) fn entry(
        &self,
        node: &NodeSource,
        kind: &TypeSource,
        name: &Said<String>,
        way: Way,
    ) -> Option<Entry> {
        let gap = match name.value.as_str() {
            "gap8" => Some(DataType::U8),
            "gap16" => Some(DataType::U16),
            "gap32" => Some(DataType::U32),
            _ => None,
        };
        if let Some(gap) = gap {
            self.complaints.demand(way == Way::Receive && kind.dummy_mapping, &name.spot, || {
                "gaps take a receive PDO and `dummy-mapping = true`".to_owned()
            });
            return Some(Entry::gap(gap));
        }
        let found = self.resolve(kind, name, way)?;
        let scale = self.scale(node, kind, found, name)?;
        Some(Entry {
            object: found.object,
            kind: found.kind,
            signal: found.signal,
            scale: scale as f32,
        })
    }

    /// Signal and object of a name.
    fn resolve(&self, kind: &TypeSource, name: &Said<String>, way: Way) -> Option<Resolved> {
        let Some((signal, measure, default)) = self.signal(kind, &name.value, way) else {
            let message = format!(
                "no such signal in this direction for this role: `{}`{}",
                name.value,
                suggestion(&name.value, self.names(kind, way))
            );
            self.complaints.add(&name.spot, message);
            return None;
        };
        let given = object_of(kind, &name.value);
        let Some((object, data)) = given.map(|given| (given.object, given.kind)).or(default) else {
            let message = format!("`{}` has no object in `objects`", name.value);
            self.complaints.add(&name.spot, message);
            return None;
        };
        Some(Resolved { signal, object, kind: data, measure })
    }

    #[expect(clippy::type_complexity, reason = "what, how measured, and the standard's object")]
    fn signal(
        &self,
        kind: &TypeSource,
        name: &str,
        way: Way,
    ) -> Option<(Signal, Measure, Option<(Object, DataType)>)> {
        let fits = |known: &&Known| {
            known.name == name
                && known.way == way
                && known.role.is_none_or(|role| role == kind.role.value)
        };
        if let Some(known) = KNOWN.iter().find(fits) {
            return Some((known.signal, known.measure, known.object));
        }
        if way == Way::Receive || !matches!(kind.role.value, Role::Imu | Role::Encoder) {
            return None;
        }
        let index = |name: &str| self.model.coordinates.iter().position(|c| c.name == name);
        if let Some(at) = index(name) {
            let unit = self.model.coordinates[at].unit;
            return Some((Signal::Coordinate(at as u8), Measure::Si(unit), None));
        }
        let at = index(name.strip_suffix("-rate")?)?;
        let unit = if self.model.coordinates[at].unit == "m" { "m/s" } else { "rad/s" };
        Some((Signal::Rate(at as u8), Measure::Si(unit), None))
    }

    /// Names that fit a role and a direction.
    fn names(&self, kind: &TypeSource, way: Way) -> Vec<&'static str> {
        let role = kind.role.value;
        let fits = |known: &&Known| known.way == way && known.role.is_none_or(|r| r == role);
        let mut names: Vec<_> = KNOWN.iter().filter(fits).map(|known| known.name).collect();
        if way == Way::Transmit && matches!(role, Role::Imu | Role::Encoder) {
            names.extend(self.model.coordinates.iter().map(|c| c.name));
        }
        names
    }

    /// Object and type of a signal in the type's PDOs, `None` if it is in none and no axis shares it.
    pub(crate) fn entry_type(
        &self,
        kind: &TypeSource,
        signal: Signal,
        name: &str,
    ) -> Option<(Object, DataType)> {
        let given = object_of(kind, name).map(|given| (given.object, given.kind));
        given.or_else(|| KNOWN.iter().find(|known| known.signal == signal)?.object)
    }

    /// What a count of a drive's signal is worth.
    pub(super) fn unit_of(&self, kind: &TypeSource, name: &str) -> Option<Unit> {
        let way = if name == "torque" { Way::Receive } else { Way::Transmit };
        let (_, measure, _) = self.signal(kind, name, way)?;
        let given = object_of(kind, name).and_then(|given| given.unit.as_ref());
        self.unit(kind, measure, given)
    }

    fn unit(
        &self,
        kind: &TypeSource,
        measure: Measure,
        given: Option<&Said<String>>,
    ) -> Option<Unit> {
        let Some(given) = given else {
            return match measure {
                Measure::Code => Some(Unit::One),
                Measure::Torque => Some(Unit::PerMille),
                Measure::Position | Measure::Velocity => Some(Unit::Counts),
                Measure::Si(unit) => {
                    let message = format!("a signal in {unit} has no `unit` in `objects`");
                    self.complaints.add(&kind.name.spot, message);
                    None
                }
            };
        };
        let read = |like| quantity(&given.value, like);
        let unit = match measure {
            Measure::Code => Err("codes have no unit".to_owned()),
            Measure::Torque if given.value == "per mille" => Ok(Unit::PerMille),
            Measure::Torque => read("N*m").map(Unit::Si).or_else(|e| match read("A") {
                Ok(step) => Ok(Unit::Ampere(step)),
                Err(_) => Err(e),
            }),
            Measure::Position => Err("positions are counts of the encoder".to_owned()),
            Measure::Velocity => read("rad/s").map(Unit::Si),
            Measure::Si(unit) => read(unit).map(Unit::Si),
        };
        match unit {
            Ok(Unit::Si(0.0) | Unit::Ampere(0.0)) => {
                self.complaints.add(&given.spot, "a count is worth nothing");
                None
            }
            Ok(unit) => Some(unit),
            Err(message) => {
                self.complaints.add(&given.spot, message);
                None
            }
        }
    }

    /// SI value of a count, with the sign that the master applies.
    fn scale(
        &self,
        node: &NodeSource,
        kind: &TypeSource,
        found: Resolved,
        name: &Said<String>,
    ) -> Option<f64> {
        let given = object_of(kind, &name.value).and_then(|given| given.unit.as_ref());
        let unit = self.unit(kind, found.measure, given)?;
        let in_drive = node.sign_in_drive.as_ref().is_some_and(|said| said.value);
        let sign = match &node.sign {
            Some(sign) if !in_drive => f64::from(sign.value),
            _ => 1.0,
        };
        let per_radian = || {
            let axis = self.axis_of(node)?;
            let unit = self.model.coordinates.iter().find(|c| c.name == axis.name.value);
            Some(sign / self.ratio_of(axis, unit.map_or("rad", |c| c.unit))?)
        };
        let motor = || kind.motor.as_ref();
        match (found.measure, unit) {
            (Measure::Code, _) => Some(1.0),
            (Measure::Torque, Unit::PerMille) => Some(sign * motor()?.rated.value / 1000.0),
            (Measure::Torque, Unit::Ampere(step)) => Some(sign * step * motor()?.constant?),
            (Measure::Torque, Unit::Si(step)) => Some(sign * step),
            (Measure::Position | Measure::Velocity, Unit::Counts) => {
                Some(per_radian()? * std::f64::consts::TAU / f64::from(motor()?.counts.value))
            }
            (Measure::Velocity, Unit::Si(step)) => Some(per_radian()? * step),
            (Measure::Si(_), Unit::Si(step)) => Some(step),
            _ => None,
        }
    }

    /// The axis that names a drive.
    pub(super) fn axis_of(&self, node: &NodeSource) -> Option<&crate::source::AxisSource> {
        let names = |axis: &&crate::source::AxisSource| {
            axis.drives.value.iter().any(|d| d.value == node.name.value)
        };
        self.source.axes.iter().find(names)
    }
}

/// What a type says about a signal's object.
fn object_of<'t>(kind: &'t TypeSource, name: &str) -> Option<&'t ObjectSource> {
    kind.objects.iter().find(|object| object.signal.value == name)
}
