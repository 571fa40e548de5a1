//! From samples at any times to a curve at any time, without inventing motion.
//!
//! Two steps. Between the samples a monotone cubic (PCHIP: Fritsch and Carlson, with the harmonic mean of the
//! neighbouring slopes): it passes through every sample, its slope is continuous, and it never leaves the range of
//! its two neighbours. A natural spline or a windowed sinc would ring on every step of the sensor. Then a Gaussian
//! low-pass: the sensor's steps are no motion, and as voluntary motion ends near 10 Hz nothing is lost above 20 Hz.
//! The Gaussian's weights are all positive, so it cannot ring nor overshoot either, it has no delay, and it is the
//! anti-alias filter where the recording is faster than the control rate.

use std::f64::consts::{LN_2, PI};

/// Frequency at which the low-pass has taken 3 dB, Hz. At 2 Hz it takes 0.3 %, at 5 Hz 2.1 %, at 100 Hz all but 2e-4.
pub const SMOOTHING_HZ: f64 = 20.0;

/// Coarsest step of the smoothed curve, s: seven steps to a standard deviation of the low-pass.
const STEP_S: f64 = 1e-3;

/// Most steps of a curve: an hour in milliseconds, 29 MB.
pub(super) const MOST_STEPS: f64 = 3.6e6;

/// Finest step, s. Above half its rate a recording has no motion of a hand, and the low-pass costs the square of the
/// step's inverse.
const FINEST_S: f64 = 1e-4;

/// Steps of a curve that is smoothed in steps of less than [`STEP_S`].
const MOST_FINE_STEPS: f64 = 6e5;

/// Step for a recording of this length with this many samples, s: the mean interval, as samples may come in bursts.
pub(super) fn step_s(length_s: f64, samples: usize) -> f64 {
    let mean_s = length_s / samples.saturating_sub(1).max(1) as f64;
    mean_s
        .max(FINEST_S)
        .max(length_s / MOST_FINE_STEPS)
        .min(STEP_S)
}

/// A smooth curve over time, given at equal steps from time 0; constant before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    step_s: f64,
    values: Vec<f64>,
}

impl Curve {
    /// Smooth curve through samples at rising times (at least two, the first at time 0), all in s; values in any unit.
    pub fn smooth(times_s: &[f64], values: &[f64]) -> Self {
        let last = times_s.last().copied().unwrap_or(0.0);
        let step_s = step_s(last, times_s.len());
        let through = Monotone::new(times_s, values);
        let steps = (last / step_s).ceil() as usize + 1;
        let dense: Vec<f64> = (0..steps)
            .map(|i| through.at((i as f64 * step_s).min(last)))
            .collect();
        Curve {
            step_s,
            values: low_pass(&dense, step_s),
        }
    }

    /// The value at a time.
    pub fn at(&self, time_s: f64) -> f64 {
        let place = (time_s / self.step_s).clamp(0.0, (self.values.len() - 1) as f64);
        let left = (place as usize).min(self.values.len().saturating_sub(2));
        let slope = |i: usize| {
            if i == 0 || i + 1 >= self.values.len() {
                return 0.0;
            }
            monotone_slope(
                1.0,
                self.values[i] - self.values[i - 1],
                1.0,
                self.values[i + 1] - self.values[i],
            )
        };
        match self.values.get(left + 1) {
            Some(right) => hermite(
                place - left as f64,
                1.0,
                self.values[left],
                *right,
                slope(left),
                slope(left + 1),
            ),
            None => self.values[left],
        }
    }

    /// Lowest and highest value.
    pub fn range(&self) -> (f64, f64) {
        self.values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(*v), high.max(*v))
            })
    }

    /// Share of the time above a level, 0 to 1.
    pub fn share_above(&self, level: f64) -> f64 {
        self.values.iter().filter(|value| **value > level).count() as f64 / self.values.len() as f64
    }
}

/// Median interval between samples, s.
pub(super) fn median_interval_s(times_s: &[f64]) -> f64 {
    let mut intervals: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    intervals.sort_by(f64::total_cmp);
    intervals
        .get(intervals.len() / 2)
        .copied()
        .unwrap_or(STEP_S)
}

/// Gaussian low-pass; the first and last values go on for ever.
fn low_pass(values: &[f64], step_s: f64) -> Vec<f64> {
    // |H| = exp(-(2π f σ)²/2) is 1/√2 where (2π f σ)² = ln 2.
    let sigma = LN_2.sqrt() / (2.0 * PI * SMOOTHING_HZ) / step_s;
    let reach = (4.0 * sigma).ceil() as isize;
    let mut weights: Vec<f64> = (-reach..=reach)
        .map(|i| i as f64 / sigma)
        .map(|x| libm::exp(-0.5 * x * x))
        .collect();
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= total);
    let last = values.len() as isize - 1;
    let around = |i: isize| {
        weights
            .iter()
            .zip(-reach..)
            .map(move |(w, j)| w * values[(i + j).clamp(0, last) as usize])
    };
    (0..=last).map(|i| around(i).sum()).collect()
}

/// Monotone cubic through samples at any rising times.
struct Monotone<'a> {
    times: &'a [f64],
    values: &'a [f64],
    slopes: Vec<f64>,
}

impl<'a> Monotone<'a> {
    fn new(times: &'a [f64], values: &'a [f64]) -> Self {
        let last = times.len() - 1;
        // At the ends the hand rests: slope 0, which also joins the constant before and after.
        let slope = |i: usize| match i {
            0 => 0.0,
            i if i == last => 0.0,
            i => monotone_slope(
                times[i] - times[i - 1],
                values[i] - values[i - 1],
                times[i + 1] - times[i],
                values[i + 1] - values[i],
            ),
        };
        Monotone {
            times,
            values,
            slopes: (0..=last).map(slope).collect(),
        }
    }

    fn at(&self, time: f64) -> f64 {
        let right = self
            .times
            .partition_point(|t| *t <= time)
            .clamp(1, self.times.len() - 1);
        let left = right - 1;
        let length = self.times[right] - self.times[left];
        let share = ((time - self.times[left]) / length).clamp(0.0, 1.0);
        hermite(
            share,
            length,
            self.values[left],
            self.values[right],
            self.slopes[left],
            self.slopes[right],
        )
    }
}

/// Slope at a sample from the intervals and rises before and after it: 0 at a turn, else a weighted harmonic mean.
fn monotone_slope(length_before: f64, rise_before: f64, length_after: f64, rise_after: f64) -> f64 {
    if rise_before * rise_after <= 0.0 {
        return 0.0;
    }
    let (before, after) = (rise_before / length_before, rise_after / length_after);
    let (w_before, w_after) = (
        length_before + 2.0 * length_after,
        2.0 * length_before + length_after,
    );
    (w_before + w_after) / (w_after / before + w_before / after)
}

/// Cubic between two values with given slopes, `share` of the way along an interval of this length.
fn hermite(
    share: f64,
    length: f64,
    left: f64,
    right: f64,
    slope_left: f64,
    slope_right: f64,
) -> f64 {
    let (s, s2) = (share, share * share);
    let step = s2 * (3.0 - 2.0 * s);
    left + (right - left) * step
        + length * (s * (1.0 - s)) * ((1.0 - s) * slope_left - s * slope_right)
}
