//! Experiments that consist of many simulated runs. Examples are the thesis' comparison of control laws, its Algorithm 2.1 that
//! measures a device's damping, scorecards, tuning and sweeps.

pub mod accuracy;
pub mod beside;
pub mod boundary;
pub mod certify;
#[cfg(test)]
mod documented;
pub mod hard;
pub mod identify;
pub mod journal;
pub mod plan;
pub mod random_device;
mod scene_hand;
pub mod scorecard;
pub mod space_report;
pub mod sweep;
pub mod thesis;
pub mod tune;
