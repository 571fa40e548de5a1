//! Velocity from the positions that a law gets, for virtual damping, in the place of the plain difference of two positions.
//!
//! A difference cannot resolve less than one encoder count per tick. At 40,000 counts per turn and 1 kHz that is 0.157 rad/s, and a
//! damper turns every such step into a step of torque. The smoother a velocity is, the larger is its delay:
//!
//! | | velocity on a ramp | variance of the result, per tick, for white position noise of variance `σ²` |
//! |---|---|---|
//! | difference | exact | `2 σ²` |
//! | [`Smoothed`], a first-order filter with gain `a` | exact after settling | `2 a²/(2 - a) σ²` |
//! | [`FirstOrderAdaptiveWindow`] | within `2 d/n` over a window of `n` ticks, `d` the allowed distance from a line | depends on the window |
//! | [`Tracker`], steady Kalman gains `α`, `β` | exact after settling | `2 β²/(α (4 - 2 α - β)) σ²` for constant velocity |
//!
//! These filters use no model of the device and no commanded forces. [`crate::estimator`] uses both.

mod settings;
mod smoothed;
mod tracker;
mod window;

pub use crate::settings::VelocitySettings;
pub use smoothed::Smoothed;
pub use tracker::Tracker;
pub use window::{FirstOrderAdaptiveWindow, LONGEST_WINDOW, Slope};

use crate::estimator::EstimatedMotion;
use crate::{Number, Position};

/// Coefficients of one method to get a velocity from positions. The memory is [`VelocityState`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Velocity<N: Number> {
    /// The difference of two positions through a first-order low-pass filter.
    Smoothed(Smoothed<N>),
    /// The slope of the longest straight line that fits the last positions within the error of an encoder count.
    Window(FirstOrderAdaptiveWindow<N>),
    /// A Kalman filter of the position with constant gains (its steady state).
    Tracker(Tracker<N>),
}

/// Memory of a [`Velocity`]; the default is the state before the first position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VelocityState<N: Number> {
    /// Memory of a recursive filter: position, displacement per tick, and for a third-order filter the change of that displacement
    /// per tick.
    Motion(Option<EstimatedMotion<N>>),
    /// Memory of adaptive windowing: the last positions, the latest first.
    Positions([Position<N>; LONGEST_WINDOW]),
}

impl<N: Number> Default for VelocityState<N> {
    fn default() -> Self {
        Self::Motion(None)
    }
}

impl<N: Number> Velocity<N> {
    /// Runs one control period: takes the position, returns the displacement per tick. At the first position the device counts as
    /// at rest.
    #[inline]
    pub fn tick(&self, state: &mut VelocityState<N>, at: Position<N>) -> Position<N> {
        if let Self::Window(window) = self {
            let mut past = match state {
                VelocityState::Positions(past) => *past,
                VelocityState::Motion(_) => [at; LONGEST_WINDOW],
            };
            let moved = window.tick(&mut past, at);
            *state = VelocityState::Positions(past);
            return moved;
        }
        let before = match state {
            VelocityState::Motion(motion) => *motion,
            VelocityState::Positions(_) => None,
        };
        let motion = before
            .and_then(|before| match self {
                Self::Smoothed(filter) => filter.tick(&before, at),
                Self::Tracker(tracker) => tracker.tick(&before, at),
                Self::Window(_) => None,
            })
            .unwrap_or(EstimatedMotion::standing(at));
        *state = VelocityState::Motion(Some(motion));
        Position(N::narrow(motion.moved))
    }
}
