//! Measures of how a wall feels to a hand, one per file. Each measure is updated once per tick (control period).
//!
//! All measures use the true motion and the motor's true force (after torque limit, resolution and delay), not the values in the
//! control law. Only true values can show that the law is wrong.

mod hardness;
mod penetration;
mod release;
mod response;
mod ripple;
mod rise;
mod settle;
mod windowed_energy;

pub use hardness::RateHardness;
pub use penetration::PeakPenetration;
pub use release::Release;
pub use response::{DynamicStiffness, Response, Wiggle};
pub use ripple::{HIGH_PASS_HZ, Ripple};
pub use rise::{ContactRise, RISE_S};
pub use settle::{Settle, Settled, TOLERANCE};
pub use windowed_energy::WorstWindow;
