//! The control laws of a scorecard, each defined as a change of a scene.

use super::cases::most_torque_n_m;
use touchstone_control::choices::{
    ChangeOfForce, FirstContact, IdealStep, LawKind, ObserverForm, OffsetUpdate, StatesKind,
    VelocityKind,
};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{Law, Preset, Scene, nearest};

/// A control law that the scorecard compares with others.
#[derive(Debug, Clone, Copy)]
pub struct Rival {
    /// Name of the law on the command line and in JSON.
    pub name: &'static str,
    /// Description of the control law in a few words.
    pub about: &'static str,
    /// Publication or other source of the law.
    pub source: &'static str,
    /// Whether the law is a spring with virtual damping, with which the other laws are compared.
    pub damped_spring: bool,
    /// Whether the law is tuned with the state estimator. In a scorecard, enhanced successive force augmentation uses the estimator
    /// only if its scene does.
    pub estimated: bool,
    apply: fn(&mut Scene),
}

/// All control laws of a scorecard.
pub const RIVALS: [Rival; 12] = [
    Rival {
        name: "spring",
        about: "virtual spring",
        source: "thesis (1.6)",
        damped_spring: false,
        estimated: false,
        apply: |scene| measured(scene, LawKind::Spring),
    },
    Rival {
        name: "spring-damper",
        about: "spring with virtual damping, velocity from the difference of two positions",
        source: "thesis §1.2.6",
        damped_spring: true,
        estimated: false,
        apply: |scene| measured(scene, LawKind::SpringDamper),
    },
    Rival {
        name: "spring-damper-estimated",
        about: "spring with virtual damping, on estimated states",
        source: "thesis §1.2.6 behind this project's estimator",
        damped_spring: true,
        estimated: true,
        apply: |scene| {
            scene.law.kind = LawKind::SpringDamper;
            scene.law.states = StatesKind::Estimated;
        },
    },
    Rival {
        name: "spring-damper-filtered",
        about: "spring with virtual damping, velocity through a first-order filter",
        source: "thesis §1.2.6 with what drivers of haptic devices do",
        damped_spring: true,
        estimated: false,
        apply: |scene| filtered(scene, VelocityKind::Filtered),
    },
    Rival {
        name: "spring-damper-foaw",
        about: "spring with virtual damping, velocity by an adaptive window",
        source: "thesis §1.2.6 with Janabi-Sharifi, Hayward and Chen 2000",
        damped_spring: true,
        estimated: false,
        apply: |scene| filtered(scene, VelocityKind::Foaw),
    },
    Rival {
        name: "spring-damper-kalman",
        about: "spring with virtual damping, velocity of a Kalman filter of the position alone",
        source: "thesis §1.2.6 with Kalata 1984",
        damped_spring: true,
        estimated: false,
        apply: |scene| filtered(scene, VelocityKind::Kalman),
    },
    Rival {
        name: "tdpa",
        about: "time-domain passivity approach, exact observer, the device's damping counted",
        source: "thesis (2.1) to (2.6), with the force that acted over each displacement",
        damped_spring: false,
        estimated: false,
        apply: |scene| {
            measured(scene, LawKind::Tdpa);
            scene.law.observer = ObserverForm::Exact;
            scene.law.count_device_damping = true;
        },
    },
    Rival {
        name: "tdpa-published",
        about: "time-domain passivity approach, observer as published",
        source: "thesis (2.1) to (2.6)",
        damped_spring: false,
        estimated: false,
        apply: |scene| {
            measured(scene, LawKind::Tdpa);
            scene.law.observer = ObserverForm::Thesis;
            scene.law.count_device_damping = false;
        },
    },
    Rival {
        name: "fba",
        about: "force bounding approach",
        source: "thesis (2.7) to (2.10)",
        damped_spring: false,
        estimated: false,
        apply: |scene| measured(scene, LawKind::Fba),
    },
    Rival {
        name: "sfa",
        about: "original successive force augmentation",
        source: "thesis (2.11) to (2.17)",
        damped_spring: false,
        estimated: false,
        apply: |scene| {
            measured(scene, LawKind::Sfa);
            scene.law.first_contact = Some(FirstContact::KeepForce);
        },
    },
    Rival {
        name: "enhanced-published",
        about: "enhanced successive force augmentation as published, with no loan",
        source: "thesis (3.1) to (3.14)",
        damped_spring: false,
        estimated: false,
        apply: |scene| {
            measured(scene, LawKind::EnhancedSfa);
            let law = &mut scene.law;
            law.observer = ObserverForm::Thesis;
            law.energy_credit_j = 0.0;
            law.offset_update = OffsetUpdate::Inward;
            law.ideal_step = IdealStep::Position;
        },
    },
    Rival {
        name: "enhanced",
        about: "enhanced successive force augmentation with the scene's settings",
        source: "this project",
        damped_spring: false,
        estimated: true,
        apply: |scene| scene.law.kind = LawKind::EnhancedSfa,
    },
];

/// Sets a control law as it is usually published: without state estimator and energy guard, and with the thesis' parameters for
/// values that the scene does not set.
fn measured(scene: &mut Scene, kind: LawKind) {
    if let Ok(known) = scene.with_preset(Preset::Thesis) {
        *scene = known;
    }
    scene.law.kind = kind;
    scene.law.states = StatesKind::Measured;
    scene.law.guard.on = false;
}

/// Sets a spring-damper law whose velocity comes from the given velocity filter.
fn filtered(scene: &mut Scene, from: VelocityKind) {
    measured(scene, LawKind::SpringDamper);
    scene.law.velocity.from = from;
}

