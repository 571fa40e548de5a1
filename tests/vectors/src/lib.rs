//! One motion with all the hard cases, played through every law in a fixed-point format, and a digest of all results.
//!
//! Integers only, no allocation, no operating system: the microcontroller's program (`tests/thumb`) and the desktop's
//! (`examples/golden.rs`) run the same code, and `cargo xtask thumb` compares what they print.
#![no_std]
#![forbid(unsafe_code)]

mod cases;
mod digest;
mod motion;
pub mod space;

pub use cases::{Case, cases};
pub use digest::{Bits, Digest};
pub use motion::{Motion, SEGMENTS, Segment};

use touchstone_control::{Controller, CountScale, Force, Number, Position, SettingsError, Si};

/// Counts of the encoder in one turn: the knob of the thesis.
pub const COUNTS_PER_TURN: u32 = 40_000;
/// Where the wall begins, rad; not a whole number of counts.
pub const SURFACE: Si = Si::lit("0.5");

/// Runs the ticks: it may look at a clock around each, and gets the results.
pub trait Machine<N: Number> {
    /// Encoder count to penetration.
    fn penetration(&mut self, scale: &CountScale, count: i64) -> Position<N>;
    /// Runs one tick.
    fn tick(&mut self, wall: &mut Controller<N>, e: Position<N>) -> Force<N>;
    /// A segment of the motion is over; the digest is of all that came out since the start of the case.
    fn segment_done(&mut self, case: &Case, segment: &Segment, digest: u64);
}

/// Plays the whole motion through the law of a case.
///
/// # Errors
/// Settings that the format cannot hold.
pub fn play<N: Bits>(case: &Case, machine: &mut impl Machine<N>) -> Result<(), SettingsError> {
    let mut wall = Controller::<N>::new(&case.settings)?;
    let Some(scale) = CountScale::new(COUNTS_PER_TURN, SURFACE) else {
        return Ok(());
    };
    let mut digest = Digest::default();
    let mut motion = Motion::default();
    for segment in &SEGMENTS {
        for tick in 0..segment.ticks {
            let e = machine.penetration(&scale, motion.count(segment, tick));
            let force = machine.tick(&mut wall, e);
            digest.tick(e, force, &wall.view());
        }
        machine.segment_done(case, segment, digest.value());
    }
    Ok(())
}
