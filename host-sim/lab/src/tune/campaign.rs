//! Random devices, each with a law tuned for it: how often is there a setting?
//!
//! Ranges: inertia 1e-6 to 1e-3 kg·m², damping 1e-5 to 1e-2 N·m·s/rad, dry friction none (a third) or 1e-4 to 0.02 N·m, 1e3 to 1e5
//! counts, 0.5 to 20 kHz, delay none (a third) or up to 2 ticks; each drawn evenly on a logarithmic scale but for the delay. Drawn
//! again is a device whose wall cannot be resolved: a press of at most [`MOST_N_M`] must go 20 counts deep, stand above dry friction
//! four times, and stay within a radian. The torque limit is twice that press.

use super::cost::Judgement;
use super::{Tuned, search_by};
use crate::certify::{self, hands::Family};
use crate::scorecard::cases::{CASES, Deed, GRIPS, Programme};
use crate::scorecard::measure::Measure;
use crate::scorecard::reference::Reference;
use crate::scorecard::rivals::Rival;
use crate::scorecard::{figures, stiffness_per_tick};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::record::Verdict;
use touchstone_sim::scene::{Encoder, Friction, MotionSpec, Scene, TouchAndPress};

/// Largest press, N·m.
pub const MOST_N_M: f64 = 0.5;
/// Damping of a fingertip, which `c_i` holds beside the device's own, N·m·s/rad.
const FINGERTIP: f64 = 1e-4;
/// Share of `J/T²` that an estimator was seen to hold.
const OF_INERTIA: f64 = 0.16;

/// How stiff a wall is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// `5 k_c`.
    FiveCritical,
    /// `20 k_c`, where that is below `0.16 J/T²`.
    TwentyCritical,
    /// `0.16 J/T²`.
    Inertia,
}

impl Class {
    /// All.
    pub const ALL: [Class; 3] = [Class::FiveCritical, Class::TwentyCritical, Class::Inertia];
}

/// SplitMix64 (Steele, Lea and Flood, 2014).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }
}

/// The device of a number at its wall.
#[must_use]
pub fn scene(seed: u64, class: Class, number: u64) -> Scene {
    let mut random = Random(
        seed ^ number.wrapping_mul(0xd1b5_4a32_d192_ed03)
            ^ (class as u64).wrapping_mul(0xa076_1d64_78bd_642f),
    );
    random.unit();
    loop {
        if let Some(mut scene) = drawn(&mut random, class) {
            let class = serde_json::to_value(class).unwrap_or_default();
            scene.name = format!("{}-{seed}-{number}", class.as_str().unwrap_or_default());
            return scene;
        }
    }
}

