//! The energy guard's settings, their ranges and warnings, and the coefficients that are computed from them.

use super::Guard;
use crate::quotient::over;
// By its former name, because another word in a proved body has the proofs made anew.
use crate::refusal as validate;
use crate::{
    ChangeOfForce, Compliance, Energy, Field, GuardSettings, Number, Position, Ratio,
    SettingsError, Si, Stiffness, Warning,
};

/// The properties of the device that the guard's coefficients depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GuardedDevice {
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Largest force ever commanded, N·m (N).
    pub force_limit: Si,
    /// Twice the largest error of a measured position: one encoder count plus twice the other errors, rad (m); up to 0.1.
    pub count: Si,
}

/// Added to a value that was rounded down, to make it an upper bound. It is larger than the rounding errors of a sum of products
/// and quotients.
const UP: Si = Si::from_bits(8);

/// Quantities in SI units that follow from the guard's settings and the device.
struct Derived {
    /// Trusted damping over the control period, rounded down.
    damping: Si,
    /// Largest displacement in a tick, rounded up.
    distance: Si,
    /// Largest displacement in a tick plus an encoder count, rounded up.
    reach: Si,
    /// Mean fraction of a tick after which a force begins to act. The value is exact, because the control rate is a whole number.
    late: Si,
}

impl GuardSettings {
    /// Limits the sum of delay and lag to one tick, rounded down. Accepted settings can exceed the tick by 2^-32 s, the
    /// smallest step of [`Si`].
    #[inline]
    fn within_a_tick(&self, device: &GuardedDevice) -> Self {
        let tick = over(Si::ONE, Si::saturating_from_num(device.rate_hz));
        let delay = self.delay.min(tick);
        let lag = self.lag.min(tick.saturating_sub(delay));
        Self {
            delay,
            lag,
            ..*self
        }
    }

    #[inline]
    fn derived(&self, device: &GuardedDevice) -> Derived {
        let rate = Si::saturating_from_num(device.rate_hz);
        let damping = self
            .share_of_damping
            .saturating_mul(self.damping)
            .saturating_mul(rate);
        // A measured displacement may be shorter than the true one by an encoder count.
        let measured = over(self.overspeed, rate);
        let distance = measured.saturating_add(device.count).saturating_add(UP);
        Derived {
            damping,
            distance,
            reach: distance.saturating_add(device.count),
            late: self.delay.saturating_add(self.lag).saturating_mul(rate),
        }
    }

    /// Checks every setting against its range, at a control rate from 1 Hz to 100 kHz.
    ///
    /// # Errors
    /// The first setting that is out of range.
    #[inline]
    pub fn validate(&self, device: &GuardedDevice) -> Result<(), SettingsError> {
        self.check_ranges()?;
        let within = |field, value, max| validate::within(field, value, Si::ZERO, max);
        let whole = Si::const_from_int;
        let rate = Si::saturating_from_num(device.rate_hz);
        validate::within(Field::RateHz, rate, Si::ONE, whole(100_000))?;
        within(Field::ForceLimit, device.force_limit, whole(1_000))?;
        let coarsest = const { Si::lit("0.1") };
        if device.count < Si::ZERO || device.count > coarsest {
            return Err(SettingsError::TooCoarse {
                count: device.count,
                coarsest,
            });
        }
        // Settings are rounded to the nearest digit and this quotient is rounded down. So a delay of exactly a tick, or a delay and
        // a lag that sum to a tick, can exceed the quotient by one last digit.
        let tick = over(Si::ONE, rate).saturating_add(Si::DELTA);
        within(Field::GuardDelay, self.delay, tick)?;
        within(Field::GuardLag, self.lag, tick.saturating_sub(self.delay))
    }

    /// Warnings about settings with which the guard softens the wall, or with which its energy account runs empty in normal use.
    #[must_use]
    pub fn warnings(&self, device: &GuardedDevice) -> [Option<Warning>; 2] {
        let derived = self.within_a_tick(device).derived(device);
        let force = device.force_limit;
        // The energy for the displacement of a tick, and for the part of it over which the force acts after the next sample.
        let needed = force
            .saturating_mul(derived.reach)
            .saturating_mul(Si::ONE.saturating_add(derived.late))
            .saturating_add(force.saturating_mul(device.count) / 2);
        [
            (self.capacity < needed).then_some(Warning::GuardSoftensAtForceLimit {
                capacity: self.capacity,
                needed,
            }),
            (self.refill <= Si::ZERO).then_some(Warning::GuardNeverRefilled),
        ]
    }
}

fn refused<N: Number>(field: Field, value: Si) -> SettingsError {
    SettingsError::OutOfFormat {
        field,
        value,
        format: N::NAME,
    }
}

/// The smallest position or force above 0 in the number format.
pub(crate) fn quantum<N: Number>() -> Si {
    let step = |bit| Si::from_bits(1_i64.wrapping_shl(bit));
    let shows = |step: &Si| N::signal(*step).is_some_and(|signal| signal >= N::QUANTUM);
    (0..Si::FRAC_NBITS).map(step).find(shows).unwrap_or(Si::ONE)
}

/// Converts a position to the number format, rounded up.
fn up<N: Number>(field: Field, value: Si) -> Result<Position<N>, SettingsError> {
    N::signal(value)
        .map(|x| Position(N::add(x, N::QUANTUM)))
        .ok_or(refused::<N>(field, value))
}

