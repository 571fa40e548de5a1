//! Scenes, and the runs that they describe: `scene -> plan -> loop -> record`.
//!
//! A scene is text with units in its names ([`scene`]); a run is what the loop of sensor, law, amplifier and plant leaves behind
//! ([`run`]). [`error::Error`] says what a person can mend, and where.
//!
//! One scene leaves the same bits on every machine: transcendental functions are those of `libm`.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod error;
pub mod harmless;
pub mod input;
pub mod output;
pub mod run;
pub mod scene;
