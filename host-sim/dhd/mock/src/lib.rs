//! A mock of Force Dimension's library `libdhd`: the same C interface, with a simulated device. For tests, and to try the program
//! without a device.
//!
//! Without a device the mock behaves as measurements of the real library showed. With a device it follows the maker's
//! documentation. After a failure a call returns -1, leaves its arguments unchanged and sets the calling thread's error number,
//! which a success does not clear. The name of an unknown device is NULL. The simulated device runs in real time or on a clock that
//! a test controls. A plan of text lines makes calls fail: [`door`].

mod clock;
pub mod door;
mod interface;
mod machine;
mod plan;
