//! The steps of a calibration that measures the motor.

#[cfg(feature = "wire")]
use serde::{Deserialize, Serialize};

/// Part of a measurement of the motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(Serialize, Deserialize))]
pub enum MeasuringPart {
    /// A field that turns far faster than the rotor can follow, with half of the calibration's current.
    Low,
    /// The same field, at full strength.
    High,
    /// The shaft is brought to rest.
    Brake,
    /// A steady current along the torque.
    Push,
    /// The bridge is off, the shaft runs on.
    Coast,
    /// The shaft is turned slowly along the count. The record's position is that from the encoder's own zero.
    #[cfg(feature = "large")]
    Forward,
    /// The same turn, backwards.
    #[cfg(feature = "large")]
    Backward,
}

/// One control tick of such a calibration.
#[cfg(feature = "wire")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeasuringTick {
    /// The part of the measurement.
    pub part: MeasuringPart,
    /// Current along the frame that the current loop works in, mA; the one across it is [`crate::Telemetry::current_q_ma`].
    pub current_d_ma: i32,
    /// Voltage along that frame, mV.
    pub voltage_d_mv: i32,
    /// Voltage across it, mV.
    pub voltage_q_mv: i32,
}
