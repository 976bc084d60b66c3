//! Axes: each actuated coordinate once, and forces that the motors can give.

use super::{Check, figure};
use crate::description::{Axis, Node, Resolution};
use crate::error::{Said, suggestion};
use crate::source::{AxisSource, Motor, NodeSource, Ratio, TypeSource, Unit};
use shapebot_drive::{MAX_PAIR, Signal, YawTable};
use shapebot_dynamics::{Coordinate, Role};

impl<'a> Check<'a> {
    /// Index and coordinate of each unactuated shape coordinate: lean.
    pub(super) fn lean(&self) -> impl Iterator<Item = (usize, &'a Coordinate)> + 'a {
        let all = self.model.coordinates.iter().enumerate();
        all.filter(|(_, c)| c.role == Role::Shape && !c.actuated)
    }

    /// The axes, the actuated coordinates' first, in the order of q.
    pub(super) fn axes(&self, resolutions: &mut Vec<Resolution>) -> Vec<Option<Axis>> {
        let source = self.source;
        for coordinate in self.model.coordinates.iter().filter(|c| c.actuated) {
            let driven = source.axes.iter().any(|axis| axis.name.value == coordinate.name);
            self.complaints.demand(driven, &source.robot.spot, || {
                format!("coordinate `{}` is actuated, but no axis drives it", coordinate.name)
            });
        }
        self.drives_have_one_axis();
        let order = self.axis_order();
        order.into_iter().map(|index| self.axis(&source.axes[index], resolutions)).collect()
    }

    /// Indices of the source's axes in the order of the table.
    pub(super) fn axis_order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.source.axes.len()).collect();
        let place = |index: &usize| {
            let name = &self.source.axes[*index].name.value;
            self.model.coordinates.iter().position(|c| c.name == name).unwrap_or(usize::MAX)
        };
        order.sort_by_key(place);
        order
    }

    fn drives_have_one_axis(&self) {
        for node in &self.source.nodes {
            let Some(kind) = self.type_of(node) else { continue };
            let named =
                |axis: &AxisSource| axis.drives.value.iter().any(|d| d.value == node.name.value);
            let count = self.source.axes.iter().filter(|axis| named(axis)).count();
            let expected = usize::from(kind.motor.is_some());
            self.complaints.demand(count == expected, &node.name.spot, || match expected {
                0 => "is no drive, but an axis names it".to_owned(),
                _ => format!("{count} axes name this drive, expected 1"),
            });
        }
    }

    /// Whether the axis is that of yaw.
    fn is_yaw(&self, axis: &AxisSource) -> bool {
        let yaw = self.source.yaw.as_ref().and_then(|yaw| yaw.axis.as_ref());
        yaw.is_some_and(|yaw| yaw.value == axis.name.value)
    }

    fn axis(&self, axis: &AxisSource, resolutions: &mut Vec<Resolution>) -> Option<Axis> {
        let name = &axis.name;
        let drives = self.axis_drives(axis);
        let (coordinate, unit) = if self.is_yaw(axis) {
            (None, "rad")
        } else {
            let index = self.driven_coordinate(name)?;
            (Some(index), self.model.coordinates[index].unit)
        };
        let ratio = self.ratio_of(axis, unit)?;
        let force = match coordinate {
            Some(coordinate) => Some(self.actuator(axis, coordinate)?),
            None => None,
        };
        let drives = drives?;
        let count = drives.len() as f64;
        let mut per_force = None;
        for node in &drives {
            let source = &self.source.nodes[usize::from(*node)];
            let Some((kind, motor)) = self.motor_of(source) else { continue };
            let each = self.torque_per_count(kind, motor)?;
            let found = 1.0 / (count * ratio * each);
            let same = per_force.is_none_or(|other| other == found);
            self.complaints.demand(same, &source.name.spot, || {
                format!(
                    "drives of `{}` do not share a torque unit: one number goes to all",
                    name.value
                )
            });
            per_force = Some(found);
            self.motor_suffices(axis, kind, motor, axis.force.value / (count * ratio), each);
        }
        let per_force = per_force?;
        let (force_unit, first) = (force_unit(axis), &self.source.nodes[usize::from(drives[0])]);
        let (kind, motor) = self.motor_of(first)?;
        let torque = self.entry_type(kind, Signal::Torque, "torque")?;
        let range = torque.1.range().1 as f64 / per_force;
        let what = format!("torque of {}", name.value);
        self.resolution(
            resolutions,
            what,
            [1.0 / per_force, range],
            force_unit,
            axis.force_step.as_ref(),
        );
        self.encoder(axis, kind, motor, ratio, coordinate, resolutions);
        Some(Axis {
            name: name.value.clone(),
            unit: unit.to_owned(),
            coordinate: coordinate.map(|index| index as u8),
            force,
            drives,
            balances: self.balances(coordinate),
            counts_per_force: per_force,
            limit: axis.force.value,
            slew: axis.slew,
            pair_tolerance: axis.pair_tolerance.as_ref().map_or(f64::INFINITY, |said| said.value),
        })
    }

    /// Whether the robot falls without this coordinate's drive: actuated position coordinates balance
    /// what leans; without any, all drives count.
    fn balances(&self, coordinate: Option<usize>) -> bool {
        let Some(coordinate) = coordinate else { return false };
        let all = self.model.coordinates;
        let position = |c: &Coordinate| c.role == Role::Position && c.actuated;
        position(&all[coordinate]) || !all.iter().any(position)
    }

    /// Indices of the axis' drives.
    fn axis_drives(&self, axis: &AxisSource) -> Option<Vec<u8>> {
        let names = self.source.nodes.iter().map(|node| node.name.value.as_str());
        let drives: Vec<_> =
            axis.drives.value.iter().map(|d| self.index_of("node", d, names.clone())).collect();
        let drives: Vec<u8> = drives.into_iter().collect::<Option<_>>()?;
        let count = drives.len();
        if !(1..=MAX_PAIR).contains(&count) {
            let message = format!("{count} drives; there may be 1 to {MAX_PAIR}");
            self.complaints.add(&axis.drives.spot, message);
            return None;
        }
        if count > 1 {
            self.complaints.demand(axis.pair_tolerance.is_some(), &axis.name.spot, || {
                format!("{count} drives share this axis: `pair-tolerance` is missing")
            });
        }
        Some(drives)
    }

    fn driven_coordinate(&self, name: &Said<String>) -> Option<usize> {
        let all = self.model.coordinates;
        let Some(index) = all.iter().position(|c| c.name == name.value) else {
            let known = all.iter().filter(|c| c.actuated).map(|c| c.name);
            let message = format!(
                "is neither a coordinate of `{}` nor the yaw axis{}",
                self.model.name,
                suggestion(&name.value, known)
            );
            self.complaints.add(&name.spot, message);
            return None;
        };
        let message = || "this coordinate has no actuator in the model".to_owned();
        self.complaints.demand(all[index].actuated, &name.spot, message);
        all[index].actuated.then_some(index)
    }

    /// Radians of the motor per unit of the coordinate.
    pub(super) fn ratio_of(&self, axis: &AxisSource, unit: &str) -> Option<f64> {
        let torque = unit == "rad";
        self.complaints.demand(torque == axis.is_torque, &axis.force.spot, || {
            let wanted = if torque { "torque" } else { "force" };
            format!("the coordinate is in {unit}: expected a `{wanted}`")
        });
        match (&axis.ratio.value, torque) {
            (Ratio::Angle(ratio), true) | (Ratio::Length(ratio), false) => Some(*ratio),
            (Ratio::Angle(_), false) => {
                let message = "the coordinate is in m: expected { wheel, gear }";
                self.complaints.add(&axis.ratio.spot, message);
                None
            }
            (Ratio::Length(_), true) => {
                let message =
                    "the coordinate is in rad: expected a number or { ball, roller, gear }";
                self.complaints.add(&axis.ratio.spot, message);
                None
            }
        }
    }

    /// Index of the axis' force among the model's actuators.
    fn actuator(&self, axis: &AxisSource, coordinate: usize) -> Option<u8> {
        let actuators = self.model.actuators;
        let actuated = self.model.coordinates.iter().enumerate().filter(|(_, c)| c.actuated);
        let index = match &axis.actuator {
            Some(named) => self.index_of("actuator", named, actuators.iter().map(|a| a.name))?,
            None if actuated.clone().count() == actuators.len() => {
                actuated.map(|(index, _)| index).position(|index| index == coordinate)? as u8
            }
            None => {
                let message = format!(
                    "the model has {} actuators for {} coordinates: `actuator` is missing",
                    actuators.len(),
                    actuated.count()
                );
                self.complaints.add(&axis.name.spot, message);
                return None;
            }
        };
        let actuator = actuators.get(usize::from(index))?;
        self.complaints.demand(axis.force.value <= actuator.limit, &axis.force.spot, || {
            let (found, limit) = (figure(axis.force.value), figure(actuator.limit));
            format!(
                "{found} {0}; the model's `{1}` ends at {limit} {0}",
                actuator.unit, actuator.name
            )
        });
        Some(index)
    }

    /// N·m at the motor for one count of the torque object.
    pub(crate) fn torque_per_count(&self, kind: &TypeSource, motor: &Motor) -> Option<f64> {
        match self.unit_of(kind, "torque")? {
            Unit::PerMille => Some(motor.rated.value / 1000.0),
            Unit::Si(step) => Some(step),
            Unit::Ampere(step) => {
                if motor.constant.is_none() {
                    let message = "torque in amperes: `torque-constant` is missing";
                    self.complaints.add(&kind.name.spot, message);
                }
                Some(step * motor.constant?)
            }
            Unit::Counts | Unit::One => None,
        }
    }

    /// Torque in the range of motor and object.
    fn motor_suffices(
        &self,
        axis: &AxisSource,
        kind: &TypeSource,
        motor: &Motor,
        needed: f64,
        per_count: f64,
    ) {
        let spot = &axis.force.spot;
        self.complaints.demand(needed <= motor.peak.value * (1.0 + 1e-9), spot, || {
            format!(
                "{} {} take {} N*m of each motor, its peak is {} N*m",
                figure(axis.force.value),
                force_unit(axis),
                figure(needed),
                figure(motor.peak.value)
            )
        });
        let Some((_, data)) = self.entry_type(kind, Signal::Torque, "torque") else { return };
        let (counts, largest) = (needed / per_count, data.range().1 as f64);
        self.complaints.demand(data.is_signed() && counts <= largest, spot, || {
            let sign = if data.is_signed() { "signed" } else { "unsigned" };
            format!(
                "{} counts of the torque object, {sign}, which ends at {largest}",
                figure(counts)
            )
        });
        let per_mille = 1000.0 * motor.peak.value / motor.rated.value;
        self.complaints.demand(per_mille <= 65_535.0, &motor.peak.spot, || {
            let found = figure(per_mille);
            format!("{found} per mille of the rated torque, 0x6072 ends at 65535")
        });
    }

    /// Steps and range of a motor's encoder.
    fn encoder(
        &self,
        axis: &AxisSource,
        kind: &TypeSource,
        motor: &Motor,
        ratio: f64,
        coordinate: Option<usize>,
        resolutions: &mut Vec<Resolution>,
    ) {
        let (Some(coordinate), Some((_, data))) =
            (coordinate, self.entry_type(kind, Signal::Position, "position"))
        else {
            return;
        };
        let coordinate = &self.model.coordinates[coordinate];
        let step = std::f64::consts::TAU / (f64::from(motor.counts.value) * ratio);
        let range = step * data.range().1 as f64;
        let bounds = coordinate.lower.abs().max(coordinate.upper.abs());
        self.complaints.demand(bounds.is_infinite() || bounds <= range, &motor.counts.spot, || {
            format!(
                "the position object holds {} {}, `{}` goes to {}",
                figure(range),
                coordinate.unit,
                coordinate.name,
                figure(bounds)
            )
        });
        let what = format!("position of {}", axis.name.value);
        let wanted = axis.position_step.as_ref();
        self.resolution(resolutions, what, [step, range], coordinate.unit, wanted);
    }

    pub(crate) fn type_of(&self, node: &NodeSource) -> Option<&'a TypeSource> {
        self.source.types.iter().find(|kind| kind.name.value == node.kind.value)
    }

    /// Type and motor of a drive.
    pub(super) fn motor_of(&self, node: &NodeSource) -> Option<(&'a TypeSource, &'a Motor)> {
        let kind = self.type_of(node)?;
        Some((kind, kind.motor.as_ref()?))
    }

    /// The yaw axis and its plane.
    pub(super) fn yaw(&self, axes: &[Option<Axis>], nodes: &[Option<Node>]) -> Option<YawTable> {
        let yaw = self.source.yaw.as_ref()?;
        let known = axes.iter().map(|axis| axis.as_ref().map_or("", |axis| axis.name.as_str()));
        let index = |name| self.index_of("axis", name, known.clone());
        let plane: Vec<u8> = yaw.plane.value.iter().filter_map(index).collect();
        let message = || "expected two axes: those along x and y of the drive unit".to_owned();
        self.complaints.demand(yaw.plane.value.len() == 2, &yaw.plane.spot, message);
        let sent = |wanted: Signal| {
            let entries = nodes.iter().flatten().flat_map(|node| &node.transmit);
            entries.flat_map(|pdo| pdo.entries()).filter(|entry| entry.signal == wanted).count()
        };
        let encoders = sent(Signal::Yaw);
        self.complaints.demand(encoders == 1, &yaw.spot, || {
            format!("{encoders} nodes send `yaw`, expected 1")
        });
        if let Some(axis) = &yaw.axis {
            let measured = sent(Signal::Heading) == 1 && sent(Signal::HeadingRate) == 1;
            self.complaints.demand(measured, &axis.spot, || {
                "holding the heading takes one `heading` and one `heading-rate`".to_owned()
            });
        }
        let axis = match &yaw.axis {
            Some(axis) => Some(index(axis)?),
            None => None,
        };
        let plane = <[u8; 2]>::try_from(plane).ok()?;
        Some(YawTable {
            axis,
            plane,
            stiffness: yaw.stiffness as f32,
            damping: yaw.damping as f32,
            rate_limit: yaw.rate_limit as f32,
        })
    }
}

fn force_unit(axis: &AxisSource) -> &'static str {
    if axis.is_torque { "N*m" } else { "N" }
}
