//! Validation of the stability certificates: random devices at random walls, for which the certificate's verdict is compared with a
//! simulated run.
//!
//! Devices are those of [`crate::random_device`], each in three simulated grips (light, medium, firm). The stiffness is 0.3 to 30
//! times the largest one that sampling allows without delay. It is at most `J/T²` (inertia `J`, control period `T`), and soft
//! enough that 1 N·m goes 20 encoder counts deep. The law is random too: a spring, a spring-damper, or enhanced successive force
//! augmentation. The enhanced law has either the shipped settings in proportion to the device, or a stiff coupling spring between
//! the hand's point and the law's virtual mass. The law's energy loan (energy that it may give out beyond what it took) is 4 to
//! 32 times the energy in this spring under the press. The laws TDPA, FBA and original augmentation are not drawn.
//!
//! The table holds 14,007 runs with seeds 81 to 84 on estimated and 85 to 87 on measured states. These seeds were not used when the
//! limits of the certificate were set. The verdict is that for each run's own hand.
//!
//! | certificate | run rests | limit cycle | unstable |
//! |---|---|---|---|
//! | stable | 8787 | 0 | 0 |
//! | undecided | 779 | 78 | 35 |
//! | unstable | 1217 | 211 | 2900 |
//!
//! 6.4 % of the certificates are undecided.

use super::{CertifyOptions, Verdict, certify, hands::Family};
use crate::random_device::{FINGERTIP, Random, RandomDevice};
use serde::{Deserialize, Serialize};
use touchstone_control::{Choice as _, LawKind, StatesKind};
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::record::Verdict as Outcome;
use touchstone_sim::scene::{Encoder, Grip, MotionSpec, Number, RampAndHold, Scene};

/// Least stiffness of the soft spring that the settings of the law enhanced successive force augmentation accept, N·m/rad. The
/// law's virtual mass presses on this spring, whose deformation the law increases until the force is that of the requested
/// stiffness.
const SOFTEST_N_M_PER_RAD: f64 = 0.01;

/// Makes a random scene from a number and a seed. Device, wall and law are the same for three consecutive numbers, which differ
/// in the grip. With estimated states, the device that the estimator assumes is random too: half to twice the true values, where
/// the estimator accepts these.
#[must_use]
pub fn scene(seed: u64, index: u64, states: StatesKind) -> Scene {
    let mut random = Random::new(seed ^ (index / 3).wrapping_mul(0xd1b5_4a32_d192_ed03));
    let mut scene = Scene {
        name: format!("random-{seed}-{index}"),
        ..Scene::default()
    };
    let device = RandomDevice::drawn(&mut random);
    device.put_into(&mut scene);
    let RandomDevice {
        inertia, damping, ..
    } = device;
    let (counts, rate) = (device.counts, device.rate_hz);

    let c_i = damping + FINGERTIP;
    let k_c = 2.0 * c_i * rate;
    let depth = 20.0 * std::f64::consts::TAU / counts;
    let stiffness = (k_c * random.between(0.3, 30.0))
        .min(inertia * rate * rate)
        .min(1.0 / depth);
    let push = (stiffness * depth)
        .max(0.05)
        .max(4.0 * device.friction_n_m());
    scene.wall.k_desired_n_m_per_rad = stiffness;
    law(&mut scene, &mut random, c_i, k_c, stiffness);
    if scene.law.kind == LawKind::EnhancedSfa {
        // The loan is four times the energy that the coupling stores under the press, as in the shipped settings, or up to 32
        // times.
        let stored = 0.5 * push * push / scene.law.filter.stiffness_n_m_per_rad;
        scene.law.energy_credit_j = stored * random.between(4.0, 32.0);
    }
    scene.law.force_limit_n_m = 20.0 * push;
    scene.law.states = states;
    if states == StatesKind::Estimated {
        let own_hz = (stiffness / inertia).sqrt() / std::f64::consts::TAU;
        let estimator = &mut scene.law.estimator;
        // The estimator's settings accept a bandwidth of a 500th to a fifth of the control rate, and a delay of up to two ticks.
        estimator.bandwidth_hz =
            (own_hz * random.between(0.3, 4.0)).clamp(0.0021 * rate, 0.19 * rate);
        // Not below the least inertia that the estimator's arithmetic accepts at this force.
        let lightest = 1.01 * scene.law.force_limit_n_m.max(0.76) / (rate * rate);
        estimator.inertia_kg_m2 = (inertia * random.between(0.5, 2.0)).max(lightest);
        estimator.damping_n_m_s_per_rad = damping * random.between(0.5, 2.0);
        let late_s = scene.timing.computational_delay_s + 0.5 / rate;
        estimator.delay_s = (late_s * random.between(0.5, 2.0)).min(2.0 / rate);
    }

    scene.operator.grip = [Grip::Light, Grip::Medium, Grip::Firm][(index % 3) as usize];
    let press = RampAndHold {
        push_torque_n_m: push,
        ramp_s: 0.3,
        hold_s: 6.0,
        ..RampAndHold::default()
    };
    scene.timing.duration_s = press.start_s + press.ramp_s + press.hold_s;
    scene.operator.motion = MotionSpec::RampAndHold(press);
    scene
}

