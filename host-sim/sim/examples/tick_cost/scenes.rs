//! The configurations whose cost is measured: one scene without effects, and scenes with effects added to it.

use std::path::Path;
use touchstone_control::{Choice as _, LawKind};
use touchstone_sim::run::chain::Stage;
use touchstone_sim::run::effects::{self, EFFECTS};
use touchstone_sim::scene::{Preset, Scene};

/// Names of the configurations, each with the fields that it changes in [`BARE`].
pub const CONFIGURATIONS: &[(&str, &[&str])] = &[
    ("bare", &[]),
    ("encoder", &["encoder.counts_per_rev=40000"]),
    ("friction", &["device.friction.kinetic_n_m=3e-4"]),
    ("hand", &["operator.grip=medium"]),
    ("delay", &["timing.computational_delay_s=1e-3"]),
    ("limit", &["device.torque_limit_n_m=0.5"]),
    ("steps", &["device.amplifier_step_n_m=1e-5"]),
    (
        "enhanced",
        &["law.kind=enhanced-sfa", "wall.k_desired_n_m_per_rad=5"],
    ),
    ("estimator", &["law.states=estimated"]),
    ("guard", &["law.guard.on=true"]),
    (
        "held",
        &["operator.grip=medium", "encoder.counts_per_rev=40000"],
    ),
    (
        "held-enhanced",
        &[
            "operator.grip=medium",
            "encoder.counts_per_rev=40000",
            "law.kind=enhanced-sfa",
            "wall.k_desired_n_m_per_rad=5",
        ],
    ),
    (
        "held-guarded",
        &[
            "operator.grip=medium",
            "encoder.counts_per_rev=40000",
            "law.kind=enhanced-sfa",
            "wall.k_desired_n_m_per_rad=5",
            "law.guard.on=true",
        ],
    ),
    (
        "held-guarded-f64",
        &[
            "operator.grip=medium",
            "encoder.counts_per_rev=40000",
            "law.kind=enhanced-sfa",
            "wall.k_desired_n_m_per_rad=5",
            "law.guard.on=true",
            "law.number=f64",
        ],
    ),
    (
        "held-shipped",
        &[
            "operator.grip=medium",
            "encoder.counts_per_rev=40000",
            "law.kind=enhanced-sfa",
            "wall.k_desired_n_m_per_rad=5",
            "law.states=estimated",
            "law.guard.on=true",
        ],
    ),
    (
        "held-shipped-f64",
        &[
            "operator.grip=medium",
            "encoder.counts_per_rev=40000",
            "law.kind=enhanced-sfa",
            "wall.k_desired_n_m_per_rad=5",
            "law.states=estimated",
            "law.guard.on=true",
            "law.number=f64",
        ],
    ),
];

/// Scene of a knob without a hand, inside a wall that stays stable in every configuration, even with one tick of delay.
const BARE: &str = "
name = \"tick-cost\"
[device]
inertia_kg_m2 = 1e-4
damping_n_m_s_per_rad = 4e-4
initial_angle_rad = 0.55
[timing]
rate_hz = 1000
duration_s = 1.0
[wall]
surface_rad = 0.5
k_desired_n_m_per_rad = 0.2
[law]
kind = \"spring\"
";

/// Makes the scene of a configuration; `None` for an unknown name.
///
/// A name is one of [`CONFIGURATIONS`], or has a prefix: `with:` before effects joined by `+`, at their typical magnitudes;
/// `silent:` before an effect at amplitude zero; `law:` before the name of a control law; `set:` before `key=value`.
pub fn scene(name: &str) -> Option<Scene> {
    let bare = Scene::parse(BARE, Path::new("tick-cost.toml"))
        .and_then(|scene| scene.with_preset(Preset::Thesis))
        .ok()?;
    if let Some(names) = name.strip_prefix("with:") {
        return names.split('+').try_fold(bare, |scene, name| {
            scene.with(effects::by_name(name)?.add).ok()
        });
    }
    if let Some(name) = name.strip_prefix("silent:") {
        return bare.with(effects::by_name(name)?.silence?).ok();
    }
    if let Some(kind) = name.strip_prefix("law:") {
        let kind = format!("law.kind={kind}");
        return bare
            .with_overrides(&[&kind, "wall.k_desired_n_m_per_rad=5"])
            .ok();
    }
    if let Some(set) = name.strip_prefix("set:") {
        return bare.with_overrides(&[set]).ok();
    }
    let (_, sets) = CONFIGURATIONS.iter().find(|(known, _)| *known == name)?;
    bare.with_overrides(sets).ok()
}

/// Names of all configurations that `tick_cost --ladder` measures.
///
/// The order is: no effect; each control law; the state estimator and the energy guard. Then follow each effect at amplitude zero,
/// where that is possible, each effect alone, and all pairs of effects that a scene can have.
pub fn ladder() -> Vec<String> {
    let mut names = vec!["bare".to_owned()];
    names.extend(LawKind::WORDS.iter().map(|word| format!("law:{word}")));
    names.extend(["set:law.states=estimated", "set:law.guard.on=true"].map(str::to_owned));
    let silent = EFFECTS.iter().filter(|effect| effect.silence.is_some());
    names.extend(silent.map(|effect| format!("silent:{}", effect.name)));
    names.extend(EFFECTS.iter().map(|effect| format!("with:{}", effect.name)));
    for (at, first) in EFFECTS.iter().enumerate() {
        let others = &EFFECTS[at + 1..];
        names.extend(
            others
                .iter()
                .filter(|second| !effects::exclude_each_other(first, second))
                .map(|second| format!("with:{}+{}", first.name, second.name)),
        );
    }
    names
}

/// Number of ticks after which the pressing torque or the hand's rest point changes.
pub const JOLT_TICKS: u32 = 32;
/// The two rest points between which the hand alternates, rad. The change keeps the knob in motion inside the wall.
pub const HAND_RAD: [f64; 2] = [0.6, 0.56];

/// Presses the knob by given torques in place of a hand.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pressed {
    ticks: u32,
}

/// The two pressing torques between which the press alternates, N·m. The change keeps the knob in motion inside the wall.
const PRESS: [f64; 2] = [0.022, 0.018];

impl Stage for Pressed {
    // The pressing torque is not a command. The control law is not informed of it, nor of a hand's torque.
    const TOLD: bool = false;

    #[inline(always)]
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        let tick = self.ticks;
        self.ticks = tick.wrapping_add(1);
        torque_n_m + PRESS[(tick / JOLT_TICKS) as usize & 1]
    }
}
