//! What a person sets of the guard, its ranges and warnings, and the coefficients made of it.

use super::Guard;
use crate::settings::Si;
use crate::{Compliance, Energy, Number, Position, Ratio, Stiffness};
use core::fmt;

/// What is known of the position at the instant at which a new force takes the place of the old one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ChangeOfForce {
    /// Nothing: positions are taken once a tick ([`Guard::tick`]). Each change of force is charged for what can have happened.
    #[default]
    Estimated,
    /// It is measured as well ([`Guard::tick_with_change`]), `delay` after the tick: nothing is charged for the delay.
    Measured,
}

/// The energy guard in SI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GuardSettings {
    /// `C`: what a hand may get out at once, J; 0 to 16.
    pub capacity: Si,
    /// `P`: what it may get out again and again, W; 0 to 1.
    pub refill: Si,
    /// The share of the device's measured damping that is trusted to be there, 0 to 1.
    pub share_of_damping: Si,
    /// The speed at which the drive trips, rad/s (m/s); up to 1000.
    pub overspeed: Si,
    /// From the sample to the instant at which its force begins to act, s; with `lag` at most one tick.
    pub delay: Si,
    /// From there to the force itself, as the mean of the current loop's step response, s.
    pub lag: Si,
    /// Twice the largest error of a measured position: a count of the encoder, rad (m); up to 0.1.
    pub count: Si,
    /// What is known of the position when the force changes.
    pub change: ChangeOfForce,
}

impl Default for GuardSettings {
    /// 20 mJ at once and half a milliwatt, for the thesis' knob with 40,000 counts.
    fn default() -> Self {
        Self {
            capacity: const { Si::lit("0.02") },
            refill: const { Si::lit("0.0005") },
            share_of_damping: const { Si::lit("0.8") },
            overspeed: const { Si::lit("60") },
            delay: Si::ZERO,
            lag: Si::ZERO,
            count: const { Si::lit("0.000157079633") },
            change: ChangeOfForce::Estimated,
        }
    }
}

/// What the guard must know of the device behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GuardedDevice {
    /// Control rate `1/T`, Hz.
    pub rate_hz: u32,
    /// Viscous damping of the device alone, without the hand, N·m·s/rad (N·s/m).
    pub damping: Si,
    /// Largest force ever commanded, N·m (N).
    pub force_limit: Si,
}

/// A setting of the guard, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum GuardField {
    RateHz,
    Damping,
    ForceLimit,
    Capacity,
    Refill,
    ShareOfDamping,
    Overspeed,
    Delay,
    Lag,
    Count,
}

impl GuardField {
    /// Name as in [`GuardSettings`] or [`GuardedDevice`].
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::RateHz => "rate_hz",
            Self::Damping => "damping",
            Self::ForceLimit => "force_limit",
            Self::Capacity => "guard.capacity",
            Self::Refill => "guard.refill",
            Self::ShareOfDamping => "guard.share_of_damping",
            Self::Overspeed => "guard.overspeed",
            Self::Delay => "guard.delay",
            Self::Lag => "guard.lag",
            Self::Count => "guard.count",
        }
    }
}

/// Why the guard's settings are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GuardError {
    /// Outside its physical range.
    OutOfRange {
        /// Which setting.
        field: GuardField,
        /// Its value, SI.
        value: Si,
        /// Smallest allowed value, SI.
        min: Si,
        /// Largest allowed value, SI.
        max: Si,
    },
    /// A coefficient made of it does not fit the number format.
    OutOfFormat {
        /// The setting that it rests on most.
        field: GuardField,
        /// The coefficient, SI.
        value: Si,
        /// The format.
        format: &'static str,
    },
}

impl fmt::Display for GuardError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange {
                field,
                value,
                min,
                max,
            } => write!(
                f,
                "{} = {value:.6} is outside {min:.6} to {max:.6}",
                field.name()
            ),
            Self::OutOfFormat {
                field,
                value,
                format,
            } => write!(
                f,
                "{}: its coefficient {value:.6} does not fit the number format {format}",
                field.name()
            ),
        }
    }
}

/// What the settings give away.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GuardWarning {
    /// A full account does not answer for the force limit: harder presses meet a softer wall.
    ForceLimitNotCovered {
        /// `C`, J.
        capacity: Si,
        /// What the force limit needs, J.
        needed: Si,
    },
    /// Without a refill, rounding and one-count chatter use the account up in time, in the quietest hold.
    NeverRefilled,
}