fn law(scene: &mut Scene, random: &mut Random, c_i: f64, k_c: f64, stiffness: f64) {
    let inertia = scene.device.inertia_kg_m2;
    let law = &mut scene.law;
    // Rounding of the law's number format is not part of the campaign.
    law.number = Number::F64;
    law.guard.on = false;
    law.device_damping_n_m_s_per_rad = c_i;
    law.k_soft_n_m_per_rad = 0.8 * k_c;
    law.virtual_damping_n_m_s_per_rad = 0.0;
    let critical = (stiffness * inertia).sqrt();
    match (random.unit() * 6.0) as u32 {
        0 => law.kind = LawKind::Spring,
        1 | 2 => {
            law.kind = LawKind::SpringDamper;
            law.virtual_damping_n_m_s_per_rad = 2.0 * critical * random.between(0.05, 1.0);
        }
        3 => {
            // The shipped settings, scaled to the device: times in seconds, stiffnesses in units of k_c.
            law.kind = LawKind::EnhancedSfa;
            law.step_of_ideal_per_ms = 0.012;
            law.limit_of_penetration_per_ms = 0.03;
            law.limit_of_force_per_ms = 0.03;
            law.filter.mass_kg_m2 = 0.03 * inertia;
            law.filter.stiffness_n_m_per_rad = k_c;
            law.filter.damping_n_m_s_per_rad = 0.0;
            law.filter.ground_damping_n_m_s_per_rad = 0.01 * k_c;
        }
        _ => {
            // A stiff, damped coupling.
            law.kind = LawKind::EnhancedSfa;
            law.k_soft_n_m_per_rad =
                (stiffness * random.between(0.1, 0.95)).max(SOFTEST_N_M_PER_RAD);
            law.step_of_ideal_per_ms = random.between(0.02, 0.8);
            law.limit_of_penetration_per_ms = random.between(0.02, 0.3);
            law.limit_of_force_per_ms = random.between(0.02, 0.3);
            law.filter.mass_kg_m2 = inertia * random.between(0.0075, 0.3);
            law.filter.stiffness_n_m_per_rad = stiffness * random.between(1.5, 5.0);
            law.filter.damping_n_m_s_per_rad = critical * random.between(0.03, 1.0);
            law.filter.ground_damping_n_m_s_per_rad = critical * random.between(0.5, 3.0);
        }
    }
}

/// How a simulated run ended, in the classes that a certificate predicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// The knob rests; it moves by at most four encoder counts peak to peak.
    Rest,
    /// The knob keeps oscillating in the wall.
    LimitCycle,
    /// The knob leaves the wall repeatedly, the force is at its limit, or the simulation diverges.
    Unstable,
}

