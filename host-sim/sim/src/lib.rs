//! Simulates haptic devices, each described by a scene: `scene -> plan -> loop -> record`.
//!
//! A scene is a TOML text whose field names contain the units ([`scene`]). Running a scene simulates the loop of sensor, control
//! law, amplifier and device, and records every control period, called a tick ([`run`]). [`error::Error`] reports a problem that
//! the user can solve, and its place.
//!
//! The same scene gives the same bits on every machine, because all transcendental functions are those of `libm`.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod error;
pub mod harmless;
pub mod input;
pub mod output;
pub mod positions;
pub mod run;
pub mod scene;
pub mod texture;
