//! Firmware in the loop: tests that boot, calibrate and arm the firmware on an emulated board, compare its forces during a press
//! with the control law bit for bit, and inject every fault.

pub mod around;
pub mod campaign;
pub mod checks;
pub mod cogging;
pub mod eccentricity;
pub mod fault;
pub mod jobs;
pub mod lasting;
pub mod list;
mod noisy;
pub mod over_current;
pub mod press;
pub mod registers;
pub mod report;
pub mod slow_turn;
pub mod starts;
pub mod storage;
pub mod supply;
pub mod tally;
