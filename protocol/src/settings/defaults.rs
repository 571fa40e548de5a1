//! What a device does that was never told otherwise.

use super::{
    CalibrationSettings, ControlSettings, Decimal, DeviceSettings, DriveKind, DriveSettings,
    EncoderKind, EncoderSettings, LimitSettings, MotorSettings, TelemetrySettings, WallSettings,
};
use crate::reply::Board;
use touchstone_control as law;

impl DeviceSettings {
    /// The thesis' wall on a gimbal-type motor, at 24 V: valid on the board, but no motor's data sheet.
    #[must_use]
    pub fn defaults(board: Board) -> Self {
        Self {
            control: ControlSettings { rate_hz: 1000 },
            // The surface a sixth of a turn away, so that a knob that was just calibrated is outside.
            wall: WallSettings::of(&law::Settings::default(), const { Decimal::lit("1") }),
            encoder: EncoderSettings {
                // The smaller board has no SPI on its connectors.
                kind: match board {
                    Board::NucleoG474re => EncoderKind::As5047p,
                    Board::BG431bEsc1 => EncoderKind::Incremental,
                },
                counts_per_rev: 16_384,
                reversed: false,
                bad_readings: 3,
            },
            drive: DriveSettings {
                kind: DriveKind::ThreePhase,
                analogue_full_scale_n_m: const { Decimal::lit("1") },
            },
            motor: MotorSettings {
                pole_pairs: 7,
                resistance_ohm: const { Decimal::lit("6") },
                inductance_h: const { Decimal::lit("0.003") },
                torque_constant_n_m_per_a: const { Decimal::lit("0.25") },
                current_limit_a: const { Decimal::lit("2") },
                current_bandwidth_hz: const { Decimal::lit("600") },
            },
            limits: LimitSettings {
                trip_current_a: const { Decimal::lit("4") },
                bus_min_v: const { Decimal::lit("18") },
                // The smaller board is for six lithium cells.
                bus_max_v: match board {
                    Board::NucleoG474re => const { Decimal::lit("30") },
                    Board::BG431bEsc1 => const { Decimal::lit("26") },
                },
                derate_from_celsius: const { Decimal::lit("70") },
                fault_from_celsius: const { Decimal::lit("90") },
                max_speed_rad_per_s: const { Decimal::lit("60") },
                fade_in_s: const { Decimal::lit("0.2") },
            },
            calibration: CalibrationSettings {
                current_a: const { Decimal::lit("1") },
                electrical_turns_per_s: const { Decimal::lit("4") },
            },
            telemetry: TelemetrySettings { decimation: 1 },
        }
    }
}
