//! A mock of Force Dimension's `libdhd`: the same C interface, with a simulated device. For tests, and to try the program without a
//! device.
//!
//! Without a device it behaves as the maker's library was measured; with one, as the maker's documentation says. After a failure a
//! call returns -1, leaves its arguments unchanged and sets the calling thread's error number, which a success does not clear. The
//! name of an unknown device is NULL. The simulated device runs in real time or on a test's own clock. A plan in words makes calls
//! fail: [`door`].

mod clock;
pub mod door;
mod interface;
mod machine;
mod plan;
