//! Checks a description against a model and works out all numbers.

mod axes;
mod ids;
mod nodes;
mod sensors;
mod setup;
mod shared;
mod signals;
mod timing;

use crate::description::{Bus, DriveDescription, Resolution, Safety};
use crate::error::{Complaints, Errors, Said, suggestion};
use crate::simulation;
use crate::source::Source;
use shapebot_drive::{
    MAX_AXES, MAX_BUSES, MAX_COORDINATES, MAX_NODES, NodeId, OperatorTable, SafetyTable,
};
use shapebot_dynamics::Description;

/// What the checks share.
pub(crate) struct Check<'a> {
    pub(crate) source: &'a Source,
    pub(crate) model: &'a Description,
    pub(crate) complaints: &'a Complaints,
}

impl Source {
    /// Checks the description against a model.
    ///
    /// # Errors
    ///
    /// All that is wrong, with line, key and figure.
    pub fn check(&self, model: &Description) -> Result<DriveDescription, Errors> {
        let complaints = Complaints::new(&self.file);
        let check = Check { source: self, model, complaints: &complaints };
        let description = check.run();
        match description {
            Some(description) if complaints.is_empty() => Ok(description),
            _ => Err(complaints.into_errors()),
        }
    }
}

/// Reads and checks a description.
///
/// # Errors
///
/// All that is wrong, with line, key and figure.
pub fn read(file: &str, text: &str, model: &Description) -> Result<DriveDescription, Errors> {
    Source::parse(file, text)?.check(model)
}

impl<'a> Check<'a> {
    fn run(&self) -> Option<DriveDescription> {
        self.sizes();
        let source = self.source;
        let timing = self.timing();
        let buses: Vec<Bus> = source.buses.iter().filter_map(|bus| self.bus(bus)).collect();
        let mut resolutions = Vec::new();
        let axes = self.axes(&mut resolutions);
        let mut nodes = self.nodes(&axes, timing.as_ref(), &mut resolutions);
        let commands = self.commands(&mut nodes, &axes);
        self.sensors(&nodes);
        let yaw = self.yaw(&axes, &nodes);
        let operator = self.operator()?;
        self.unique(&nodes, &commands);
        let loads = self.loads(&buses, &nodes, &commands);
        let mut timing = timing?;
        timing.input_window_us = timing::input_window(&loads);
        self.presence(&nodes);
        if !self.complaints.is_empty() {
            return None;
        }
        let nodes: Option<Vec<_>> = nodes.into_iter().collect();
        let simulated = simulation::simulated(self, nodes.as_deref()?, &axes);
        let coordinates =
            self.model.coordinates.iter().map(|c| (c.name.to_owned(), c.unit.to_owned()));
        let mut description = DriveDescription {
            name: source.name.clone(),
            title: source.title.clone(),
            robot: source.robot.value.clone(),
            coordinates: coordinates.collect(),
            fingerprint: 0,
            timing,
            buses,
            nodes: nodes?,
            axes: axes.into_iter().collect::<Option<_>>()?,
            commands,
            yaw,
            safety: self.safety(),
            operator,
            loads,
            resolutions,
            simulated,
        };
        let tables = description.tables();
        let text = format!("{:?}", tables.table());
        description.fingerprint = shapebot_drive::crc::crc32(text.as_bytes());
        Some(description)
    }

    fn sizes(&self) {
        let source = self.source;
        for (what, count, limit) in [
            ("nodes", source.nodes.len(), MAX_NODES),
            ("axes", source.axes.len(), MAX_AXES),
            ("buses", source.buses.len(), MAX_BUSES),
            ("coordinates", self.model.coordinates.len(), MAX_COORDINATES),
        ] {
            self.complaints.demand((1..=limit).contains(&count), &source.robot.spot, || {
                format!("{count} {what}; there may be 1 to {limit}")
            });
        }
        let (named, model) = (&source.robot, self.model.name);
        self.complaints.demand(named.value == model, &named.spot, || {
            format!("the description is for `{}`, the model is `{model}`", named.value)
        });
    }

    fn bus(&self, bus: &crate::source::BusSource) -> Option<Bus> {
        let rates = [125e3, 250e3, 500e3, 800e3, 1e6];
        if !rates.contains(&bus.rate.value) {
            let message = format!(
                "{} bit/s; CiA 301 has 125, 250, 500, 800 kbit/s and 1 Mbit/s",
                bus.rate.value
            );
            self.complaints.add(&bus.rate.spot, message);
            return None;
        }
        let (name, bit_rate) = (bus.name.value.clone(), bus.rate.value as u32);
        Some(Bus { name, bit_rate, load_limit: bus.load_limit })
    }

    /// Index of the bus of that name.
    fn bus_index(&self, name: &Said<String>) -> Option<u8> {
        let buses = self.source.buses.iter().map(|bus| bus.name.value.as_str());
        self.index_of("bus", name, buses)
    }

    /// Index of a name in a list of names, or a complaint.
    fn index_of<'n>(
        &self,
        what: &str,
        name: &Said<String>,
        known: impl Iterator<Item = &'n str> + Clone,
    ) -> Option<u8> {
        let found = known.clone().position(|other| other == name.value);
        if found.is_none() {
            let suggestion = suggestion(&name.value, known);
            let message = format!("there is no {what} `{}`{suggestion}", name.value);
            self.complaints.add(&name.spot, message);
        }
        found.and_then(|index| u8::try_from(index).ok())
    }

    fn operator(&self) -> Option<OperatorTable> {
        let operator = &self.source.operator;
        Some(OperatorTable {
            bus: self.bus_index(&operator.bus)?,
            command: operator.command.value,
            telemetry: operator.telemetry.value,
            master: NodeId::new(operator.master.value)?,
        })
    }

    fn safety(&self) -> Safety {
        let safety = &self.source.safety;
        let limits = SafetyTable {
            lean: &[],
            lean_start: safety.lean_start.value as f32,
            lean_limit: safety.lean_limit.value as f32,
            lean_rate_start: safety.lean_rate_start as f32,
            stale_fault: safety.stale_fault,
            silent_fault: safety.silent_fault,
            rise_timeout_us: timing::micros(safety.rise_timeout),
            lower_timeout_us: timing::micros(safety.lower_timeout),
            fault_deadline_us: timing::micros(safety.fault_deadline),
        };
        let lean = self.lean().map(|(index, _)| index as u8).collect();
        Safety { lean, limits }
    }

    /// A resolution, and a complaint if it is coarser than wanted.
    fn resolution(
        &self,
        list: &mut Vec<Resolution>,
        what: String,
        [step, range]: [f64; 2],
        unit: &str,
        wanted: Option<&Said<f64>>,
    ) {
        if let Some(wanted) = wanted {
            self.complaints.demand(step <= wanted.value, &wanted.spot, || {
                let found = figure(step);
                format!(
                    "{what}: one count is {found} {unit}, at most {} {unit} are wanted",
                    figure(wanted.value)
                )
            });
        }
        let wanted = wanted.map(|wanted| wanted.value);
        list.push(Resolution { what, step, unit: unit.to_owned(), range, wanted });
    }
}

/// Four significant digits.
pub(crate) fn figure(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-2..1e5).contains(&size) {
        return format!("{value:.3e}");
    }
    let digits = if size >= 1000.0 {
        0
    } else if size >= 100.0 {
        1
    } else {
        3
    };
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
