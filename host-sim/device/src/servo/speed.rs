//! The speed as the servo loop itself estimates it. The omega.3 library's speed is by default a mean over 20 ms, and some devices
//! report none.

/// Length of the window over which the speed is estimated, s.
const WINDOW_S: f64 = 4e-3;

/// An estimate of the speed: the slope of a least-squares line through the last positions.
#[derive(Debug, Clone)]
pub struct SpeedEstimate {
    interval_s: f64,
    window: Vec<[f64; 3]>,
    next: usize,
    filled: usize,
}

impl SpeedEstimate {
    /// An estimate of the speed from positions that come at this rate, Hz.
    #[must_use]
    pub fn new(rate_hz: u32) -> Self {
        let ticks = (WINDOW_S * f64::from(rate_hz)).ceil().max(2.0) as usize;
        Self {
            interval_s: 1.0 / f64::from(rate_hz),
            window: vec![[0.0; 3]; ticks],
            next: 0,
            filled: 0,
        }
    }

    /// Adds a position and returns the speed, m/s; 0 until the window is full.
    pub fn take(&mut self, position_m: [f64; 3]) -> f64 {
        let size = self.window.len();
        self.window[self.next] = position_m;
        self.next = (self.next + 1) % size;
        self.filled = (self.filled + 1).min(size);
        if self.filled < size {
            return 0.0;
        }
        let middle = (size - 1) as f64 / 2.0;
        let (mut slope, mut spread) = ([0.0; 3], 0.0);
        for i in 0..size {
            let from_middle = i as f64 - middle;
            // The positions are read from the oldest to the newest.
            let at = self.window[(self.next + i) % size];
            spread += from_middle * from_middle;
            for axis in 0..3 {
                slope[axis] += from_middle * at[axis];
            }
        }
        crate::haptic::length(slope) / (spread * self.interval_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_has_its_speed_and_a_count_of_chatter_hardly_any() {
        let mut speed = SpeedEstimate::new(4000);
        let mut seen = 0.0;
        for tick in 0..40 {
            let t = f64::from(tick) / 4000.0;
            seen = speed.take([0.3 * t, -0.4 * t, 0.01]);
        }
        assert!((seen - 0.5).abs() < 1e-12, "{seen}");
        let mut speed = SpeedEstimate::new(4000);
        for tick in 0..40 {
            seen = speed.take([if tick % 2 == 0 { 1e-5 } else { 0.0 }, 0.0, 0.0]);
        }
        // The difference of two successive positions would give 40 mm/s.
        assert!(seen < 1e-3, "{seen}");
    }
}
