//! Tunes control laws for random devices, to count how often settings exist with which a wall comes to rest and feels right.
//!
//! Devices come from [`crate::random_device`]. A device is replaced if its encoder or torque do not suffice for its wall. A press
//! of at most [`MOST_N_M`] must go at least 20 encoder counts deep, be at least four times the dry friction, and stay below a
//! depth of 1 rad. The torque limit is twice [`MOST_N_M`].

use super::diagnosis::{self, FailureCause, certificate};
use super::outcome::Outcome;
use super::{Effort, TuneOptions, Tuned, to_rest, tune};
use crate::certify::Verdict;
use crate::random_device::{FINGERTIP, Random, RandomDevice};
use crate::scorecard::cases::{CASES, Programme};
use crate::scorecard::rivals::Rival;
use crate::scorecard::{figures, stiffness_per_tick};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use touchstone_sim::error::Result;
use touchstone_sim::scene::{MotionSpec, Scene, TouchAndPress};

/// Largest torque of a press, N·m.
pub const MOST_N_M: f64 = 0.5;
/// Largest stiffness at which an estimator was found to hold a wall, as a fraction of `J/T²` (inertia `J`, control period `T`).
const OF_INERTIA: f64 = 0.16;

/// Class of the requested stiffness: the rule that derives the stiffness from the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// Five times the critical stiffness, the largest that sampling allows a plain spring.
    FiveCritical,
    /// Twenty times the largest stiffness that sampling allows a plain spring, for devices where this is below the limit by inertia
    /// (see `Inertia`).
    TwentyCritical,
    /// The limit by inertia, `0.16 J/T²`: inertia `J`, control period `T`.
    Inertia,
}

impl Class {
    /// All classes of stiffness.
    pub const ALL: [Class; 3] = [Class::FiveCritical, Class::TwentyCritical, Class::Inertia];
}

/// Scene with the random device of this number and the wall to tune.
#[must_use]
pub fn scene(seed: u64, class: Class, number: u64) -> Scene {
    let mut random = Random::new(
        seed ^ number.wrapping_mul(0xd1b5_4a32_d192_ed03)
            ^ (class as u64).wrapping_mul(0xa076_1d64_78bd_642f),
    );
    loop {
        if let Some(mut scene) = drawn(&mut random, class) {
            let class = serde_json::to_value(class).unwrap_or_default();
            scene.name = format!("{}-{seed}-{number}", class.as_str().unwrap_or_default());
            return scene;
        }
    }
}

fn drawn(random: &mut Random, class: Class) -> Option<Scene> {
    let device = RandomDevice::drawn(random);
    let RandomDevice {
        inertia,
        damping,
        counts,
        rate_hz: rate,
        ..
    } = device;
    let by_inertia = OF_INERTIA * inertia * rate * rate;
    let critical = 2.0 * (damping + FINGERTIP) * rate;
    let stiffness = match class {
        Class::FiveCritical => 5.0 * critical,
        Class::TwentyCritical => 20.0 * critical,
        Class::Inertia => by_inertia,
    };
    let push = (20.0 * stiffness * TAU / counts)
        .max(4.0 * device.friction_n_m())
        .max(0.02);
    let asked = class != Class::TwentyCritical || stiffness < by_inertia;
    if !asked || push > MOST_N_M || push > stiffness {
        return None;
    }
    let mut scene = Scene::default();
    device.put_into(&mut scene);
    scene.device.torque_limit_n_m = Some(2.0 * MOST_N_M);
    scene.wall.k_desired_n_m_per_rad = stiffness;
    scene.law.device_damping_n_m_s_per_rad = damping + FINGERTIP;
    scene.law.force_limit_n_m = 2.0 * MOST_N_M;
    scene.operator.motion = MotionSpec::TouchAndPress(TouchAndPress {
        push_torque_n_m: push,
        touch_torque_n_m: 0.2 * push,
        ..TouchAndPress::default()
    });
    Some(scene)
}

