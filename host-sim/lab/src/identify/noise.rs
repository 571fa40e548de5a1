//! Measures the noise of a position sensor from encoder counts of a knob at rest.
//!
//! The noise of a record is independent of that of the record before it, a slow drift is not. The noise therefore follows from the
//! differences of neighbouring records, whose variance is twice the noise's. Rounding to whole counts adds a twelfth of a squared
//! count to the variance of a record (Widrow 1956). That holds from a noise of some 0.4 counts on. Less noise is taken for at most
//! 0.41 counts: the value for a knob that rests where two counts meet.

use std::fmt;

/// Fewest records: they give the noise within 5 % (three standard errors).
pub const FEWEST_RECORDS: usize = 3000;
/// Largest range of the counts of a knob at rest, over the noise's root mean square, beyond [`ROUNDED_COUNTS`]. Of 10^7 normal
/// numbers none is expected to be further than 5.4 from their mean.
const WIDEST: f64 = 12.0;
/// Part of the range that rounding may add, counts.
const ROUNDED_COUNTS: f64 = 2.0;

/// Reason why no noise can be measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotAtRest {
    /// There are fewer records than [`FEWEST_RECORDS`].
    Short(usize),
    /// The knob turned by this number of counts, which is more than noise explains.
    Turned(f64),
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
            Self::Turned(counts) => {
                write!(f, "the knob is not at rest: it turns by {counts} counts")
            }
        }
    }
}

/// Root mean square of the noise, in counts.
///
/// # Errors
/// The counts are too few, or those of a knob that turns.
pub fn rms_counts(counts: &[f64]) -> Result<f64, NotAtRest> {
    if counts.len() < FEWEST_RECORDS {
        return Err(NotAtRest::Short(counts.len()));
    }
    let differences = counts.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    let variance = differences.sum::<f64>() / (counts.len() - 1) as f64 / 2.0;
    let rms = (variance - 1.0 / 12.0).max(0.0).sqrt();
    let low = counts.iter().copied().fold(f64::INFINITY, f64::min);
    let high = counts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match high - low > WIDEST * rms + ROUNDED_COUNTS {
        true => Err(NotAtRest::Turned(high - low)),
        false => Ok(rms),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
    fn a_knob_that_turns_and_a_short_recording_are_refused() {
        assert!(matches!(
            rms_counts(&recorded(1.37, 60.0, 5)),
            Err(NotAtRest::Turned(counts)) if counts > 60.0
        ));
        assert_eq!(
            rms_counts(&recorded(1.37, 0.0, 6)[..100]),
            Err(NotAtRest::Short(100))
        );
    }
}
