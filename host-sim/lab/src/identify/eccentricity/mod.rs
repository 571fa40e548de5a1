//! What an encoder's disc or magnet out of the axis, or tilted, makes of the angle: an error that comes back once and twice a turn,
//!
//! ```text
//! reading = θ + ε(θ),   ε(θ) = A1 sin(θ + φ1) + A2 sin(2θ + φ2)
//! ```
//!
//! with `θ` the shaft's true angle in the direction in which the encoder counts, its zero placed so that `ε` has no mean. The only witness
//! is the encoder itself, so that something else has to say where the shaft is. A calibration has two such motions, and says both on the way
//! (`touchstone_drive::calibration`, `touchstone_drive::measurement`); neither needs anything of the firmware that was not there.
//!
//! - **The field's angle** ([`field`]). A field that is turned slowly holds the rotor as a spring of `K = p k_t I` (pole pairs, torque constant,
//!   current; 1.75 N·m/rad with seven, 0.25 N·m/A and 1 A). The field's speed is that of a clock, and the rotor is behind it by what it takes to
//!   turn it, over `K`: friction and damping shift each way as a whole, which no harmonic sees, and friction that differs from place to place
//!   has the other sign on the way back and falls out of the mean of both. Cogging comes back with slots and poles and not once or twice a turn.
//!   Left is a torque that comes back once or twice a turn, in both directions alike: a weight out of the axis, of 1 mN·m, is 0.03 degrees of
//!   the shaft with those numbers, and 0.3 with the small motor's. **The field alone cannot tell it from an eccentric magnet.**
//! - **The shaft's own motion** ([`coast`]). With the bridge off nothing but inertia, damping and friction is at work, and the shaft slows down
//!   evenly. Such a torque `T` shakes it by `T/(J (n ω)²)`, which falls with the square of the speed `ω`; the encoder's error is the same at any.
//!   A coast from fast to slow tells them apart. It is short and coarser.
//!
//! Both together are what is reported: the field's value, and no less of an uncertainty than what the two differ by; or the coast's, where the field is
//! further from it than twice what the coast may be off.
//!
//! **Not told apart by either:** orders above two (a magnetic encoder's own fourth, its interpolation) are left in what does not fit. A rotor
//! whose poles are unevenly spaced, as far as the windings do not average over all of them, looks to the field like the encoder's error; an
//! eddy current brake that differs from place to place has a ripple that falls as `1/ω` and lies between the coast's two.

pub mod coast;
pub mod cost;
pub mod field;
mod least;

use nalgebra::Complex;
use touchstone_protocol::MeasuringPart;

pub use cost::{Cost, Reseat};

/// Orders of a turn that are looked for.
pub const ORDERS: usize = 2;
/// Fastest field with which the calibration is to be run for this, electrical turns a second: it has its speed within the electrical turn that is
/// not examined.
pub const FIELD_FASTEST_TURNS_PER_S: f64 = 4.0;
/// An error is worth showing above this share of a count.
const COUNT_SHARE: f64 = 0.25;

/// A device's data of one control tick of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CalibrationTick {
    /// Number of the tick.
    pub tick: u32,
    /// Part of the measurement; nothing while the field is turned.
    pub part: Option<MeasuringPart>,
    /// Position, counts.
    pub count: i32,
}

/// Known properties of the encoder and its motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownEncoder {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Counts of a revolution.
    pub counts_per_rev: f64,
    /// Pole pairs, which the alignment has confirmed.
    pub pole_pairs: f64,
    /// Speed of the field, electrical turns a second.
    pub field_turns_per_s: f64,
}

/// One order of the error: `A sin(n θ + φ)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// `A`, rad.
    pub amplitude_rad: f64,
    /// `φ`, rad.
    pub phase_rad: f64,
    /// Uncertainty, rad: how far `A e^(jφ)` may be off in any direction.
    pub uncertainty_rad: f64,
}

/// The motion from which the value was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Witness {
    /// The field's.
    Field,
    /// The shaft's own.
    Coast,
}

