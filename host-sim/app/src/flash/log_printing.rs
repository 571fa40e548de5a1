//! State of a board's log while the program prints it, and when the printing ends.

use crate::out;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// State of the log while the program prints it.
#[derive(Debug)]
pub struct LogPrinting {
    /// True after Ctrl-C; printing then ends.
    pub stop: Arc<AtomicBool>,
    /// Time at which the log was opened.
    pub begun: Instant,
    /// Whether each message is printed with its source file and line.
    #[cfg_attr(
        not(feature = "probe"),
        expect(dead_code, reason = "the program says them always")
    )]
    pub locations: bool,
    /// Time after which printing ends, s; `None` without a limit.
    pub seconds: Option<f64>,
}

impl LogPrinting {
    /// Creates a log that ends when `stop` is set.
    pub fn until(stop: Arc<AtomicBool>) -> Self {
        Self {
            stop,
            begun: Instant::now(),
            locations: false,
            seconds: None,
        }
    }

    /// Whether to continue printing: the stop flag is not set, the time limit has not passed, and standard output is still open.
    pub fn goes_on(&self) -> bool {
        let elapsed_s = self.begun.elapsed().as_secs_f64();
        !self.stop.load(Ordering::Relaxed)
            && out::is_read()
            && self.seconds.is_none_or(|seconds| elapsed_s < seconds)
    }
}
