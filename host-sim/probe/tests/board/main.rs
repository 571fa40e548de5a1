//! A simulated board behind a simulated probe. Writes and reads go through all of the crate probe-rs but its drivers
//! for USB.

mod cpu;
mod elf;
mod flash_memory;
mod lister;
mod machine;
mod memory;
mod probe;

mod choosing;
mod logging;
mod writing;
