//! Data that the interrupts pass to one another and to the thread.

use core::sync::atomic::{AtomicBool, AtomicU32};

use touchstone_drive::CurrentConfig;
use touchstone_drive::exchange::{CommandBox, ReportBox};

use crate::shared::Latest;

/// The commands from the control tick to the current loop.
pub static COMMAND: CommandBox = CommandBox::new();
/// The reports from the current loop to the control tick.
pub static REPORT: ReportBox = ReportBox::new();
/// The timer's break has pulled, and was not cleared by command since.
pub static BREAK: AtomicBool = AtomicBool::new(false);
/// The supply has sagged, and that was not cleared by command since.
pub static BROWN_OUT: AtomicBool = AtomicBool::new(false);
/// Most cycles that the current loop has taken.
pub static CURRENT_CYCLES_MAX: AtomicU32 = AtomicU32::new(0);
/// PWM periods in which new compare values came after the counter's turn, so that they counted a period later.
pub static LATE_PERIODS: AtomicU32 = AtomicU32::new(0);
/// The current loop ran since the supervisor looked.
pub static CURRENT_LIVES: AtomicBool = AtomicBool::new(false);
/// The control tick ran since the supervisor looked.
pub static CONTROL_LIVES: AtomicBool = AtomicBool::new(false);

/// Other coefficients for the current loop.
pub static CONFIG: Latest<CurrentConfig> = Latest::new();
/// A whole frame of the desktop came, since the control tick looked.
pub static HEARD: AtomicBool = AtomicBool::new(false);
/// A whole frame of the desktop came, since the start.
#[cfg(feature = "g474re")]
pub static SPOKEN: AtomicBool = AtomicBool::new(false);
