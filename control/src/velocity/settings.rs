//! The velocity filter's settings in SI units, and the coefficients computed from them.

use super::{FirstOrderAdaptiveWindow, LONGEST_WINDOW, Slope, Smoothed, Tracker, Velocity};
use crate::estimator::{Flow, Weight, approach, per_tick, ratio_of_bits};
use crate::number::Exact;
use crate::{
    Field, Number, Position, Ratio, SettingsError, Si, Stiffness, VelocityKind, VelocitySettings,
};

/// `1/√2`, to the last digit of the number format in which filter coefficients are calculated.
const ROOT_HALF: Exact = Exact::lit("0.7071067811865475244");

impl VelocitySettings {
    /// Checks every setting against its range at a control rate.
    ///
    /// # Errors
    /// The first setting that is out of range.
    #[inline]
    pub fn validate(&self, rate_hz: u32) -> Result<(), SettingsError> {
        self.check_ranges()?;
        match self.from {
            VelocityKind::Told | VelocityKind::Foaw => Ok(()),
            VelocityKind::Filtered | VelocityKind::Kalman | VelocityKind::KalmanAcceleration => {
                crate::estimator::check_bandwidth(
                    Field::VelocityBandwidth,
                    self.bandwidth_hz,
                    rate_hz,
                )
            }
        }
    }

    /// Validates the settings and computes the filter's coefficients. `None` if the settings choose no filter. `count` is the
    /// distance between neighbouring positions, rad (m).
    ///
    /// # Errors
    /// Same as [`VelocitySettings::validate`]; also a count that the number format cannot hold.
    pub fn velocity<N: Number>(
        &self,
        rate_hz: u32,
        count: Si,
    ) -> Result<Option<Velocity<N>>, SettingsError> {
        self.validate(rate_hz)?;
        let angle = per_tick(self.bandwidth_hz, rate_hz);
        let built = match self.from {
            VelocityKind::Told => return Ok(None),
            VelocityKind::Filtered => smoothed(approach(angle)),
            VelocityKind::Kalman => tracker(approach(angle.saturating_mul(ROOT_HALF)), false),
            VelocityKind::KalmanAcceleration => tracker(approach(angle), true),
            VelocityKind::Foaw => window(self.window_s, rate_hz, count),
        };
        built.map(Some).ok_or(SettingsError::OutOfFormat {
            field: Field::VelocityFrom,
            value: count,
            format: N::NAME,
        })
    }
}

fn weight<N: Number>(value: Exact) -> Option<Weight<N>> {
    <N::Wide as crate::number::Wide>::weight(value)
}

fn smoothed<N: Number>(share: Exact) -> Option<Velocity<N>> {
    let share = weight::<N>(share)?;
    Some(Velocity::Smoothed(Smoothed { share }))
}

/// The Kalman filter for `r = sqrt(1 - α)`, as in [`Tracker`]. `lost` is `1 - r`; `accelerates` chooses constant acceleration.
#[inline]
fn tracker<N: Number>(lost: Exact, accelerates: bool) -> Option<Velocity<N>> {
    let two = Exact::const_from_int(2);
    // The gain α = 1 - r², with r = 1 - lost: 1 - r² = (1 - r)(2 - (1 - r)).
    let alpha = lost.saturating_mul(two.saturating_sub(lost));
    let beta = lost.saturating_add(lost).saturating_mul(lost);
    let gamma = if accelerates {
        let twice = alpha.saturating_add(alpha);
        ratio_of_bits(beta.saturating_mul(beta).to_bits(), twice.to_bits())
    } else {
        Exact::ZERO
    };
    Some(Velocity::Tracker(Tracker {
        free: Flow::free()?,
        correction: [weight::<N>(alpha)?, weight::<N>(beta)?, weight::<N>(gamma)?],
    }))
}

fn window<N: Number>(window_s: Si, rate_hz: u32, count: Si) -> Option<Velocity<N>> {
    let half = const { Si::lit("0.5") };
    let ticks = window_s
        .saturating_mul(Si::saturating_from_num(rate_hz))
        .saturating_add(half)
        .saturating_to_num::<u8>();
    let longest = ticks.clamp(1, LONGEST_WINDOW as u8);
    let mut slopes = [Slope {
        times: Stiffness::zero(),
        share: Ratio::zero(),
    }; LONGEST_WINDOW];
    for (slope, n) in slopes.iter_mut().zip(1_i32..) {
        let n = Si::saturating_from_num(n);
        slope.times = Stiffness(N::gain(n)?);
        slope.share = Ratio(N::ratio(Si::ONE.checked_div(n)?)?);
    }
    Some(Velocity::Window(FirstOrderAdaptiveWindow {
        slopes,
        longest,
        // Adds a step of the number format for each of the three positions that are compared.
        margin: Position(N::signal(count)?)
            + Position::quantum()
            + Position::quantum()
            + Position::quantum(),
    }))
}