impl Ended {
    fn of(verdict: Outcome) -> Self {
        match verdict {
            // A knob that never met the wall counts as at rest, as does a run that was not judged.
            Outcome::Passive | Outcome::Active | Outcome::NotJudged | Outcome::NoContact => {
                Ended::Rest
            }
            Outcome::LimitCycle => Ended::LimitCycle,
            Outcome::Unstable => Ended::Unstable,
        }
    }
}

/// Certificate and simulated run of one random scene, as one row of the results.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Row {
    /// Number of the random scene within its seed.
    pub index: u64,
    /// Name of the control law.
    pub law: String,
    /// Whether the coupling spring of the enhanced law, between the hand's point and the law's virtual mass, is at least 5 %
    /// stiffer than the largest plain spring that sampling allows.
    pub stiff_coupling: bool,
    /// Name of the grip.
    pub grip: String,
    /// Verdict of the certificate for this hand.
    pub said: Verdict,
    /// Causes of the certificate's verdict if it is not "stable".
    pub cause: String,
    /// How the simulated run ended.
    pub outcome: Ended,
    /// Motion at the end of the hold, peak to peak, encoder counts.
    pub motion_counts: f64,
    /// Stiffness of the wall as the angle in rad by which the device's oscillation on the wall advances per control period.
    pub stiffness_per_tick: f64,
    /// Delay from sample to force, in ticks (control periods).
    pub delay_ticks: f64,
    /// Largest magnitude of an eigenvalue of the loop, per control period, over the linear phases of the control law.
    pub radius: f64,
    /// Rate at which the slowest motion of the loop decays, 1/s.
    pub decay_per_s: f64,
    /// Rate of decay of the slowest motion with dry friction counted as damping, 1/s; `None` without dry friction, or if the
    /// motion does not oscillate.
    pub decay_with_friction_per_s: Option<f64>,
    /// Frequency of the loop's slowest motion, Hz.
    pub frequency_hz: f64,
    /// Largest ratio of the speed at which the device returns to the wall after a bounce to the speed of the touch before.
    pub bounce: f64,
    /// Energy that the control law gives out in the press beyond what it took, as a fraction of the largest energy that it may
    /// lend; `None` without a loan or a press.
    pub loan_used: Option<f64>,
    /// Largest magnitude of an eigenvalue of the loop while measured penetrations are multiplied by the largest gain that rounding
    /// to encoder counts can have.
    pub radius_rounded: f64,
    /// Motion at rest that rounding to encoder counts causes, root mean square, counts.
    pub rounding_rms_counts: Option<f64>,
    /// Smallest cosine in the circle criterion for gains between the control law's linear phases. Above 0 the criterion holds.
    pub switching: Option<f64>,
    /// Amplitude below which dry friction stops a growing oscillation, encoder counts.
    pub friction_holds_counts: f64,
    /// Depth of the press, encoder counts.
    pub depth_counts: f64,
    /// Dry friction divided by the press' torque.
    pub friction_share: f64,
}

impl Row {
    /// Whether the simulated run came to rest.
    #[must_use]
    pub fn rests(&self) -> bool {
        self.outcome == Ended::Rest
    }
}

