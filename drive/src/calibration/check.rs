//! Check of a stored alignment. The alignment gives the direction in which the rotor should be; a current builds up a field in that
//! direction, and the field is rocked by an eighth of an electrical turn each way.
//!
//! ```text
//! Offsets -> Raise -> Settle -> Rock: out, back, forth, home -> done
//! ```
//!
//! Let `φ` be the electrical angle by which the stored alignment is wrong. A current `I` along the stored direction of the rotor
//! turns the rotor with the torque `k_t I sin φ` towards its true direction.
//!
//! 1. The check waits until the shaft stands still, for at most four seconds. The stored alignment gives the electrical angle of
//!    that position, and the field is raised there.
//! 2. From then on the rotor must stay within an eighth of an electrical turn of the field. With a `φ` of a quarter turn the rising
//!    current pulls the rotor further away, and the outputs are switched off.
//! 3. With a `φ` of half a turn the torque is zero: the rotor stands against the field, and dry friction keeps it there. So the
//!    field is rocked by an eighth of a turn each way. A rotor that stands against the field then turns away from it, or does not
//!    move at all.
//! 4. While the field moves back and forth, the check samples the angle between rotor and field at each 32nd of a turn. Friction
//!    makes the rotor lag, once in each direction, so the mean of all samples is `φ`. It must be within 20 electrical degrees.
//!    Between the two ends the rotor must have moved at least half as far as the field, at most one and a half times as far, and
//!    in the same direction. This detects a held shaft, phases in another order, and a rotor that is stuck against the field.
//!
//! The check cannot detect the following errors:
//!
//! - a magnet that slipped by whole electrical turns, which makes no difference to the motor;
//! - another number of pole pairs with which the rotor moves nearly as far (the settings' number is compared with the stored one
//!   instead);
//! - an error below 20 degrees, which costs at most 6 % of the torque;
//! - a load that turns the shaft as far as the alignment's error, in the opposite direction.

use super::{Calibration, CalibrationConfig, Progress, Reason, Stage, failed};
use crate::angle::{Angle, ElectricalScale};
use crate::calibration::Alignment;
use touchstone_protocol::KeptAlignment;

/// Angle by which the field is rocked each way, 2^-32 electrical turns: an eighth of a turn.
const REACH: i64 = 1 << 29;
/// Largest allowed angle between rotor and field, in 1/65,536 electrical turns: an eighth of a turn. A rotor that follows the field
/// lags by less than half of that.
const APART: i32 = 0x2000;
/// Largest allowed mean angle between rotor and field, in 1/65,536 electrical turns: 20 degrees. An eccentric magnet and cogging
/// can cause up to 15 degrees without an error of the alignment.
const WRONG: i32 = 65_536 / 18;
/// Range within which a shaft that stands still may move, in 1/65,536 electrical turns: a 64th of a turn.
const STILL: i32 = 0x400;
/// Longest time that the check waits for the shaft to stand still, in half seconds.
const PATIENCE: u32 = 8;
/// Angle of the field between two samples, as a power of two in 2^-32 electrical turns: a 32nd of a turn.
const PLACES_LOG2: u32 = 27;

/// The motions of the field while it is rocked, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Out,
    Back,
    Forth,
    Home,
}

/// The state of a running check of a stored alignment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Check {
    /// The stored alignment, converted so that it holds for count 0 of the unwrapped encoder.
    kept: Alignment,
    /// Encoder count at which the shaft stands; `None` before the first reading. `still`: control periods for which it has stood
    /// there; `waited`: control periods for which the check has waited.
    stands: Option<i64>,
    still: u32,
    waited: u32,
    way: Way,
    /// Angle by which the field has moved from where it was raised, 2^-32 electrical turns.
    reached: i64,
    /// Sum of the sampled angles between rotor and field, in 1/65,536 of a turn; `samples` is their number.
    sum: i32,
    samples: i32,
    /// The rotor's electrical angle when the field reached the far end of its way back.
    end: Angle,
}

impl Check {
    pub(super) const fn is_backward(&self) -> bool {
        matches!(self.way, Way::Back | Way::Home)
    }
}

impl From<KeptAlignment> for Alignment {
    fn from(kept: KeptAlignment) -> Self {
        Self {
            offset: Angle(kept.offset),
            against: kept.against,
        }
    }
}

impl Alignment {
    /// The rotor's electrical angle at an encoder count, by this alignment.
    #[must_use]
    pub fn at(&self, count: i64, scale: &ElectricalScale) -> Angle {
        let turned = scale.angle(if self.against {
            count.wrapping_neg()
        } else {
            count
        });
        self.offset.plus(turned)
    }

