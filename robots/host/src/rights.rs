//! What a control loop asks of the system: to run before all else, and never to wait for a page.

use rustix::mm::{MlockAllFlags, mlockall};
use std::fmt;
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// A right that the system did not grant: the loop runs without it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Missing {
    /// SCHED_FIFO of this priority, and what the system said.
    Fifo(u8, String),
    /// Locked memory, and what the system said.
    LockedMemory(String),
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fifo(priority, why) => write!(
                f,
                "warning: no SCHED_FIFO with priority {priority} ({why}): other programs can delay the \
                 loop; it takes CAP_SYS_NICE or `rtprio` in limits.conf"
            ),
            Self::LockedMemory(why) => write!(
                f,
                "warning: memory is not locked ({why}): a page fault can delay the loop; it takes \
                 CAP_IPC_LOCK or `memlock` in limits.conf"
            ),
        }
    }
}

/// Locks the memory of the process, also what it gets later, and gives this thread SCHED_FIFO with a
/// priority of 1 to 99. What is missing is returned.
#[must_use]
pub fn ask(priority: u8) -> Vec<Missing> {
    let locked = mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE);
    let locked = locked.map_err(|error| Missing::LockedMemory(error.to_string()));
    let fifo = fifo(priority).map_err(|why| Missing::Fifo(priority, why));
    [locked, fifo].into_iter().filter_map(Result::err).collect()
}

fn fifo(priority: u8) -> Result<(), String> {
    let value = ThreadPriorityValue::try_from(priority)?;
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::Crossplatform(value);
    set_thread_priority_and_policy(thread_native_id(), priority, policy).map_err(|e| e.to_string())
}