impl<N: Number> Guard<N> {
    /// Validates the settings and computes the coefficients.
    ///
    /// # Errors
    /// A setting is out of its range, or a coefficient does not fit the number format.
    pub fn new(settings: &GuardSettings, device: &GuardedDevice) -> Result<Self, SettingsError> {
        settings.validate(device)?;
        let settings = &settings.within_a_tick(device);
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
        // Each term of the account's sum must be at most a quarter of its format.
        let quarter = |field, value: Si| {
            N::signal(value.saturating_mul_int(4)).ok_or(refused::<N>(field, value))
        };
        N::signal(device.force_limit).ok_or(refused::<N>(Field::ForceLimit, device.force_limit))?;
        quarter(Field::GuardCapacity, settings.capacity)?;
        quarter(
            Field::GuardDamping,
            derived.damping.saturating_mul(derived.distance),
        )?;
        quarter(Field::GuardOverspeed, derived.distance)?;
        quarter(Field::GuardRefill, over(settings.refill, rate))?;
        // The largest force for which the account's sum has room. If the capacity would allow a larger force, the guard allows
        // less force for each joule.
        let room = [
            const { Si::lit("31.9") },
            const { Si::lit("0.49") },
            const { Si::lit("0.24") },
        ]
        .into_iter()
        .find(|room| quarter(Field::GuardCapacity, *room).is_ok())
        .unwrap_or_default();
        // Roundings that are added to the largest displacement. The rounding of the reserve's displacement is a little more than a
        // step of the format, that of each of the two measured positions is a step.
        let step = quantum::<N>();
        let rounded = step
            .saturating_add(step)
            .saturating_add(step)
            .saturating_add(UP);
        let reach = derived.reach.saturating_add(rounded);
        let per_reach = over(Si::ONE, reach).min(over(room, settings.capacity));
        let largest_change = settings
            .capacity
            .saturating_mul(per_reach)
            .saturating_add(UP)
            .saturating_mul_int(2);

        // The time span in which the old force may still act, and the mean time for which it does.
        let tick = over(Si::ONE, rate);
        let (span, mean) = match settings.change {
            ChangeOfForce::Estimated => (tick, settings.delay.saturating_add(settings.lag)),
            ChangeOfForce::Measured => (tick.saturating_sub(settings.delay), settings.lag),
        };
        let delayed = settings.delay > Si::ZERO || settings.lag > Si::ZERO;
        let share = over(mean, span).min(Si::ONE);
        let rest = span.saturating_sub(mean).max(Si::ZERO);
        let split = share.saturating_mul(rest).saturating_add(UP);
        let (late, split) = if mean > Si::ZERO {
            (share, split)
        } else {
            (Si::ZERO, Si::ZERO)
        };
        // The product with the largest change of force must fit. Without damping, a delay cannot be compensated.
        let trusted = settings.share_of_damping.saturating_mul(settings.damping);
        let stray = over(split, trusted.saturating_mul_int(4));
        let stray = if split > Si::ZERO { stray } else { Si::ZERO };
        quarter(Field::GuardDamping, stray.saturating_mul(largest_change))?;
        let half_count = device.count / 2;
        // Upper bound of what rounding leaves out. The last digits of `stray` and `late` lose one step of the format for every
        // newton-metre of a change of force and for every radian of a displacement. Rounding the tick, of which `late` is a
        // fraction, loses a 256th of the overspeed `v`.
        let left_out = largest_change
            .saturating_add(derived.distance)
            .saturating_add(settings.overspeed / 256);
        let quanta = 1 + i64::from(left_out.saturating_to_num::<u16>());
        // Below 2^48, because a step of the format is at most 1, which is 2^32 steps of [`Si`].
        let left_out = Si::from_bits(step.to_bits().wrapping_mul(quanta));
        // A measured position at the change of force is rounded by a step of the format.
        let rounded_change = match settings.change {
            ChangeOfForce::Estimated => Position::zero(),
            ChangeOfForce::Measured => Position::quantum(),
        };
        // Adds half an encoder count, and a step of the format each for the position and for the part under the old force.
        let slack = up::<N>(Field::GuardOverspeed, half_count.saturating_add(left_out))?
            + Position::quantum()
            + Position::quantum()
            + rounded_change;
        let way = derived.late.saturating_mul(derived.distance);
        let in_flight = if delayed {
            way.saturating_add(UP).saturating_add(half_count)
        } else {
            half_count
        };
        // The position from which the displacement is measured is rounded as well.
        quarter(Field::GuardDelay, in_flight.saturating_add(rounded))?;
        let overrun = over(
            derived.late.saturating_add(UP).saturating_add(Si::ONE),
            derived.damping.saturating_mul_int(4),
        );
        // With hardly any damping the cost of overspeed has no bound; the coefficient is then the largest ratio of the format.
        let overrun = [overrun, whole(127), whole(1), const { Si::lit("0.99") }]
            .into_iter()
            .find_map(N::ratio)
            .unwrap_or_default();
        Ok(Self {
            capacity: energy(Field::GuardCapacity, settings.capacity)?,
            refill: energy(Field::GuardRefill, over(settings.refill, rate))?,
            damping: gain(Field::GuardDamping, derived.damping)?,
            furthest: Position(
                N::signal(over(settings.overspeed, rate))
                    .ok_or(refused::<N>(Field::GuardOverspeed, settings.overspeed))?,
            ),
            count: up::<N>(Field::GuardOverspeed, device.count)?
                + Position::quantum()
                + Position::quantum(),
            late: Ratio(N::ratio(late).ok_or(refused::<N>(Field::GuardDelay, late))?),
            stray: Compliance(N::ratio(stray).ok_or(refused::<N>(Field::GuardDamping, stray))?),
            slack,
            per_reach: gain(Field::GuardOverspeed, per_reach)?,
            in_flight: up::<N>(Field::GuardDelay, in_flight)? + Position::quantum(),
            overrun: Compliance(overrun),
        })
    }
}
