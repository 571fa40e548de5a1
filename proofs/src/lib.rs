//! What is proved about the control laws: each property a body, run by Kani for all inputs and without it on seeded samples.
//!
//! `cargo xtask prove` runs all of it and writes the table in this directory's README; `cargo test -p touchstone-proofs` runs
//! the sampled form and the exhaustive 8-bit form on stable Rust.
//!
//! Read from the bottom: [`heart`] (unsigned magnitudes), [`edges`] (signed numbers around them), one file per law, the
//! filter, settings, the encoder and the fault machine, the drive's arithmetic.
// Bodies name the checker's macros only under the checker.
#![cfg_attr(kani, allow(missing_docs))]
// The one file-wide cast habit: samples of `bits` bits are narrowed on purpose.
#![allow(clippy::missing_panics_doc)]
// The list of what a property replaces is long.
#![recursion_limit = "1024"]

/// Under the checker every assertion of a property is a cover as well: one that nothing reaches says nothing. The gate asks for both, and
/// has the checker ask the same of no other assertion: that took a quarter of its time, most of it for a trace of each that it reached.
#[cfg(kani)]
macro_rules! assert {
    ($condition:expr $(,)?) => {{
        kani::cover!(true, "assertion reached");
        core::assert!($condition)
    }};
    // With words of its own it is one of what stands in the place of the code, which not every harness asks.
    ($($condition:tt)+) => {
        core::assert!($($condition)+)
    };
}

pub mod accepted;
#[cfg(kani)]
pub mod answers;
pub mod contact;
pub mod controller;
pub mod device;
pub mod divided;
pub mod drive;
pub mod edges;
pub mod enhanced;
pub mod estimated;
pub mod estimator;
pub mod facts;
pub mod fba;
pub mod format;
pub mod functions;
pub mod guard;
pub mod heart;
pub mod multiplied;
pub mod objects;
pub mod offset;
pub mod parts;
pub mod pieces;
pub mod place;
pub mod planes;
pub mod reckoned;
pub mod refines;
pub mod refines_enhanced;
pub mod set;
pub mod set_laws;
pub mod set_space;
pub mod settings;
pub mod shells;
pub mod source;
pub mod space;
pub mod spec;
pub mod specified;
pub mod spring_sfa;
pub mod stage;
#[cfg(kani)]
pub mod stand_ins;
pub mod tdpa;
pub mod valid;
pub mod vector_guard;
pub mod vectors;
pub mod velocity;
pub mod views;
pub mod weighed;
pub mod wide;
