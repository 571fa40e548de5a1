//! Simulated haptic devices, scenes, experiments and reports around the Touchstone control law.
//!
//! A run goes `scene -> plan -> loop -> record -> report`; each has its module.

pub mod cli;
pub mod error;
pub mod identify;
pub mod link;
pub mod motor;
pub mod plant;
pub mod report;
pub mod run;
pub mod scene;
pub mod thesis;
