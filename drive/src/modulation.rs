//! Space-vector modulation: converts a voltage vector to three compare values.
//!
//! The three phase voltages are shifted by half the sum of the largest and the smallest. This gives the same switching times as
//! the method of sectors and dwell times. The voltage between two phases can reach the whole bus voltage, the length of a voltage
//! vector `bus/√3`.

use crate::Volts;
use crate::transform::AlphaBeta;
use crate::units::{clamp_i32, product};

/// The timer's range, and the largest compare value that leaves time to sample the currents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Modulator {
    /// Compare value at which a phase is always at the bus voltage: the timer's reload value.
    pub top: u16,
    /// Largest compare value. Above it the low side is on for too short a time to sample its shunt.
    pub longest: u16,
}

/// The constant `2^16 · √3/2`, rounded.
const HALF_ROOT_3: i32 = 56_756;
/// The constant `2^16/√3`, rounded down.
const ONE_OVER_ROOT_3: i64 = 37_837;

impl Modulator {
    /// Compare values for zero voltage at the motor: all phases are at the bus voltage half of the time.
    #[must_use]
    pub const fn zero(&self) -> [u16; 3] {
        [self.top / 2; 3]
    }

    /// Length of the longest voltage vector that the compare range allows, as a fraction of the bus voltage in 1/65,536: `(2
    /// longest/top - 1)/√3`.
    #[must_use]
    pub const fn share(&self) -> i32 {
        let span = 2 * self.longest as i64 - self.top as i64;
        if self.top == 0 || span <= 0 {
            return 0;
        }
        // One step less than the quotient, so that rounding never exceeds the compare range.
        clamp_i32(span * ONE_OVER_ROOT_3 / self.top as i64 - 1)
    }

    /// Compare values for a voltage vector at the bus voltage `bus`, each within `top - longest ..= longest`.
    ///
    /// A bus voltage of 1 V or less gives zero voltage.
    #[inline]
    #[must_use]
    pub fn duties(&self, v: AlphaBeta, bus: Volts) -> [u16; 3] {
        // `scale` below is in counts per volt with 7 fractional bits: one division of 32 bits.
        let divisor = bus.to_bits().max(0).unsigned_abs() >> 8;
        if divisor <= 256 {
            return self.zero();
        }
        // The scale is below 2^31 / 2^8.
        let scale = ((u32::from(self.top) << 15) / divisor).cast_signed();
        // Calculated in half volts, so that all values down to the products fit 32 bits: no phase exceeds 0.69 · 2^31.
        let half_alpha = v.alpha.to_bits() >> 1;
        let sideways = product(v.beta.to_bits(), HALF_ROOT_3, 17);
        let a = half_alpha;
        let b = sideways.wrapping_sub(half_alpha >> 1);
        let c = sideways.wrapping_neg().wrapping_sub(half_alpha >> 1);
        let common = (a.max(b).max(c) >> 1).wrapping_add(a.min(b).min(c) >> 1);
        let middle = i64::from(self.top) << 21;
        let (least, most) = (
            i32::from(self.top.saturating_sub(self.longest)),
            i32::from(self.longest),
        );
        [a, b, c].map(|phase| {
            let wide = i64::from(phase.wrapping_sub(common)) * i64::from(scale);
            let count = clamp_i32((middle + wide + (1 << 21)) >> 22);
            // The result fits into u16, because `most` does.
            count.min(most).max(least) as u16
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transform::{Dq, Rotation};
    use crate::{Angle, units::product};
    use fixed::types::I16F16;

    const TIMER: Modulator = Modulator {
        top: 4_250,
        longest: 4_080,
    };

    fn value(x: f64) -> I16F16 {
        I16F16::from_num(x)
    }

    #[test]
    fn the_average_of_a_period_is_the_vector() {
        let bus = 24.0;
        let longest = f64::from(product(value(bus).to_bits(), TIMER.share(), 16)) / 65_536.0;
        assert!((12.7..12.8).contains(&longest), "{longest}");
        for bits in (0..=u16::MAX).step_by(61) {
            for size in [0.0, 0.01, 3.0, longest] {
                let v = Rotation::of(Angle(bits)).back(Dq {
                    d: value(size),
                    q: value(0.0),
                });
                let duties = TIMER.duties(v, value(bus)).map(f64::from);
                let [a, b, c] = duties.map(|d| d / 4_250.0 * bus);
                let (alpha, beta) = ((2.0 * a - b - c) / 3.0, (b - c) / 3f64.sqrt());
                // Errors: half a compare count of 5.6 mV, 1.3e-4 of the sine table, 4e-5 of the scale.
                assert!(
                    (alpha - v.alpha.to_num::<f64>()).abs() < 0.006,
                    "{bits} {size}: {duties:?}"
                );
                assert!(
                    (beta - v.beta.to_num::<f64>()).abs() < 0.006,
                    "{bits} {size}: {duties:?}"
                );
                assert!(duties.iter().all(|d| (170.0..=4_080.0).contains(d)));
            }
        }
    }

    #[test]
    fn zero_is_half_and_no_bus_is_zero() {
        let zero = AlphaBeta::default();
        assert_eq!(TIMER.duties(zero, value(24.0)), [2_125; 3]);
        assert_eq!(TIMER.zero(), [2_125; 3]);
        let v = AlphaBeta {
            alpha: value(5.0),
            beta: value(0.0),
        };
        for bus in [I16F16::MIN, value(-24.0), value(0.0), value(1.0)] {
            assert_eq!(TIMER.duties(v, bus), [2_125; 3]);
        }
    }

    #[test]
    fn whatever_comes_in_the_range_is_kept() {
        let ends = [
            I16F16::MIN,
            value(-3.0),
            value(0.0),
            value(7.5),
            I16F16::MAX,
        ];
        for alpha in ends {
            for beta in ends {
                for bus in ends {
                    let duties = TIMER.duties(AlphaBeta { alpha, beta }, bus);
                    assert!(
                        duties.iter().all(|d| (170..=4_080).contains(d)),
                        "{duties:?}"
                    );
                }
            }
        }
        let odd = Modulator { top: 0, longest: 0 };
        assert_eq!(odd.duties(AlphaBeta::default(), value(24.0)), [0; 3]);
        assert_eq!(odd.share(), 0);
    }
}
