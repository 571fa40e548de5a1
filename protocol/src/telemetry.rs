//! The telemetry of one control tick, and the record of the last second.

use crate::machine::{Context, FaultCode, State};
use crate::measuring::MeasuringTick;
use crate::settings::{Decimal, decimal::bits};
use fixed::types::I8F24;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// One control tick. Small numbers take few bytes: a tick at rest has 17, a busy one about 32, none more than
/// [`TELEMETRY_MAX`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Telemetry {
    /// Number of the tick since the reset, modulo 2^32. A gap means that the port could not carry some records.
    pub tick: u32,
    /// Position, counts from the calibrated zero.
    pub count: i32,
    /// Penetration of the wall, rad; negative outside.
    #[serde(with = "bits")]
    pub penetration_rad: I8F24,
    /// How far the device has moved inwards since the force changed, had all of the change come at once, rad; 0 where that is not
    /// measured.
    #[serde(with = "bits")]
    pub since_change_rad: I8F24,
    /// Torque that the law commands, N·m, positive out of the wall.
    #[serde(with = "bits")]
    pub force_n_m: I8F24,
    /// Offset of the augmented spring, rad; 0 for laws without.
    #[serde(with = "bits")]
    pub offset_rad: I8F24,
    /// Energy that the law's observer counts, J.
    pub energy_j: Decimal,
    /// State of the device.
    pub phase: Phase,
    /// The latched fault, 0 for none: [`FaultCode::to_wire`].
    pub fault: u8,
    /// What held the force back: [`crate::Limits`] as bits.
    pub limits: u8,
    /// Processor cycles of the tick before.
    pub cycles: u32,
    /// Processor cycles from when this tick was due to when it began.
    pub lateness_cycles: u32,
    /// Measured q-axis current, mA.
    pub current_q_ma: i32,
    /// Readings of the motor during a calibration that measures; `None` at other times.
    pub measuring: Option<MeasuringTick>,
}

/// No record takes more bytes: twelve numbers of 32 bits, one of 64, five bytes.
pub const TELEMETRY_MAX: usize = 12 * 5 + 10 + 5;

/// State of the device, without the fault's context.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Power is on, nothing is known yet.
    Boot,
    /// The calibration moves the shaft.
    Calibrating,
    /// Calibrated, outputs off.
    Ready,
    /// The law drives the outputs.
    Armed,
    /// Switched off for a reason.
    Fault,
    /// Switched off by command; the calibration is forgotten.
    Stopped,
}

impl Phase {
    /// All phases, by their numbers.
    pub const ALL: [Self; 6] = [
        Self::Boot,
        Self::Calibrating,
        Self::Ready,
        Self::Armed,
        Self::Fault,
        Self::Stopped,
    ];

    /// Text for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Boot => "boot",
            Self::Calibrating => "calibrating",
            Self::Ready => "ready",
            Self::Armed => "armed",
            Self::Fault => "fault",
            Self::Stopped => "stopped",
        }
    }
}

impl From<State> for Phase {
    fn from(state: State) -> Self {
        match state {
            State::Boot => Self::Boot,
            State::Calibrating => Self::Calibrating,
            State::Ready => Self::Ready,
            State::Armed => Self::Armed,
            State::Fault(_) => Self::Fault,
            State::Stopped => Self::Stopped,
        }
    }
}

/// A fault's context on the wire. The code is a number: an older desktop shows one that it does not know.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// [`FaultCode::to_wire`].
    pub code: u8,
    /// Tick in which it was seen.
    pub tick: u32,
    /// The value that broke the limit, in the raw unit of its source.
    pub value: i32,
}

impl Fault {
    /// The code, if this version knows it.
    #[must_use]
    pub fn known(&self) -> Option<FaultCode> {
        FaultCode::from_wire(self.code)
    }
}

impl From<Context> for Fault {
    fn from(context: Context) -> Self {
        Self {
            code: context.code.to_wire(),
            tick: context.tick,
            value: context.value,
        }
    }
}

/// Records in one answer to `Ring`.
pub const RING_CHUNK: usize = 24;

/// Part of the ring of the last second.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RingChunk {
    /// Index of the first record here; 0 is the oldest.
    pub first: u16,
    /// Records in the ring.
    pub total: u16,
    /// The records from `first` on; empty beyond the end.
    pub records: Vec<RingRecord, RING_CHUNK>,
}

/// One tick in the ring: coarser than [`Telemetry`], so that a second fits into the smaller board.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RingRecord {
    /// Low 16 bits of the tick's number.
    pub tick: u16,
    /// Position, counts from the calibrated zero; 24 bits.
    pub count: i32,
    /// Torque that the law commands, N·m in 1/4096, at most ±8.
    pub force: i16,
    /// Measured q-axis current, A in 1/1024, at most ±32.
    pub current_q: i16,
    /// Lateness in units of 64 cycles.
    pub lateness_64: u8,
    /// What held the force back: [`crate::Limits`] as bits.
    pub limits: u8,
    /// [`Phase`] as a number, in its order.
    pub phase: u8,
}