    /// This alignment, converted for an encoder count whose 0 is at this count of the present one.
    #[must_use]
    pub fn from(&self, count: i64, scale: &ElectricalScale) -> Self {
        Self {
            offset: self.at(count, scale),
            against: self.against,
        }
    }
}

impl Calibration {
    /// Begins a calibration that checks a stored alignment. The alignment must be given for count 0 of the unwrapped encoder.
    #[must_use]
    pub const fn of_kept(config: CalibrationConfig, kept: Alignment) -> Self {
        let mut calibration = Self::new(config);
        calibration.check = Some(Check {
            kept,
            stands: None,
            still: 0,
            waited: 0,
            way: Way::Out,
            reached: 0,
            sum: 0,
            samples: 0,
            end: Angle(0),
        });
        calibration
    }

    /// Checks that the rotor is within the allowed angle of the field. If not, returns why the calibration failed.
    pub(super) fn watch(&mut self, count: i64) -> Option<Reason> {
        let field = self.field_angle();
        let check = self.check.as_mut()?;
        let scale = &self.config.scale;
        let rotor = check.kept.at(count, scale);
        if self.stage == Stage::Offsets {
            let stands = *check.stands.get_or_insert(count);
            self.field = i64::from(rotor.0) << 16;
            let moved = i32::from(rotor.since(check.kept.at(stands, scale)));
            if moved.abs() > STILL {
                (check.stands, check.still) = (Some(count), 0);
            }
            check.still = check.still.saturating_add(1);
            check.waited = check.waited.saturating_add(1);
            let patience = self.config.settle.saturating_mul(PATIENCE);
            return (check.waited > patience).then_some(Reason::KeptTurning);
        }
        (i32::from(rotor.since(field)).abs() > APART).then_some(Reason::KeptWrong)
    }

    /// Whether the shaft has stood still for a quarter of a second; always true for a calibration that checks no stored alignment.
    pub(super) fn may_begin(&self) -> bool {
        self.check
            .is_none_or(|check| check.still >= self.config.settle / 2)
    }

    /// Runs one control period of rocking the field.
    pub(super) fn rock(&mut self, count: i64) -> Option<Progress> {
        // The count belongs to the field of the previous control period, which has acted since.
        let field = self.field_angle();
        let (most, step) = self.rocking();
        self.speed = self.speed.saturating_add(step).min(most);
        let check = self.check.as_mut()?;
        let rotor = check.kept.at(count, &self.config.scale);
        let target = match check.way {
            Way::Out | Way::Forth => REACH,
            Way::Back => -REACH,
            Way::Home => 0,
        };
        let before = check.reached;
        let step = i64::from(self.speed);
        check.reached = if check.is_backward() {
            before.saturating_sub(step).max(target)
        } else {
            before.saturating_add(step).min(target)
        };
        self.field = self
            .field
            .saturating_add(check.reached.saturating_sub(before));
        let is_looked_at = matches!(check.way, Way::Back | Way::Forth);
        if is_looked_at && before >> PLACES_LOG2 != check.reached >> PLACES_LOG2 {
            check.sum = check.sum.saturating_add(i32::from(rotor.since(field)));
            check.samples = check.samples.saturating_add(1);
        }
        if check.reached != target {
            return None;
        }
        match check.way {
            Way::Out => check.way = Way::Back,
            Way::Back => (check.way, check.end) = (Way::Forth, rotor),
            Way::Forth => {
                let mean = check.sum.checked_div(check.samples).unwrap_or(i32::MAX);
                let followed = i32::from(rotor.since(check.end));
                // The field moved by twice this value.
                const HALF: i32 = (REACH >> 16) as i32;
                if !(HALF..=3 * HALF).contains(&followed) {
                    return Some(failed(Reason::KeptNotFollowed));
                }
                if mean.saturating_abs() > WRONG {
                    return Some(failed(Reason::KeptWrong));
                }
                check.way = Way::Home;
            }
            Way::Home => return Some(Progress::Done(check.kept)),
        }
        self.enter(Stage::Rock);
        None
    }

    /// Largest speed of the field while it is rocked, 2^-32 electrical turns per control period, and the largest change of that
    /// speed in a period. The speed is at most one electrical turn per second, so that a light rotor does not swing around the
    /// field.
    fn rocking(&self) -> (u32, u32) {
        // Control periods in a second and in a quarter of a second.
        let settle = self.config.settle.max(2);
        let second = settle.saturating_mul(2);
        let most = self
            .config
            .speed
            .min(u32::MAX.checked_div(second).unwrap_or(1));
        let step = most.checked_div(settle / 2).unwrap_or(most);
        (most.max(1), step.max(1))
    }
}
