//! Results of one run: the summary for `results.json`, and the trace for the plots.

use super::judge::Judge;
pub use super::measure::DynamicStiffness;
pub use super::verdict::Verdict;
use crate::scene::Scene;
use serde::Serialize;
use touchstone_control::{Choice as _, LawKind};

/// Measures of one run, all in SI units. `None` means that the measure does not apply, for example where the scene has no hold.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// Control law of the scene.
    #[serde(serialize_with = "crate::scene::word")]
    pub law: LawKind,
    /// Name in tables and figures instead of the law's own name, for a report that compares two settings of one law. In results
    /// files the name comes from [`Summary::word`].
    #[serde(skip)]
    pub shown_as: Option<&'static str>,
    /// Number format of the law: `fixed32`, `fixed16`, `f32` or `f64`.
    pub number: String,
    /// Requested stiffness `k_de` of the wall, N·m/rad.
    pub k_desired: f64,
    /// Grip: `none`, `light`, `medium`, `firm` or `custom`.
    pub grip: String,
    /// Encoder counts per revolution; `None` for an exact position.
    pub encoder_counts_per_rev: Option<f64>,
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// How the run ended.
    pub verdict: Verdict,
    /// Why the run could not be judged; `None` if it was judged.
    pub not_judged: Option<String>,
    /// Stiffness displayed at the end of the hold, mean force over mean penetration, N·m/rad.
    pub k_displayed: Option<f64>,
    /// Rate-hardness of the first contact, thesis (1.5), from true force and true motion, N·m/rad.
    pub rate_hardness: Option<f64>,
    /// Extended rate-hardness of the first contact (Han and Choi 2010), N·m/rad.
    pub extended_rate_hardness: Option<f64>,
    /// Largest torque of the motor in the first five milliseconds of the first contact, N·m.
    pub touch_torque_n_m: Option<f64>,
    /// Deepest penetration over `F/k_de`, with `F` the largest static torque that the motion aims at; 1 is ideal.
    pub peak_penetration_ratio: Option<f64>,
    /// Ratio of force to penetration, `F/x`, while the hand moves rhythmically inside the wall. Empty if the hand does not, or
    /// leaves the wall.
    pub dynamic_stiffness: Vec<DynamicStiffness>,
    /// Ripple of the motor's torque from tick to tick, rms, while the hand moves or presses steadily, N·m.
    pub ripple_rms_n_m: Option<f64>,
    /// RMS of the ripple above 50 Hz, N·m.
    pub ripple_above_50_hz_rms_n_m: Option<f64>,
    /// Largest outward speed from the moment at which the hand begins to let go, rad/s.
    pub release_speed_rad_per_s: Option<f64>,
    /// Largest distance outside the wall's surface from the moment at which the hand begins to let go, rad.
    pub release_excursion_rad: Option<f64>,
    /// Largest peak-to-peak motion of the HIP at the end of the hold, rad.
    pub limit_cycle_peak_to_peak: Option<f64>,
    /// Lowest true energy of the wall's port, J (negative: the wall gave energy away).
    pub energy_true_min: f64,
    /// Lowest true energy of the user's port: the wall's plus what the device dissipated, J.
    pub energy_user_min: f64,
    /// Most energy that the user's port gave beyond what it had taken, J; 0 or more. It is
    /// [`energy_user_min`](Self::energy_user_min) with the sign changed, or 0 within the rounding of the sums.
    pub energy_out: f64,
    /// Lowest energy that the law's own observer reported, J; `None` for laws without one.
    pub energy_observed_min: Option<f64>,
    /// Most energy that the hand got out of the device in any window of time, J, counting the wall, the device's losses and the
    /// device's motion.
    pub energy_out_worst_window_j: f64,
    /// Most energy that the wall's port gave in any window of time, J.
    pub energy_out_wall_worst_window_j: f64,
    /// Lowest value of the guard's energy account, J (negative after overspeed); `None` without a guard.
    pub guard_account_min_j: Option<f64>,
    /// Ticks in which the guard passed less force than the control law requested; `None` without a guard.
    pub guard_limited_ticks: Option<u64>,
    /// Time at which the guard switched the force off, for overspeed or at the end of the range of positions, s. `None` if it did
    /// not, or without a guard.
    pub guard_tripped_s: Option<f64>,
    /// Time from the first touch until force over penetration stays within 5 % of the requested stiffness, s; `None` if it never
    /// does.
    pub settle_time: Option<f64>,
    /// Time from the end of the press' ramp until the force has settled, s; 0 if it had settled before.
    pub settle_from_ramp_end_s: Option<f64>,
    /// Deepest true penetration of the wall, rad; 0 if the wall was never reached, infinite if the simulation diverged.
    pub penetration_max: f64,
    /// Largest force command, N·m.
    pub force_max: f64,
    /// Number of ticks simulated.
    pub ticks: u64,
    /// Number of ticks with a force from the wall.
    pub contact_ticks: u64,
}

impl Summary {
    /// Name of the run in results and file names: the law's name in commands, or the name that a report gives the run, in lower
    /// case.
    #[must_use]
    pub fn word(&self) -> String {
        match self.shown_as {
            Some(name) => name.to_lowercase(),
            None => self.law.word().to_owned(),
        }
    }

