//! Experiments that consist of many simulated runs, and readable results of them. Examples are the thesis' comparison of control
//! laws, its Algorithm 2.1 that measures a device's damping, scorecards, tuning, sweeps and reports.

pub mod accuracy;
pub mod beside;
pub mod boundary;
pub mod certify;
pub mod hard;
pub mod identify;
pub mod journal;
pub mod plan;
pub mod random_device;
pub mod report;
pub mod scorecard;
pub mod sweep;
pub mod thesis;
pub mod tune;
