//! A virtual wall pushed with the mouse: the simulator's control loop in one self-contained web page.
//!
//! The crates of the simulator, compiled to WebAssembly, compute all numbers that the page shows. [`desk`] holds the loops of one
//! axis that run side by side; [`space_loop`] is the loop of three axes. On `wasm32`, one exported function per method gives the
//! page access to the loops. On every other target, [`page`] builds the page for the simulation and [`board_page`] the page for a
//! real board. A page that holds the board's serial port itself runs the host's side of the protocol ([`touchstone_link::talk`]) in
//! the same WebAssembly module.

#[cfg(not(target_arch = "wasm32"))]
pub mod board_page;
pub mod desk;
#[cfg(target_arch = "wasm32")]
mod exports;
#[cfg(target_arch = "wasm32")]
mod exports_of_boards;
#[cfg(target_arch = "wasm32")]
mod exports_of_space;
#[cfg(not(target_arch = "wasm32"))]
pub mod page;
mod space_choice;
pub mod space_loop;
#[cfg(not(target_arch = "wasm32"))]
pub mod space_page;
