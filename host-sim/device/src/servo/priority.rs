//! Real-time priority and locked memory for the servo loop, if the operating system permits them.

/// The priority that the servo loop's thread obtained, or why it did not.
#[derive(Debug, Clone, PartialEq)]
pub struct Priority {
    /// Whether the thread runs before all ordinary threads (`SCHED_FIFO`); otherwise the reason.
    pub first: Result<(), String>,
    /// Whether the memory is locked, so that no page can be swapped out (`mlockall`); otherwise the reason.
    pub locked: Result<(), String>,
}

/// Requests real-time priority and locked memory for the calling thread. A refusal is no error, because the servo loop counts
/// missed control intervals.
#[must_use]
pub fn real_time() -> Priority {
    Priority {
        first: first_of_threads(),
        locked: locked(),
    }
}

/// The thread's priority in % of the real-time range: above all ordinary threads, below the kernel's own interrupts.
const SHARE: u8 = 80;

/// Requests real-time priority alone, for a servo loop in another program: with locked memory, that program's other threads might
/// get no more memory.
///
/// # Errors
/// The operating system's reason for its refusal.
#[cfg(unix)]
pub fn first_of_threads() -> Result<(), String> {
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

/// Requests the highest priority for the calling thread.
///
/// # Errors
/// The operating system's reason for its refusal.
#[cfg(not(unix))]
pub fn first_of_threads() -> Result<(), String> {
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
