//! Compensation of cogging by a stored map: a current that depends on the shaft's position is added to the current that the control
//! law requests.
//!
//! The map's harmonics are summed once, outside the control interrupt, into a table over a turn. In each control period the device
//! interpolates linearly between the table's entries. Three properties bound the map's effect. No entry is more than a quarter of
//! the current limit. The entries add up to zero, so the work over a turn is zero. The table is read at the position that the shaft
//! has when the current acts. `docs/energy-guard.md` states the energy that the map can still give to a hand.

use crate::Amps;
use crate::angle::{Angle, ElectricalScale};
use crate::hardware::Hardware;
use crate::units::{clamp_i32, narrow, quotient};
use fixed::types::I16F16;
use touchstone_control::Si;
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::settings::cogging::{CURRENT_BITS, CoggingMap};

/// Number of table entries per turn, as a power of two. With the usual 84 cogging periods per turn that is 24 entries per period,
/// and linear interpolation errs by at most 0.9 % of the amplitude.
const PLACES_LOG2: u32 = 11;
/// Number of entries in the table of currents, per turn of the shaft.
pub const PLACES: usize = 1 << PLACES_LOG2;
/// Number of low bits of a 16-bit angle that lie between two table entries and are interpolated.
const REST_BITS: u32 = 16 - PLACES_LOG2;
/// The cogging map may use at most the current limit divided by this number. With more, too little current would be left for the
/// wall's force.
pub const SHARE: i32 = 4;

/// The constant `2π`.
const TWO_PI: Si = Si::lit("6.283185307");
/// Mean time in PWM periods from the encoder reading of a control period until the command computed from it acts. The current
/// loop's own lag is not included.
const ACTS_AFTER_PERIODS: i64 = 2;

/// A cogging map prepared for the control interrupt, as a table of currents.
#[derive(Debug, Clone)]
pub struct Played {
    /// Current by position within a turn, in 2^-13 A.
    table: [i16; PLACES],
    scale: ElectricalScale,
    /// Angle per unit of speed by which the table is read ahead of the shaft's position: 2^-16 turns per rad/s.
    lead: I16F16,
}

impl Played {
    /// Calculates the table of currents as the sum of the cogging map's harmonics.
    #[cold]
    #[inline(never)]
    #[must_use]
    pub fn new(map: &CoggingMap, settings: &DeviceSettings, hardware: &Hardware) -> Self {
        let most = narrow(settings.motor.current_limit_a).to_bits() / SHARE;
        let most = i64::from(most >> (16 - CURRENT_BITS)).min(i64::from(i16::MAX));
        let peak = (0..PLACES as u32)
            .map(|place| sum_at(map, place).abs())
            .max();
        let peak = peak.unwrap_or(0).max(1);
        let mut table = [0; PLACES];
        let mut sum = 0;
        for (place, entry) in (0..).zip(&mut table) {
            let value = sum_at(map, place);
            // The whole map is scaled down: if only its peaks were cut off, it would do work over a turn.
            let value = if peak > most {
                value * most / peak
            } else {
                value
            };
            sum += value;
            // The value is within the current limit, so it fits into 16 bits.
            *entry = value as i16;
        }
        level(&mut table, sum);
        Self {
            table,
            scale: ElectricalScale::new(1, settings.encoder.counts_per_rev),
            lead: lead(settings, hardware),
        }
    }

    /// The current that compensates the cogging; positive if its torque acts towards rising counts. Takes the position in counts
    /// from the encoder's zero, and the speed in rad/s.
    #[inline]
    #[must_use]
    pub const fn current(&self, place: i64, rad_per_s: I16F16) -> Amps {
        let ahead = (rad_per_s.to_bits() as i64 * self.lead.to_bits() as i64) >> 32;
        let angle = self.scale.angle(place).0.wrapping_add(ahead as u16);
        let at = (angle >> REST_BITS) as usize;
        let rest = (angle & ((1 << REST_BITS) - 1)) as i32;
        // The indices are always in range: they have 11 bits.
        let (from, to) = (
            self.table[at & (PLACES - 1)] as i32,
            self.table[(at + 1) & (PLACES - 1)] as i32,
        );
        Amps::from_bits(
            ((from << REST_BITS) + (to - from) * rest) >> (CURRENT_BITS + REST_BITS - 16),
        )
    }
}

/// Sum of the cogging map's harmonics at one entry of the table of currents.
fn sum_at(map: &CoggingMap, place: u32) -> i64 {
    let of = |it: &touchstone_protocol::CoggingHarmonic| {
        let angle = Angle((place.wrapping_mul(u32::from(it.order)) << REST_BITS) as u16);
        i64::from(it.cos) * i64::from(angle.cos()) + i64::from(it.sin) * i64::from(angle.sin())
    };
    let sum: i64 = map.harmonics.iter().map(of).sum();
    (sum + (1 << 14)) >> 15
}

