//! Tests with a simulated board behind a simulated debug probe. They run all code of the crate probe-rs except its USB drivers.

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
