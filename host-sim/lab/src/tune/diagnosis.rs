//! Finds the cause why a tuned wall fails. The wall is simulated again with one change at a time; the change with which it passes
//! shows the cause.
//!
//! A certificate describes the linear loop only. A wall that it rightly calls stable may still oscillate by an encoder count, be
//! weakened by its energy guard, or have the wrong stiffness.

use super::outcome::Outcome;
use crate::certify::{self, Certificate, Verdict as Said, hands::Family};
use crate::scorecard::cases::{CASES, Deed, GRIPS, Programme};
use crate::scorecard::measure::Measure;
use crate::scorecard::press::SHALLOW_COUNTS;
use crate::scorecard::reference::Reference;
use crate::scorecard::{Cell, Row, figures};
use serde::{Deserialize, Serialize};
use touchstone_sim::scene::{MotionSpec, Number, Scene};

/// Cause why a wall fails. Most causes are tried in the order of the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FailureCause {
    /// The control law accepts no settings for the device.
    Refused,
    /// The linear loop is unstable according to the certificate.
    UnstableLoop,
    /// The energy guard: the wall passes without it.
    Guard,
    /// The torque limit: the wall passes with a hundred times the law's force limit, without the motor's limit and the energy
    /// guard.
    TorqueLimit,
    /// Rounding in the control law: the wall passes if the law computes in `f64`.
    LawRounding,
    /// The sensor's noise: the wall passes without it.
    Noise,
    /// Encoder counts: the wall passes with the exact angle. It oscillates by counts, or a press is too few counts deep.
    Counts,
    /// Dry friction, which keeps the device stuck where the hand should move it: the wall passes without friction.
    Friction,
    /// The light touch before the press, which is only a few counts deep: the wall passes if the touch is as strong as the press.
    LightTouch,
    /// Slow decay: the wall passes if touch and hold last ten times as long.
    Slow,
    /// The impact of a fast touch: the wall passes if touch and press come slowly.
    Contact,
    /// Encoder counts and dry friction together: the wall passes without both, but not without one alone.
    CountsAndFriction,
    /// The wall comes to rest at another stiffness, and none of the other causes explains it.
    Stiffness,
    /// An oscillating hand meets another stiffness, and none of the other causes explains it. The control law's own dynamics cause
    /// the difference.
    Dynamics,
    /// No single change makes the wall pass.
    Unexplained,
}

impl FailureCause {
    /// All causes of failure.
    pub const ALL: [FailureCause; 15] = [
        FailureCause::Refused,
        FailureCause::UnstableLoop,
        FailureCause::Guard,
        FailureCause::TorqueLimit,
        FailureCause::LawRounding,
        FailureCause::Noise,
        FailureCause::Counts,
        FailureCause::Friction,
        FailureCause::LightTouch,
        FailureCause::Slow,
        FailureCause::Contact,
        FailureCause::CountsAndFriction,
        FailureCause::Stiffness,
        FailureCause::Dynamics,
        FailureCause::Unexplained,
    ];

    /// The cause in words for readers.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Refused => "the law rejects such settings",
            Self::UnstableLoop => "unstable: the linear loop grows",
            Self::Guard => "the energy guard holds the force back",
            Self::TorqueLimit => "the torque limit",
            Self::LawRounding => "rounding inside the law",
            Self::Noise => "noise of the position sensor",
            Self::Counts => {
                "encoder counts: a limit cycle, an offset, or a press of too few counts"
            }
            Self::Friction => "dry friction holds the knob against the hand",
            Self::LightTouch => "the light touch chatters, the press rests",
            Self::Slow => "too slow: it comes to rest later",
            Self::Contact => "the impact of the touch",
            Self::CountsAndFriction => "counts and dry friction together",
            Self::Stiffness => "rests at another stiffness",
            Self::Dynamics => "a moving hand feels another stiffness",
            Self::Unexplained => "unexplained",
        }
    }
}

/// A cause, with the change of the scene that removes it.
type Remedy = (FailureCause, fn(&mut Scene));

const REMEDIES: [Remedy; 10] = [
    (FailureCause::Guard, |scene| scene.law.guard.on = false),
    (FailureCause::TorqueLimit, |scene| {
        scene.device.torque_limit_n_m = None;
        scene.law.force_limit_n_m *= 100.0;
        scene.law.guard.on = false;
    }),
    (FailureCause::LawRounding, |scene| {
        scene.law.number = Number::F64
    }),
    (FailureCause::Noise, |scene| scene.sensor.noise = None),
    (FailureCause::Counts, |scene| scene.encoder = None),
    (FailureCause::Friction, |scene| scene.device.friction = None),
    (FailureCause::LightTouch, |scene| {
        if let MotionSpec::TouchAndPress(press) = &mut scene.operator.motion {
            press.touch_torque_n_m = press.push_torque_n_m;
        }
    }),
    (FailureCause::Slow, |scene| {
        if let MotionSpec::TouchAndPress(press) = &mut scene.operator.motion {
            press.hold_s *= 10.0;
            press.touch_s *= 10.0;
        }
    }),
    (FailureCause::Contact, |scene| {
        if let MotionSpec::TouchAndPress(press) = &mut scene.operator.motion {
            press.approach_rad *= 0.01;
            press.touch_ramp_s *= 10.0;
            press.ramp_s *= 10.0;
        }
    }),
    (FailureCause::CountsAndFriction, |scene| {
        scene.encoder = None;
        scene.device.friction = None;
    }),
];

