//! Finds suspicious features of a recorded hand motion, and reports each with the number that shows it.

use super::recording::Recording;
use std::f64::consts::TAU;

/// Speed above which a recording is reported as faster than any hand, rad/s. A wrist reaches some 25 rad/s.
const FASTEST_RAD_PER_S: f64 = 60.0;
/// Range of angles above which a recording is reported, rad: two turns. A slow motion whose degrees were read as radians is
/// noticed by its range, not by its speed.
const WIDEST_RAD: f64 = 2.0 * TAU;
/// Shortest time over which a speed is computed, s. Over less time, one step of the sensor would look like a fast motion.
const OVER_S: f64 = 5e-3;
/// First time stamp of a recording above which the time column is taken for calendar time (seconds since an epoch), s: 11 days.
const EPOCH_S: f64 = 1e6;
/// Shortest time between two samples that is reported as a gap in the recording, s. In a longer gap a hand may have moved out and
/// back without a sample.
const GAP_S: f64 = 0.1;

impl Recording {
    /// Warnings on suspicious features of the recording, one line each; empty if there is none.
    #[must_use]
    pub fn odd(&self) -> Vec<String> {
        [
            self.epoch(),
            self.gap(),
            self.bursts(),
            self.wraps(),
            self.speed().or_else(|| self.range()),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    fn epoch(&self) -> Option<String> {
        let begins_s = self.begins_s();
        (begins_s.abs() > EPOCH_S).then(|| {
            format!("times begin at {begins_s:.3} s, such as those of a clock; the recording's time counts from there")
        })
    }

    fn gap(&self) -> Option<String> {
        let times = self.times_s();
        let (after, longest) = times
            .windows(2)
            .map(|pair| (pair[0], pair[1] - pair[0]))
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        let usual = self.interval_s();
        (longest > GAP_S && longest > 10.0 * usual).then(|| {
            format!("a gap of {longest:.3} s after {after:.3} s, where the usual interval is {usual:.6} s: the hand's motion in it is a guess")
        })
    }

    fn bursts(&self) -> Option<String> {
        let mean = self.length_s() / (self.times_s().len() - 1) as f64;
        let usual = self.interval_s();
        let is_burst = self.times_s().len() > 10 && usual < 0.25 * mean && mean < GAP_S;
        is_burst.then(|| {
            format!("samples come in bursts, {usual:.3e} s apart where {mean:.3e} s is the mean: check that the times are those of the measurement, not of the transfer")
        })
    }

    fn wraps(&self) -> Option<String> {
        let jump = |pair: &[f64]| (pair[1] - pair[0]).abs();
        let is_wrap = |jump: f64| (jump - TAU).abs() < 0.1 * TAU;
        let wraps = self
            .angles_rad()
            .windows(2)
            .filter(|pair| is_wrap(jump(pair)));
        let wraps = wraps.count();
        (wraps > 0).then(|| {
            format!("the angle jumps by a whole turn between two samples, {wraps} times: unwrap it")
        })
    }

    fn speed(&self) -> Option<String> {
        let (times, angles) = (self.times_s(), self.angles_rad());
        let mut worst = (0.0, 0.0);
        let mut from = 0;
        for to in 1..times.len() {
            // The last sample that is at least OVER_S before the sample `to`.
            while from + 1 < to && times[to] - times[from + 1] >= OVER_S {
                from += 1;
            }
            let speed = (angles[to] - angles[from]).abs() / (times[to] - times[from]).max(OVER_S);
            if speed > worst.0 {
                worst = (speed, times[to]);
            }
        }
        (worst.0 > FASTEST_RAD_PER_S).then(|| {
            format!(
                "{:.0} rad/s near {:.3} s is faster than a hand: check for a bad sample, or whether {} is in another unit, such as degrees",
                worst.0, worst.1, self.angle()
            )
        })
    }

    fn range(&self) -> Option<String> {
        let angles = self.angles_rad();
        let low = angles.iter().copied().fold(f64::INFINITY, f64::min);
        let high = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let range = high - low;
        (range > WIDEST_RAD).then(|| {
            format!(
                "a range of {range:.1} rad is {:.1} turns: check whether {} is in another unit, such as degrees",
                range / TAU,
                self.angle()
            )
        })
    }
}
