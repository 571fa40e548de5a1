//! Detects when the zero of the angles in a board's records changes: after a reset of the board, and after a calibration.

use touchstone_protocol::{Phase, Telemetry};

/// If the control periods of two successive records are further apart than this, s, the board was reset. Lost records cannot be the
/// cause: without telemetry, reception ends much earlier.
const LONGEST_GAP_S: u32 = 10;

/// How the angle of a record relates to earlier angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Angles {
    /// The angle has the same zero as the angles before.
    Same,
    /// A calibration is turning the shaft.
    Calibrating,
    /// A calibration has set a new zero.
    Calibrated,
    /// The board was reset: it has its stored settings and a new zero.
    Reset {
        /// Number of the control period of the last record before the reset.
        before: u32,
    },
}

/// Detects a change of zero by comparing each record with the one before.
#[derive(Debug, Clone, Copy)]
pub struct Zero {
    most_ticks: u32,
    before: Option<(u32, Phase)>,
}

impl Zero {
    /// Creates the detector for a board with this control rate.
    pub const fn new(rate_hz: u32) -> Self {
        Self {
            most_ticks: rate_hz.saturating_mul(LONGEST_GAP_S),
            before: None,
        }
    }

    /// Compares a record with the one before.
    pub fn see(&mut self, record: &Telemetry) -> Angles {
        let before = self.before.replace((record.tick, record.phase));
        // A reset sets the number of the control period to 0. The wrapped difference from the number before is then a large gap.
        match before {
            Some((before, _)) if record.tick.wrapping_sub(before) > self.most_ticks => {
                Angles::Reset { before }
            }
            _ if record.phase == Phase::Calibrating => Angles::Calibrating,
            Some((_, Phase::Calibrating)) => Angles::Calibrated,
            _ => Angles::Same,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Angles, Zero};
    use fixed::types::I8F24;
    use touchstone_protocol::{Decimal, Phase, Telemetry};

    #[test]
    fn resets_and_calibrations_are_seen() {
        let mut zero = Zero::new(10_000);
        let any = Telemetry {
            tick: 0,
            count: 0,
            penetration_rad: I8F24::ZERO,
            since_change_rad: I8F24::ZERO,
            force_n_m: I8F24::ZERO,
            offset_rad: I8F24::ZERO,
            energy_j: Decimal::lit("0"),
            phase: Phase::Boot,
            fault: 0,
            limits: 0,
            cycles: 0,
            lateness_cycles: 0,
            current_q_ma: 0,
            measuring: None,
        };
        let mut see = |tick, phase| zero.see(&Telemetry { tick, phase, ..any });
        for (tick, phase, seen) in [
            (5_000, Phase::Boot, Angles::Same),
            (5_040, Phase::Calibrating, Angles::Calibrating),
            (9_000, Phase::Calibrating, Angles::Calibrating),
            (9_040, Phase::Ready, Angles::Calibrated),
            (9_080, Phase::Armed, Angles::Same),
            // Two seconds of lost records are no reset.
            (29_080, Phase::Armed, Angles::Same),
            (400, Phase::Boot, Angles::Reset { before: 29_080 }),
            (440, Phase::Boot, Angles::Same),
            // The wrap from `u32::MAX` to 39 is no reset. The last entry is a reset after days.
            (u32::MAX, Phase::Boot, Angles::Reset { before: 440 }),
            (39, Phase::Boot, Angles::Same),
            (u32::MAX - 5, Phase::Boot, Angles::Reset { before: 39 }),
            (
                200_000,
                Phase::Boot,
                Angles::Reset {
                    before: u32::MAX - 5,
                },
            ),
        ] {
            assert_eq!(see(tick, phase), seen, "{tick} {phase:?}");
        }
    }
}
