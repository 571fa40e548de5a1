//! The scorecard's measures in one direction of space: the hand acts along a wall's normal, and the measures are computed from
//! depth and force along the normal.

use super::cases::Deed;
use super::measure::Figures;
use super::press::{DesiredStiffness, HELD_AFTER_S, PressFigures};
use touchstone_sim::run::measure::{Response, Ripple, Wiggle};
use touchstone_world::plant::Hand;

/// A wall of a given stiffness, and a hand that approaches it along its normal; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// Requested stiffness of the wall, N/m.
    pub k_desired_n_per_m: f64,
    /// Force of the press, N.
    pub push_n: f64,
    /// Force of the light touch before the press, N.
    pub touch_n: f64,
    /// Resolution of the measured position, m.
    pub count_m: f64,
    /// Error of a position along the wall's normal if each axis is off by half a count, m.
    pub unsure_m: f64,
    /// Control rate, Hz.
    pub rate_hz: u32,
}

/// Distance from the wall at which the hand starts, m.
pub const OUTSIDE_M: f64 = 0.002;
const START_S: f64 = 0.1;
const TOUCH_RAMP_S: f64 = 0.05;
const TOUCH_S: f64 = 0.5;
const RAMP_S: f64 = 0.3;
const HOLD_S: f64 = 0.8;
const RELEASE_S: f64 = 0.4;
/// Amplitude of an oscillating hand's force, as a fraction of the press.
const MOVE_SHARE: f64 = 0.3;
/// Tolerance for a settled press: the depth stays within this fraction of the ideal depth (force of the press over requested
/// stiffness), plus [`Approach::unsure_m`].
const SETTLED: f64 = 0.05;

/// A smooth rise from 0 to 1 as `t` goes from 0 to 1, without jumps of speed or acceleration, as hands move.
pub(super) fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
}

impl Approach {
    fn ramp_start_s(deed: Deed) -> f64 {
        match deed {
            Deed::Press => START_S + TOUCH_RAMP_S + TOUCH_S,
            Deed::Move(_) => START_S,
        }
    }

    /// Start and end of the measured part of an oscillation, s; it contains whole periods only.
    fn periods_s(frequency_hz: f64) -> (f64, f64) {
        let period_s = 1.0 / frequency_hz;
        let from = START_S + RAMP_S + period_s.max(0.5);
        (from, from + frequency_hz.ceil().max(1.0) * period_s)
    }

    /// Duration of an action of the hand, s.
    #[must_use]
    pub fn seconds(&self, deed: Deed) -> f64 {
        match deed {
            Deed::Press => Self::ramp_start_s(deed) + RAMP_S + HOLD_S + RELEASE_S,
            Deed::Move(frequency_hz) => Self::periods_s(frequency_hz).1,
        }
    }

    /// Duration of an action, in ticks (control periods).
    #[must_use]
    pub fn ticks(&self, deed: Deed) -> u64 {
        self.tick_of(self.seconds(deed))
    }

    fn tick_of(&self, time_s: f64) -> u64 {
        (time_s * f64::from(self.rate_hz)).round() as u64
    }

    /// Depth of the hand's rest point below the surface, m. With this rest point, the hand pushes with the intended force if it is
    /// at rest and the wall has the requested stiffness.
    #[must_use]
    pub fn rest_depth_m(&self, hand: &Hand, deed: Deed, time_s: f64) -> f64 {
        let compliance =
            1.0 / hand.stiffness + 1.0 / hand.pad_stiffness + 1.0 / self.k_desired_n_per_m;
        let way = |force_n: f64| OUTSIDE_M + force_n * compliance;
        let from_start = time_s - START_S;
        let out = match deed {
            Deed::Press => {
                let ramp = time_s - Self::ramp_start_s(deed);
                let touch = way(self.touch_n) * smooth(from_start / TOUCH_RAMP_S);
                let press = (way(self.push_n) - way(self.touch_n)) * smooth(ramp / RAMP_S);
                let release = smooth((ramp - RAMP_S - HOLD_S) / RELEASE_S);
                (touch + press) * (1.0 - release)
            }
            Deed::Move(frequency_hz) => {
                let press = way(self.push_n) * smooth(from_start / RAMP_S);
                let moving_s = (from_start - RAMP_S).max(0.0);
                let swing = (std::f64::consts::TAU * frequency_hz * moving_s).sin();
                press + MOVE_SHARE * self.push_n * compliance * swing
            }
        };
        out - OUTSIDE_M
    }

    /// The requested stiffness, with the resolution and uncertainty of a depth.
    #[must_use]
    pub fn stiffness(&self) -> DesiredStiffness {
        DesiredStiffness {
            k_desired: self.k_desired_n_per_m,
            count: self.count_m,
            unsure: self.unsure_m,
        }
    }

    /// First tick of the release after a press.
    #[must_use]
    pub fn release_tick(&self) -> u64 {
        self.tick_of(Self::ramp_start_s(Deed::Press) + RAMP_S + HOLD_S)
    }

