//! Properties that are proved about the control laws. Each has a body, which the model checker Kani runs for all inputs and the
//! tests run on random samples with a fixed seed.
//!
//! `cargo xtask prove` runs all of them and writes their table below `target/`. `cargo test -p touchstone-proofs` runs the random
//! tests, and the 8-bit tests of all inputs, on stable Rust.
//!
//! To read the proofs from the bottom up, begin with [`heart`] (unsigned absolute values) and [`edges`] (signed numbers built on
//! them). One file per law follows, then filter, settings, encoder, fault machine and the drive's arithmetic.
// Under the checker, items without documentation are allowed.
#![cfg_attr(kani, allow(missing_docs))]
// Bodies panic where a property fails; this needs no documentation of its own.
#![allow(clippy::missing_panics_doc)]
// The list of functions that a property replaces is long.
#![recursion_limit = "1024"]

/// An assertion for places where no cover follows in the same block. (A cover is a situation that the model checker must be able
/// to reach.) The macro is a cover too, because an assertion that is never reached proves nothing. If a cover follows, that cover
/// shows that the assertion is reached, and `assert!` is enough.
///
/// The proof gate checks that every assertion has one of these two forms. Assertions with a message, which belong to replacements
/// of the code, are exempt. So the gate switches off the checker's own reachability checks of assertions, which took a quarter of
/// the checker's time.
macro_rules! assert_reached {
    ($condition:expr $(,)?) => {{
        #[cfg(kani)]
        kani::cover!(true, "assertion reached");
        core::assert!($condition)
    }};
}

pub mod accepted;
#[cfg(kani)]
pub mod answers;
pub mod any_law;
pub mod contact;
mod contact_phase;
pub mod control_tick;
pub mod controller;
pub mod device;
#[cfg(kani)]
pub mod device_parts;
pub mod divided;
pub mod drive;
pub mod edges;
pub mod enhanced;
pub mod estimated;
pub mod estimator;
pub mod facts;
pub mod fba;
pub mod feel;
pub mod format;
pub mod functions;
pub mod guard;
pub mod heart;
pub mod impact;
pub mod monitors;
pub mod multiplied;
pub mod objects;
pub mod offset;
pub mod parts;
pub mod pieces;
pub mod place;
pub mod planes;
pub mod profile;
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
pub mod yielding;
