//! Depth and force of a run on a device, one value per control period. Also finds the times at which a hand is in the wall or rests
//! in it.

use super::press::DesiredStiffness;
use std::ops::Range;

/// A recorded tick (control period) in SI units: position that was read, force commanded from then on, and surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TouchedTick {
    /// Number of control periods since the first tick. Neighbouring ticks differ by more than one if ticks were missed.
    pub due: u64,
    /// Position of the effector that was read, m.
    pub position_m: [f64; 3],
    /// Force that was commanded to the motors, N.
    pub force_n: [f64; 3],
    /// Depth of the position below the surface, m; negative outside.
    pub depth_m: f64,
    /// Unit vector that points out of the surface.
    pub normal: [f64; 3],
}

/// Largest motion of a resting hand, in position counts. The hand also counts as resting if it moves by less than the fraction
/// `RESTING_SHARE` of its depth.
pub const RESTING_COUNTS: f64 = 4.0;
const RESTING_SHARE: f64 = 0.02;

/// Depth and force of a run, one value per control period. The depth of a missed tick is interpolated; its force is that of the
/// recorded tick before.
pub struct TouchedSeries {
    first: u64,
    /// Depth below the surface at each tick, m.
    pub depth: Vec<f64>,
    /// Depth in the middle of each tick, during which the force is constant, m.
    pub middle: Vec<f64>,
    /// Force during each tick, N, positive out of the surface.
    pub out: Vec<f64>,
}

/// Scalar product of two vectors.
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

impl TouchedSeries {
    /// Builds the series from recorded ticks.
    pub fn of(ticks: &[TouchedTick]) -> Self {
        let mut series = Self {
            first: ticks.first().map_or(0, |tick| tick.due),
            depth: Vec::new(),
            middle: Vec::new(),
            out: Vec::new(),
        };
        for pair in ticks.windows(2) {
            let [here, next] = pair else { continue };
            let out = dot(here.force_n, here.normal);
            let intervals = next.due.saturating_sub(here.due).max(1);
            let step = (next.depth_m - here.depth_m) / intervals as f64;
            for i in 0..intervals {
                let at = here.depth_m + step * i as f64;
                series.depth.push(at);
                series.middle.push(at + 0.5 * step);
                series.out.push(out);
            }
        }
        series
    }

    /// Index in the series of a tick, given as control periods since the start.
    pub fn index(&self, due: u64) -> usize {
        (due.saturating_sub(self.first) as usize).min(self.out.len())
    }

    /// Ranges of contact that have at least `least` ticks and are deep enough to measure a stiffness.
    pub fn contacts(
        &self,
        from: usize,
        stiffness: &DesiredStiffness,
        least: usize,
    ) -> Vec<Range<usize>> {
        let touched =
            |i: usize| self.out[i] > 0.0 && stiffness.off(self.middle[i], self.out[i]).is_some();
        let mut found = Vec::new();
        let mut start = from;
        for i in from..=self.out.len() {
            if i == self.out.len() || !touched(i) {
                if i - start >= least {
                    found.push(start..i);
                }
                start = i + 1;
            }
        }
        found
    }

    /// Speed into the surface, averaged over the last `intervals` ticks (control periods), m/s.
    pub fn speed(&self, index: usize, intervals: usize, rate_hz: f64) -> f64 {
        let was = index.saturating_sub(intervals);
        match index > was {
            true => (self.depth[index] - self.depth[was]) * rate_hz / (index - was) as f64,
            false => 0.0,
        }
    }
}

/// Ranges of `length` ticks within a contact in which the hand rests.
pub fn resting(
    depth: &[f64],
    contact: &Range<usize>,
    length: usize,
    count: f64,
) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    let mut from = contact.start;
    while from + length <= contact.end {
        let part = &depth[from..from + length];
        let low = part.iter().copied().fold(f64::INFINITY, f64::min);
        let high = part.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if high - low <= (RESTING_COUNTS * count).max(RESTING_SHARE * high) {
            found.push(from..from + length);
        }
        from += (length / 4).max(1);
    }
    found
}
