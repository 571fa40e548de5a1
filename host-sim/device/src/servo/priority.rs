//! Real-time priority and locked memory, where the system permits them.

/// The priority that was obtained, or why not.
#[derive(Debug, Clone, PartialEq)]
pub struct Priority {
    /// Whether the thread goes before all others (`SCHED_FIFO`); otherwise why not.
    pub first: Result<(), String>,
    /// Whether no page of memory can be swapped out (`mlockall`); otherwise why not.
    pub locked: Result<(), String>,
}

/// Requests both for the calling thread. A refusal is not an error, since missed ticks are counted.
#[must_use]
pub fn real_time() -> Priority {
    Priority {
        first: first(),
        locked: locked(),
    }
}

/// A priority within the real-time range, in hundredths: before all ordinary threads, after the kernel's own interrupts.
const SHARE: u8 = 80;

#[cfg(unix)]
fn first() -> Result<(), String> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    let value = ThreadPriorityValue::try_from(SHARE).map_err(|why| why.to_string())?;
    set_thread_priority_and_policy(
        thread_native_id(),
        ThreadPriority::Crossplatform(value),
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    )
    .map_err(|why| why.to_string())
}

#[cfg(not(unix))]
fn first() -> Result<(), String> {
    thread_priority::set_current_thread_priority(thread_priority::ThreadPriority::Max)
        .map_err(|why| why.to_string())
}

#[cfg(target_os = "linux")]
fn locked() -> Result<(), String> {
    use nix::sys::mman::{MlockAllFlags, mlockall};
    mlockall(MlockAllFlags::MCL_CURRENT | MlockAllFlags::MCL_FUTURE).map_err(|why| why.to_string())
}

#[cfg(not(target_os = "linux"))]
fn locked() -> Result<(), String> {
    Err("not on this system".to_owned())
}
