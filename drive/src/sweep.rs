//! Cogging sweep after a calibration. It turns the shaft slowly and evenly, in one direction and back, and reports the current that
//! each position needs. The computer calculates the cogging from these currents, in `touchstone_lab::identify::cogging`.
//!
//! ```text
//! Forward: a quarter of a turn to get going, two turns -> Backward: the same -> stand -> done
//! ```
//!
//! A position loop follows a reference that moves at a quarter of a turn per second. The loop need not be stiff: the encoder counts
//! show how far the shaft deviates, and the computer corrects for the inertia. Friction changes its sign with the direction and
//! cogging does not, so the mean of both directions is the cogging alone. Two turns in each direction show how well the result
//! repeats.

use crate::Amps;
use crate::calibration::Reason;
use crate::command::Rotor;
use crate::measurement::Measuring;
use crate::units::{clamp_i32, narrow, product, quotient};
use fixed::types::I16F16;
use touchstone_control::Si;
use touchstone_protocol::{DeviceSettings, MeasuringPart};

/// Number of turns in each direction from which the cogging is calculated.
pub const TURNS: i64 = 2;
/// Speed of the sweep in quarters of a turn per second.
pub const QUARTERS_PER_S: i64 = 1;
/// The shaft counts as held if it is behind the position reference by more than a turn divided by this number.
const HELD: i64 = 16;

/// The constant `2π`.
const TWO_PI: Si = Si::lit("6.283185307");
/// Natural frequency of the sweep's position loop, rad/s (20 Hz).
const OMEGA: Si = Si::lit("125.66");
/// Damping of the position loop, as a fraction of critical damping.
const DAMPING: Si = Si::lit("0.7");
/// Growth of the position loop's integral part per second, as a multiple of its proportional part.
const INTEGRAL_PER_S: Si = Si::lit("25");

/// Coefficients of a cogging sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SweepConfig {
    counts_per_rev: i64,
    /// Speed of the position reference, 2^-16 counts per control period; `speed_step` is its largest change in a period.
    speed: i64,
    speed_step: i64,
    /// Factor from a speed in 2^-16 counts per control period to rad/s, with 32 fractional bits.
    rad_per_s: i64,
    /// Stiffness of the position loop, A per count, with 32 fractional bits.
    stiffness: i64,
    /// Growth of the position loop's integral in a control period, as a fraction of the proportional part, with 32 fractional bits.
    integral: i64,
    /// Damping of the sweep's position loop, A·s/rad.
    damping: I16F16,
    limit: Amps,
    /// Control periods for which the shaft is held at rest at the end of the sweep.
    stand: u32,
}

