//! Measures the error of the angle from an encoder disc or magnet that is off the axis or tilted. The error repeats once and twice
//! per turn:
//!
//! ```text
//! reading = θ + ε(θ),   ε(θ) = A1 sin(θ + φ1) + A2 sin(2θ + φ2)
//! ```
//!
//! `θ` is the shaft's true angle in the encoder's direction of counting, with its zero placed so that `ε` has zero mean. There is
//! no second encoder, so the true angle has to come from a known motion. A calibration has two such motions, and the device sends
//! their data (`touchstone_drive::calibration`, `touchstone_drive::measurement`).
//!
//! - **The field's angle** ([`field`]). A slowly turning field holds the rotor like a spring of `K = p k_t I` (pole pairs, torque
//!   constant, current; 1.75 N·m/rad with seven, 0.25 N·m/A and 1 A). A clock sets the field's speed. The rotor lags by its load
//!   torque divided by `K`. Constant friction and damping shift each direction as a whole, which does not affect the harmonics.
//!   Friction that depends on the angle has the opposite sign on the way back and cancels in the mean of both directions. Cogging
//!   repeats with slots and poles, not once or twice per turn. A torque that repeats once or twice per turn, alike in both
//!   directions, does not cancel. An unbalanced weight of 1 mN·m shifts the shaft by 0.03 degrees with these numbers, and by 0.3
//!   degrees with the small motor of the build guide. **The field alone cannot distinguish such a torque from an eccentric
//!   magnet.**
//! - **The shaft's own motion** ([`coast`]). With the motor switched off only inertia, damping and friction act, and the shaft
//!   slows down evenly. A torque `T` that repeats `n` times per turn moves the shaft by `T/(J (n ω)²)`, with the inertia `J`. The
//!   motion falls with the square of the speed `ω`, while the encoder's error is the same at any speed. A coast from fast to slow
//!   therefore distinguishes the two, but is short and less accurate.
//!
//! The result combines both motions, order by order. It is the coast's value if the two differ by more than twice the coast's
//! uncertainty and by more than a quarter of an encoder count. Otherwise it is the field's value. Its uncertainty is then at
//! least the smaller of that difference and the coast's uncertainty.
//!
//! **Neither motion shows** orders above two, such as a magnetic encoder's own fourth order; they stay in the residual. A rotor
//! with unevenly spaced poles looks like an encoder error to the field, as far as the windings do not average it out. An eddy
//! current brake that depends on the angle has a ripple in proportion to `1/ω`, between the two terms of the coast.

pub mod coast;
pub mod cost;
pub mod field;
mod least;

use nalgebra::Complex;
use touchstone_protocol::MeasuringPart;

pub use cost::{Cost, Reseat};

/// Number of orders (periods per turn) of the error that are measured, from order 1.
pub const ORDERS: usize = 2;
/// Fastest field with which the measurement works, electrical turns per second. A faster field has not reached its constant speed
/// after the first electrical turn, which is not used.
pub const FIELD_FASTEST_TURNS_PER_S: f64 = 4.0;
/// Fraction of an encoder count above which an amplitude is worth reporting.
const COUNT_SHARE: f64 = 0.25;

/// Data that a device sends for one control period (tick) of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CalibrationTick {
    /// Number of the control period (tick).
    pub tick: u32,
    /// Part of the measurement; `None` while the field turns.
    pub part: Option<MeasuringPart>,
    /// Position of the shaft, encoder counts.
    pub count: i32,
}

/// Properties of encoder and motor that the caller has to give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownEncoder {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Encoder counts per turn.
    pub counts_per_rev: f64,
    /// Number of pole pairs, which the motor's alignment has confirmed.
    pub pole_pairs: f64,
    /// Speed of the field, electrical turns per second.
    pub field_turns_per_s: f64,
}

