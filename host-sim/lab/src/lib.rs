//! Experiments over runs, and their results for people: the thesis' comparison, Algorithm 2.1 as an instrument,
//! reports.

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
