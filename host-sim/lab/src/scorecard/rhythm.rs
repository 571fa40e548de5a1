//! Finds in a depth signal where a person's hand oscillated, and at which frequency.

use touchstone_sim::run::measure::Wiggle;

/// Length of the examined window, s. The starts of two windows are `HOP_S` apart.
const WINDOW_S: f64 = 3.0;
const HOP_S: f64 = 1.5;
/// Lowest and highest frequency of an oscillation that is searched, Hz: two periods in a window, and the limit of hands.
const SLOWEST_HZ: f64 = 2.0 / WINDOW_S;
const FASTEST_HZ: f64 = 16.0;
/// Smallest fraction of the motion's mean square that one sine must explain to count as an oscillation.
const EXPLAINED: f64 = 0.8;
/// Sample rate that is enough for the search, Hz; faster signals are thinned out.
const ENOUGH_HZ: f64 = 200.0;

/// Fits a sine and a constant: returns the fraction of the mean square that the sine explains, and its amplitude.
fn sine(series: &[f64], cycles_per_sample: f64) -> (f64, f64) {
    let count = series.len() as f64;
    let mean = series.iter().sum::<f64>() / count;
    let (mut s, mut c, mut ss, mut cc, mut sc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let (mut xs, mut xc, mut xx) = (0.0, 0.0, 0.0);
    for (index, value) in series.iter().enumerate() {
        let (sin, cos) = (std::f64::consts::TAU * cycles_per_sample * index as f64).sin_cos();
        let x = value - mean;
        (s, c) = (s + sin, c + cos);
        (ss, cc, sc) = (ss + sin * sin, cc + cos * cos, sc + sin * cos);
        (xs, xc, xx) = (xs + x * sin, xc + x * cos, xx + x * x);
    }
    let (ss, cc, sc) = (ss - s * s / count, cc - c * c / count, sc - s * c / count);
    let determinant = ss * cc - sc * sc;
    let (a, b) = (
        (xs * cc - xc * sc) / determinant,
        (xc * ss - xs * sc) / determinant,
    );
    ((a * xs + b * xc) / xx, a.hypot(b))
}

/// Frequency in Hz, explained fraction and amplitude of the sine that explains most.
fn strongest(series: &[f64], rate_hz: f64) -> Option<(f64, f64, f64)> {
    let at = |hz: f64| {
        let (share, amplitude) = sine(series, hz / rate_hz);
        (hz, share, amplitude)
    };
    let best = |from: f64, to: f64, step: f64| {
        let count = ((to - from) / step).round() as usize;
        (0..=count)
            .map(|i| at(from + step * i as f64))
            .filter(|found| found.1.is_finite())
            .max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let coarse = best(SLOWEST_HZ, FASTEST_HZ.min(0.25 * rate_hz), 0.1)?;
    best((coarse.0 - 0.1).max(SLOWEST_HZ), coarse.0 + 0.1, 0.005)
}

/// Windows in which one sine with an amplitude of at least `least` explains most of the motion. `depth` has one value per tick,
/// beginning with tick `first`.
#[must_use]
pub fn rhythms(depth: &[f64], first: u64, rate_hz: f64, least: f64) -> Vec<Wiggle> {
    let window = (WINDOW_S * rate_hz).round() as usize;
    let hop = (HOP_S * rate_hz).round().max(1.0) as usize;
    let every = ((rate_hz / ENOUGH_HZ) as usize).max(1);
    let mut found = Vec::new();
    let mut from = 0;
    while from + window <= depth.len() {
        let part: Vec<f64> = depth[from..from + window]
            .iter()
            .step_by(every)
            .copied()
            .collect();
        let best = strongest(&part, rate_hz / every as f64);
        if let Some((frequency_hz, share, amplitude)) = best
            && share >= EXPLAINED
            && amplitude >= least
        {
            let start = first + from as u64;
            found.push(Wiggle {
                frequency_hz,
                window: (start, start + window as u64),
            });
        }
        from += hop;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(of: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..4000).map(|tick| of(f64::from(tick) * 1e-3)).collect()
    }

    #[test]
    fn a_rhythm_is_found_where_there_is_one() {
        for hz in [0.955, 2.0, 7.3] {
            let sine = |t: f64| 0.003 + 0.001 * (std::f64::consts::TAU * hz * t + 0.4).sin();
            let found = rhythms(&moved(sine), 100, 1000.0, 4e-5);
            // One window of three seconds fits into four.
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].window, (100, 3100));
            assert!((found[0].frequency_hz - hz).abs() < 0.01, "{found:?}");
        }
    }

    #[test]
    fn a_drift_a_tremble_and_two_rhythms_at_once_are_none() {
        let tau = std::f64::consts::TAU;
        assert!(rhythms(&moved(|t| 0.002 * t), 0, 1000.0, 4e-5).is_empty());
        let small = |t: f64| 0.003 + 3e-5 * (tau * 2.0 * t).sin();
        assert!(rhythms(&moved(small), 0, 1000.0, 4e-5).is_empty());
        let two = |t: f64| 1e-3 * ((tau * 1.0 * t).sin() + (tau * 5.2 * t).sin());
        assert!(rhythms(&moved(two), 0, 1000.0, 4e-5).is_empty());
        assert!(rhythms(&moved(|_| 0.003), 0, 1000.0, 4e-5).is_empty());
    }
}
