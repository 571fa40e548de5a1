//! Data that the interrupts pass to one another and to the main thread.

use core::sync::atomic::{AtomicBool, AtomicU32};

use touchstone_drive::CurrentConfig;
use touchstone_drive::exchange::{CommandBox, ReportBox};

use crate::shared::Latest;

/// Mailbox for commands from the control interrupt to the current loop.
pub static COMMAND: CommandBox = CommandBox::new();
/// Mailbox for reports from the current loop to the control interrupt.
pub static REPORT: ReportBox = ReportBox::new();
/// Whether the timer's hardware break has acted since a command last cleared this flag.
pub static BREAK: AtomicBool = AtomicBool::new(false);
/// Whether the processor's supply has fallen below 2.9 V since a command last cleared this flag.
pub static BROWN_OUT: AtomicBool = AtomicBool::new(false);
/// Longest run of the current loop, in processor cycles.
pub static CURRENT_CYCLES_MAX: AtomicU32 = AtomicU32::new(0);
/// Number of PWM periods whose new compare values were written too late, after the counter had turned at the bottom. They then took
/// effect a period later.
pub static LATE_PERIODS: AtomicU32 = AtomicU32::new(0);
/// Whether the current loop has run since the supervision task last checked.
pub static CURRENT_LIVES: AtomicBool = AtomicBool::new(false);
/// Whether the control interrupt has run since the supervision task last checked.
pub static CONTROL_LIVES: AtomicBool = AtomicBool::new(false);

/// New coefficients for the current loop, from the control interrupt.
pub static CONFIG: Latest<CurrentConfig> = Latest::new();
/// Whether a valid frame from the computer arrived since the last control period.
pub static HEARD: AtomicBool = AtomicBool::new(false);
/// Whether a valid frame from the computer arrived since the start.
#[cfg(feature = "g474re")]
pub static SPOKEN: AtomicBool = AtomicBool::new(false);
