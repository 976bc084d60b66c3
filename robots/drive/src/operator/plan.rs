//! Plans that are uploaded while another one is in use.

use crate::crc::crc32;
use crate::operator::command::CHUNK;
use crate::safety::State;

/// Why a plan, or a part of it, is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanError {
    /// It is longer than the buffer, or shorter than a plan can be.
    Length,
    /// A part is missing or came twice.
    Order,
    /// No upload was begun, or it is not complete.
    Incomplete,
    /// One of its two checksums is wrong, or it is no plan file.
    Corrupt,
    /// The state does not allow to swap plans.
    State,
}

/// Two buffers of the caller: the plan in use, and the one that is uploaded.
#[derive(Debug)]
pub struct PlanStore<'b> {
    active: &'b mut [u8],
    active_len: usize,
    pending: &'b mut [u8],
    /// Bytes that the upload will have; zero without one.
    expected: usize,
    received: usize,
    /// The upload is whole and sound.
    complete: bool,
}

/// Header, and checksum, of a plan file: nothing is shorter.
const SHORTEST: usize = 44;

impl<'b> PlanStore<'b> {
    /// Plans in two buffers, whose lengths bound those of plans.
    #[must_use]
    pub const fn new(active: &'b mut [u8], pending: &'b mut [u8]) -> Self {
        Self { active, active_len: 0, pending, expected: 0, received: 0, complete: false }
    }

    /// The plan file in use.
    #[must_use]
    pub fn active(&self) -> Option<&[u8]> {
        self.active.get(..self.active_len).filter(|plan| !plan.is_empty())
    }

    /// The plan file that was uploaded and is not in use yet.
    #[must_use]
    pub fn pending(&self) -> Option<&[u8]> {
        self.pending.get(..self.expected).filter(|_| self.complete)
    }

    /// Bytes received and expected of the upload.
    #[must_use]
    pub const fn progress(&self) -> (usize, usize) {
        (self.received, self.expected)
    }

    /// Begins an upload; one that was not swapped in is lost.
    pub(super) fn begin(&mut self, length: u32) -> Result<(), PlanError> {
        self.forget();
        let length = usize::try_from(length).map_err(|_| PlanError::Length)?;
        // The buffers change places: a plan must fit both.
        let room = self.pending.len().min(self.active.len());
        if length < SHORTEST || length > room {
            return Err(PlanError::Length);
        }
        self.expected = length;
        Ok(())
    }

    pub(super) fn chunk(&mut self, index: u8, data: &[u8]) -> Result<(), PlanError> {
        if self.received >= self.expected || self.complete {
            return Err(PlanError::Incomplete);
        }
        let number = self.received.checked_div(CHUNK).unwrap_or(0);
        if number & 0x7F != usize::from(index) {
            return Err(PlanError::Order);
        }
        let rest = self.pending.get_mut(self.received..self.expected).unwrap_or_default();
        for (to, from) in rest.iter_mut().zip(data) {
            *to = *from;
            self.received = self.received.saturating_add(1);
        }
        Ok(())
    }

    pub(super) fn end(&mut self, checksum: u32) -> Result<(), PlanError> {
        let whole = self.pending.get(..self.expected).filter(|_| self.expected > 0);
        let file = whole.filter(|_| self.received == self.expected).ok_or(PlanError::Incomplete)?;
        let own = file.split_last_chunk::<4>();
        let sound = file.starts_with(b"SBPL")
            && crc32(file) == checksum
            && own.is_some_and(|(content, crc)| crc32(content) == u32::from_le_bytes(*crc));
        if sound {
            self.complete = true;
            Ok(())
        } else {
            self.forget();
            Err(PlanError::Corrupt)
        }
    }

    /// Forgets an upload.
    pub fn forget(&mut self) {
        self.expected = 0;
        self.received = 0;
        self.complete = false;
    }

    /// Takes the uploaded plan into use, if the state allows it and the robot is where the plan begins:
    /// `fits` is asked with the plan file.
    ///
    /// # Errors
    ///
    /// [`PlanError::Incomplete`] without a plan, [`PlanError::State`] while one is followed, or unless
    /// `fits` says yes.
    pub fn swap(
        &mut self,
        state: State,
        fits: impl FnOnce(&[u8]) -> bool,
    ) -> Result<(), PlanError> {
        let plan = self.pending().ok_or(PlanError::Incomplete)?;
        let at_rest = matches!(state, State::LegsDown | State::StationKeeping);
        if !at_rest || !fits(plan) {
            return Err(PlanError::State);
        }
        core::mem::swap(&mut self.active, &mut self.pending);
        self.active_len = self.expected;
        self.forget();
        Ok(())
    }
}
