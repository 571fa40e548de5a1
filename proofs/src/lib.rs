//! Properties that are proved about the control laws: each is a body, which Kani runs for all inputs and the tests on
//! seeded samples.
//!
//! `cargo xtask prove` runs all of them and writes their table below `target/`; `cargo test -p touchstone-proofs` runs
//! the sampled form and the exhaustive 8-bit form on stable Rust.
//!
//! Read from the bottom: [`heart`] (unsigned magnitudes), [`edges`] (signed numbers around them), one file per law,
//! the filter, settings, the encoder and the fault machine, the drive's arithmetic.
// Bodies name the checker's macros only under the checker.
#![cfg_attr(kani, allow(missing_docs))]
// The one file-wide cast habit: samples of `bits` bits are narrowed on purpose.
#![allow(clippy::missing_panics_doc)]
// The list of what a property replaces is long.
#![recursion_limit = "1024"]

/// An assertion after which no cover comes as a statement of its block: under the checker it is one itself, as an assertion that nothing reaches says
/// nothing. Where one comes, that shows it, and `assert!` is enough. The gate sees to it that each is one or the other (but those with words
/// of their own, which stand in the place of the code), and has the checker ask for no other assertion. A trace of each that is reached took
/// a quarter of its time.
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