/// Ratio of the capacity of the energy guard's account to the energy that the largest force at the over-speed limit can cost.
/// With this capacity a full account never reduces a press.
const CAPACITY_SHARE: f64 = 1.2;
/// Ratio of the power that refills the energy guard's account to the power that a wall costs.
///
/// The cost assumes that the force changes by the stiffness times one encoder count in every tick. The guard charges half a count
/// for each change.
const REFILL_SHARE: f64 = 4.0;
/// Largest power for refilling the account that the energy guard's settings accept, W.
const MOST_REFILL_W: f64 = 1.0;
/// Largest capacity of the account that the energy guard's settings accept, J.
const MOST_CAPACITY_J: f64 = 16.0;
/// Delay in ticks above which the encoder is also read at the moment when the force changes. Without that reading the energy guard
/// would charge more energy for each change.
const MEASURED_FROM_TICKS: f64 = 0.1;

/// Largest fraction of the device's damping that the energy guard relies on, even if the scene has a larger fraction.
const MOST_SHARE: f64 = 0.8;

/// Longest delay in ticks (control periods) that the energy guard covers, with a margin for rounding. With a longer delay the guard
/// is off.
pub const MOST_DELAY_TICKS: f64 = 1.0 + 1e-9;

/// The larger of the delays of the scene and of its energy guard, plus the guard's lag, in ticks (control periods).
#[must_use]
pub fn delay_ticks(scene: &Scene) -> f64 {
    let guard = &scene.law.guard;
    (guard.delay_s.max(scene.timing.computational_delay_s) + guard.lag_s) / scene.timing.period_s()
}

/// Sets a scene's state estimator and energy guard to the device's values and torque.
///
/// The guard's capacity (most energy in its account) and refill power are set to what the device needs, but not below the scene's
/// values. They stay within the limits of the settings. A coarse encoder at a stiff wall needs much of both.
fn told(scene: &mut Scene) {
    let (period_s, rate_hz) = (scene.timing.period_s(), f64::from(scene.timing.rate_hz));
    let count = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
    let k = scene.wall.k_desired_n_m_per_rad;
    let late = delay_ticks(scene);
    let most_n_m = most_torque_n_m(scene);
    let (device, law) = (&scene.device, &mut scene.law);
    law.force_limit_n_m = most_n_m;
    law.estimator.inertia_kg_m2 = device.inertia_kg_m2;
    law.estimator.damping_n_m_s_per_rad = device.damping_n_m_s_per_rad;
    let guard = &mut law.guard;
    // If the guard's damping has its default (that of the thesis' knob), it is replaced by the device's. A value that the scene
    // sets is never raised.
    let said = guard.damping_n_m_s_per_rad;
    let unsaid = said == Law::default().guard.damping_n_m_s_per_rad;
    guard.damping_n_m_s_per_rad = match unsaid {
        true => device.damping_n_m_s_per_rad,
        false => said.min(device.damping_n_m_s_per_rad),
    };
    let most = MOST_SHARE * device.damping_n_m_s_per_rad;
    if guard.share_of_damping * guard.damping_n_m_s_per_rad > most {
        guard.share_of_damping = most / guard.damping_n_m_s_per_rad;
    }
    // The delay is never below the one that the scene sets for its guard.
    guard.delay_s = guard.delay_s.max(scene.timing.computational_delay_s);
    guard.on = late <= MOST_DELAY_TICKS;
    if late > MEASURED_FROM_TICKS {
        guard.change = ChangeOfForce::Measured;
    }
    // The guard's own condition on its capacity, with a margin.
    let step = guard.overspeed_rad_per_s * period_s + count;
    let least = CAPACITY_SHARE * law.force_limit_n_m * (step * (1.0 + late) + 0.5 * count);
    guard.capacity_j = guard.capacity_j.max(least).min(MOST_CAPACITY_J);
    let chatter = REFILL_SHARE * rate_hz * 0.5 * k * count * count;
    guard.refill_w = guard.refill_w.max(chatter).min(MOST_REFILL_W);
}

impl Rival {
    /// Returns the law with this name.
    ///
    /// # Errors
    /// No law has this name.
    pub fn named(name: &str) -> Result<&'static Rival> {
        RIVALS
            .iter()
            .find(|rival| rival.name == name)
            .ok_or_else(|| {
                let names: Vec<&str> = RIVALS.iter().map(|rival| rival.name).collect();
                Error::Option {
                    option: format!("--law {name}"),
                    problem: "no law of the scorecard has this name".to_owned(),
                    fix: match nearest(name, &names) {
                        Some(near) => format!("did you mean {near}?"),
                        None => format!("give one of {}", names.join(", ")),
                    },
                }
            })
    }

    /// Whether the control loop with this law is linear, so that matrices describe its motion. A law that reduces its force by an
    /// energy sum is not linear.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.damped_spring || self.estimated
    }

    /// The scene with this law, ready for tuning. The energy guard is kept, because the settings are for a real device.
    #[must_use]
    pub fn to_tune(&self, scene: &Scene) -> Scene {
        let mut tuned = self.of(scene);
        if self.estimated {
            tuned.law.states = StatesKind::Estimated;
        }
        tuned.law.guard = scene.law.guard.clone();
        told(&mut tuned);
        tuned
    }

    /// The scene with this law's own settings, as the scorecard runs it.
    #[must_use]
    pub fn of(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        (self.apply)(&mut scene);
        scene
    }
}
