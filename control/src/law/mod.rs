//! The control laws, one file each, behind one trait.
//!
//! A law is an immutable configuration; its memory is a separate, small [`Law::State`]; a tick is a pure function of both and
//! of the sampled position. Every law gives a force that pushes out of the wall (a negative one pulls in) and leaves contact
//! with force 0 and its memory cleared.

mod damped;
mod enhanced;
mod fba;
mod sfa;
mod spring;
mod tdpa;

pub use damped::{Damped, DampedState};
pub use enhanced::{Augmentation, Augmented, EnhancedSfa, EnhancedState};
pub use fba::{Fba, FbaState};
pub use sfa::{Sfa, SfaState};
pub use spring::{Spring, SpringState};
pub use tdpa::{Tdpa, TdpaState};

use crate::{Energy, Force, Number, Position};

/// Phase of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Contact {
    /// Outside the wall.
    #[default]
    Free,
    /// First contact, up to the first reversal of the motion; laws without that distinction stay here.
    First,
    /// Force augmentation, after the first reversal.
    Augmenting,
}

/// A law's inner values, for telemetry and plots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View<N: Number> {
    /// Phase of the contact.
    pub contact: Contact,
    /// The law's own observed energy; `None` if it observes none.
    pub energy: Option<Energy<N>>,
    /// Offset `O`: how much further the virtual spring is deformed than the wall is penetrated.
    pub offset: Position<N>,
    /// Penetration of the virtual mass while it is in use.
    pub mass: Option<Position<N>>,
}

/// Input of a law in one tick: measured, or estimated for the time at which its force will act.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample<N: Number> {
    /// Penetration `e = x - x_s`, positive inside.
    pub e: Position<N>,
    /// Displacement since the last tick, positive inward; estimated, the velocity times a tick.
    pub moved: Position<N>,
}

impl<N: Number> Sample<N> {
    /// A sample as measured: the displacement is the difference of two penetrations.
    #[inline(always)]
    #[must_use]
    pub fn measured(e: Position<N>, last: Position<N>) -> Self {
        Self { e, moved: e - last }
    }

    /// The displacement as far as it lies in the wall, for laws whose memory ends at the surface.
    #[inline(always)]
    #[must_use]
    pub fn moved_inside(self) -> Position<N> {
        self.moved.min(self.e)
    }
}

/// A control law over one number format.
pub trait Law<N: Number> {
    /// The law's memory; the default is "outside, at rest".
    type State: Copy + Default;

    /// Runs one control period: takes where the HIP is and how it moves, returns the force pushing out.
    fn tick(&self, state: &mut Self::State, sample: Sample<N>) -> Force<N>;

    /// The law's internal values after the last tick.
    fn view(&self, state: &Self::State) -> View<N>;
}
