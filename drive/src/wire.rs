//! Functions between the serial protocol and the drive: they check received settings and make the records that are sent.

use crate::hardware::{B_G431B_ESC1, Hardware, IHM08M1, IHM16M1, SIMPLEFOC_MINI};
use crate::settings::validate;
use crate::units::milli;
use crate::{CompactRecord, CurrentReport, Record};
use touchstone_control::Si;
use touchstone_protocol::settings::{Decimal, DeviceSettings, SettingsError};
use touchstone_protocol::{
    Board, Fault, MeasuringPart, MeasuringTick, Phase, RingRecord, Telemetry,
};

/// The constants of a board's power stage.
#[must_use]
pub const fn hardware(board: Board) -> &'static Hardware {
    match board {
        Board::NucleoG474re => &IHM08M1,
        Board::BG431bEsc1 => &B_G431B_ESC1,
        Board::NucleoG474reIhm16m1 | Board::NucleoG431rbIhm16m1 => &IHM16M1,
        Board::NucleoG474reSimplefocMini => &SIMPLEFOC_MINI,
    }
}

/// Checks settings, for firmware and computer alike: ranges, the board, the control law, and the power stage.
///
/// # Errors
/// The first setting that is refused.
#[inline]
pub fn checked(settings: &DeviceSettings, board: Board) -> Result<(), SettingsError> {
    settings.validate(board)?;
    validate(settings, hardware(board))
}

/// The values of a motor measurement that are sent beside the telemetry record. They are calculated separately, so that control
/// periods of a wall take no longer.
#[cold]
#[inline(never)]
#[must_use]
pub fn measuring(part: MeasuringPart, report: &CurrentReport) -> MeasuringTick {
    MeasuringTick {
        part,
        current_d_ma: milli(report.current.d),
        voltage_d_mv: milli(report.voltage.d),
        voltage_q_mv: milli(report.voltage.q),
    }
}

impl From<&Record> for Telemetry {
    fn from(record: &Record) -> Self {
        let limit = if record.count < 0 { i32::MIN } else { i32::MAX };
        let phase = Phase::from(record.state);
        Self {
            tick: record.tick,
            count: i32::try_from(record.count).unwrap_or(limit),
            penetration_rad: record.penetration.0,
            since_change_rad: record.since_change.0,
            force_n_m: record.force.0,
            offset_rad: record.offset.0,
            // Converts 48 fractional bits to 32. The range of ±32,768 fits; only the lower bits are lost.
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
            current_q_ma: milli(record.current.q),
            measuring: None,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_of_each_board_are_accepted() {
        for board in Board::ALL {
            let settings = DeviceSettings::defaults(board);
            assert_eq!(checked(&settings, board), Ok(()));
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
