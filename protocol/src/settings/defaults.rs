//! What a device does that was never told otherwise.

use super::{
    ControlSettings, Decimal, DriveKind, DriveSettings, EncoderKind, EncoderSettings,
    FilterSettings, LimitSettings, MotorSettings, TelemetrySettings, WallSettings,
};
use touchstone_control as law;

impl Default for ControlSettings {
    fn default() -> Self {
        Self { rate_hz: 1000 }
    }
}

impl Default for WallSettings {
    /// The law's own defaults, the surface at zero.
    fn default() -> Self {
        Self::of(&law::Settings::default(), Decimal::default())
    }
}

impl Default for FilterSettings {
    fn default() -> Self {
        WallSettings::default().filter
    }
}

impl Default for EncoderSettings {
    /// An optical encoder of 4096 lines.
    fn default() -> Self {
        Self {
            kind: EncoderKind::Incremental,
            counts_per_rev: 16_384,
        }
    }
}

impl Default for MotorSettings {
    /// A gimbal motor of the size of a knob.
    fn default() -> Self {
        Self {
            pole_pairs: 7,
            torque_constant_n_m_per_a: Decimal::lit("0.1"),
            resistance_ohm: Decimal::lit("1"),
            inductance_h: Decimal::lit("0.001"),
            current_limit_a: Decimal::lit("5"),
            calibration_current_a: Decimal::lit("1"),
        }
    }
}

impl Default for DriveSettings {
    fn default() -> Self {
        Self {
            kind: DriveKind::ThreePhase,
            analogue_a_per_v: Decimal::lit("1"),
            // The middle of what a DAC of 3.3 V gives.
            analogue_zero_v: Decimal::lit("1.65"),
        }
    }
}

impl Default for LimitSettings {
    fn default() -> Self {
        Self {
            over_current_a: Decimal::lit("8"),
            bus_min_v: Decimal::lit("10"),
            bus_max_v: Decimal::lit("28"),
            derating_celsius: Decimal::lit("70"),
            temperature_max_celsius: Decimal::lit("90"),
            speed_max_rad_per_s: Decimal::lit("100"),
        }
    }
}

impl Default for TelemetrySettings {
    fn default() -> Self {
        Self { decimation: 1 }
    }
}
