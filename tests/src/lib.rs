//! Shared helpers of the tests across the crates: motions of a hand, a simulated flash memory, random numbers, a matrix form of the
//! state estimator, and every variant of every control law.

pub mod adversary;
pub mod board_loop;
pub mod environment;
pub mod estimator;
pub mod flash;
pub mod grain;
pub mod motion;
pub mod port;
pub mod random;
pub mod search;
pub mod si;
pub mod single_faults;
pub mod space;
pub mod space_port;
pub mod surface_path;
pub mod variants;

pub use touchstone_knob::knob;

/// Returns the shipped scene (description of a simulation) of this name, with the control law's settings from the DLR thesis.
///
/// # Panics
/// There is no scene of this name.
#[must_use]
pub fn thesis(name: &str) -> touchstone_sim::scene::Scene {
    use touchstone_sim::scene::{Preset, Scene};
    Scene::load(name)
        .and_then(|scene| scene.with_preset(Preset::Thesis))
        .unwrap_or_else(|error| panic!("{error}"))
}
