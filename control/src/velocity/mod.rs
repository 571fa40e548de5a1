//! Velocity out of measured positions alone: what a law with virtual damping may take in the place of a difference.
//!
//! A count a tick is the whole resolution of a difference: at 40,000 counts and 1 kHz it is 0.157 rad/s, and a damper makes a
//! torque of every one of them. Each way to do better pays with lateness:
//!
//! | | velocity on a ramp | of white position noise of variance `σ²`, per tick |
//! |---|---|---|
//! | difference | exact | `2 σ²` |
//! | [`Smoothed`], a first-order filter of share `a` | exact in the end | `2 a²/(2 - a) σ²` |
//! | [`FirstOrderAdaptiveWindow`] | within `2 d/n` over a window of `n` | by its window |
//! | [`Tracker`], steady Kalman gains | exact in the end | `2 β²/(α (4 - 2 α - β)) σ²` for constant velocity |
//!
//! Nothing of the device is known to them, and nothing of what is commanded: that is what [`crate::estimator`] is for.

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

/// A way to a velocity. Its coefficients; the memory is [`VelocityState`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Velocity<N: Number> {
    /// The difference of two positions through a first-order filter.
    Smoothed(Smoothed<N>),
    /// The slope of the longest straight line through the last positions that no count speaks against.
    Window(FirstOrderAdaptiveWindow<N>),
    /// A Kalman filter in its steady state.
    Tracker(Tracker<N>),
}

/// Memory of a [`Velocity`]; the default is before the first position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VelocityState<N: Number> {
    /// Memory of a filter that follows a motion: position, displacement per tick, and for a filter of the third order
    /// its change.
    Motion(Option<EstimatedMotion<N>>),
    /// Memory of a window: the last positions, the latest first.
    Positions([Position<N>; LONGEST_WINDOW]),
}

impl<N: Number> Default for VelocityState<N> {
    fn default() -> Self {
        Self::Motion(None)
    }
}

impl<N: Number> Velocity<N> {
    /// Runs one control period: takes the position, returns the displacement per tick. The first position is that of a
    /// device at rest.
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
