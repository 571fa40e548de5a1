//! Identifies a device's properties from what a real device can record: encoder counts and commanded torques, or the motor's
//! currents and voltages.
//!
//! - [`swing`] pushes the free device at several speeds in both directions, lets it coast to rest, and fits inertia, viscous
//!   damping and dry friction at once;
//! - [`motor`] does the same with a real knob whose motor is unknown, and first measures resistance, inductance and flux;
//! - [`cogging`] makes a cogging map from the current that a slow, even turn of a real knob needs;
//! - [`eccentricity`] measures the error of the angle from an encoder disc or magnet that is off the axis;
//! - [`noise`] measures the position sensor's noise from a recording at rest;
//! - [`axis`] fits mass, damping and friction of an axis of a haptic device that was moved about;
//! - [`bisection`] is Algorithm 2.1 of the thesis. It finds the largest damping that the force bounding approach may assume, with a
//!   finger on the device. Dry friction acts as damping there, by an amount that depends on how hard the finger presses. The
//!   presses are therefore repeated, and their spread is part of the result.

pub mod axis;
pub mod bisection;
pub mod cogging;
pub mod eccentricity;
pub mod lever;
pub mod motor;
pub mod noise;
pub mod swing;

pub use axis::{AxisMechanics, Unidentified};
pub use bisection::{Bracket, Identified, Search, Trial, identify};
pub use swing::{Estimate, Mechanics, Swings};
