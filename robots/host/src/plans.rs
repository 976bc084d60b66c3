//! Plans that stay where they are.

use crate::Error;
use shapebot_drive::operator::PlanStore;
use shapebot_drive::safety::State;
use shapebot_planner::value::{PlanView, RobotId};
use std::path::Path;

/// Longest plan that can be uploaded, bytes.
const LONGEST: usize = 1 << 20;

/// Bytes of all plans of a run. The controller may hold on to a plan, so that its memory is never given
/// back.
const ALL: usize = 64 << 20;

/// Plans of a run, checked for a robot.
#[derive(Clone, Copy, Debug)]
pub struct Plans<'d> {
    id: RobotId<'d>,
    used: usize,
}

/// A plan whose bytes live as long as the program.
pub(crate) type Kept<const N: usize, const NX: usize, const NS: usize> =
    PlanView<'static, f64, NX, NS, N>;

impl<'d> Plans<'d> {
    /// For a robot with its parameters.
    #[must_use]
    pub const fn new(id: RobotId<'d>) -> Self {
        Self { id, used: 0 }
    }

    /// Buffers for uploads.
    #[must_use]
    pub fn store() -> PlanStore<'static> {
        PlanStore::new(vec![0; LONGEST].leak(), vec![0; LONGEST].leak())
    }

    /// Reads a plan file.
    ///
    /// # Errors
    ///
    /// [`Error::Io`], [`Error::Plan`].
    pub fn read<const N: usize, const NX: usize, const NS: usize>(
        &mut self,
        path: &Path,
    ) -> Result<Kept<N, NX, NS>, Error> {
        let place = || path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| Error::Io { place: place(), source })?;
        PlanView::<f64, NX, NS, N>::open(&bytes, &self.id)?;
        self.used += bytes.len();
        Ok(PlanView::open(bytes.leak(), &self.id)?)
    }

    /// The plan that was uploaded, once the state allows to take it. One for another robot is forgotten.
    pub fn take<const N: usize, const NX: usize, const NS: usize>(
        &mut self,
        store: &mut PlanStore<'_>,
        state: State,
    ) -> Option<Kept<N, NX, NS>> {
        let pending = store.pending()?;
        let fits = PlanView::<f64, NX, NS, N>::open(pending, &self.id).is_ok();
        if !fits || self.used + pending.len() > ALL {
            store.forget();
            return None;
        }
        store.swap(state, |_| true).ok()?;
        let bytes = store.active()?.to_vec();
        self.used += bytes.len();
        PlanView::open(bytes.leak(), &self.id).ok()
    }
}
