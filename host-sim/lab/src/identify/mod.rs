//! What a device has, measured as on a real one: from the torque that was commanded and the counts that were read.
//!
//! - [`swing`] pushes the free device, lets it coast to rest, at several speeds and both ways, and fits inertia, viscous damping
//!   and dry friction at once;
//! - [`motor`] does so with a real knob, of whose motor nothing is known yet: resistance, inductance and flux come first;
//! - [`cogging`] makes a map of what a slow and even turn of a real knob takes;
//! - [`eccentricity`] tells what the encoder's disc or magnet out of the axis makes of the angle;
//! - [`axis`] fits mass, damping and friction of an axis of a haptic device that was moved about;
//! - [`bisection`] is Algorithm 2.1 of the thesis: the damping that FBA may count on, with a finger at the device. Dry friction
//!   counts there as damping, by an amount that depends on how hard the finger presses; so the presses are repeated, and the
//!   spread is part of the result.

pub mod axis;
pub mod bisection;
pub mod cogging;
pub mod eccentricity;
pub mod lever;
pub mod motor;
pub mod swing;

pub use axis::{AxisMechanics, Unidentified};
pub use bisection::{Bracket, Identified, Search, Trial, identify};
pub use swing::{Estimate, Mechanics, Swings};