fn drawn(random: &mut Random, class: Class) -> Option<Scene> {
    let inertia = random.between(1e-6, 1e-3);
    let damping = random.between(1e-5, 1e-2);
    let friction = random.between(1e-4, 0.02);
    let friction = if random.unit() < 2.0 / 3.0 {
        friction
    } else {
        0.0
    };
    let counts = random.between(1e3, 1e5).round();
    let rate = random.between(500.0, 20_000.0).round();
    let late = random.unit() * 2.0;
    let delay = if random.unit() < 2.0 / 3.0 { late } else { 0.0 };
    let by_inertia = OF_INERTIA * inertia * rate * rate;
    let critical = 2.0 * (damping + FINGERTIP) * rate;
    let stiffness = match class {
        Class::FiveCritical => 5.0 * critical,
        Class::TwentyCritical => 20.0 * critical,
        Class::Inertia => by_inertia,
    };
    let push = (20.0 * stiffness * TAU / counts)
        .max(4.0 * friction)
        .max(0.02);
    let asked = class != Class::TwentyCritical || stiffness < by_inertia;
    if !asked || push > MOST_N_M || push > stiffness {
        return None;
    }
    let mut scene = Scene::default();
    scene.device.inertia_kg_m2 = inertia;
    scene.device.damping_n_m_s_per_rad = damping;
    scene.device.torque_limit_n_m = Some(2.0 * MOST_N_M);
    scene.device.friction = (friction > 0.0).then_some(Friction {
        kinetic_n_m: friction,
        ..Friction::default()
    });
    scene.encoder = Some(Encoder {
        counts_per_rev: counts,
    });
    scene.timing.rate_hz = rate as u32;
    scene.timing.computational_delay_s = delay / rate;
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

/// What became of a device.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Row {
    /// How stiff.
    pub class: Class,
    /// Number of the device.
    pub number: u64,
    /// The law that was tuned.
    pub law: String,
    /// Inertia, kg·m².
    pub inertia_kg_m2: f64,
    /// Damping, N·m·s/rad.
    pub damping_n_m_s_per_rad: f64,
    /// Dry friction, N·m.
    pub friction_n_m: f64,
    /// Counts a revolution.
    pub counts_per_rev: f64,
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Delay, ticks.
    pub delay_ticks: f64,
    /// `k_de`, N·m/rad.
    pub k_desired: f64,
    /// `T sqrt(k_de/J)`.
    pub stiffness_per_tick: f64,
    /// `b T/J`, the share of its speed that a device loses in a tick.
    pub damping_per_tick: f64,
    /// Whether a press in every grip comes to rest within 5 % of `k_de`.
    pub rests: bool,
    /// Whether a hand that moves feels `k_de` within 15 % and 15° up to 4 Hz in every grip.
    pub moves: bool,
    /// Largest deviation at rest, share; empty where a press does not rest.
    pub displayed_error: Option<f64>,
    /// Deviation of the modulus of a hand that moves, share; empty where the wall was left.
    pub modulus_error: Option<f64>,
    /// Its phase, degrees.
    pub phase_deg: Option<f64>,
    /// What `certify` says of the hands of the scorecard.
    pub certificate: String,
    /// Why, where it does not rest or is not stable.
    pub cause: String,
}

/// Tunes a law for a device and judges it.
///
/// # Errors
/// A scene that no law can run in.
pub fn row(seed: u64, class: Class, number: u64, rival: &'static Rival, ticks: f64) -> Result<Row> {
    let device = scene(seed, class, number);
    // Ripple is not judged here.
    let reference = Reference::none();
    let judgement = Judgement::at_rest(&device, reference);
    let looks = ticks / judgement.ticks(&device);
    let Tuned { scene, .. } = search_by(
        &device,
        rival,
        reference,
        &judgement,
        looks,
        seed,
        &mut |_, _| (),
    );
    let programme = Programme::of(&scene);
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
        displayed_error: None,
        modulus_error: None,
        phase_deg: None,
        certificate: String::new(),
        cause: String::new(),
    };
    let (felt, _) = match figures(&scene, &programme, &CASES[0], false) {
        Ok(felt) => felt,
        Err(refused) => {
            row.cause = format!("refused: {refused}");
            return Ok(row);
        }
    };
    let finite = |measure| Some(felt.get(measure)).filter(|value| value.is_finite());
    row.modulus_error = finite(Measure::ModulusError);
    row.phase_deg = finite(Measure::PhaseDeg);
    row.moves = row.modulus_error.is_some_and(|error| error <= 0.15)
        && row.phase_deg.is_some_and(|phase| phase <= 15.0);
    let mut error = Some(0.0_f64);
    for grip in GRIPS {
        let run = run::run(&programme.scene(&scene, grip, Deed::Press), false)?.summary;
        let own = run
            .k_displayed
            .filter(|_| matches!(run.verdict, Verdict::Passive | Verdict::Active))
            .map(|k| (k / row.k_desired - 1.0).abs());
        error = error.zip(own).map(|(a, b)| a.max(b));
    }
    row.displayed_error = error;
    row.rests = error.is_some_and(|error| error <= 0.05);
    let pressed = programme.scene(&scene, GRIPS[1], Deed::Press);
    let asked = certify::Options {
        family: Family::Grips,
        margins: false,
        current_loop_hz: None,
    };
    match certify::certify(&pressed, &asked) {
        Ok(certificate) => {
            row.certificate = certificate.verdict.word().to_owned();
            row.cause = certificate.hands[certificate.worst].causes.join("; ");
        }
        Err(refused) => row.cause = format!("no certificate: {refused}"),
    }
    Ok(row)
}
