//! A virtual wall under the mouse: the simulator's loop in one self-contained page.
//!
//! The page's numbers are made by the very crates of the simulator, compiled to WebAssembly: [`desk`] holds the loops that run
//! side by side, and is what a page talks to, [`space_loop`] one of three axes. On `wasm32` a plain function stands before each of its methods. On every other
//! machine [`page`] writes the file, and [`board_page`] what is shown of a board. A page that has the board's port itself finds its side of
//! the conversation ([`touchstone_link::talk`]) in the same module.

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
pub mod space_loop;
#[cfg(not(target_arch = "wasm32"))]
pub mod space_page;
