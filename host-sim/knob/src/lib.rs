//! A complete simulated knob without a board: the firmware's code with the simulated motor.
//!
//! [`knob`] runs the firmware's two interrupt functions (current loop and control tick) alternately with the motor, for tests.
//! [`served_knob`] serves such a knob on a TCP port in real time, so that every command of the desktop program works with it as
//! with a board (`touchstone demo`).

pub mod knob;
pub mod served_knob;
