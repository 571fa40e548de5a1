//! A decaying vibration at the touch of a wall, by which people tell materials apart (Okamura, Cutkosky and Dennerlein, IEEE/ASME
//! Trans. Mechatronics 6(3) 245, 2001).
//!
//! A sinusoidal force `x` of the frequency `f` starts at the first control period `n = 1` inside the wall, where the device has the
//! speed `v`. It decays by `exp(-t/τ)` and is added to the law's force as long as the device is inside. Its amplitude is `s J ω v`,
//! at most the force limit, with the estimator's inertia `J`, `ω = 2π f` and the setting `s` (`vibration_share_of_speed`). That
//! force moves a free device with the speed amplitude `s v`.
//!
//! ```text
//! x(0) = 0,  x(1) = s J ω v w d,  x(n+1) = (2 - w²) d x(n) - d² x(n-1)     w = ω T,  d = τ/(τ + T)
//! ```
//!
//! The sum of both forces stays between 0 and the force limit, and then passes the energy guard.

use super::Sample;
use crate::quotient::over;
use crate::validate::{gain, ratio};
use crate::{
    Field, Force, ImpactSettings, Number, Position, Ratio, Settings, SettingsError, Si, Stiffness,
};

/// The vibration at the touch of one wall, with its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vibration<N: Number> {
    /// `s J ω w d/T`: the first force, per displacement in one control period.
    pub first: Stiffness<N>,
    /// Largest first force, at which the amplitude is the force limit.
    pub most: Force<N>,
    /// `(2 - w²) d`, the weight of the last force in the next.
    pub last_share: Ratio<N>,
    /// `d²`, the weight of the force before the last in the next.
    pub older_share: Ratio<N>,
    /// Control periods after which the vibration ends.
    pub length: u16,
    /// The vibration's force at the next control period.
    pub next: Force<N>,
    /// The vibration's force at the last control period.
    pub last: Force<N>,
    /// Control periods until the vibration ends.
    pub left: u16,
}

/// Number of time constants `τ` after which the vibration ends: then a 400th of the amplitude is left, less than a hand can feel.
const TIME_CONSTANTS: Si = Si::lit("6");

impl ImpactSettings {
    /// Checks the vibration's frequency, if there is a vibration. Up to a tenth of the control rate, the rendered frequency is
    /// within 2 % of the configured one.
    ///
    /// # Errors
    /// The frequency is above a tenth of the control rate.
    pub fn validate(&self, rate_hz: u32) -> Result<(), SettingsError> {
        let max = over(
            Si::saturating_from_num(rate_hz),
            const { Si::const_from_int(10) },
        );
        if self.vibration != Si::ZERO && self.frequency_hz > max {
            return Err(SettingsError::OutOfRange {
                field: Field::ImpactFrequency,
                value: self.frequency_hz,
                min: Si::ONE,
                max,
            });
        }
        Ok(())
    }
}

impl<N: Number> Vibration<N> {
    /// The vibration of validated settings; `None` if they have none.
    ///
    /// # Errors
    /// A coefficient does not fit the number format.
    pub fn vibration_of(settings: &Settings) -> Result<Option<Self>, SettingsError> {
        let wanted = &settings.impact;
        if wanted.vibration == Si::ZERO {
            return Ok(None);
        }
        let rate = Si::saturating_from_num(settings.rate_hz);
        let angle = over(wanted.frequency_hz.saturating_mul(Si::TAU), rate);
        let periods = wanted.decay_s.saturating_mul(rate);
        let decay = over(periods, Si::ONE.saturating_add(periods));
        let inertia_per_tick2 = settings
            .estimator
            .inertia
            .saturating_mul(rate)
            .saturating_mul(rate);
        let first = angle.saturating_mul(decay);
        let turn = const { Si::lit("2") }.saturating_sub(angle.saturating_mul(angle));
        let share = |value: Si| ratio::<N>(Field::ImpactDecay, value).map(Ratio);
        let amplitude = wanted
            .vibration
            .saturating_mul(inertia_per_tick2)
            .saturating_mul(angle);
        let length = TIME_CONSTANTS.saturating_mul(periods);
        Ok(Some(Self {
            first: Stiffness(gain::<N>(
                Field::ImpactVibration,
                amplitude.saturating_mul(first),
            )?),
            most: Force(N::saturating_signal(
                settings.force_limit.saturating_mul(first),
            )),
            last_share: share(turn.saturating_mul(decay))?,
            older_share: share(decay.saturating_mul(decay))?,
            length: length.saturating_to_num::<u16>().max(1),
            next: Force::zero(),
            last: Force::zero(),
            left: 0,
        }))
    }

    /// Runs one control period: takes the law's input, whether this control period begins a new touch, and the force of law and
    /// pulse. Returns the force with the vibration. While the vibration lasts, that sum is between 0 and `limit`.
    ///
    /// The function is not inlined: its code in the controller would slow every control period, also without a vibration.
    #[inline(never)]
    pub fn with_vibration(
        &mut self,
        sample: Sample<N>,
        touch: bool,
        force: Force<N>,
        limit: Force<N>,
    ) -> Force<N> {
        if sample.e <= Position::zero() {
            self.left = 0;
            return force;
        }
        if touch {
            self.left = self.length;
            self.last = Force::zero();
            self.next = (self.first * sample.moved)
                .towards_zero()
                .max(Force::zero())
                .min(self.most);
        } else if self.left == 0 {
            return force;
        }
        let shown = self.next;
        self.next =
            self.last_share.share_of_force(shown) - self.older_share.share_of_force(self.last);
        self.last = shown;
        self.left = self.left.saturating_sub(1);
        (force + shown).max(Force::zero()).min(limit)
    }
}
