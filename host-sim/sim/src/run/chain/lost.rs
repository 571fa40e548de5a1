//! Lost ticks: control periods in which the controller side does not run.

use super::control::{Answer, Control};
use super::noise::Stream;

/// A controller side that does not run in some ticks (control periods). In a lost tick the motor keeps its torque, and the control
/// law receives no sample. The first tick is never lost.
pub struct Lossy {
    inner: Box<dyn Control>,
    share: f64,
    stream: Stream,
    torque_n_m: Option<f64>,
    answer: Option<Answer>,
}

impl Lossy {
    /// Makes `inner` lose ticks with probability `share` (0 to 1), each independently of the others.
    #[must_use]
    pub fn around(inner: Box<dyn Control>, share: f64, stream: Stream) -> Box<dyn Control> {
        Box::new(Self {
            inner,
            share,
            stream,
            torque_n_m: None,
            answer: None,
        })
    }

    fn is_lost(&mut self) -> bool {
        self.stream.uniform() < self.share
    }
}

impl Control for Lossy {
    fn torque_n_m(&mut self, angle_rad: f64) -> f64 {
        match (self.is_lost(), self.torque_n_m) {
            (true, Some(kept)) => kept,
            _ => *self.torque_n_m.insert(self.inner.torque_n_m(angle_rad)),
        }
    }

    fn answer(&mut self, angle_rad: f64) -> Answer {
        match (self.is_lost(), self.answer) {
            (true, Some(kept)) => kept,
            _ => *self.answer.insert(self.inner.answer(angle_rad)),
        }
    }

    fn commanded(&mut self, torque_n_m: f64) {
        self.inner.commanded(torque_n_m);
    }

    fn changed_at(&mut self, angle_rad: f64) {
        self.inner.changed_at(angle_rad);
    }
}
