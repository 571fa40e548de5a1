//! Turns recorded samples at uneven times into a smooth curve, without adding motion that the samples lack.
//!
//! In the first step, a monotone cubic joins the samples (PCHIP by Fritsch and Carlson, with the harmonic mean of the neighbouring
//! slopes). The curve passes through every sample, has a continuous slope, and stays between neighbouring samples. A natural spline
//! or a windowed sinc would ring on every step of the sensor.
//!
//! In the second step, a Gaussian low-pass removes the sensor's steps. Voluntary motion ends near 10 Hz, so a cut-off at 20 Hz
//! keeps it. All weights of the Gaussian are positive, so the filter neither rings nor overshoots, and it has no delay. The filter
//! also prevents aliasing if the recording is faster than the control rate.

use std::f64::consts::{LN_2, PI};

/// Cut-off frequency (-3 dB) of the Gaussian low-pass for recordings, Hz. The filter reduces an amplitude by 0.3 % at 2 Hz and by
/// 2.1 % at 5 Hz; at 100 Hz a fraction of 2e-4 remains.
pub const SMOOTHING_HZ: f64 = 20.0;

/// Largest time step of the smoothed curve, s. The standard deviation of the Gaussian low-pass is about seven such steps.
const STEP_S: f64 = 1e-3;

/// Largest number of stored steps in a smoothed curve: an hour in steps of 1 ms, 29 MB.
pub(super) const MOST_STEPS: f64 = 3.6e6;

/// Smallest time step of the smoothed curve, s. A hand has no motion above 5 kHz, half the rate of such steps. The cost of the
/// low-pass grows with the inverse square of the step.
const FINEST_S: f64 = 1e-4;

/// Largest number of stored steps in a curve with a time step shorter than [`STEP_S`].
const MOST_FINE_STEPS: f64 = 6e5;

/// Time step of the smoothed curve for a recording, s: the mean sample interval, from [`FINEST_S`] to [`STEP_S`], and longer than
/// the mean where [`MOST_FINE_STEPS`] requires it. The mean is used because samples may come in bursts.
pub(super) fn step_s(length_s: f64, samples: usize) -> f64 {
    let mean_s = length_s / samples.saturating_sub(1).max(1) as f64;
    mean_s
        .max(FINEST_S)
        .max(length_s / MOST_FINE_STEPS)
        .min(STEP_S)
}

/// A smooth curve over time, stored at equal steps from time 0. Outside the stored time, the first or last value holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    step_s: f64,
    values: Vec<f64>,
}

impl Curve {
    /// Makes a smooth curve through samples of any unit. `times_s` rises from 0 and has at least two entries.
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

    /// The curve's value at a time in s, interpolated between the stored steps.
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

    /// Lowest and highest value of the curve.
    pub fn range(&self) -> (f64, f64) {
        self.values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(*v), high.max(*v))
            })
    }

    /// Fraction of the time (0 to 1) in which the curve lies above a level.
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

/// Applies the Gaussian low-pass to values at steps of `step_s`; beyond the ends it repeats the first and last value.
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

/// Monotone cubic interpolation (PCHIP) through samples at rising times.
struct Monotone<'a> {
    times: &'a [f64],
    values: &'a [f64],
    slopes: Vec<f64>,
}

impl<'a> Monotone<'a> {
    fn new(times: &'a [f64], values: &'a [f64]) -> Self {
        let last = times.len() - 1;
        // At the first and last sample the slope is 0, which joins smoothly to the constant before and after.
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

/// Slope of the monotone cubic at a sample, from the intervals and rises before and after the sample. It is 0 where the samples
/// turn back, otherwise a weighted harmonic mean of the neighbouring slopes.
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

/// Cubic Hermite interpolation between two values with given slopes. `share` is the fraction (0 to 1) of the interval, `length` its
/// length.
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
