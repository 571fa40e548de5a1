//! The device's time: the machine's, or one that a test moves.

use std::time::Instant;

/// Seconds since the library was loaded.
#[derive(Debug, Clone, Copy)]
pub enum MockClock {
    /// Real time.
    Real(Instant),
    /// Moved by every call by what it costs, and by waits.
    Own(f64),
}

impl MockClock {
    pub fn now_s(&self) -> f64 {
        match self {
            Self::Real(start) => start.elapsed().as_secs_f64(),
            Self::Own(now) => *now,
        }
    }

    /// Lets time pass; in real time it passes anyway, unless a call is to be slow.
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
