//! What a desktop program and a browser's page have in common for talking to a board. The crate uses no port, no clock and no file.
//!
//! ```text
//! bytes -> talk: frames, questions and answers -> rows: records as numbers
//!                                              -> told: states, settings and faults in words
//! text  -> setting, value: by the table of all settings -> talk -> bytes
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
