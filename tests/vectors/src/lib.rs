//! One motion with all difficult cases, run through every control law in a fixed-point format, and a digest (hash) of all results.
//!
//! The code uses integers only, no allocation and no operating system. The microcontroller's program (`tests/thumb`) and the
//! desktop's (`examples/golden.rs`) run the same code, and `cargo xtask thumb` compares what the two print.
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

/// Encoder counts per turn, as on the simulated knob of the DLR thesis.
pub const COUNTS_PER_TURN: u32 = 40_000;
/// Position of the wall's surface, rad; not a whole number of encoder counts.
pub const SURFACE: Si = Si::lit("0.5");

/// Runs the control periods of a case, and gets the digests. An implementation may read a clock around each period.
pub trait Machine<N: Number> {
    /// Converts an encoder count to a penetration.
    fn penetration(&mut self, scale: &CountScale, count: i64) -> Position<N>;
    /// Runs one control period of the wall's controller at the penetration `e`; returns the force.
    fn tick(&mut self, wall: &mut Controller<N>, e: Position<N>) -> Force<N>;
    /// Called at the end of each segment of the motion. The digest (hash) covers all results since the start of the case.
    fn segment_done(&mut self, case: &Case, segment: &Segment, digest: u64);
}

/// Runs the whole motion of the test vectors through the control law of a case.
///
/// # Errors
/// The number format cannot hold the settings.
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
