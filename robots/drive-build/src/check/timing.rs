//! Periods, and the load of the buses.

use super::Check;
use crate::description::{Bus, Command, Node};
use crate::error::Said;
use crate::load::{BusLoad, LoadFrame, Rate};
use shapebot_drive::{Pdo, Timing, id};

/// Whole microseconds.
pub(super) fn micros(seconds: f64) -> u32 {
    // Casts saturate.
    (seconds * 1e6).round() as u32
}

/// From SYNC to the last instant at which the controller may start.
pub(super) fn input_window(loads: &[BusLoad]) -> u32 {
    let window = |load: &BusLoad| micros(load.period - load.compute - load.outputs());
    loads.iter().map(window).min().unwrap_or(0)
}

/// Bytes of a frame of the operator protocol.
const OPERATOR_BYTES: usize = 8;

impl Check<'_> {
    pub(super) fn timing(&self) -> Option<Timing> {
        let timing = &self.source.timing;
        let period_us = self.whole(&timing.period, 1e6, "us", 100, 1_000_000)?;
        let heartbeat_ms = self.whole(&timing.heartbeat, 1e3, "ms", 1, 65_535)?;
        let warn = timing.missed_warning <= timing.missed_fault;
        self.complaints.demand(warn, &timing.period.spot, || {
            let (warning, fault) = (timing.missed_warning, timing.missed_fault);
            format!("warning after {warning} missed cycles, fault after {fault} already")
        });
        Some(Timing {
            period_us,
            input_window_us: 0,
            jitter_limit_us: timing.jitter.as_ref().map_or(period_us, |j| micros(j.value)),
            heartbeat_us: 1000 * heartbeat_ms,
            boot_timeout_us: micros(timing.boot_timeout),
            sdo_timeout_us: micros(timing.sdo_timeout),
            sdo_retries: timing.sdo_retries,
            enable_timeout_us: micros(timing.enable_timeout),
            missed_warning: timing.missed_warning,
            missed_fault: timing.missed_fault,
        })
    }

    /// A whole number of `unit` (1 s / `factor`) within bounds.
    pub(super) fn whole(
        &self,
        time: &Said<f64>,
        factor: f64,
        unit: &str,
        low: u32,
        high: u32,
    ) -> Option<u32> {
        let exact = time.value * factor;
        let whole = exact.round();
        let fits =
            (exact - whole).abs() < 1e-6 && (f64::from(low)..=f64::from(high)).contains(&whole);
        if fits {
            return Some(whole as u32);
        }
        let found = super::figure(exact);
        let message =
            format!("{found} {unit}; expected a whole number from {low} to {high} {unit}");
        self.complaints.add(&time.spot, message);
        None
    }

    pub(super) fn loads(
        &self,
        buses: &[Bus],
        nodes: &[Option<Node>],
        commands: &[Command],
    ) -> Vec<BusLoad> {
        let loads = buses.iter().enumerate().map(|(index, bus)| {
            let frames = self.frames(index, nodes, commands);
            self.load(bus, index, frames)
        });
        loads.collect()
    }

    fn load(&self, bus: &Bus, index: usize, frames: Vec<LoadFrame>) -> BusLoad {
        let timing = &self.source.timing;
        let load = BusLoad {
            bus: bus.name.clone(),
            bit_rate: bus.bit_rate,
            period: timing.period.value,
            compute: timing.compute.value,
            frames,
        };
        let spot = &self.source.buses[index].rate.spot;
        let share = load.cyclic() + load.background();
        self.complaints.demand(share <= bus.load_limit, spot, || {
            let (share, limit) = (share * 100.0, bus.load_limit * 100.0);
            format!("worst-case load {share:.1} %, at most {limit:.1} % are accepted")
        });
        self.complaints.demand(load.last_frame() <= load.period, spot, || {
            format!(
                "the last frame of a cycle is through {} us after SYNC, the period is {} us",
                micros(load.last_frame()),
                micros(load.period)
            )
        });
        load
    }

    fn frames(&self, bus: usize, nodes: &[Option<Node>], commands: &[Command]) -> Vec<LoadFrame> {
        let frame = |name: &str, cob_id, bytes, rate| LoadFrame {
            name: name.to_owned(),
            cob_id,
            bytes,
            rate,
        };
        let mut frames = vec![frame("SYNC", id::SYNC, 0, Rate::Input)];
        for node in nodes.iter().flatten().filter(|node| usize::from(node.bus) == bus) {
            for pdo in &node.transmit {
                let name = format!("TPDO {} of {}", pdo.number, node.name);
                frames.push(frame(&name, pdo.cob_id, pdo.bytes(), input_rate(pdo)));
            }
            let every = Rate::Every(f64::from(node.heartbeat_ms) * 1e-3);
            let name = format!("heartbeat of {}", node.name);
            frames.push(frame(&name, node.id.heartbeat(), 1, every));
        }
        for command in commands.iter().filter(|command| usize::from(command.bus) == bus) {
            let repeat = REPEAT_CYCLES * self.source.timing.period.value;
            let rate = if command.cyclic { Rate::Output } else { Rate::Every(repeat) };
            frames.push(frame(&command.name, command.cob_id, command.bytes(), rate));
        }
        let master = u16::from(self.source.operator.master.value);
        let every = Rate::Every(self.source.timing.heartbeat.value);
        frames.push(frame("heartbeat of the master", 0x700 + master, 1, every));
        let operator = &self.source.operator;
        if self.bus_index(&operator.bus).is_some_and(|index| usize::from(index) == bus) {
            let (command, telemetry) = (operator.command.value, operator.telemetry.value);
            frames.push(frame("operator command", command, OPERATOR_BYTES, Rate::Event));
            let every = Rate::Every(TELEMETRY_CYCLES * self.source.timing.period.value);
            frames.push(frame("telemetry", telemetry, OPERATOR_BYTES, every));
        }
        frames.sort_by_key(|frame| frame.cob_id);
        frames
    }
}

/// Cycles from one telemetry frame to the next.
const TELEMETRY_CYCLES: f64 = shapebot_drive::TELEMETRY_CYCLES as f64;

/// Cycles from one to the next of frames that are sent when their content changes.
const REPEAT_CYCLES: f64 = shapebot_drive::REPEAT_CYCLES as f64;

fn input_rate(pdo: &Pdo) -> Rate {
    if pdo.is_synchronous() {
        Rate::Input
    } else {
        Rate::Every(f64::from(super::setup::EVENT_TIMER_MS) * 1e-3)
    }
}
