//! The mock device's clock: the machine's clock, or one that a test advances.

use std::time::Instant;

/// A clock of seconds since the library was loaded.
#[derive(Debug, Clone, Copy)]
pub enum MockClock {
    /// The machine's clock.
    Real(Instant),
    /// A test's clock, s. Each call advances it by the time that the call takes, and a test can wait.
    Own(f64),
}

impl MockClock {
    pub fn now_s(&self) -> f64 {
        match self {
            Self::Real(start) => start.elapsed().as_secs_f64(),
            Self::Own(now) => *now,
        }
    }

    /// Lets time pass. On the machine's clock time passes by itself, so this function sleeps only if `slow` is true.
    pub fn pass(&mut self, seconds: f64, slow: bool) {
        match self {
            Self::Own(now) => *now += seconds,
            Self::Real(_) if slow => {
                std::thread::sleep(std::time::Duration::from_secs_f64(seconds));
            }
            Self::Real(_) => {}
        }
    }
}