/// Results of tuning one law for one device.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Row {
    /// Class of the requested stiffness.
    pub class: Class,
    /// Number of the random device within its seed.
    pub number: u64,
    /// The law that was tuned.
    pub law: String,
    /// Inertia of the device, kg·m².
    pub inertia_kg_m2: f64,
    /// Viscous damping of the device, N·m·s/rad.
    pub damping_n_m_s_per_rad: f64,
    /// Dry friction of the device, N·m.
    pub friction_n_m: f64,
    /// Encoder counts per turn.
    pub counts_per_rev: f64,
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Delay from sample to force, in ticks (control periods).
    pub delay_ticks: f64,
    /// Requested stiffness `k_de`, N·m/rad.
    pub k_desired: f64,
    /// Stiffness of the wall as the angle in rad by which the device's oscillation on the wall advances per control period.
    pub stiffness_per_tick: f64,
    /// Damping as the fraction of its speed that the free device loses per control period.
    pub damping_per_tick: f64,
    /// Whether a press comes to rest in every grip, at a stiffness within 5 % of the requested one.
    pub rests: bool,
    /// Whether the stiffness for an oscillating hand (force over penetration) is within 15 % and 15° of the requested one up to 4
    /// Hz, in every grip.
    pub moves: bool,
    /// Whether a press comes to rest in every grip, at any stiffness.
    pub ends_at_rest: bool,
    /// Largest relative deviation of the stiffness at rest from the requested one; empty if a press does not come to rest.
    pub displayed_error: Option<f64>,
    /// Relative deviation of force over penetration from the requested stiffness for an oscillating hand; empty if the knob left
    /// the wall.
    pub modulus_error: Option<f64>,
    /// Phase of force over penetration for an oscillating hand, degrees.
    pub phase_deg: Option<f64>,
    /// Depth of a light touch over that in an ideal damped wall, the worst of three grips; empty if the law was refused.
    #[serde(default)]
    pub touch: Option<f64>,
    /// Number of settings that were examined.
    pub looks: u64,
    /// Power that refills the account of the energy guard, W; absent if the delay is longer than the guard covers.
    pub guard_refill_w: Option<f64>,
    /// Worst verdict of the stability certificate over the scorecard's hands; empty if there is no certificate.
    pub certificate: String,
    /// Reasons that the certificate gives for its verdict.
    pub certificate_causes: String,
    /// Cause why a press does not rest at the requested stiffness; empty if it does.
    pub rest_cause: Option<FailureCause>,
    /// Cause why an oscillating hand meets another stiffness than the requested one; empty if it does not.
    pub motion_cause: Option<FailureCause>,
}

impl Row {
    /// Whether the certificate says "stable" although the wall does not come to rest.
    #[must_use]
    pub fn is_wrongly_stable(&self) -> bool {
        self.certificate == Verdict::Stable.word() && !self.ends_at_rest
    }

    /// Whether the stiffness at rest and for a moving hand is within 10 % of the requested one, and a light touch goes at most 1.5
    /// times as deep as in an ideal damped wall.
    #[must_use]
    pub fn is_hard_from_the_touch(&self) -> bool {
        let at_most = |value: Option<f64>, most| value.is_some_and(|it| it <= most);
        at_most(self.displayed_error, 0.1)
            && at_most(self.modulus_error, 0.1)
            && at_most(self.touch, 1.5)
    }

    /// Rank of the result; the greatest is best. The best walls are hard from the touch, the next come to rest and have the
    /// requested stiffness for a moving hand. Walls that only come to rest are third, those that only have the requested
    /// stiffness for a moving hand fourth.
    fn rank(&self) -> (bool, bool, bool, bool) {
        let hard = self.is_hard_from_the_touch();
        (hard, self.rests && self.moves, self.rests, self.moves)
    }
}

/// Lengths of the searches in simulated ticks (control periods): of a first search, and of a second search if the first finds no
/// suitable wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Length of the first search, simulated ticks.
    pub first: f64,
    /// Length of the second search, simulated ticks; 0 for none.
    pub second: f64,
    /// Whether walls are tuned as by `touchstone tune --quick`: for every measure of the scorecard, the touch among them, and on
    /// variants of the device. Otherwise they only have to come to rest and have the requested stiffness for a moving hand.
    pub for_all_measures: bool,
}

