//! The reason why the processor started, and which of the reasons is a fault.

use crate::FaultCode;
#[cfg(feature = "wire")]
use serde::{Deserialize, Serialize};

/// The processor's reset flags, and the values that survived the reset in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ResetFlags {
    /// The brown-out detector caused the reset; the flag is also set when power comes on.
    pub brown_out: bool,
    /// The reset pin was low; every other reset sets this flag too, because it pulls the pin low.
    pub pin: bool,
    /// The reset was caused by software.
    pub software: bool,
    /// The independent watchdog caused the reset.
    pub independent_watchdog: bool,
    /// The window watchdog caused the reset.
    pub window_watchdog: bool,
    /// The loading of the option bytes caused the reset.
    pub option_bytes: bool,
    /// A forbidden attempt to enter a low-power mode caused the reset.
    pub low_power: bool,
    /// Whether the mark that the running program keeps in memory is still there. If so, the memory kept its power.
    pub memory_kept: bool,
    /// Number of the place where the program panicked, stored by the panic handler before the reset; `None` without a panic.
    pub panic: Option<u32>,
}

/// Why the processor last started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(Serialize, Deserialize))]
pub enum ResetReason {
    /// Power came on.
    #[default]
    PowerOn,
    /// The supply voltage dipped, and came back before memory was lost.
    BrownOut,
    /// The reset pin was pulled low, for example by the reset button.
    Pin,
    /// The program or a debugger reset the processor.
    Software,
    /// The independent watchdog was not fed.
    IndependentWatchdog,
    /// The window watchdog was fed too late or too early.
    WindowWatchdog,
    /// The program panicked; the value is the place in the program that the panic handler stored.
    Panic(u32),
    /// Option bytes were loaded.
    OptionBytes,
    /// The program attempted to enter a low-power mode, which is forbidden.
    LowPower,
}

impl ResetReason {
    /// The reason that the reset flags give. If several flags are set, the most specific one decides.
    #[must_use]
    pub const fn of(flags: &ResetFlags) -> Self {
        match flags {
            ResetFlags {
                panic: Some(place),
                software: true,
                ..
            } => Self::Panic(*place),
            ResetFlags {
                independent_watchdog: true,
                ..
            } => Self::IndependentWatchdog,
            ResetFlags {
                window_watchdog: true,
                ..
            } => Self::WindowWatchdog,
            ResetFlags {
                brown_out: true,
                memory_kept: true,
                ..
            } => Self::BrownOut,
            ResetFlags {
                brown_out: true, ..
            } => Self::PowerOn,
            ResetFlags {
                low_power: true, ..
            } => Self::LowPower,
            ResetFlags {
                option_bytes: true, ..
            } => Self::OptionBytes,
            ResetFlags { software: true, .. } => Self::Software,
            _ => Self::Pin,
        }
    }

    /// The reason as text for people.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::PowerOn => "power on",
            Self::BrownOut => "brown-out",
            Self::Pin => "reset pin",
            Self::Software => "software",
            Self::IndependentWatchdog => "independent watchdog",
            Self::WindowWatchdog => "window watchdog",
            Self::Panic(_) => "panic",
            Self::OptionBytes => "option bytes",
            Self::LowPower => "low-power mode",
        }
    }

    /// The fault that this reason causes, with the fault's value; `None` if the reason is no fault.
    #[must_use]
    pub const fn fault(self) -> Option<(FaultCode, i32)> {
        match self {
            Self::IndependentWatchdog => Some((FaultCode::Watchdog, 0)),
            Self::WindowWatchdog => Some((FaultCode::Watchdog, 1)),
            Self::BrownOut => Some((FaultCode::BrownOut, 0)),
            Self::Panic(place) => Some((FaultCode::Panic, place.cast_signed())),
            Self::PowerOn | Self::Pin | Self::Software | Self::OptionBytes | Self::LowPower => None,
        }
    }
}
