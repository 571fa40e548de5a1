//! Why the processor started, and which of the reasons is a fault.

use touchstone_protocol::FaultCode;

/// The reset flags as the processor keeps them, and what survived in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ResetFlags {
    /// The brown-out detector; also set when power comes on.
    pub brown_out: bool,
    /// The reset pin; set by every other reset too, as it pulls the pin.
    pub pin: bool,
    /// The reset was caused by software.
    pub software: bool,
    /// Independent watchdog.
    pub independent_watchdog: bool,
    /// Window watchdog.
    pub window_watchdog: bool,
    /// Loading of the option bytes.
    pub option_bytes: bool,
    /// An attempt to enter a low-power mode that is forbidden.
    pub low_power: bool,
    /// The mark that the running program keeps in memory is still there: power was not really off.
    pub memory_kept: bool,
    /// The record that the panic handler left.
    pub panic: Option<u32>,
}

/// Why the processor started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ResetReason {
    /// Power came on.
    #[default]
    PowerOn,
    /// Power dipped, and came back before memory was lost.
    BrownOut,
    /// The reset button was pressed.
    Pin,
    /// The program or a debugger reset the processor.
    Software,
    /// The independent watchdog was not fed.
    IndependentWatchdog,
    /// The window watchdog was not fed, or too early.
    WindowWatchdog,
    /// A panic; where, as its record says.
    Panic(u32),
    /// Option bytes were loaded.
    OptionBytes,
    /// A forbidden low-power mode.
    LowPower,
}

impl ResetReason {
    /// The reason behind the flags, the most telling first.
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

    /// The fault that it stands for, with its value.
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
