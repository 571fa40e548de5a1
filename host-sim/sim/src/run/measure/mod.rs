//! Measures of a wall's haptic quality, one per file. Each is updated tick by tick.
//!
//! All measures use the true motion and the motor's true force (after limits, steps and delay), not the law's input. A measure of
//! the law's input could not show that the law is wrong.

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
