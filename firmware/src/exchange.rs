//! Data that the interrupts pass to one another and to the thread.

use core::sync::atomic::{AtomicBool, AtomicU32};

use touchstone_drive::CurrentConfig;
use touchstone_drive::exchange::{CommandBox, ReportBox};

use crate::shared::Latest;

/// Commands from the control tick to the current loop.
pub static COMMAND: CommandBox = CommandBox::new();
/// Reports from the current loop to the control tick.
pub static REPORT: ReportBox = ReportBox::new();
/// Whether the timer's hardware break has acted since a command last cleared it.
pub static BREAK: AtomicBool = AtomicBool::new(false);
/// Whether the processor's supply has fallen below 2.9 V since a command last cleared this flag.
pub static BROWN_OUT: AtomicBool = AtomicBool::new(false);
/// Longest run of the current loop, in processor cycles.
pub static CURRENT_CYCLES_MAX: AtomicU32 = AtomicU32::new(0);
/// Number of PWM periods in which the new compare values came after the counter's turn and so took effect a period later.
pub static LATE_PERIODS: AtomicU32 = AtomicU32::new(0);
/// Whether the current loop has run since the supervisor last checked.
pub static CURRENT_LIVES: AtomicBool = AtomicBool::new(false);
/// Whether the control tick has run since the supervisor last checked.
pub static CONTROL_LIVES: AtomicBool = AtomicBool::new(false);

/// New coefficients for the current loop, from the control tick.
pub static CONFIG: Latest<CurrentConfig> = Latest::new();
/// Whether a valid frame from the desktop arrived since the last control tick.
pub static HEARD: AtomicBool = AtomicBool::new(false);
/// Whether a valid frame from the desktop arrived since the start.
#[cfg(feature = "g474re")]
pub static SPOKEN: AtomicBool = AtomicBool::new(false);
