//! Measures of what a hand feels of a wall; one measure a file, each fed tick by tick.
//!
//! All of them use the true motion and the motor's true force (after limits, steps and delay), never the law's own
//! input: a measure against that input could not show that the law is wrong.

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
