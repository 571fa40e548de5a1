//! Measures the noise of a position sensor from encoder counts of a knob at rest.
//!
//! The noise of a record is independent of that of the record before it, a slow drift is not. The noise therefore follows from the
//! differences of neighbouring records, whose variance is twice the noise's. Rounding to whole counts adds a twelfth of a squared
//! count to the variance of a record (Widrow 1956). That holds from a noise of some 0.4 counts on. Less noise is taken for at most
//! 0.41 counts: the value for a knob that rests where two counts meet.

use std::fmt;

/// Fewest records: they give the noise within 5 % (three standard errors).
pub const FEWEST_RECORDS: usize = 3000;
/// Largest range of the counts of a knob at rest with random noise, over the noise's root mean square, beyond [`ROUNDED_COUNTS`]. Of
/// 10^7 normal numbers none is expected to be further than 5.4 from their mean.
const WIDEST: f64 = 12.0;
/// Part of the range that rounding may add, counts.
const ROUNDED_COUNTS: f64 = 2.0;

/// Distances in records over which the differences' variance is compared with that of neighbours: half a period of 50 Hz mains hum
/// is 10 records at 1 kHz and 100 at 10 kHz.
const DISTANCES: [usize; 6] = [2, 4, 8, 16, 32, 64];
/// Largest ratio of these variances. Random noise gives 1, within 0.2 for [`FEWEST_RECORDS`].
const CORRELATED: f64 = 1.5;
/// Variance that a count adds at any distance if it flickers slowly between two values, counts squared.
const FLICKER: f64 = 0.25;

/// Reason why no noise can be measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotAtRest {
    /// There are fewer records than [`FEWEST_RECORDS`].
    Short(usize),
    /// The counts have this range, which is wider than noise explains that is random from record to record.
    Wide(f64),
    /// Neighbouring records differ less than distant ones.
    Correlated,
}

impl fmt::Display for NotAtRest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short(records) => {
                write!(
                    f,
                    "has {records} records, at least {FEWEST_RECORDS} are needed"
                )
            }
            Self::Wide(counts) => {
                write!(
                    f,
                    "its counts range over {counts}, which random noise does not explain: the knob is not at rest, single records are wrong, or its noise is not random from record to record (hum, a filtered encoder)"
                )
            }
            Self::Correlated => f.write_str(
                "its noise is not random from record to record (hum, a filtered encoder), or the knob trembles",
            ),
        }
    }
}

/// Root mean square of the noise, in counts.
///
/// # Errors
/// The counts are too few, or too wide apart for random noise.
pub fn rms_counts(counts: &[f64]) -> Result<f64, NotAtRest> {
    if counts.len() < FEWEST_RECORDS {
        return Err(NotAtRest::Short(counts.len()));
    }
    let variance_at = |distance: usize| {
        let pairs = counts.iter().zip(&counts[distance..]);
        let squares: f64 = pairs.map(|(one, other)| (other - one).powi(2)).sum();
        squares / (counts.len() - distance) as f64 / 2.0
    };
    let variance = variance_at(1);
    let rms = (variance - 1.0 / 12.0).max(0.0).sqrt();
    let low = counts.iter().copied().fold(f64::INFINITY, f64::min);
    let high = counts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if high - low > WIDEST * rms + ROUNDED_COUNTS {
        return Err(NotAtRest::Wide(high - low));
    }
    let most = CORRELATED * variance + FLICKER;
    match DISTANCES.into_iter().any(|it| variance_at(it) > most) {
        true => Err(NotAtRest::Correlated),
        false => Ok(rms),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;
    use touchstone_sim::run::chain::{Channel, Stream};

    /// Counts of a knob that turns by `turned` counts in all, read with noise.
    fn recorded(rms: f64, turned: f64, seed: u32) -> Vec<f64> {
        let mut stream = Stream::new(seed, Channel::Sensor);
        let of = |index| {
            let angle = 0.3 + turned * f64::from(index) / 10_000.0;
            (angle + rms * stream.normal()).round()
        };
        (0..10_000).map(of).collect()
    }

    #[test]
    fn the_noise_of_a_recording_is_found_through_rounding_and_a_slow_drift() {
        for rms in [0.5, 1.37, 5.0] {
            for (seed, drift) in [(1, 0.0), (2, 1.5)] {
                let found = rms_counts(&recorded(rms, drift, seed)).unwrap();
                // Four standard errors of 10,000 differences, sqrt(3/(4 n)) of the value each.
                assert!((found / rms - 1.0).abs() < 0.035, "{rms}: {found}");
            }
        }
    }

    #[test]
    fn noise_below_half_a_count_is_never_overrated_by_more_than_half_a_count() {
        for rms in [0.0, 0.05, 0.2] {
            let found = rms_counts(&recorded(rms, 0.0, 3)).unwrap();
            assert!(found < 0.5, "{rms}: {found}");
        }
        // Where two counts meet, each record is either.
        let flickering: Vec<f64> = recorded(5.0, 0.0, 4);
        let flickering: Vec<f64> = flickering.iter().map(|it| it.rem_euclid(2.0)).collect();
        let found = rms_counts(&flickering).unwrap();
        assert!((found - (1.0_f64 / 6.0).sqrt()).abs() < 0.02, "{found}");
    }

    #[test]
    fn hum_an_outlier_and_a_filter_are_no_random_noise_but_a_warming_sensor_is() {
        // 50 Hz at 1, 5 and 10 kHz.
        for (rate_hz, amplitude) in [(1e3, 1.0), (1e3, 3.0), (5e3, 1.0), (10e3, 2.0)] {
            let hum = |(index, count): (u32, f64)| {
                let turns = 50.0 * f64::from(index) / rate_hz;
                count + (amplitude * (TAU * turns).sin()).round()
            };
            let hum: Vec<f64> = (0..).zip(recorded(0.5, 0.0, 10)).map(hum).collect();
            assert_eq!(rms_counts(&hum), Err(NotAtRest::Correlated), "{rate_hz}");
        }
        let mut outlier = recorded(1.37, 0.0, 7);
        outlier[5000] += 50.0;
        assert!(matches!(rms_counts(&outlier), Err(NotAtRest::Wide(_))));
        let mut filtered = 0.0;
        let filter = |count: f64| {
            filtered += 0.02 * (10.0 * count - filtered);
            f64::round(filtered)
        };
        let filtered: Vec<f64> = recorded(1.37, 0.0, 8).into_iter().map(filter).collect();
        assert!(matches!(rms_counts(&filtered), Err(NotAtRest::Wide(_))));
        // A drift that slows down, as that of a sensor that warms up.
        let warm = |(index, count)| count + 4.0 * (1.0 - f64::exp(-f64::from(index) / 3e3));
        let warm: Vec<f64> = (0_u32..).zip(recorded(1.37, 0.0, 9)).map(warm).collect();
        assert!((rms_counts(&warm).unwrap() / 1.37 - 1.0).abs() < 0.035);
    }

    #[test]
    fn a_knob_that_turns_and_a_short_recording_are_refused() {
        assert!(matches!(
            rms_counts(&recorded(1.37, 60.0, 5)),
            Err(NotAtRest::Wide(counts)) if counts > 60.0
        ));
        assert_eq!(
            rms_counts(&recorded(1.37, 0.0, 6)[..100]),
            Err(NotAtRest::Short(100))
        );
    }
}
