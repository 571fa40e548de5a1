//! The state estimator's settings in SI units, and the coefficients that are computed from them.

use super::flow::{DeviceInTicks, LONGEST_DELAY, approach};
use super::{Estimator, Weight};
use crate::number::Exact;
use crate::quotient::over;
use crate::{EstimatorSettings, Field, Force, Number, SettingsError, Si};

/// The quotient `a / b` of two positive settings, saturating.
#[inline]
fn ratio(a: Si, b: Si) -> Exact {
    ratio_of_bits(a.to_bits(), b.to_bits())
}

/// `a / b` for two positive fixed-point numbers of the same format, given as integers. Rounded down, saturating.
#[cold]
#[inline(never)]
pub fn ratio_of_bits(a: i64, b: i64) -> Exact {
    let bits = i128::from(a)
        .wrapping_shl(Exact::FRAC_NBITS)
        .checked_div(i128::from(b))
        .unwrap_or(i128::from(i64::MAX));
    Exact::from_bits(i64::try_from(bits).unwrap_or(i64::MAX))
}

/// Checks a bandwidth in Hz against its range, a 500th to a fifth of the control rate.
#[inline]
pub(crate) fn check_bandwidth(
    field: Field,
    bandwidth_hz: Si,
    rate_hz: u32,
) -> Result<(), SettingsError> {
    let rate = Si::saturating_from_num(rate_hz.max(1));
    let (min, max) = (
        over(rate, const { Si::const_from_int(500) }),
        over(rate, const { Si::const_from_int(5) }),
    );
    if bandwidth_hz < min || bandwidth_hz > max {
        return Err(SettingsError::OutOfRange {
            field,
            value: bandwidth_hz,
            min,
            max,
        });
    }
    Ok(())
}

/// A bandwidth `p` as an angle per tick, `2π p T` in rad, with the tick `T` in seconds.
#[inline]
pub(crate) fn per_tick(bandwidth_hz: Si, rate_hz: u32) -> Exact {
    let rate = Si::saturating_from_num(rate_hz.max(1));
    ratio(bandwidth_hz, rate).saturating_mul(Exact::TAU)
}

/// Ranges of the estimator's settings, with the tick `T` in seconds:
///
/// - `bandwidth_hz`, `p`: from a 500th to a fifth of the control rate. The three poles of the estimator's error are `exp(-2π p T)`.
/// - `inertia`: so large that the force limit, or 0.76 N·m if that is larger, accelerates the device by at most 1 rad per tick²;
///   at most `6e7 T²` kg·m².
/// - `damping`: only a damping over inertia up to `2π p` is modelled. With more damping the device would coast to rest faster
///   than the estimator can follow, so the excess counts as a part of the hand's push.
/// - `delay_s`: a delay longer than two ticks is predicted for two ticks, so that one scene serves several control rates.
impl EstimatorSettings {
    /// Checks every setting against its range at a control rate and for a largest force, N·m (N).
    ///
    /// # Errors
    /// The first setting that is out of range.
    #[inline]
    pub fn validate(&self, rate_hz: u32, force_limit: Si) -> Result<(), SettingsError> {
        self.check_ranges()?;
        let rate = Si::saturating_from_num(rate_hz.max(1));
        check_bandwidth(Field::EstimatorBandwidth, self.bandwidth_hz, rate_hz)?;
        // The limits on the inertia over T² keep `q f` at most 1 and `q (X(2) - X(1)) = 3/2 q` below 2, with `q = T²/J`. (The
        // inertia is multiplied by the squared rate, because T² itself would have too few digits at a high rate.)
        let (lightest, heaviest) = (
            force_limit.max(const { Si::lit("0.76") }),
            const { Si::lit("60000000") },
        );
        let per_tick2 = self.inertia_in_ticks(rate);
        if per_tick2 < lightest || per_tick2 > heaviest {
            let inertia = |per_tick2| over(over(per_tick2, rate), rate);
            return Err(SettingsError::OutOfRange {
                field: Field::EstimatorInertia,
                value: self.inertia,
                min: inertia(lightest).saturating_add(Si::DELTA),
                max: inertia(heaviest),
            });
        }
        Ok(())
    }

    /// Torque that accelerates the inertia by 1 rad per tick², N·m. On three axes it is the force in N for 1 m per tick².
    ///
    /// The function is separate because of the stack analysis, which cannot follow the indirect call that the compiler of small
    /// programs otherwise makes.
    #[inline]
    fn inertia_in_ticks(&self, rate: Si) -> Si {
        self.inertia.saturating_mul(rate).saturating_mul(rate)
    }

    /// Validates the settings, and computes the estimator's coefficients.
    ///
    /// # Errors
    /// Same as [`EstimatorSettings::validate`]. An error about the inertia has two further causes: the force limit does not fit the
    /// number format, or sums of coefficients could overflow ([`Estimator::is_bounded`]). No settings with the second cause are
    /// known.
    pub fn estimator<N: Number>(
        &self,
        rate_hz: u32,
        force_limit: Si,
    ) -> Result<Estimator<N>, SettingsError> {
        self.validate(rate_hz, force_limit)?;
        let rate = Si::saturating_from_num(rate_hz.max(1));
        let inertia = self.inertia_in_ticks(rate);
        let angle = per_tick(self.bandwidth_hz, rate_hz);
        let device = DeviceInTicks {
            loss: ratio(self.damping.saturating_mul(rate), inertia).min(angle),
            per_torque: ratio(Si::ONE, inertia),
            delay: ratio(self.delay_s.saturating_mul(rate), Si::ONE)
                .min(Exact::saturating_from_num(LONGEST_DELAY)),
        };
        let built = || {
            Some(Estimator {
                tick: device.tick()?,
                ahead: device.ahead()?,
                correction: device.correction::<N>(angle)?,
                limit: N::signal(force_limit).map(Force)?,
            })
        };
        built()
            .filter(Estimator::is_bounded)
            .ok_or(SettingsError::OutOfFormat {
                field: Field::EstimatorInertia,
                value: inertia,
                format: N::NAME,
            })
    }
}

impl DeviceInTicks {
    /// The gains `α`, `β`, `γ` with which the difference of measured and predicted position corrects position, displacement per
    /// tick and the hand's push. They put all three poles of the estimator's error at `exp(-angle)`. `None` if one gain does not
    /// fit its format.
    pub fn correction<N: Number>(&self, angle: Exact) -> Option<[Weight<N>; 3]> {
        let fast = approach(angle);
        let pole = Exact::ONE.saturating_sub(fast);
        let (reach, drift) = self.integrals(Exact::ONE);
        let kept = Exact::ONE.saturating_sub(self.loss.saturating_mul(reach));
        let cube = |x: Exact| x.saturating_mul(x).saturating_mul(x);
        let quotient = |a: Exact, b: Exact| a.checked_div(b).unwrap_or(Exact::ZERO);
        let two = Exact::const_from_int(2);
        let three = Exact::const_from_int(3);

        let position = Exact::ONE.saturating_sub(quotient(cube(pole), kept));
        let pushed = quotient(cube(fast), reach);
        let moved = two
            .saturating_add(kept)
            .saturating_sub(pole.saturating_mul(three))
            .saturating_sub(position)
            .saturating_sub(drift.saturating_mul(pushed));
        let moved = quotient(moved, reach);
        let weight = <N::Wide as crate::number::Wide>::weight;
        Some([weight(position)?, weight(moved)?, weight(pushed)?])
    }
}
