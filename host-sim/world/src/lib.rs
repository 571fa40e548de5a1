//! Simulated hardware around a control law: the mechanics of a device and a hand, and the motor with its bridge, current sensors
//! and encoder.
//!
//! The crate does not depend on scene files or control laws: its functions take and return numbers. Its libraries are `nalgebra`,
//! `libm` and `thiserror`. Equal inputs give results with equal bits on every machine, because transcendental functions are those
//! of `libm`.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod integrator;
pub mod motor;
pub mod plant;