impl SweepConfig {
    /// Computes the coefficients of a cogging sweep from validated settings. The position loop needs `law.estimator.inertia_kg_m2`
    /// to be right within a factor of two.
    #[must_use]
    pub fn new(settings: &DeviceSettings) -> Self {
        let rate = settings.timing.rate_hz.max(1);
        let counts = i64::from(settings.encoder.counts_per_rev.max(1));
        let per_second = (counts << 16) * QUARTERS_PER_S / 4;
        let speed = (per_second / i64::from(rate)).max(1);
        let constant = settings.motor.torque_constant_n_m_per_a;
        let inertia = settings.law.estimator.inertia_kg_m2;
        // Inertia times frequency over torque constant: J ω / k_t, A·s/rad, and J ω² / k_t, A/rad.
        let once = quotient(inertia.saturating_mul(OMEGA), constant);
        let twice = once.saturating_mul(OMEGA);
        let counts_si = Si::saturating_from_num(counts);
        let stiffness = quotient(twice.saturating_mul(TWO_PI), counts_si);
        let rate_si = Si::saturating_from_num(rate);
        let integral = quotient(INTEGRAL_PER_S, rate_si);
        let rad = quotient(TWO_PI.saturating_mul(rate_si), counts_si);
        Self {
            counts_per_rev: counts,
            speed,
            speed_step: (speed * 4 / i64::from(rate)).max(1),
            rad_per_s: rad.to_bits(),
            stiffness: stiffness.to_bits(),
            integral: integral.to_bits(),
            damping: narrow(
                once.saturating_mul(DAMPING)
                    .saturating_mul(Si::const_from_int(2)),
            ),
            limit: narrow(settings.calibration.current_a),
            stand: (rate / 2).max(1),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Forward,
    Backward,
    Stand,
}

/// The state of a running cogging sweep.
#[derive(Debug, Clone, Copy)]
pub struct Running {
    config: SweepConfig,
    way: Way,
    /// Control periods for which the shaft has stood at the end of the sweep.
    ticks: u32,
    /// Position of the loop's reference, 2^-16 counts; `speed` is its speed, 2^-16 counts per control period.
    place: i64,
    speed: i64,
    /// Encoder count at which the sweep's present direction ends.
    end: i64,
    /// Current of the position loop's integral part, 2^-48 A.
    integral: i64,
}

impl Running {
    /// Begins a sweep with the shaft at this encoder count.
    #[must_use]
    pub const fn new(config: SweepConfig, count: i64) -> Self {
        Self {
            config,
            way: Way::Forward,
            ticks: 0,
            place: count << 16,
            speed: 0,
            end: count + way(config.counts_per_rev),
            integral: 0,
        }
    }

    /// The part of the sweep that runs (forward or backward); `None` while the shaft stands at the end.
    #[must_use]
    pub const fn part(&self) -> Option<MeasuringPart> {
        match self.way {
            Way::Forward => Some(MeasuringPart::Forward),
            Way::Backward => Some(MeasuringPart::Backward),
            Way::Stand => None,
        }
    }

    /// Runs one control period of the sweep. Takes the encoder count, the shaft's speed, the rotor's angle, and the current that a
    /// cogging map adds.
    ///
    /// In a control period without a good encoder reading the caller does not call this function: the outputs are off.
    pub fn tick(&mut self, count: i64, speed: I16F16, rotor: &Rotor, map: Amps) -> Measuring {
        self.go(count);
        let config = &self.config;
        let behind = self.place.saturating_sub(count << 16);
        if behind.saturating_abs() > (config.counts_per_rev << 16) / HELD {
            return Measuring::Failed(Reason::Held);
        }
        if self.way == Way::Stand && self.ticks >= config.stand {
            return Measuring::Done;
        }
        let spring = clamp_i32(behind.saturating_mul(config.stiffness) >> 32);
        let most = i64::from(config.limit.to_bits()) << 32;
        let more = i64::from(spring) * config.integral;
        // Not `clamp`, because that panics if its lower end is above the upper one.
        self.integral = self.integral.saturating_add(more).min(most).max(-most);
        let wanted = clamp_i32((self.speed * config.rad_per_s) >> 32);
        let slower = wanted.saturating_sub(speed.to_bits());
        let damper = product(slower, config.damping.to_bits(), 16);
        let sum = i64::from(spring) + i64::from(damper) + (self.integral >> 32);
        let along = Amps::from_bits(clamp_i32(sum));
        let along = along.min(config.limit).max(config.limit.saturating_neg());
        Measuring::Running(rotor.along(along.saturating_add(map)))
    }

    /// Moves the position reference by one control period.
    fn go(&mut self, count: i64) {
        let wanted = match self.way {
            Way::Forward => self.config.speed,
            Way::Backward => -self.config.speed,
            Way::Stand => 0,
        };
        let step = self.config.speed_step;
        self.speed += (wanted - self.speed).min(step).max(-step);
        self.place = self.place.saturating_add(self.speed);
        match self.way {
            Way::Forward if count >= self.end => {
                self.way = Way::Backward;
                self.end -= way(self.config.counts_per_rev);
            }
            Way::Backward if count <= self.end => self.way = Way::Stand,
            Way::Stand => self.ticks = self.ticks.saturating_add(1),
            Way::Forward | Way::Backward => {}
        }
    }
}

/// Encoder counts of one direction of the sweep: a quarter of a turn to start or to reverse, and the turns that are evaluated.
const fn way(counts_per_rev: i64) -> i64 {
    counts_per_rev * TURNS + counts_per_rev / 4
}