/// Tunes a law for the random device of this number, and evaluates the result.
///
/// # Errors
/// The control law cannot run in the scene.
pub fn row(
    seed: u64,
    class: Class,
    number: u64,
    rival: &'static Rival,
    budget: Budget,
) -> Result<Row> {
    let device = scene(seed, class, number);
    let rate = f64::from(device.timing.rate_hz);
    let mut row = Row {
        class,
        number,
        law: rival.name.to_owned(),
        inertia_kg_m2: device.device.inertia_kg_m2,
        damping_n_m_s_per_rad: device.device.damping_n_m_s_per_rad,
        friction_n_m: device
            .device
            .friction
            .as_ref()
            .map_or(0.0, |it| it.kinetic_n_m),
        counts_per_rev: device.encoder.as_ref().map_or(0.0, |it| it.counts_per_rev),
        rate_hz: device.timing.rate_hz,
        delay_ticks: device.timing.computational_delay_s * rate,
        k_desired: device.wall.k_desired_n_m_per_rad,
        stiffness_per_tick: stiffness_per_tick(&device),
        damping_per_tick: device.device.damping_n_m_s_per_rad
            / (rate * device.device.inertia_kg_m2),
        rests: false,
        moves: false,
        ends_at_rest: false,
        displayed_error: None,
        modulus_error: None,
        phase_deg: None,
        touch: None,
        looks: 0,
        guard_refill_w: None,
        certificate: String::new(),
        certificate_causes: String::new(),
        rest_cause: None,
        motion_cause: None,
    };
    let mut best: Option<(Scene, Outcome)> = None;
    for (try_number, ticks) in [budget.first, budget.second].into_iter().enumerate() {
        if ticks <= 0.0 || best.as_ref().is_some_and(|(_, outcome)| outcome.holds()) {
            continue;
        }
        let seed = seed + try_number as u64;
        let found = if budget.for_all_measures {
            let options = TuneOptions {
                effort: Effort::Ticks(ticks),
                seed,
                ripple_n_m: None,
            };
            match tune(&device, rival, &options, |_, _| ()) {
                Ok(found) => found,
                Err(_) => continue,
            }
        } else {
            to_rest(&device, rival, ticks, seed)
        };
        let Tuned {
            scene, evaluations, ..
        } = found;
        row.looks += evaluations;
        if let Ok(outcome) = Outcome::of(&scene)
            && best
                .as_ref()
                .is_none_or(|(_, before)| rank(before) < rank(&outcome))
        {
            best = Some((scene, outcome));
        }
    }
    let Some((scene, outcome)) = best else {
        row.rest_cause = Some(FailureCause::Refused);
        row.motion_cause = Some(FailureCause::Refused);
        return Ok(row);
    };
    let guard = &scene.law.guard;
    row.guard_refill_w = guard.on.then_some(guard.refill_w);
    row.rests = outcome.rests();
    row.moves = outcome.moves();
    row.ends_at_rest = outcome.ends_at_rest();
    row.displayed_error = outcome.displayed_error;
    row.modulus_error = outcome.modulus_error;
    row.phase_deg = outcome.phase_deg;
    let (_, beside) = figures(&scene, &Programme::of(&scene), &CASES[0], true)?;
    row.touch = beside.touch.map(|touch| touch.penetration);
    let said = certificate(&scene)?;
    row.certificate = said.verdict.word().to_owned();
    row.certificate_causes = said.hands[said.worst].causes.join("; ");
    let why = |fails| diagnosis::cause(&scene, &outcome, said.verdict, fails);
    row.rest_cause = (!row.rests).then(|| why(|outcome| !outcome.rests()));
    row.motion_cause = (!row.moves).then(|| why(|outcome| !outcome.moves()));
    Ok(row)
}

fn rank(outcome: &Outcome) -> (bool, bool, bool) {
    (outcome.holds(), outcome.rests(), outcome.moves())
}

/// The best of the results for one device, which has one result per control law. A user would choose the law of that result.
#[must_use]
pub fn best<'a>(rows: &[&'a Row]) -> Option<&'a Row> {
    rows.iter().copied().max_by_key(|row| row.rank())
}