/// The result of one kind of motion: `A e^(jφ)` of each order and its uncertainty, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Said {
    /// The components by order, from order 1.
    pub parts: [Complex<f64>; ORDERS],
    /// Uncertainty from the difference of both directions, or from noise.
    pub uncertainty_rad: [f64; ORDERS],
    /// What does not fit, effective value, rad.
    pub residual_rms_rad: f64,
}

/// The encoder's error over a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eccentricity {
    /// By orders from 1. Phases are counted from the place where the calibration ended: from the zero that it set.
    pub harmonics: [Harmonic; ORDERS],
    /// The motion from which each order was taken.
    pub witness: [Witness; ORDERS],
    /// How far the field and the coasts are apart, rad; nothing where there was no coast long enough.
    pub apart_rad: Option<[f64; ORDERS]>,
    /// The part of the field's motion that does not fit, effective value, rad.
    pub residual_rms_rad: f64,
    /// A step of the encoder, rad.
    pub count_rad: f64,
}

/// Why the error cannot be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NotSeen {
    /// The field was not turned a whole turn both ways, or that was not heard.
    #[error(
        "the calibration's turn of the field is not whole: {heard} of {needed} ticks were heard"
    )]
    Incomplete {
        /// How many.
        heard: usize,
        /// Number of ticks needed.
        needed: usize,
    },
    /// The rotor did not go with the field.
    #[error(
        "the shaft did not go evenly with the field: it is off by {degrees:.1} electrical degrees"
    )]
    NotFollowed {
        /// Effective value.
        degrees: f64,
    },
    /// The two directions disagree.
    #[error("the turn there and the turn back disagree about the encoder by {degrees:.2} degrees")]
    DoesNotRepeat {
        /// Difference between the two turns, degrees.
        degrees: f64,
    },
}

impl Eccentricity {
    /// Evaluates a calibration's telemetry.
    ///
    /// # Errors
    /// [`NotSeen`].
    pub fn new(ticks: &[CalibrationTick], known: &KnownEncoder) -> Result<Self, NotSeen> {
        let field = field::said(ticks, known)?;
        let coast = coast::said(ticks, known);
        let count_rad = std::f64::consts::TAU / known.counts_per_rev;
        // From the zero that the calibration sets, which is where it ends.
        let zero = ticks.last().map_or(0.0, |last| f64::from(last.count)) * count_rad;
        let mut harmonics = [Harmonic {
            amplitude_rad: 0.0,
            phase_rad: 0.0,
            uncertainty_rad: 0.0,
        }; ORDERS];
        let mut witness = [Witness::Field; ORDERS];
        let mut apart = [0.0; ORDERS];
        for (index, harmonic) in harmonics.iter_mut().enumerate() {
            let (mut value, mut open) = (field.parts[index], field.uncertainty_rad[index]);
            if let Some(coast) = &coast {
                let of_coast = coast.uncertainty_rad[index];
                apart[index] = (coast.parts[index] - value).norm();
                // What is far more than the coast may be off, only the field can have wrong.
                if apart[index] > (2.0 * of_coast).max(COUNT_SHARE * count_rad) {
                    witness[index] = Witness::Coast;
                    (value, open) = (coast.parts[index], of_coast);
                } else {
                    open = open.max(apart[index].min(of_coast));
                }
            }
            let order = (index + 1) as f64;
            let value = value * Complex::cis(order * zero);
            *harmonic = Harmonic {
                amplitude_rad: value.norm(),
                phase_rad: value.arg(),
                uncertainty_rad: open,
            };
        }
        Ok(Self {
            harmonics,
            witness,
            apart_rad: coast.map(|_| apart),
            residual_rms_rad: field.residual_rms_rad,
            count_rad,
        })
    }

    /// The error at an angle, rad.
    #[must_use]
    pub fn error_rad(&self, angle_rad: f64) -> f64 {
        let parts = self.harmonics.iter().zip(1..);
        parts
            .map(|(it, order)| {
                it.amplitude_rad * (f64::from(order) * angle_rad + it.phase_rad).sin()
            })
            .sum()
    }

    /// Whether an order exceeds its uncertainty and a share of a count.
    #[must_use]
    pub fn stands_out(&self, index: usize) -> bool {
        let it = &self.harmonics[index];
        it.amplitude_rad > it.uncertainty_rad.max(COUNT_SHARE * self.count_rad)
    }
}