/// The first cause whose removal makes the wall pass.
fn mended(scene: &Scene, holds: impl Fn(&Scene) -> bool) -> Option<FailureCause> {
    let mut pressed = scene.clone();
    // The press stays the same even if a change allows more torque.
    pressed.operator.motion = MotionSpec::TouchAndPress(Programme::of(scene).press);
    let found = REMEDIES.iter().find(|(_, remedy)| {
        let mut mended = pressed.clone();
        remedy(&mut mended);
        holds(&mended)
    });
    found.map(|(cause, _)| *cause)
}

/// Finds the cause of a failure. `fails` returns whether a result still fails.
#[must_use]
pub fn cause(
    scene: &Scene,
    found: &Outcome,
    certificate: Said,
    fails: fn(&Outcome) -> bool,
) -> FailureCause {
    // A change with which the law refuses the scene does not make the wall hold.
    let holds = |scene: &Scene| Outcome::of(scene).is_ok_and(|outcome| !fails(&outcome));
    match (mended(scene, holds), certificate) {
        (Some(cause), _) => cause,
        (None, Said::Unstable) => FailureCause::UnstableLoop,
        _ if !found.rests() && found.ends_at_rest() => FailureCause::Stiffness,
        _ if found.rests() => FailureCause::Dynamics,
        _ => FailureCause::Unexplained,
    }
}

/// Cause why a law fails in a scorecard, on the device with the worst measure; `None` if the law passes.
#[must_use]
pub fn of_row(scene: &Scene, row: &Row, reference: &Reference) -> Option<FailureCause> {
    (!row.passes).then(|| why(scene, row, reference))
}

/// Cause why a law that does not pass fails in a scorecard.
fn why(scene: &Scene, row: &Row, reference: &Reference) -> FailureCause {
    let share = |cell: &Cell| cell.worst.1.unwrap_or(f64::INFINITY);
    let Some(worst) = row
        .cells
        .iter()
        .max_by(|a, b| share(a).total_cmp(&share(b)))
    else {
        return FailureCause::Refused;
    };
    let Some(case) = CASES.iter().find(|case| case.name == worst.case) else {
        return FailureCause::Unexplained;
    };
    let changed = case.of(scene);
    let count_rad = changed.encoder.as_ref().map_or(0.0, |it| it.step_rad());
    let depth_rad = Programme::of(scene).press.push_torque_n_m / scene.wall.k_desired_n_m_per_rad;
    if depth_rad <= SHALLOW_COUNTS * count_rad {
        return FailureCause::Counts;
    }
    let holds = |scene: &Scene| {
        let mut programme = Programme::of(scene);
        if let MotionSpec::TouchAndPress(press) = &scene.operator.motion {
            programme.press = press.clone();
        }
        let felt = figures(scene, &programme, &CASES[0], false);
        felt.is_ok_and(|(felt, _)| {
            Cell::new(case, felt, worst.beside, reference.limits(case)).passes()
        })
    };
    if let Some(cause) = mended(&changed, holds) {
        return cause;
    }
    if certificate(&changed).is_ok_and(|said| said.verdict == Said::Unstable) {
        return FailureCause::UnstableLoop;
    }
    let Ok(found) = Outcome::of(&changed) else {
        return FailureCause::Refused;
    };
    match worst.worst.0 {
        _ if found.ends_at_rest() && !found.rests() => FailureCause::Stiffness,
        Measure::ModulusError | Measure::PhaseDeg => FailureCause::Dynamics,
        _ if found.rests() && !found.moves() => FailureCause::Dynamics,
        _ => FailureCause::Unexplained,
    }
}

/// The stability certificate of a wall for the three simulated grips (light, medium, firm).
///
/// # Errors
/// The control law does not accept its settings.
pub fn certificate(scene: &Scene) -> touchstone_sim::error::Result<Certificate> {
    let pressed = Programme::of(scene).scene(scene, GRIPS[1], Deed::Press);
    let asked = certify::CertifyOptions {
        family: Family::Grips,
        margins: false,
        current_loop_hz: None,
    };
    certify::certify(&pressed, &asked)
}
