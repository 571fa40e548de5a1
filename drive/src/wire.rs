//! Between the wire and the drive: its settings from the tree that people write, its records to the ones that they read.

use crate::hardware::{B_G431B_ESC1, Hardware, IHM08M1};
use crate::settings::{
    AnalogueSettings, CalibrationSettings, DriveKind, EncoderSettings, Field, LimitSettings,
    MotorSettings,
};
use crate::{CompactRecord, EncoderKind, Record, ResetReason, Settings, SettingsError};
use touchstone_control::Si;
use touchstone_protocol::settings::{
    self as tree, Decimal, DeviceSettings, Invalid, Reason, refused,
};
use touchstone_protocol::{Board, Fault, Phase, RingRecord, Telemetry};

/// The power stage of a board.
#[must_use]
pub const fn hardware(board: Board) -> &'static Hardware {
    match board {
        Board::NucleoG474re => &IHM08M1,
        Board::BG431bEsc1 => &B_G431B_ESC1,
    }
}

/// The one check of settings, of firmware and desktop: ranges, the board, the law, the power stage.
///
/// # Errors
/// The first setting that is refused.
pub fn checked(settings: &DeviceSettings, board: Board) -> Result<Settings, Invalid> {
    settings.validate(board)?;
    let drive = Settings::from(settings);
    match drive.validate(hardware(board)) {
        Ok(()) => Ok(drive),
        Err(error) => Err(invalid(&error)),
    }
}

impl From<&DeviceSettings> for Settings {
    fn from(tree: &DeviceSettings) -> Self {
        let (motor, limits) = (&tree.motor, &tree.limits);
        Self {
            wall: tree.law(),
            surface_rad: tree.wall.surface_rad.0,
            encoder: EncoderSettings {
                kind: match tree.encoder.kind {
                    tree::EncoderKind::Incremental => EncoderKind::Incremental,
                    tree::EncoderKind::As5047p => EncoderKind::As5047p,
                    tree::EncoderKind::Mt6701 => EncoderKind::Mt6701,
                },
                counts_per_rev: tree.encoder.counts_per_rev,
                reversed: tree.encoder.reversed,
                bad_readings: tree.encoder.bad_readings,
            },
            drive: match tree.drive.kind {
                tree::DriveKind::ThreePhase => DriveKind::ThreePhase,
                tree::DriveKind::Analogue => DriveKind::Analogue,
            },
            motor: MotorSettings {
                pole_pairs: motor.pole_pairs,
                resistance_ohm: motor.resistance_ohm.0,
                inductance_h: motor.inductance_h.0,
                torque_constant_nm_per_a: motor.torque_constant_n_m_per_a.0,
                current_limit_a: motor.current_limit_a.0,
                current_bandwidth_hz: motor.current_bandwidth_hz.0,
            },
            analogue: AnalogueSettings {
                full_scale_nm: tree.drive.analogue_full_scale_n_m.0,
            },
            limits: LimitSettings {
                bus_min_v: limits.bus_min_v.0,
                bus_max_v: limits.bus_max_v.0,
                trip_current_a: limits.trip_current_a.0,
                derate_from_c: limits.derate_from_celsius.0,
                fault_from_c: limits.fault_from_celsius.0,
                max_speed_rad_per_s: limits.max_speed_rad_per_s.0,
                fade_in_s: limits.fade_in_s.0,
            },
            calibration: CalibrationSettings {
                current_a: tree.calibration.current_a.0,
                turns_per_s: tree.calibration.electrical_turns_per_s.0,
            },
        }
    }
}

/// The path of a setting of the drive in the tree.
const fn path(field: Field) -> &'static str {
    match field {
        Field::RateHz => "control.rate_hz",
        Field::SurfaceRad => "wall.surface_rad",
        Field::CountsPerRev => "encoder.counts_per_rev",
        Field::BadReadings => "encoder.bad_readings",
        Field::PolePairs => "motor.pole_pairs",
        Field::ResistanceOhm => "motor.resistance_ohm",
        Field::InductanceH => "motor.inductance_h",
        Field::TorqueConstantNmPerA => "motor.torque_constant_n_m_per_a",
        Field::CurrentLimitA => "motor.current_limit_a",
        Field::CurrentBandwidthHz => "motor.current_bandwidth_hz",
        Field::FullScaleNm => "drive.analogue_full_scale_n_m",
        Field::BusMinV => "limits.bus_min_v",
        Field::BusMaxV => "limits.bus_max_v",
        Field::TripCurrentA => "limits.trip_current_a",
        Field::DerateFromC => "limits.derate_from_celsius",
        Field::FaultFromC => "limits.fault_from_celsius",
        Field::MaxSpeedRadPerS => "limits.max_speed_rad_per_s",
        Field::FadeInS => "limits.fade_in_s",
        Field::CalibrationCurrentA => "calibration.current_a",
        Field::CalibrationTurnsPerS => "calibration.electrical_turns_per_s",
    }
}