/// Generates the random scene of a number, certifies it, and simulates it.
///
/// # Errors
/// The scene cannot be run or certified.
pub fn row(seed: u64, index: u64, states: StatesKind) -> Result<Row> {
    let scene = scene(seed, index, states);
    let options = CertifyOptions {
        family: Family::Own,
        margins: false,
        ..CertifyOptions::default()
    };
    let certificate = certify(&scene, &options)?;
    let own = &certificate.hands[0];
    let run = run::run(&scene, false)?.summary;
    let count = scene.encoder.as_ref().map_or(1.0, Encoder::step_rad);
    let push = match &scene.operator.motion {
        MotionSpec::RampAndHold(press) => press.push_torque_n_m,
        _ => f64::NAN,
    };
    Ok(Row {
        index,
        law: scene.law.kind.word().to_owned(),
        stiff_coupling: scene.law.filter.stiffness_n_m_per_rad
            > 2.1 * scene.law.device_damping_n_m_s_per_rad * f64::from(scene.timing.rate_hz),
        grip: scene.operator.grip.name().to_owned(),
        said: own.verdict,
        cause: own.causes.join("; "),
        outcome: Ended::of(run.verdict),
        motion_counts: run.limit_cycle_peak_to_peak.unwrap_or(0.0) / count,
        stiffness_per_tick: certificate.stiffness_per_tick,
        delay_ticks: scene.timing.computational_delay_s * f64::from(scene.timing.rate_hz),
        radius: own.radius,
        decay_per_s: own.decay_per_s,
        decay_with_friction_per_s: own.decay_with_friction_per_s,
        frequency_hz: own.frequency_hz,
        bounce: own.bounce,
        loan_used: own.loan_used,
        radius_rounded: own.radius_rounded,
        rounding_rms_counts: own.rounding_rms_counts,
        switching: own.switching,
        friction_holds_counts: own.friction_holds_rad / count,
        depth_counts: push / scene.wall.k_desired_n_m_per_rad / count,
        friction_share: scene
            .device
            .friction
            .as_ref()
            .map_or(0.0, |friction| friction.kinetic_n_m / push),
    })
}

/// Numbers of runs by the certificate's verdict and the outcome of the simulated run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tally {
    /// Numbers of runs. The first index is the verdict; the second says whether the run rested, kept oscillating or was unstable.
    counts: [[u32; 3]; 3],
    /// Numbers of runs by verdict and outcome, for classes of the wall's stiffness. Stiffness is the angle in rad by which the
    /// oscillation advances per control period, in classes 0.1 rad wide.
    by_stiffness: std::collections::BTreeMap<u32, [[u32; 3]; 3]>,
    /// Numbers of the random scenes that were certified stable but did not come to rest.
    wrong: Vec<u64>,
}

impl Tally {
    /// Adds one run to the counts.
    pub fn add(&mut self, row: &Row) {
        let outcome = row.outcome as usize;
        let tenth = (10.0 * row.stiffness_per_tick).floor() as u32;
        self.counts[row.said as usize][outcome] += 1;
        self.by_stiffness.entry(tenth).or_default()[row.said as usize][outcome] += 1;
        if row.said == Verdict::Stable && outcome > 0 {
            self.wrong.push(row.index);
        }
    }

    /// Number of runs counted.
    #[must_use]
    pub fn total(&self) -> u32 {
        self.counts.iter().flatten().sum()
    }

    /// Number of runs that were certified stable.
    #[must_use]
    pub fn stable(&self) -> u32 {
        self.counts[Verdict::Stable as usize].iter().sum()
    }

    /// Number of runs whose certificate was undecided.
    #[must_use]
    pub fn undecided(&self) -> u32 {
        self.counts[Verdict::Undecided as usize].iter().sum()
    }

    /// Numbers of the random scenes that were certified stable but did not come to rest.
    #[must_use]
    pub fn wrong(&self) -> &[u64] {
        &self.wrong
    }
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let table = |f: &mut std::fmt::Formatter<'_>, counts: &[[u32; 3]; 3]| {
            for (verdict, row) in [Verdict::Stable, Verdict::Undecided, Verdict::Unstable]
                .into_iter()
                .zip(counts)
            {
                let [rest, cycle, unstable] = row;
                writeln!(
                    f,
                    "{:>10} {rest:>6} {cycle:>12} {unstable:>9}",
                    verdict.word()
                )?;
            }
            Ok(())
        };
        writeln!(
            f,
            "{:>10} {:>6} {:>12} {:>9}",
            "said", "rests", "limit cycle", "unstable"
        )?;
        table(f, &self.counts)?;
        writeln!(
            f,
            "undecided {:.1} %; called stable and not: {:?}",
            100.0 * f64::from(self.undecided()) / f64::from(self.total()),
            self.wrong
        )?;
        for (tenth, counts) in &self.by_stiffness {
            writeln!(f, "T sqrt(k_de/J) from {:.1}", f64::from(*tenth) / 10.0)?;
            table(f, counts)?;
        }
        Ok(())
    }
}
