//! The pace of the servo loop: decides when its control intervals (ticks) begin.

use std::time::{Duration, Instant};

/// The result of a wait for the next control interval (tick).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Waited {
    /// Lateness of the control interval that begins, s.
    pub late_s: f64,
    /// Number of control intervals (ticks) that were left out before the one that begins.
    pub missed_ticks: u64,
}

/// Decides when the control intervals (ticks) of the servo loop begin.
pub trait Pace {
    /// Starts the pace: the first control interval (tick) is due now.
    fn start(&mut self);
    /// Waits until the next control interval (tick) is due.
    fn wait(&mut self) -> Waited;
    /// Time by which the work of the present control interval has already exceeded the interval, s.
    fn late_s(&self) -> f64;
}

/// The pace of the machine's clock. If a control interval (tick) begins late by whole intervals, as many are left out, so that no
/// burst follows.
#[derive(Debug, Clone)]
pub struct RealTime {
    interval: Duration,
    due: Instant,
    sleeper: spin_sleep::SpinSleeper,
    first: bool,
}

/// Typical lateness with which the operating system wakes a thread, ns. So a waiting thread sleeps until this time before the end
/// of the wait, and then polls the clock.
const WAKING_NS: u32 = 100_000;

impl RealTime {
    /// A pace of this many control intervals per second.
    #[must_use]
    pub fn new(rate_hz: u32) -> Self {
        Self {
            interval: Duration::from_secs_f64(1.0 / f64::from(rate_hz)),
            due: Instant::now(),
            sleeper: spin_sleep::SpinSleeper::new(WAKING_NS),
            first: true,
        }
    }
}

impl Pace for RealTime {
    fn start(&mut self) {
        self.due = Instant::now();
        self.first = true;
    }

    fn wait(&mut self) -> Waited {
        if !std::mem::take(&mut self.first) {
            self.due += self.interval;
        }
        let now = Instant::now();
        if let Some(left) = self.due.checked_duration_since(now) {
            self.sleeper.sleep(left);
        }
        let late_s = self.due.elapsed().as_secs_f64();
        let missed = (late_s / self.interval.as_secs_f64()) as u32;
        self.due += self.interval * missed;
        Waited {
            late_s,
            missed_ticks: missed.into(),
        }
    }

    fn late_s(&self) -> f64 {
        (self.due.elapsed().as_secs_f64() - self.interval.as_secs_f64()).max(0.0)
    }
}

/// The pace of simulated time: every control interval (tick) is due at once and none is late.
#[derive(Debug, Clone, Copy, Default)]
pub struct SimulatedPace;

impl Pace for SimulatedPace {
    fn start(&mut self) {}
    fn wait(&mut self) -> Waited {
        Waited::default()
    }
    fn late_s(&self) -> f64 {
        0.0
    }
}

/// The pace of a device that sets the servo loop's rate by its positions. If the time between two positions exceeds a control
/// interval, the second one is late by the excess.
#[derive(Debug, Clone)]
pub struct DevicePace {
    interval: Duration,
    last: Instant,
    before: Option<Instant>,
}

impl DevicePace {
    /// The pace of a device that is expected to send positions at this rate.
    #[must_use]
    pub fn new(rate_hz: u32) -> Self {
        Self {
            interval: Duration::from_secs_f64(1.0 / f64::from(rate_hz)),
            last: Instant::now(),
            before: None,
        }
    }
}

impl Pace for DevicePace {
    fn start(&mut self) {
        self.last = Instant::now();
        self.before = None;
    }

    fn wait(&mut self) -> Waited {
        let now = Instant::now();
        let took = self.before.map_or(self.interval, |before| now - before);
        (self.before, self.last) = (Some(now), now);
        let late_s = took.saturating_sub(self.interval).as_secs_f64();
        Waited {
            late_s,
            missed_ticks: (late_s / self.interval.as_secs_f64()) as u64,
        }
    }

    fn late_s(&self) -> f64 {
        self.last
            .elapsed()
            .saturating_sub(self.interval)
            .as_secs_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_that_were_missed_are_left_out_and_counted() {
        let mut pace = RealTime::new(1000);
        pace.start();
        pace.wait();
        std::thread::sleep(Duration::from_micros(5500));
        // This tick was due 1 ms after the first. So it is at least 4.5 ms late, and at least four ticks were missed.
        assert!(pace.late_s() >= 4.4e-3);
        let late = pace.wait();
        assert!(late.late_s >= 4.4e-3 && late.missed_ticks >= 4, "{late:?}");
        // The missed ticks are not made up for: the next tick is due within one interval.
        let begun = Instant::now();
        let next = pace.wait();
        let waited_s = begun.elapsed().as_secs_f64();
        assert!(waited_s + next.late_s <= 1.1e-3 + next.late_s * 2.0);
    }
}
