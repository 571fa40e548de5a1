//! A delta mechanism: three motors at the base, three arms, three parallelograms, and an effector that they keep upright.
//!
//! [`DeltaGeometry`] is where joints and effector are, [`DeltaPlant`] how they move. What [`super::Cartesian`] has as one mass is here one that
//! depends on the place and the direction, forces are made by torques of three motors with a limit each, and places are known
//! through three encoders.

mod dynamics;
mod geometry;
#[cfg(test)]
mod tests;

pub use dynamics::{DeltaDevice, DeltaMasses, DeltaPlant, DeltaState, DeltaWork, FALCON};
pub use geometry::{DeltaGeometry, DeltaPose, FALCON_GEOMETRY, Unreachable};