/// Shifts the entries so that they add up to zero. Then the interpolated current does no net work over a turn.
fn level(table: &mut [i16; PLACES], sum: i64) {
    let (each, mut rest) = (sum.div_euclid(PLACES as i64), sum.rem_euclid(PLACES as i64));
    for entry in table {
        let more = i64::from(rest > 0);
        rest -= more;
        // Changes entries by a step or two only, because harmonics have no mean. The entries are within a quarter of 16 bits.
        *entry = clamp_i32(i64::from(*entry) - each - more) as i16;
    }
}

/// Angle per unit of speed that the shaft turns from the encoder reading to the middle of the time in which the current acts.
fn lead(settings: &DeviceSettings, hardware: &Hardware) -> I16F16 {
    let of = |parts: i64, rate: Si| quotient(Si::const_from_int(parts), rate);
    let period = of(ACTS_AFTER_PERIODS, Si::saturating_from_num(hardware.pwm_hz));
    let loops = of(
        1,
        settings.motor.current_bandwidth_hz.saturating_mul(TWO_PI),
    );
    let half = of(1, Si::saturating_from_num(settings.timing.rate_hz)) / 2;
    let lead_s = period.saturating_add(loops).saturating_add(half);
    narrow(quotient(
        lead_s.saturating_mul(Si::const_from_int(1 << 16)),
        TWO_PI,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hardware::IHM08M1;
    use core::f64::consts::TAU;
    use touchstone_protocol::CoggingHarmonic;

    const AMPERE: f64 = (1 << CURRENT_BITS) as f64;

    fn map(parts: &[(u8, f64, f64)]) -> CoggingMap {
        CoggingMap {
            harmonics: parts
                .iter()
                .map(|(order, cos, sin)| CoggingHarmonic {
                    order: *order,
                    cos: (cos * AMPERE) as i16,
                    sin: (sin * AMPERE) as i16,
                })
                .collect(),
        }
    }

    fn played(parts: &[(u8, f64, f64)]) -> Played {
        Played::new(&map(parts), &DeviceSettings::default(), &IHM08M1)
    }

    #[test]
    fn a_map_is_the_sum_of_its_harmonics_at_every_count() {
        let parts = [(84, 0.02, -0.01), (12, 0.004, 0.003), (7, 0.0, 0.005)];
        let (played, map) = (played(&parts), map(&parts));
        let mut worst = 0.0_f64;
        for count in -20_000..20_000_i64 {
            let angle = TAU * count as f64 / 16_384.0;
            let of = |it: &CoggingHarmonic| {
                let (sin, cos) = (f64::from(it.order) * angle).sin_cos();
                (f64::from(it.cos) * cos + f64::from(it.sin) * sin) / AMPERE
            };
            let exact: f64 = map.harmonics.iter().map(of).sum();
            let found: f64 = played.current(count, I16F16::ZERO).to_num();
            worst = worst.max((found - exact).abs());
        }
        // The linear interpolation errs by up to 0.83 % of the 22 mA, the rounding to current steps of 0.12 mA by half a step.
        assert!(worst < 3.5e-4, "{worst}");
    }

    #[test]
    fn a_turn_takes_no_work_and_no_map_is_more_than_a_quarter_of_the_limit() {
        // In the second map the peaks of all harmonics meet on one side.
        for parts in [
            &[(84, 0.01, 0.003)][..],
            &[(5, 3.9, 0.0), (10, 3.9, 0.0)][..],
            &[(255, 0.1, 0.1), (1, 0.3, 0.0)][..],
        ] {
            let played = played(parts);
            assert_eq!(played.table.iter().map(|it| i64::from(*it)).sum::<i64>(), 0);
            let most = played.table.iter().map(|it| it.unsigned_abs()).max();
            // A quarter of the 2 A limit, and two steps because the entries were shifted to add up to zero.
            assert!(f64::from(most.unwrap()) <= 0.5 * AMPERE + 2.0, "{most:?}");
        }
    }

    #[test]
    fn it_is_looked_up_where_the_shaft_will_be() {
        let played = played(&[(84, 0.02, 0.0)]);
        // Two PWM periods, the current loop's lag of 0.265 ms, and half a control period.
        let lead_s = 100e-6 + 1.0 / (TAU * 600.0) + 0.5e-3;
        for speed in [-30.0, -5.0, 0.0, 5.0, 30.0] {
            for count in 0..1_000_i64 {
                let angle = TAU * count as f64 / 16_384.0 + speed * lead_s;
                let exact = 0.02 * (84.0 * angle).cos();
                let found: f64 = played.current(count, I16F16::from_num(speed)).to_num();
                // The error of 16-bit angles, 84 · 9.6e-5 rad, and that of the linear interpolation.
                assert!(
                    (found - exact).abs() < 5e-4,
                    "{speed} {count}: {found} {exact}"
                );
            }
        }
    }
}