/// One order `n` of the encoder's error over the shaft's angle `θ`: `A sin(n θ + φ)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// Amplitude of the error of this order, rad.
    pub amplitude_rad: f64,
    /// Phase of the error of this order, rad.
    pub phase_rad: f64,
    /// Uncertainty of amplitude and phase as a phasor `A e^(jφ)`, in any direction of the complex plane, rad.
    pub uncertainty_rad: f64,
}

/// The known motion from which the encoder's error was computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Witness {
    /// The turning of the motor's field, which is slow and timed by a clock.
    Field,
    /// The shaft's own motion with the motor switched off.
    Coast,
}

/// The encoder's error from one type of motion: for each order the phasor `A e^(jφ)` (amplitude and phase) and its uncertainty,
/// rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Said {
    /// Phasors of the encoder's error by order, from order 1, rad.
    pub parts: [Complex<f64>; ORDERS],
    /// Uncertainty of the phasors by order, from the difference between the directions or from noise, rad.
    pub uncertainty_rad: [f64; ORDERS],
    /// Residual of the fit, root mean square, rad.
    pub residual_rms_rad: f64,
}

/// The encoder's error as a function of the shaft's angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eccentricity {
    /// The error by order, from order 1. Phases count from the angle at which the calibration ended, which is the zero that it set.
    pub harmonics: [Harmonic; ORDERS],
    /// The known motion from which each order was calculated.
    pub witness: [Witness; ORDERS],
    /// Difference between the results from field and coasts by order, rad; `None` without a usable coast.
    pub apart_rad: Option<[f64; ORDERS]>,
    /// Residual of the fit to the field's motion, root mean square, rad.
    pub residual_rms_rad: f64,
    /// Angle of one encoder count, rad.
    pub count_rad: f64,
}

/// Reason why the encoder's error was not measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NotSeen {
    /// The field did not turn a whole turn in both directions, or its data are missing.
    #[error(
        "the record of the calibration's turn is incomplete: {heard} of {needed} records arrived"
    )]
    Incomplete {
        /// Number of ticks whose data arrived.
        heard: usize,
        /// Number of ticks whose data are needed.
        needed: usize,
    },
    /// The rotor did not follow the field.
    #[error(
        "the shaft did not follow the field evenly: it differs by {degrees:.1} electrical degrees"
    )]
    NotFollowed {
        /// Deviation of the shaft from the field, root mean square, electrical degrees.
        degrees: f64,
    },
    /// The two directions of turning give different errors of the encoder.
    #[error("the turn there and the turn back disagree about the encoder by {degrees:.2} degrees")]
    DoesNotRepeat {
        /// Difference between the encoder errors from the two directions, degrees.
        degrees: f64,
    },
}

impl Eccentricity {
    /// Calculates the encoder's error from a calibration's telemetry.
    ///
    /// # Errors
    /// Data are missing, the shaft did not follow the field, or the directions differ; see [`NotSeen`].
    pub fn new(ticks: &[CalibrationTick], known: &KnownEncoder) -> Result<Self, NotSeen> {
        let field = field::said(ticks, known)?;
        let coast = coast::said(ticks, known);
        let count_rad = std::f64::consts::TAU / known.counts_per_rev;
        // Phases count from the zero that the calibration sets, which is where it ends.
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
                // A difference far above the coast's uncertainty can only be an error of the field's result.
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

    /// Encoder error at a shaft angle, rad.
    #[must_use]
    pub fn error_rad(&self, angle_rad: f64) -> f64 {
        let parts = self.harmonics.iter().zip(1..);
        parts
            .map(|(it, order)| {
                it.amplitude_rad * (f64::from(order) * angle_rad + it.phase_rad).sin()
            })
            .sum()
    }

    /// Whether an order's amplitude exceeds its uncertainty and a quarter of an encoder count.
    #[must_use]
    pub fn stands_out(&self, index: usize) -> bool {
        let it = &self.harmonics[index];
        it.amplitude_rad > it.uncertainty_rad.max(COUNT_SHARE * self.count_rad)
    }
}
