//! The control laws, one file each, with one common trait.
//!
//! A law is an immutable set of coefficients, and its memory is a separate, small [`Law::State`]. A tick depends on these two and
//! on the sampled position alone. Every law gives a force that pushes out of the wall (a negative force pulls in). When a contact
//! ends, a law returns the force 0 and clears its memory, except for past positions and a velocity filter.

mod damped;
mod enhanced;
mod fba;
mod impact;
pub mod kept;
mod sfa;
mod spring;
mod tdpa;
mod vibration;
mod yielding;

pub use crate::sample::Sample;
pub use damped::{Damped, DampedState};
pub use enhanced::{Augmentation, Augmented, EnhancedSfa, EnhancedState};
pub use fba::{Fba, FbaState};
pub use impact::Impact;
pub use sfa::{Sfa, SfaState};
pub use spring::{Spring, SpringState};
pub use tdpa::{Tdpa, TdpaState};
pub use vibration::Vibration;
pub use yielding::YieldingSurface;

use crate::{Energy, Force, Number, Position};

/// Phase of the contact between hand and wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Contact {
    /// Outside the wall.
    #[default]
    Free,
    /// First contact, up to the first reversal of the motion. Laws without that distinction stay in this phase.
    First,
    /// Contact after the first reversal of the motion, in which an offset augments the force.
    Augmenting,
}

/// A law's internal values, for telemetry and plots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View<N: Number> {
    /// Phase of the contact between hand and wall.
    pub contact: Contact,
    /// Energy that the law's own observer has summed; `None` if the law has no observer.
    pub energy: Option<Energy<N>>,
    /// Deformation of the virtual spring beyond the penetration of the wall (offset).
    pub offset: Position<N>,
    /// Penetration of the enhanced law's virtual mass while it is in use; else `None`.
    pub mass: Option<Position<N>>,
}

/// A control law in one number format.
pub trait Law<N: Number> {
    /// The law's memory; the default is "outside the wall, at rest".
    type State: Copy + Default;

    /// Runs one control period: takes the position and displacement of the hand's point (HIP), returns the force that pushes it
    /// out.
    fn tick(&self, state: &mut Self::State, sample: Sample<N>) -> Force<N>;

    /// The law's internal values after the last tick.
    fn view(&self, state: &Self::State) -> View<N>;
}