impl fmt::Display for GuardWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ForceLimitNotCovered { capacity, needed } => write!(
                f,
                "guard.capacity = {capacity:.6} J is less than the {needed:.6} J that force_limit needs: raise it, or lower force_limit or guard.overspeed"
            ),
            Self::NeverRefilled => write!(
                f,
                "guard.refill = 0: chatter of one count uses the account up in time; 0.0005 W lasts for ever"
            ),
        }
    }
}

/// What [`GuardSettings::warnings`] found, at most one of each.
pub type GuardWarnings = [Option<GuardWarning>; 2];

/// Rounding upwards of what was computed downwards: more than the few last digits that a sum of products and quotients loses.
const UP: Si = Si::from_bits(8);
const TWO: Si = Si::const_from_int(2);

fn over(a: Si, b: Si) -> Si {
    if b <= Si::ZERO {
        Si::MAX
    } else {
        a.saturating_div(b)
    }
}

/// What settings and device come to, SI.
struct Derived {
    /// `c`, rounded down.
    damping: Si,
    /// `d`, rounded up.
    distance: Si,
    /// `D = d + δ`, rounded up.
    reach: Si,
    /// Share of a tick after which a force acts, in the mean, rounded up.
    late: Si,
}

impl GuardSettings {
    fn derived(&self, device: &GuardedDevice) -> Derived {
        let rate = Si::saturating_from_num(device.rate_hz);
        let damping = self
            .share_of_damping
            .saturating_mul(device.damping)
            .saturating_mul(rate);
        // What is measured may be a count shorter than what was moved.
        let measured = over(self.overspeed, rate);
        let distance = measured.saturating_add(self.count).saturating_add(UP);
        Derived {
            damping,
            distance,
            reach: distance.saturating_add(self.count),
            late: self
                .delay
                .saturating_add(self.lag)
                .saturating_mul(rate)
                .saturating_add(UP),
        }
    }

    /// Every setting within its range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn validate(&self, device: &GuardedDevice) -> Result<(), GuardError> {
        use GuardField as F;
        let (zero, one) = (Si::ZERO, Si::ONE);
        let whole = Si::const_from_int;
        let rate = Si::saturating_from_num(device.rate_hz);
        let within = |field, value: Si, min: Si, max: Si| {
            if value < min || value > max {
                Err(GuardError::OutOfRange {
                    field,
                    value,
                    min,
                    max,
                })
            } else {
                Ok(())
            }
        };
        within(F::RateHz, rate, one, whole(100_000))?;
        within(F::Damping, device.damping, zero, whole(1_000))?;
        within(F::ForceLimit, device.force_limit, zero, whole(1_000))?;
        within(F::Capacity, self.capacity, zero, whole(16))?;
        within(F::Refill, self.refill, zero, one)?;
        within(F::ShareOfDamping, self.share_of_damping, zero, one)?;
        within(
            F::Overspeed,
            self.overspeed,
            const { Si::lit("0.001") },
            whole(1_000),
        )?;
        within(F::Count, self.count, zero, const { Si::lit("0.1") })?;
        // A tick in the digits of a setting is rounded down: a delay of a whole tick is one of these.
        let tick = over(one, rate);
        within(F::Delay, self.delay, zero, tick)?;
        within(F::Lag, self.lag, zero, tick.saturating_sub(self.delay))
    }

    /// What the settings give away.
    #[must_use]
    pub fn warnings(&self, device: &GuardedDevice) -> GuardWarnings {
        let derived = self.derived(device);
        let force = device.force_limit;
        // For the displacement of a tick, and for the part of it that the force acts on after the next sample.
        let needed = force
            .saturating_mul(derived.reach)
            .saturating_mul(Si::ONE.saturating_add(derived.late))
            .saturating_add(force.saturating_mul(self.count) / 2);
        [
            (self.capacity < needed).then_some(GuardWarning::ForceLimitNotCovered {
                capacity: self.capacity,
                needed,
            }),
            (self.refill <= Si::ZERO).then_some(GuardWarning::NeverRefilled),
        ]
    }
}

fn refused<N: Number>(field: GuardField, value: Si) -> GuardError {
    GuardError::OutOfFormat {
        field,
        value,
        format: N::NAME,
    }
}

/// A position, rounded up.
fn up<N: Number>(field: GuardField, value: Si) -> Result<Position<N>, GuardError> {
    N::signal(value)
        .map(|x| Position(N::add(x, N::QUANTUM)))
        .ok_or(refused::<N>(field, value))
}

