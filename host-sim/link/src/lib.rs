//! The code for talking to a board that a desktop program and a browser's page share. The crate uses no port, no clock and no file.
//!
//! ```text
//! bytes from the board -> talk: frames, requests and answers -> rows: telemetry records as numbers
//!                                                            -> told: states, settings and faults as text
//! text from a person   -> setting, value: checked with the table of all settings -> talk -> bytes to the board
//! ```

pub mod counted;
pub mod fault_words;
pub mod guard;
pub mod rows;
pub mod setting;
pub mod talk;
pub mod told;
pub mod value;
pub mod words;
