//! A virtual wall under the mouse: the simulator's loop in one self-contained page.
//!
//! The page's numbers are made by the very crates of the simulator, compiled to WebAssembly: [`desk`] holds the loops that run
//! side by side, and is what a page talks to; on `wasm32` a plain function stands before each of its methods. On every other
//! machine [`page`] writes the file, and [`board_page`] what is shown of a board.

#[cfg(not(target_arch = "wasm32"))]
pub mod board_page;
pub mod desk;
#[cfg(target_arch = "wasm32")]
mod exports;
#[cfg(not(target_arch = "wasm32"))]
pub mod page;
