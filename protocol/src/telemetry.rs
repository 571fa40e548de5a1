//! The telemetry record of one control tick, and the smaller records of the ring buffer of the last second.

use crate::machine::{Context, FaultCode, State};
use crate::measuring::MeasuringTick;
use crate::settings::{Decimal, decimal::bits};
use fixed::types::I8F24;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The telemetry record of one control tick. Small numbers take few bytes: the record of a knob at rest takes 17 bytes, that of a
/// busy one about 32, and none more than [`TELEMETRY_MAX`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Telemetry {
    /// Number of the tick since the reset, modulo 2^32. A gap larger than the telemetry's decimation means that the serial port
    /// was too slow for the missing records.
    pub tick: u32,
    /// Position in encoder counts from the calibrated zero.
    pub count: i32,
    /// Depth of the knob inside the wall, rad; negative outside.
    #[serde(with = "bits")]
    pub penetration_rad: I8F24,
    /// How far the knob has moved into the wall since the last change of the force, rad. The force changes gradually; the value
    /// is as if the whole change had come at one instant. 0 if the device does not measure the position when the force changes.
    #[serde(with = "bits")]
    pub since_change_rad: I8F24,
    /// Torque that the control law commands, N·m, positive out of the wall.
    #[serde(with = "bits")]
    pub force_n_m: I8F24,
    /// Offset of the spring in the control law (successive force augmentation), rad; 0 for laws without an offset.
    #[serde(with = "bits")]
    pub offset_rad: I8F24,
    /// Energy in joules that the control law's energy observer has summed; 0 for a law without an observer.
    pub energy_j: Decimal,
    /// State of the device in this tick.
    pub phase: Phase,
    /// Number of the stored fault ([`FaultCode::to_wire`]); 0 for none.
    pub fault: u8,
    /// The limits that act in this tick: [`crate::Limits`] as bits.
    pub limits: u8,
    /// Duration of the previous control tick in processor cycles.
    pub cycles: u32,
    /// Lateness of this tick in processor cycles, from when it was due to when it began.
    pub lateness_cycles: u32,
    /// Measured torque-making (q-axis) current of the motor, mA.
    pub current_q_ma: i32,
    /// Values measured at the motor during a calibration that measures it; `None` at other times.
    pub measuring: Option<MeasuringTick>,
}

/// Longest encoded record in bytes: twelve numbers of 32 bits (5 bytes each), one of 64 bits (10 bytes), five bytes.
pub const TELEMETRY_MAX: usize = 12 * 5 + 10 + 5;

/// State of the device, without the context of a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Power is on and no calibration has started yet.
    Boot,
    /// The calibration moves the shaft.
    Calibrating,
    /// The device is calibrated and its outputs are off.
    Ready,
    /// The control law drives the outputs.
    Armed,
    /// A fault switched the outputs off.
    Fault,
    /// A command switched the outputs off and discarded the calibration.
    Stopped,
}

impl Phase {
    /// All states, in the order of their numbers.
    pub const ALL: [Self; 6] = [
        Self::Boot,
        Self::Calibrating,
        Self::Ready,
        Self::Armed,
        Self::Fault,
        Self::Stopped,
    ];

    /// The name of the device's state as text for people.
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

/// The record of a fault on the serial link. The code is a plain number, so that an older desktop program can show the code of a
/// newer fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// Number of the fault: [`FaultCode::to_wire`].
    pub code: u8,
    /// Number of the control tick in which the fault was detected.
    pub tick: u32,
    /// The measured value or the number that [`FaultCode`] names for this code.
    pub value: i32,
}

impl Fault {
    /// The fault code, if this version of the protocol has the number.
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

/// Largest number of ring-buffer records in one answer to the request `Ring`.
pub const RING_CHUNK: usize = 24;

/// Part of the ring buffer, which holds the records of the last second.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RingChunk {
    /// Index of the first record in this part; 0 is the oldest of the ring buffer.
    pub first: u16,
    /// Number of records in the ring buffer.
    pub total: u16,
    /// The records from index `first` on; empty beyond the end of the ring buffer.
    pub records: Vec<RingRecord, RING_CHUNK>,
}

/// One tick's record in the ring buffer. The record is coarser than [`Telemetry`], so that the records of a second fit into the
/// smaller microcontroller's RAM.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RingRecord {
    /// Low 16 bits of the tick's number.
    pub tick: u16,
    /// Position in encoder counts from the calibrated zero: the low 24 bits, sign-extended.
    pub count: i32,
    /// Torque that the control law commands, in units of 1/4096 N·m, at most ±8 N·m.
    pub force: i16,
    /// Measured torque-making (q-axis) current of the motor, in units of 1/1024 A, at most ±32 A.
    pub current_q: i16,
    /// Lateness of the tick in units of 64 processor cycles.
    pub lateness_64: u8,
    /// The limits that act in this tick: [`crate::Limits`] as bits.
    pub limits: u8,
    /// [`Phase`] as a number: its index in [`Phase::ALL`].
    pub phase: u8,
}