    /// Makes the recorder that computes the measures of an action.
    #[must_use]
    pub fn watch(&self, deed: Deed) -> DirectionWatch {
        let ramp_end_s = Self::ramp_start_s(deed) + RAMP_S;
        let period_s = 1.0 / f64::from(self.rate_hz);
        let press = PressFigures {
            stiffness: self.stiffness(),
            push: self.push_n,
            ramp_start: self.tick_of(Self::ramp_start_s(deed)),
            held_from: self.tick_of(ramp_end_s + HELD_AFTER_S),
            release: self.release_tick(),
        };
        let wiggle = match deed {
            Deed::Press => None,
            Deed::Move(frequency_hz) => {
                let (from, to) = Self::periods_s(frequency_hz);
                Some(Wiggle {
                    frequency_hz,
                    window: (self.tick_of(from), self.tick_of(to)),
                })
            }
        };
        DirectionWatch {
            press: (deed == Deed::Press).then_some(press),
            ramp_end: self.tick_of(ramp_end_s),
            unsettled: None,
            period_s,
            response: wiggle.map(|wiggle| Response::new(wiggle, period_s)),
            ripple: wiggle.map(|wiggle| Ripple::new(wiggle.window, f64::from(self.rate_hz))),
            figures: Figures::NONE,
            k_desired_n_per_m: self.k_desired_n_per_m,
        }
    }
}

/// Recorder that computes the scorecard's measures from depth and force of an action, tick by tick.
#[derive(Debug, Clone)]
pub struct DirectionWatch {
    press: Option<PressFigures>,
    ramp_end: u64,
    unsettled: Option<u64>,
    period_s: f64,
    response: Option<Response>,
    ripple: Option<Ripple>,
    figures: Figures,
    k_desired_n_per_m: f64,
}

/// Worst value of each measure over all actions of the hand in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionFigures {
    /// The scorecard's measures. The energy is set only if it was computed; the ripple is in N.
    pub figures: Figures,
    /// Settling time, s: from the end of the ramp until the depth of the press stays within 5 % of the ideal depth. `None` if it
    /// never did.
    pub settle_s: Option<f64>,
}

impl DirectionFigures {
    /// Start value: the measures before any tick.
    pub const NONE: Self = Self {
        figures: Figures::NONE,
        settle_s: Some(0.0),
    };

    /// The worse value of each measure from two sets.
    #[must_use]
    pub fn worst(self, other: &Self) -> Self {
        Self {
            figures: self.figures.worst(&other.figures),
            settle_s: self.settle_s.zip(other.settle_s).map(|(a, b)| a.max(b)),
        }
    }
}

impl DirectionWatch {
    /// Adds a tick: depth along the normal in the middle of the tick in m, and mean outward force during the tick in N.
    pub fn take(&mut self, index: u64, depth_m: f64, force_n: f64) {
        if let Some(press) = &self.press {
            let _ = press.take(&mut self.figures, index, depth_m, force_n);
            let goal = press.push / press.stiffness.k_desired;
            let off = (depth_m - goal).abs() - press.stiffness.unsure;
            if index >= self.ramp_end && index < press.release && off > SETTLED * goal {
                self.unsettled = Some(index);
            }
        }
        if let Some(response) = &mut self.response {
            response.record(index, depth_m, force_n);
        }
        if let Some(ripple) = &mut self.ripple {
            ripple.record(index, force_n);
        }
    }

    /// Response of the wall to the oscillating hand so far; `None` in a press.
    #[must_use]
    pub fn response(&self) -> Option<&Response> {
        self.response.as_ref()
    }

    /// Computes the measures after the last tick.
    #[must_use]
    pub fn finish(mut self) -> DirectionFigures {
        if let Some(response) = &self.response {
            self.figures.raise_moved(response, self.k_desired_n_per_m);
        }
        if let Some(ripple) = &self.ripple {
            self.figures.raise_ripple(ripple);
        }
        let settle_s = match (&self.press, self.unsettled) {
            (Some(press), Some(last)) if last + 1 >= press.release => None,
            (Some(_), Some(last)) => Some((last + 1 - self.ramp_end) as f64 * self.period_s),
            _ => Some(0.0),
        };
        DirectionFigures {
            figures: self.figures,
            settle_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::measure::Measure;
    use super::*;
    use touchstone_world::plant::FIRM_TRANSLATION;

    const APPROACH: Approach = Approach {
        k_desired_n_per_m: 5000.0,
        push_n: 6.0,
        touch_n: 1.0,
        count_m: 1e-5,
        unsure_m: 5e-6,
        rate_hz: 1000,
    };

    /// Measures of a spring with `share` times the wall's stiffness, for a hand that moves exactly to the intended depths.
    fn led(share: f64, deed: Deed) -> DirectionFigures {
        let mut watch = APPROACH.watch(deed);
        let hand = FIRM_TRANSLATION;
        let own = 1.0 / hand.stiffness + 1.0 / hand.pad_stiffness;
        for index in 0..APPROACH.ticks(deed) {
            let time_s = index as f64 * 1e-3;
            let rest = APPROACH.rest_depth_m(&hand, deed, time_s);
            let k = share * APPROACH.k_desired_n_per_m;
            let depth = rest / (1.0 + k * own);
            watch.take(index, depth, (k * depth).max(0.0));
        }
        watch.finish()
    }

    #[test]
    fn the_wall_that_was_asked_for_has_no_error_and_a_softer_one_its_own() {
        for deed in [Deed::Press, Deed::Move(2.0)] {
            let right = led(1.0, deed);
            assert!(right.figures.get(Measure::StiffnessError) < 1e-9);
            assert!(right.figures.get(Measure::ModulusError) < 1e-6, "{right:?}");
            assert_eq!(right.settle_s, Some(0.0));
        }
        assert!(
            (led(1.0, Deed::Press)
                .figures
                .get(Measure::PeakPenetrationRatio)
                - 1.0)
                .abs()
                < 1e-9
        );
        let soft = led(0.5, Deed::Press);
        assert_eq!(soft.settle_s, None);
        assert!(soft.figures.get(Measure::StiffnessErrorHeld) > 0.4);
        let moved = led(0.5, Deed::Move(1.0)).figures.get(Measure::ModulusError);
        assert!((moved - 0.5).abs() < 1e-6, "{moved}");
    }
}
