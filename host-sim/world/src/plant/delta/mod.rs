//! A delta mechanism: three motors at the base, three arms, three parallelograms, and an effector that the parallelograms keep
//! upright.
//!
//! [`DeltaGeometry`] relates joint angles to positions of the effector; [`DeltaPlant`] simulates the motion. The simpler model
//! [`super::Cartesian`] has one mass, the same everywhere. Here the inertia depends on position and direction, three motors with
//! limited torques make the force, and three joint encoders measure the position.

mod dynamics;
mod geometry;
#[cfg(test)]
mod tests;

pub use dynamics::{DeltaDevice, DeltaMasses, DeltaPlant, DeltaState, DeltaWork, FALCON};
pub use geometry::{DeltaGeometry, DeltaPose, FALCON_GEOMETRY, Unreachable};
