//! A whole knob without a board: the firmware's drive around the simulated motor.
//!
//! [`knob`] runs both interrupts in lock-step, for tests. [`served_knob`] serves that knob on a TCP port in real time, so that every
//! command of the desktop program can reach it as it reaches a board (`touchstone demo`).

pub mod knob;
pub mod served_knob;