    /// Name of the run's verdict.
    #[must_use]
    pub const fn verdict_name(&self) -> &'static str {
        self.verdict.name()
    }

    /// Name of the verdict, followed by the reason if the run could not be judged.
    #[must_use]
    pub fn verdict_and_why(&self) -> String {
        match &self.not_judged {
            Some(why) => format!("{}: {why}", self.verdict_name()),
            None => self.verdict_name().to_owned(),
        }
    }

    /// Collects the measures of a run from its judge.
    #[must_use]
    pub fn of(scene: &Scene, judge: &Judge) -> Self {
        let judged = judge.finish();
        let seconds = |ticks: u64| ticks as f64 * scene.timing.period_s();
        Self {
            scene: scene.name.clone(),
            law: scene.law.kind,
            shown_as: None,
            number: touchstone_control::Choice::word(scene.law.number).to_owned(),
            k_desired: scene.wall.k_desired_n_m_per_rad,
            grip: scene.operator.grip.name().to_owned(),
            encoder_counts_per_rev: scene.encoder.as_ref().map(|encoder| encoder.counts_per_rev),
            rate_hz: scene.timing.rate_hz,
            verdict: judged.verdict,
            not_judged: judged.not_judged.map(|why| why.to_string()),
            k_displayed: judged.k_displayed,
            rate_hardness: judged.rate_hardness,
            extended_rate_hardness: judged.extended_rate_hardness,
            touch_torque_n_m: judged.touch_torque_n_m,
            peak_penetration_ratio: judged.peak_penetration_ratio,
            dynamic_stiffness: judged.dynamic_stiffness.into_iter().collect(),
            ripple_rms_n_m: judged.ripple_rms_n_m,
            ripple_above_50_hz_rms_n_m: judged.ripple_above_50_hz_rms_n_m,
            release_speed_rad_per_s: judged.release_speed_rad_per_s,
            release_excursion_rad: judged.release_excursion_rad,
            limit_cycle_peak_to_peak: judged.limit_cycle_peak_to_peak,
            energy_true_min: judged.energy_true_min,
            energy_user_min: judged.energy_user_min,
            energy_out: judged.energy_out,
            energy_observed_min: judged.energy_observed_min,
            energy_out_worst_window_j: judged.energy_out_worst_window_j,
            energy_out_wall_worst_window_j: judged.energy_out_wall_worst_window_j,
            guard_account_min_j: judged.guard.map(|guard| guard.account_min_j),
            guard_limited_ticks: judged.guard.map(|guard| guard.limited_ticks),
            guard_tripped_s: judged
                .guard
                .and_then(|guard| guard.tripped_tick)
                .map(seconds),
            settle_time: judged.settled.map(|s| seconds(s.from_first_touch)),
            settle_from_ramp_end_s: judged.settled.map(|s| seconds(s.from_ramp_end)),
            penetration_max: judged.penetration_max,
            force_max: judged.force_max,
            ticks: scene.timing.ticks(),
            contact_ticks: judged.contact_ticks,
        }
    }
}

/// Columns of the recorded run, one entry per tick. All vectors have the same length.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// Time of the sample, s.
    pub time_s: Vec<f64>,
    /// True angle of the device (HIP), rad.
    pub angle_rad: Vec<f64>,
    /// True velocity of the device, rad/s.
    pub velocity_rad_per_s: Vec<f64>,
    /// Angle as the encoder gave it to the law, rad.
    pub angle_measured_rad: Vec<f64>,
    /// Angle of the hand's mass, rad (the device's own where there is no hand).
    pub hand_rad: Vec<f64>,
    /// The hand's moving rest point, rad.
    pub rest_rad: Vec<f64>,
    /// Force of the control law after its limit, N·m, positive out of the wall.
    pub force_n_m: Vec<f64>,
    /// Position `x_s` of the undeformed wall surface, rad.
    pub surface_rad: Vec<f64>,
    /// Position `x_s - O` of the shifted surface, rad. The law moves the surface by the offset `O` to deform the virtual spring
    /// further.
    pub surface_shifted_rad: Vec<f64>,
    /// Position of the law's virtual filter mass, rad; the device's angle for a law that has none or does not use it in the tick.
    pub mass_rad: Vec<f64>,
    /// Energy that the law's own observer reports, J (NaN: the law has none).
    pub energy_observed_j: Vec<f64>,
    /// True energy of the wall's port under the zero-order hold, J.
    pub energy_true_j: Vec<f64>,
    /// Energy that the device dissipated so far (viscous and dry friction), J.
    pub energy_device_loss_j: Vec<f64>,
    /// Energy that the guard may still let the wall give the hand, J (NaN: the scene has no guard).
    pub guard_account_j: Vec<f64>,
}

impl Trace {
    /// All columns, in the order of the fields.
    #[must_use]
    pub fn columns(&self) -> [&[f64]; 14] {
        // No `..` here: a field that is forgotten does not compile.
        let Trace {
            time_s,
            angle_rad,
            velocity_rad_per_s,
            angle_measured_rad,
            hand_rad,
            rest_rad,
            force_n_m,
            surface_rad,
            surface_shifted_rad,
            mass_rad,
            energy_observed_j,
            energy_true_j,
            energy_device_loss_j,
            guard_account_j,
        } = self;
        [
            time_s,
            angle_rad,
            velocity_rad_per_s,
            angle_measured_rad,
            hand_rad,
            rest_rad,
            force_n_m,
            surface_rad,
            surface_shifted_rad,
            mass_rad,
            energy_observed_j,
            energy_true_j,
            energy_device_loss_j,
            guard_account_j,
        ]
    }
}

/// One finished run.
#[derive(Debug, Clone)]
pub struct Run {
    /// The measures of the run.
    pub summary: Summary,
    /// Trace of the run; `None` when logging was off.
    pub trace: Option<Trace>,
}