/// The drive's refusal, by the path of the setting in the tree.
#[must_use]
pub fn invalid(error: &SettingsError) -> Invalid {
    match *error {
        SettingsError::Wall(error) => refused(&error),
        SettingsError::OutOfRange {
            field,
            value,
            min,
            max,
        } => {
            let reason = Reason::Outside {
                least: Decimal(min),
                most: Decimal(max),
            };
            Invalid::new(path(field), Decimal(value), reason)
        }
        SettingsError::Rate { rate_hz, pwm_hz } => Invalid::new(
            path(Field::RateHz),
            Decimal::from_num(rate_hz),
            Reason::NoFractionOf(pwm_hz),
        ),
        SettingsError::Coefficient { field, value } => {
            Invalid::new(path(field), Decimal(value), Reason::OutOfFormat)
        }
    }
}

/// `A` with 16 fractional bits as mA, towards minus infinity.
const fn milliamperes(bits: i32) -> i32 {
    // At most 2^31 · 1000 / 2^16 < 2^31.
    ((bits as i64 * 1000) >> 16) as i32
}

impl From<&Record> for Telemetry {
    fn from(record: &Record) -> Self {
        let limit = if record.count < 0 { i32::MIN } else { i32::MAX };
        let phase = Phase::from(record.state);
        Self {
            tick: record.tick,
            count: i32::try_from(record.count).unwrap_or(limit),
            penetration_rad: record.penetration.0,
            force_n_m: record.force.0,
            offset_rad: record.offset.0,
            // From 48 fractional bits to 32, and ±32,768 fits: exact but for the bits that are dropped.
            energy_j: Decimal(
                record
                    .energy
                    .map_or(Si::ZERO, |energy| Si::from_bits(energy.0.to_bits() >> 16)),
            ),
            phase,
            fault: match record.state {
                touchstone_protocol::State::Fault(context) => Fault::from(context).code,
                _ => 0,
            },
            limits: record.limits.to_wire(),
            cycles: record.timing.duration,
            lateness_cycles: record.timing.lateness,
            current_q_ma: milliamperes(record.current.q.to_bits()),
        }
    }
}

impl From<CompactRecord> for RingRecord {
    fn from(record: CompactRecord) -> Self {
        Self {
            tick: record.tick,
            count: record.count,
            force: record.force,
            current_q: record.current,
            lateness_64: record.lateness,
            limits: record.limits.to_wire(),
            phase: record.state,
        }
    }
}

impl From<ResetReason> for touchstone_protocol::ResetReason {
    fn from(reason: ResetReason) -> Self {
        match reason {
            ResetReason::PowerOn => Self::PowerOn,
            ResetReason::BrownOut => Self::BrownOut,
            ResetReason::Pin => Self::Pin,
            ResetReason::Software => Self::Software,
            ResetReason::IndependentWatchdog => Self::IndependentWatchdog,
            ResetReason::WindowWatchdog => Self::WindowWatchdog,
            ResetReason::Panic(place) => Self::Panic(place),
            ResetReason::OptionBytes => Self::OptionBytes,
            ResetReason::LowPower => Self::LowPower,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_of_each_board_are_accepted() {
        for board in Board::ALL {
            let settings = DeviceSettings::defaults(board);
            assert_eq!(checked(&settings, board).map(|_| ()), Ok(()));
        }
    }

    #[test]
    fn a_state_has_one_number_in_the_ring_and_on_the_wire() {
        use touchstone_protocol::State;
        let context = touchstone_protocol::Context {
            code: touchstone_protocol::FaultCode::Panic,
            tick: 0,
            value: 0,
        };
        for state in [
            State::Boot,
            State::Calibrating,
            State::Ready,
            State::Armed,
            State::Fault(context),
            State::Stopped,
        ] {
            let number = usize::from(crate::ring::state_number(state));
            assert_eq!(Phase::ALL.get(number), Some(&Phase::from(state)));
        }
    }
}
