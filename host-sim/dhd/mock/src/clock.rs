//! The mock device's clock: the computer's clock, or one that a test advances.

use std::time::Instant;

/// A clock of seconds since the library was loaded.
#[derive(Debug, Clone, Copy)]
pub enum MockClock {
    /// The computer's clock, from the moment at which the library was loaded.
    Real(Instant),
    /// A clock that a test controls; holds its time in seconds. Each library call advances it by the simulated duration of the
    /// call, and a test can let it advance.
    Own(f64),
}

impl MockClock {
    pub fn now_s(&self) -> f64 {
        match self {
            Self::Real(start) => start.elapsed().as_secs_f64(),
            Self::Own(now) => *now,
        }
    }

    /// Lets time pass. A test's clock is advanced by `seconds`. The computer's clock advances by itself; the function then sleeps
    /// only if `slow` is true.
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
