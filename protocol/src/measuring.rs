//! The steps of a calibration that also measures the motor's parameters.

#[cfg(feature = "wire")]
use serde::{Deserialize, Serialize};

/// A step of a calibration that measures the motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(Serialize, Deserialize))]
pub enum MeasuringPart {
    /// Measures the windings: the field turns far faster than the rotor can follow, with half of the calibration's current.
    Low,
    /// Same as [`Self::Low`], with the calibration's full current.
    High,
    /// The board brakes the shaft to rest.
    Brake,
    /// A constant torque-making (q-axis) current accelerates the shaft.
    Push,
    /// The motor's power bridge is off and the shaft coasts.
    Coast,
    /// The shaft turns slowly in the direction of rising encoder counts. In this step the telemetry's position is measured from the
    /// encoder's own zero.
    #[cfg(feature = "large")]
    Forward,
    /// The shaft turns slowly in the direction of falling encoder counts. The telemetry's position is measured as in
    /// [`Self::Forward`].
    #[cfg(feature = "large")]
    Backward,
}

/// The measured values of one control tick in a calibration that measures the motor.
#[cfg(feature = "wire")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeasuringTick {
    /// The step of the measurement.
    pub part: MeasuringPart,
    /// Current on the d axis of the current loop's frame, mA. The frame follows the rotor's field; in the steps `Low` and `High`
    /// it follows the fast turning field instead. The q-axis current is [`crate::Telemetry::current_q_ma`].
    pub current_d_ma: i32,
    /// Voltage on the d axis of the same frame, mV.
    pub voltage_d_mv: i32,
    /// Voltage on the q axis of the same frame, mV.
    pub voltage_q_mv: i32,
}
