//! A library with the C interface of Force Dimension's `libdhd` and no device: for tests, and for trying the program without one.
//!
//! It behaves as the vendor's library was measured to behave without a device, and as its documentation says with one: -1 and an error's number of
//! the calling thread after a failure, arguments untouched then, an old error that a success does not clear, a NULL for the
//! name of nothing. Behind it stands the simulated plant, in real time or on a clock of the test's own. What goes
//! wrong is said by a plan, in words: [`door`].

mod clock;
pub mod door;
mod interface;
mod machine;
mod plan;
