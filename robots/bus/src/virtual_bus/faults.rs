//! Faults that a bus in virtual time makes on purpose.

use std::ops::RangeInclusive;

use super::EndpointId;
use crate::{Frame, Random};

/// Which frames a [`Rule`] is about; by default all of them.
#[derive(Clone, Debug)]
pub struct Select {
    /// Identifiers.
    pub ids: RangeInclusive<u32>,
    /// The sender, if only its frames are meant.
    pub from: Option<EndpointId>,
    /// The receiver, if only what it gets is meant; for effects at the receiver's side.
    pub to: Option<EndpointId>,
    /// Start of the time in which the rule holds, µs.
    pub after: u64,
    /// End of that time, µs, itself not included.
    pub until: u64,
    /// Frames that match but are let go before the first fault.
    pub skip: u32,
    /// Most faults to be made.
    pub limit: u32,
    /// Probability of a fault for a frame that matches, 0 to 1.
    pub probability: f64,
}

impl Default for Select {
    fn default() -> Self {
        Self {
            ids: 0..=u32::MAX,
            from: None,
            to: None,
            after: 0,
            until: u64::MAX,
            skip: 0,
            limit: u32::MAX,
            probability: 1.0,
        }
    }
}

impl Select {
    /// All frames with one identifier.
    #[must_use]
    pub fn id(id: u16) -> Self {
        Self { ids: u32::from(id)..=u32::from(id), ..Self::default() }
    }
}

/// What happens to a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The receiver does not get it, as when its controller overruns.
    Drop,
    /// The receiver gets it so many microseconds late.
    Delay(u64),
    /// It is sent once more, as after an error in the last bit of a frame that all had accepted.
    Duplicate,
    /// The receiver gets it after the next frame that comes its way.
    Reorder,
    /// A bit error on the wire: an error frame, error counters, and the sender tries again.
    Corrupt,
    /// Bytes of the data are combined with this mask by exclusive or, unnoticed by the CRC.
    Alter([u8; 8]),
    /// The sender is late by a random time up to so many microseconds.
    Jitter(u64),
}

/// A fault to be made: what happens to which frames.
#[derive(Clone, Debug)]
pub struct Rule {
    /// The frames.
    pub select: Select,
    /// What happens to them.
    pub effect: Effect,
}

/// Where a frame is when a rule is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// Handed to the sender's controller.
    Queue,
    /// On the wire.
    Wire,
    /// At a receiver.
    Receiver(EndpointId),
}

impl Effect {
    fn is_at(&self, stage: Stage) -> bool {
        match self {
            Self::Jitter(_) => stage == Stage::Queue,
            Self::Corrupt | Self::Duplicate => stage == Stage::Wire,
            Self::Drop | Self::Delay(_) | Self::Reorder | Self::Alter(_) => {
                matches!(stage, Stage::Receiver(_))
            }
        }
    }
}

#[derive(Clone, Debug)]
struct Counted {
    rule: Rule,
    seen: u32,
    made: u32,
}

/// The rules of a bus and how often each was applied.
#[derive(Clone, Debug)]
pub(super) struct Faults {
    rules: Vec<Counted>,
    pub(super) random: Random,
}

impl Faults {
    pub(super) const fn new(seed: u64) -> Self {
        Self { rules: Vec::new(), random: Random::new(seed) }
    }

    pub(super) fn add(&mut self, rule: Rule) {
        self.rules.push(Counted { rule, seen: 0, made: 0 });
    }

    pub(super) fn clear(&mut self) {
        self.rules.clear();
    }

    pub(super) fn made(&self) -> u64 {
        self.rules.iter().map(|counted| u64::from(counted.made)).sum()
    }

    /// Effects on a frame at a stage, in the order of the rules.
    pub(super) fn effects(
        &mut self,
        stage: Stage,
        frame: &Frame,
        from: EndpointId,
        now: u64,
    ) -> Vec<Effect> {
        let mut effects = Vec::new();
        for counted in &mut self.rules {
            if counted.rule.effect.is_at(stage)
                && counted.matches(stage, frame, from, now)
                && counted.strikes(&mut self.random)
            {
                effects.push(counted.rule.effect.clone());
            }
        }
        effects
    }
}

impl Counted {
    fn matches(&self, stage: Stage, frame: &Frame, from: EndpointId, now: u64) -> bool {
        let select = &self.rule.select;
        let to = match stage {
            Stage::Receiver(to) => select.to.is_none_or(|only| only == to),
            Stage::Queue | Stage::Wire => true,
        };
        to && select.ids.contains(&frame.raw_id())
            && select.from.is_none_or(|only| only == from)
            && (select.after..select.until).contains(&now)
    }

    fn strikes(&mut self, random: &mut Random) -> bool {
        self.seen = self.seen.saturating_add(1);
        if self.seen <= self.rule.select.skip || self.made >= self.rule.select.limit {
            return false;
        }
        let probability = self.rule.select.probability;
        let strikes = probability >= 1.0 || random.unit() < probability;
        self.made += u32::from(strikes);
        strikes
    }
}