impl<N: Number> Guard<N> {
    /// Validates the settings and computes the coefficients.
    ///
    /// # Errors
    /// A setting out of its range, or a coefficient that does not fit the number format.
    pub fn new(settings: &GuardSettings, device: &GuardedDevice) -> Result<Self, GuardError> {
        use GuardField as F;
        settings.validate(device)?;
        let derived = settings.derived(device);
        let whole = Si::const_from_int;
        let rate = Si::saturating_from_num(device.rate_hz);
        let energy = |field, value| {
            N::energy(value)
                .map(Energy)
                .ok_or(refused::<N>(field, value))
        };
        let gain = |field, value| {
            N::gain(value)
                .map(Stiffness)
                .ok_or(refused::<N>(field, value))
        };
        // Four times of what the sums of the books are made of must fit.
        let quarter = |field, value: Si| {
            N::signal(value.saturating_mul(whole(4))).ok_or(refused::<N>(field, value))
        };
        N::signal(device.force_limit).ok_or(refused::<N>(F::ForceLimit, device.force_limit))?;
        quarter(F::Capacity, settings.capacity)?;
        quarter(F::Damping, derived.damping.saturating_mul(derived.distance))?;
        quarter(F::Overspeed, derived.distance)?;
        // An account that pays for more force than the books have room for lets less through.
        let room = [
            const { Si::lit("31.9") },
            const { Si::lit("0.49") },
            const { Si::lit("0.24") },
        ]
        .into_iter()
        .find(|room| quarter(F::Capacity, *room).is_ok())
        .unwrap_or_default();
        let per_reach = over(Si::ONE, derived.reach).min(over(room, settings.capacity));
        let largest_change = settings
            .capacity
            .saturating_mul(per_reach)
            .saturating_add(UP)
            .saturating_mul(TWO);

        // Over how much time the old force may have gone on, in the mean, of how much.
        let tick = over(Si::ONE, rate);
        let (span, mean) = match settings.change {
            ChangeOfForce::Estimated => (tick, settings.delay.saturating_add(settings.lag)),
            ChangeOfForce::Measured => (tick.saturating_sub(settings.delay), settings.lag),
        };
        let delayed = settings.delay > Si::ZERO || settings.lag > Si::ZERO;
        let (late, split) = if mean > Si::ZERO {
            let share = over(mean, span).min(Si::ONE);
            let rest = span.saturating_sub(mean).max(Si::ZERO);
            (share, share.saturating_mul(rest).saturating_add(UP))
        } else {
            (Si::ZERO, Si::ZERO)
        };
        // It must fit with the largest change of force: without damping a delay cannot be answered for.
        let trusted = settings.share_of_damping.saturating_mul(device.damping);
        let stray = if split > Si::ZERO {
            over(split, trusted.saturating_mul(whole(4)))
        } else {
            Si::ZERO
        };
        quarter(F::Damping, stray.saturating_mul(largest_change))?;
        // Half a count, and a quantum each for the position and for the part under the old force.
        let half_count = settings.count / 2;
        let mut slack = up::<N>(F::Count, half_count)? + Position::quantum() + Position::quantum();
        // What the last digit of the stray leaves out: a quantum for every newton-metre that a change can have.
        for _ in 0..=largest_change.saturating_to_num::<u16>() {
            slack = slack + Position::quantum();
        }
        let in_flight = if delayed {
            derived.late.saturating_mul(derived.distance)
        } else {
            Si::ZERO
        };
        let overrun = over(
            derived.late.saturating_add(Si::ONE),
            derived.damping.saturating_mul(whole(4)),
        );
        // With next to no damping there is no end to what overspeed costs: the largest ratio of each format in turn.
        let overrun = [overrun, whole(127), whole(1), const { Si::lit("0.99") }]
            .into_iter()
            .find_map(N::ratio)
            .unwrap_or_default();
        Ok(Self {
            capacity: energy(F::Capacity, settings.capacity)?,
            refill: energy(F::Refill, over(settings.refill, rate))?,
            damping: gain(F::Damping, derived.damping)?,
            furthest: Position(
                N::signal(over(settings.overspeed, rate))
                    .ok_or(refused::<N>(F::Overspeed, settings.overspeed))?,
            ),
            count: up::<N>(F::Count, settings.count)? + Position::quantum(),
            late: Ratio(N::ratio(late).ok_or(refused::<N>(F::Delay, late))?),
            stray: Compliance(N::ratio(stray).ok_or(refused::<N>(F::Damping, stray))?),
            slack,
            per_reach: gain(F::Overspeed, per_reach)?,
            in_flight: up::<N>(F::Delay, in_flight.saturating_add(half_count))?,
            overrun: Compliance(overrun),
        })
    }
}
