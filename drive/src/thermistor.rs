//! Temperature from a thermistor in a voltage divider, by a table with linear interpolation.

use crate::Celsius;

/// A temperature sensor: a table from the converter's code to the temperature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Thermistor {
    /// Pairs of the converter's code and degrees Celsius, both rising.
    pub points: [(u16, i16); 9],
}

/// A thermistor of 10 kΩ at 25 degrees Celsius, with the constant B = 3,455 K, between supply and converter, and 4.7 kΩ to ground.
/// The converter has 12 bits.
///
/// `R = 10 kΩ exp(B (1/T - 1/298.15 K))`, `code = 4,096 · 4.7 kΩ/(4.7 kΩ + R)`.
pub const NTC_10K_3455_OVER_4K7: Thermistor = Thermistor {
    points: [
        (232, -20),
        (573, 0),
        (1_140, 20),
        (1_844, 40),
        (2_513, 60),
        (3_034, 80),
        (3_393, 100),
        (3_627, 120),
        (3_777, 140),
    ],
};

impl Thermistor {
    /// Table for a board without a temperature sensor: no code gives a temperature.
    pub const NONE: Self = Self {
        points: [(u16::MAX, 0); 9],
    };

    /// The temperature for a converter's code, interpolated linearly between the points.
    ///
    /// `None` beyond the ends of the table: the sensor is broken, shorted, or hotter than any allowed temperature.
    #[must_use]
    pub fn celsius(&self, code: u16) -> Option<Celsius> {
        let mut points = self.points.iter();
        let mut below = points.next()?;
        if code < below.0 {
            return None;
        }
        for above in points {
            if code <= above.0 {
                let span = i32::from(above.0).saturating_sub(i32::from(below.0));
                let rise = i32::from(above.1).saturating_sub(i32::from(below.1));
                let way = i32::from(code).saturating_sub(i32::from(below.0));
                // The product before the shift by 8 may be 2^16 · 2^16, so the calculation has two steps.
                let share = (way << 8).checked_div(span)?;
                let bits =
                    (i32::from(below.1) << 16).saturating_add(rise.saturating_mul(share) << 8);
                return Some(Celsius::from_bits(bits));
            }
            below = above;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(celsius: f64) -> f64 {
        let r = 10_000.0 * (3_455.0 * (1.0 / (celsius + 273.15) - 1.0 / 298.15)).exp();
        4_096.0 * 4_700.0 / (4_700.0 + r)
    }

    #[test]
    fn the_table_is_the_thermistor() {
        for (shown, celsius) in NTC_10K_3455_OVER_4K7.points {
            assert!(
                (f64::from(shown) - code(f64::from(celsius))).abs() < 1.0,
                "{celsius}: {}",
                code(f64::from(celsius))
            );
        }
        for celsius in -20..139 {
            let exact = f64::from(celsius) + 0.5;
            let shown = NTC_10K_3455_OVER_4K7
                .celsius(code(exact).round() as u16)
                .unwrap();
            // The error of a straight line between points 20 degrees apart. This error is smallest in the range of the temperature
            // limits.
            let bound = if (20.0..100.0).contains(&exact) {
                1.0
            } else {
                2.0
            };
            assert!(
                (shown.to_num::<f64>() - exact).abs() < bound,
                "{exact}: {shown}"
            );
        }
    }

    #[test]
    fn a_broken_sensor_has_no_temperature() {
        for code in [0, 231, 3_778, 4_095, u16::MAX] {
            assert_eq!(NTC_10K_3455_OVER_4K7.celsius(code), None, "{code}");
        }
    }
}
