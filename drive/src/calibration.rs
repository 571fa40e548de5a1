//! Before the first torque: what the current sensors read without current, which way the encoder counts, whether the pole
//! pairs are those of the settings, and which count belongs to which electrical angle.
//!
//! ```text
//! Offsets -> Raise -> Settle -> Forward -> Back -> done
//! ```
//!
//! 1. Bridge off: the mean of 1,024 readings of each current sensor, which must be near where the schematic says.
//! 2. A current along a field that stands still is raised slowly; the rotor turns into it, less than half an electrical turn.
//! 3. The field turns one mechanical turn forward (`pole pairs` electrical turns), then the same way back; the rotor follows.
//!    The counts moved give direction and pole pairs.
//! 4. On the way, at each eighth of an electrical turn, the difference between field and count is taken. Friction makes the
//!    rotor lag; it lags the other way on the way back, so the mean of both ways is right.
//!
//! Nothing is learned unless all of it is plausible.

use crate::Amps;
use crate::angle::Angle;
use crate::current::{CurrentCommand, CurrentMode, CurrentReport};
use crate::hardware::Hardware;
use crate::settings::Settings;
use crate::transform::Dq;
use crate::units::{clamp_i32, narrow};
use touchstone_control::Si;
use touchstone_protocol::FaultCode;

/// Why a calibration failed: the value of [`FaultCode::CalibrationFailed`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Reason {
    /// The current loop did not report offsets in time.
    OffsetsLate = 1,
    /// The shaft moved, but not as far as the settings' pole pairs say.
    PolePairs = 2,
    /// The shaft did not come back to where it began.
    NotBack = 3,
    /// The shaft did not follow the field evenly: held fast, or the encoder is not on the motor's shaft.
    Uneven = 4,
    /// The encoder had a bad reading.
    Encoder = 5,
    /// The current did not reach what was asked: a phase is open, or the bus is too low.
    NoCurrent = 6,
}

impl Reason {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::OffsetsLate,
        Self::PolePairs,
        Self::NotBack,
        Self::Uneven,
        Self::Encoder,
        Self::NoCurrent,
    ];

    /// The reason behind a fault's value.
    #[must_use]
    pub fn from_value(value: i32) -> Option<Self> {
        Self::ALL.into_iter().find(|reason| *reason as i32 == value)
    }
}

/// What a calibration finds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Alignment {
    /// Electrical angle at count 0 of the unwrapped encoder.
    pub offset: Angle,
    /// The electrical angle falls when the count rises.
    pub against: bool,
}

/// How far a calibration is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// Goes on, with this for the current loop.
    Running(CurrentCommand),
    /// Done.
    Done(Alignment),
    /// Failed.
    Failed(FaultCode, i32),
}

/// Coefficients of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CalibrationConfig {
    current: Amps,
    /// 2^-32 electrical turns a tick.
    speed: u32,
    /// Ticks of raising the current, and of settling.
    raise: u32,
    /// Ticks after which offsets are late.
    patience: u32,
    pole_pairs: u8,
    counts_per_rev: u32,
    /// 2^-32 electrical turns per count, wrapping.
    turns_per_count: u32,
    periods_per_tick: u16,
    offset_code: u16,
    offset_tolerance: u16,
    offset_spread: u16,
}

impl CalibrationConfig {
    /// From validated settings.
    #[must_use]
    pub fn new(settings: &Settings, hardware: &Hardware) -> Self {
        let rate = settings.wall.rate_hz.max(1);
        let pole_pairs = settings.motor.pole_pairs.max(1);
        let counts_per_rev = settings.encoder.counts_per_rev.max(1);
        // 2^32 turns · turns/s / rate, from 32 fractional bits.
        let speed = settings.calibration.turns_per_s.to_bits().unsigned_abs() / u64::from(rate);
        let turn = (u64::from(pole_pairs) << 32) / u64::from(counts_per_rev);
        Self {
            current: narrow(settings.calibration.current_a),
            speed: u32::try_from(speed).unwrap_or(u32::MAX),
            raise: rate / 2,
            patience: rate / 2,
            pole_pairs,
            counts_per_rev,
            turns_per_count: turn as u32,
            periods_per_tick: u16::try_from(hardware.pwm_hz / rate).unwrap_or(u16::MAX),
            offset_code: hardware.offset_code,
            offset_tolerance: hardware.offset_tolerance,
            offset_spread: hardware.offset_spread,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Offsets,
    Raise,
    Settle,
    Forward,
    Back,
}

/// A running calibration.
#[derive(Debug, Clone, Copy)]
pub struct Calibration {
    config: CalibrationConfig,
    stage: Stage,
    /// Ticks in the stage.
    ticks: u32,
}

impl Calibration {
    /// Begins.
    #[must_use]
    pub const fn new(config: CalibrationConfig) -> Self {
        Self {
            config,
            stage: Stage::Offsets,
            ticks: 0,
        }
    }

    /// One control tick: the unwrapped count (`None`: bad reading) and the current loop's report.
    pub fn tick(&mut self, tick: u32, count: Option<i64>, report: &CurrentReport) -> Progress {
        let _ = (count, report);
        self.ticks = self.ticks.saturating_add(1);
        Progress::Running(CurrentCommand {
            tick,
            mode: CurrentMode::Offsets,
            ..CurrentCommand::default()
        })
    }
}
