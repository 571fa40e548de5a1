//! A short circuit from a motor wire to the supply or to ground: a resistance and an inductance in series with a phase's
//! transistors.

use super::seconds;
use crate::peripheral::timer::gates::Leg;

/// The conductor that the motor wire touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Touched {
    /// The supply's positive conductor.
    Supply,
    /// Ground, at a point behind the shunts, so that the current does not pass them.
    Ground,
}

/// A short circuit of a motor wire.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Short {
    /// Number of the phase whose wire is short-circuited.
    pub phase: usize,
    /// The conductor that the phase touches.
    pub touched: Touched,
    /// Resistance of the short circuit's path, including the supply and the transistor, Ω.
    pub ohm: f64,
    /// Inductance of the short circuit's path, H.
    pub henry: f64,
    /// Current from the phase's transistors into the short circuit, A.
    pub current_a: f64,
    /// Time up to which the short circuit was simulated, in processor cycles.
    pub now: u64,
}

impl Short {
    /// A short circuit through which no current flows yet.
    #[must_use]
    pub fn new(phase: usize, touched: Touched, ohm: f64, henry: f64, now: u64) -> Self {
        Self {
            phase,
            touched,
            ohm,
            henry,
            current_a: 0.0,
            now,
        }
    }

    /// Advances the current of the short circuit by the exact solution, for constant states of the transistors. With both
    /// transistors off, the current flows on through a diode until it is zero.
    pub(super) fn advance(&mut self, now: u64, leg: Leg, bus_v: f64, diode_v: f64) {
        let interval = seconds(now.saturating_sub(self.now));
        self.now = now;
        let far_v = match self.touched {
            Touched::Supply => bus_v,
            Touched::Ground => 0.0,
        };
        let here_v = match leg {
            Leg::Upper => bus_v,
            Leg::Lower => 0.0,
            Leg::Open if self.current_a > 0.0 => -diode_v,
            Leg::Open if self.current_a < 0.0 => bus_v + diode_v,
            Leg::Open => return,
        };
        let end_a = (here_v - far_v) / self.ohm;
        let decay = (-self.ohm / self.henry * interval).exp();
        let next = end_a + (self.current_a - end_a) * decay;
        let ends = leg == Leg::Open && next.signum() != self.current_a.signum();
        self.current_a = if ends { 0.0 } else { next };
    }
}

#[cfg(test)]
mod tests {
    use super::{Leg, Short, Touched};

    #[test]
    fn a_short_draws_from_whichever_transistor_is_on_and_ends_through_a_diode() {
        // 24 V across 4 µH gives 6 A/µs. At 1 mOhm the rise is practically a straight line.
        let after = |touched, legs: [Leg; 2]| {
            let mut short = Short::new(0, touched, 1e-3, 4e-6, 0);
            short.advance(170, legs[0], 24.0, 0.7);
            let first = short.current_a;
            for microsecond in 2..200 {
                short.advance(170 * microsecond, legs[1], 24.0, 0.7);
            }
            (first, short.current_a)
        };
        let (out, ended) = after(Touched::Supply, [Leg::Lower, Leg::Open]);
        assert!((out + 6.0).abs() < 2e-3 && ended == 0.0, "{out} {ended}");
        let (into, ended) = after(Touched::Ground, [Leg::Upper, Leg::Open]);
        assert!((into - 6.0).abs() < 2e-3 && ended == 0.0, "{into} {ended}");
        assert_eq!(after(Touched::Supply, [Leg::Upper; 2]), (0.0, 0.0));
        assert_eq!(after(Touched::Ground, [Leg::Lower; 2]), (0.0, 0.0));
    }
}
