//! Worst-case load of a bus (CAN 2.0A).

use std::fmt::Write as _;

/// Longest time of a data frame with an 11-bit identifier and `bytes` bytes, bits: 47 bits of frame and
/// interframe space, 8 a byte, and a stuff bit after each four of the 34 + 8n bits that are stuffed.
#[must_use]
pub const fn worst_bits(bytes: usize) -> usize {
    47 + 8 * bytes + (34 + 8 * bytes - 1) / 4
}

/// How often a frame is sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rate {
    /// Once a cycle, before the controller runs: SYNC and inputs.
    Input,
    /// Once a cycle, after the controller: commands.
    Output,
    /// Each so many seconds, at the lowest priority.
    Every(f64),
    /// On events only.
    Event,
}

/// A frame on a bus.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadFrame {
    /// What it is.
    pub name: String,
    /// Identifier.
    pub cob_id: u16,
    /// Data bytes.
    pub bytes: usize,
    /// How often.
    pub rate: Rate,
}

/// Worst-case load of a bus.
#[derive(Clone, Debug, PartialEq)]
pub struct BusLoad {
    /// Name of the bus.
    pub bus: String,
    /// Bits per second.
    pub bit_rate: u32,
    /// Seconds from SYNC to SYNC.
    pub period: f64,
    /// Seconds that the controller takes between inputs and commands.
    pub compute: f64,
    /// All frames, by identifier.
    pub frames: Vec<LoadFrame>,
}

impl BusLoad {
    /// Seconds that a frame takes at worst.
    #[must_use]
    pub fn time(&self, bytes: usize) -> f64 {
        worst_bits(bytes) as f64 / f64::from(self.bit_rate)
    }

    fn sum(&self, wanted: impl Fn(Rate) -> bool) -> f64 {
        // From −0 on, an empty sum would be printed as such.
        let frames = self.frames.iter().filter(|frame| wanted(frame.rate));
        frames.map(|frame| self.time(frame.bytes)).sum::<f64>() + 0.0
    }

    /// Share of the time that cyclic frames take.
    #[must_use]
    pub fn cyclic(&self) -> f64 {
        self.sum(|rate| matches!(rate, Rate::Input | Rate::Output)) / self.period
    }

    /// Share of the time that heartbeats and telemetry take.
    #[must_use]
    pub fn background(&self) -> f64 {
        let share = |frame: &LoadFrame| match frame.rate {
            Rate::Every(seconds) => self.time(frame.bytes) / seconds,
            _ => 0.0,
        };
        self.frames.iter().map(share).sum::<f64>() + 0.0
    }

    /// Seconds that the longest frame outside of the cycle takes: once on the bus it cannot be
    /// interrupted and delays the cycle, at worst once before the inputs and once before the commands.
    /// SDO transfers happen before operation and do not count.
    #[must_use]
    pub fn blocking(&self) -> f64 {
        let outside = |frame: &&LoadFrame| matches!(frame.rate, Rate::Every(_) | Rate::Event);
        let longest = self.frames.iter().filter(outside).map(|frame| frame.bytes).max();
        longest.map_or(0.0, |bytes| self.time(bytes))
    }

    /// Seconds from the instant at which SYNC is due until the last input is there.
    #[must_use]
    pub fn inputs(&self) -> f64 {
        self.blocking() + self.sum(|rate| rate == Rate::Input)
    }

    /// Seconds that commands take after the controller.
    #[must_use]
    pub fn outputs(&self) -> f64 {
        self.blocking() + self.sum(|rate| rate == Rate::Output)
    }

    /// Seconds from the instant at which SYNC is due until the last frame of the cycle is through.
    #[must_use]
    pub fn last_frame(&self) -> f64 {
        self.inputs() + self.compute + self.outputs()
    }

    /// The figures as text.
    #[must_use]
    pub fn report(&self) -> String {
        let mut text = String::new();
        let micros = |seconds: f64| format!("{:.0} us", seconds * 1e6);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "bus {}: {} bit/s, {} from SYNC to SYNC, worst-case bit stuffing",
            self.bus,
            self.bit_rate,
            micros(self.period)
        );
        for frame in &self.frames {
            let rate = match frame.rate {
                Rate::Input | Rate::Output => "each cycle".to_owned(),
                Rate::Every(seconds) => format!("each {:.0} ms", seconds * 1e3),
                Rate::Event => "on events".to_owned(),
            };
            let time = micros(self.time(frame.bytes));
            let LoadFrame { name, cob_id, bytes, .. } = frame;
            let _ = writeln!(text, "  0x{cob_id:03X}  {bytes} bytes  {time:>7}  {rate:<12} {name}");
        }
        let percent = |share: f64| format!("{:.1} %", share * 100.0);
        let _ = writeln!(
            text,
            "  load: {} cyclic, {} heartbeats and telemetry\n  SYNC to last frame: {} = {} inputs + {} \
             controller + {} commands, of {} (each with {} of blocking)",
            percent(self.cyclic()),
            percent(self.background()),
            micros(self.last_frame()),
            micros(self.inputs()),
            micros(self.compute),
            micros(self.outputs()),
            micros(self.period),
            micros(self.blocking()),
        );
        text
    }
}
