//! Results of one run: the summary for `results.json`, and the trace for the plots.

use super::judge::Judge;
pub use super::measure::DynamicStiffness;
pub use super::verdict::Verdict;
use crate::scene::Scene;
use serde::Serialize;
use touchstone_control::{Choice as _, LawKind};

/// Measures of one run, in SI units. `None` means that the measure does not apply, for example because the scene has no hold.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// Control law of the scene.
    #[serde(serialize_with = "crate::scene::word")]
    pub law: LawKind,
    /// Name of the run in tables and figures in place of the law's name, for a report that compares two settings of one law. The
    /// name in results files is that of [`Summary::word`].
    #[serde(skip)]
    pub shown_as: Option<&'static str>,
    /// Number format of the law: `fixed32`, `fixed16`, `f32` or `f64`.
    pub number: String,
    /// Stiffness `k_de` that the wall should display, N·m/rad.
    pub k_desired: f64,
    /// Grip: `none`, `light`, `medium`, `firm` or `custom`.
    pub grip: String,
    /// Encoder counts per revolution; `None` for an exact position.
    pub encoder_counts_per_rev: Option<f64>,
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Verdict on the run, such as passive or unstable.
    pub verdict: Verdict,
    /// Reason why the run could not be judged; `None` if it was judged.
    pub not_judged: Option<String>,
    /// Stiffness displayed in the second half of the last hold, N·m/rad: mean force divided by mean penetration.
    pub k_displayed: Option<f64>,
    /// Rate-hardness of the first contact (thesis, equation 1.5), computed from true force and true motion, N·m/rad.
    pub rate_hardness: Option<f64>,
    /// Extended rate-hardness of the first contact (Han and Choi 2010), N·m/rad: largest rate of change of the force, divided by
    /// the largest speed.
    pub extended_rate_hardness: Option<f64>,
    /// Largest torque of the motor in the first five milliseconds of the first contact, N·m.
    pub touch_torque_n_m: Option<f64>,
    /// Deepest penetration divided by that of an ideal spring, `F/k_de`; 1 is ideal. `F` is the largest static torque of the hand's
    /// push, `k_de` the requested stiffness.
    pub peak_penetration_ratio: Option<f64>,
    /// Dynamic stiffness, the ratio of force to penetration, while the hand moves rhythmically inside the wall. Empty if the hand
    /// does not move rhythmically or leaves the wall.
    pub dynamic_stiffness: Vec<DynamicStiffness>,
    /// Ripple of the motor's torque from tick to tick (control periods), rms, while the hand moves or presses steadily, N·m.
    pub ripple_rms_n_m: Option<f64>,
    /// Ripple of the motor's torque above 50 Hz, rms, N·m.
    pub ripple_above_50_hz_rms_n_m: Option<f64>,
    /// Largest outward speed of the device after the hand begins to let go, rad/s.
    pub release_speed_rad_per_s: Option<f64>,
    /// Largest distance of the device outside the wall's surface after the hand begins to let go, rad.
    pub release_excursion_rad: Option<f64>,
    /// Largest peak-to-peak motion of the device in the last quarter of a hold, rad.
    pub limit_cycle_peak_to_peak: Option<f64>,
    /// Lowest energy that the wall has absorbed since the start, J; negative if at some time it had given more than it took.
    pub energy_true_min: f64,
    /// Lowest energy that the user has put in since the start, J: the wall's absorbed energy plus the device's dissipation.
    pub energy_user_min: f64,
    /// Most energy that the user got out beyond what was put in, J; 0 or more. It is [`energy_user_min`](Self::energy_user_min)
    /// with the sign changed, or 0 if that is within the rounding of the sums.
    pub energy_out: f64,
    /// Lowest energy that the passivity observer of the control law reported, J; `None` for laws without an observer.
    pub energy_observed_min: Option<f64>,
    /// Most energy that the hand got out of the device in any window of time, J. The window may start at any tick.
    pub energy_out_worst_window_j: f64,
    /// Most energy that the wall gave out in any window of time, J. The window may start at any tick.
    pub energy_out_wall_worst_window_j: f64,
    /// Lowest value of the energy guard's account, J: the energy that the wall may still give (negative after overspeed). `None`
    /// without a guard.
    pub guard_account_min_j: Option<f64>,
    /// Number of ticks in which the energy guard passed less force than the control law requested; `None` without a guard.
    pub guard_limited_ticks: Option<u64>,
    /// Time at which the energy guard switched the force off, s, because of overspeed or the end of the range of positions. `None`
    /// if it did not, or without a guard.
    pub guard_tripped_s: Option<f64>,
    /// Time from which a wall was off, s, because the device was deeper inside it than the number format of positions reaches.
    /// `None` if it never was.
    #[serde(skip)]
    pub wall_off_s: Option<f64>,
    /// Settling time, s: from the first touch until force over penetration stays within 5 % of the requested stiffness. `None` if
    /// it never settles.
    pub settle_time: Option<f64>,
    /// Time from the end of the press' ramp until force over penetration has settled, s; 0 if it had settled before.
    pub settle_from_ramp_end_s: Option<f64>,
    /// Deepest true penetration of the wall, rad; 0 if the wall was never reached, infinite if the simulation diverged.
    pub penetration_max: f64,
    /// Largest absolute force of the control law, N·m.
    pub force_max: f64,
    /// Number of ticks (control periods) that were simulated.
    pub ticks: u64,
    /// Number of ticks (control periods) in which the control law gave a force.
    pub contact_ticks: u64,
}

impl Summary {
    /// Name of the run in results and file names: the law's name as in `--law`, or the name that a report gives the run, in lower
    /// case.
    #[must_use]
    pub fn word(&self) -> String {
        match self.shown_as {
            Some(name) => name.to_lowercase(),
            None => self.law.word().to_owned(),
        }
    }

    /// A note on a wall that was off in the run, because the device was too deep inside it; `None` if none was.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        self.wall_off_s.map(|from_s| {
            format!(
                "a wall is off from {from_s:.3} s on, because the device is deeper inside it than law.number = {} can express; move the wall, or choose another number format",
                self.number
            )
        })
    }

    /// Name of the run's verdict.
    #[must_use]
    pub const fn verdict_name(&self) -> &'static str {
        self.verdict.name()
    }

    /// Name of the verdict, with the reason if the run could not be judged.
    #[must_use]
    pub fn verdict_and_why(&self) -> String {
        match &self.not_judged {
            Some(why) => format!("{}: {why}", self.verdict_name()),
            None => self.verdict_name().to_owned(),
        }
    }

    /// Collects the measures of a run from the judge that observed it.
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
            wall_off_s: judged.beyond_reach_tick.map(seconds),
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
    /// Time of each position sample, s.
    pub time_s: Vec<f64>,
    /// True angle of the device, rad.
    pub angle_rad: Vec<f64>,
    /// True velocity of the device, rad/s.
    pub velocity_rad_per_s: Vec<f64>,
    /// Angle that the sensor gave to the control law, rad.
    pub angle_measured_rad: Vec<f64>,
    /// Angle of the hand's mass, rad; without a hand, the device's angle.
    pub hand_rad: Vec<f64>,
    /// Rest point of the hand, rad: the angle to which the person pulls the hand.
    pub rest_rad: Vec<f64>,
    /// Force of the control law after its limit, N·m, positive out of the wall.
    pub force_n_m: Vec<f64>,
    /// Position `x_s` of the wall's surface before the control law moves it, rad.
    pub surface_rad: Vec<f64>,
    /// Position `x_s - O` of the shifted surface, rad. The law moves the surface by the offset `O` to deform the virtual spring
    /// further.
    pub surface_shifted_rad: Vec<f64>,
    /// Position of the control law's virtual filter mass, rad; the device's angle if the law has no such mass or does not use it.
    pub mass_rad: Vec<f64>,
    /// Energy that the passivity observer of the control law reports, J; NaN for a law without an observer.
    pub energy_observed_j: Vec<f64>,
    /// Energy that the wall has absorbed since the start, J, from true positions with the force held over each control period.
    pub energy_true_j: Vec<f64>,
    /// Energy that the device has dissipated since the start, J (viscous and dry friction).
    pub energy_device_loss_j: Vec<f64>,
    /// Account of the energy guard, J: energy that the wall may still give to the hand. NaN for a scene without an energy guard.
    pub guard_account_j: Vec<f64>,
}

impl Trace {
    /// All columns, in the order of the fields.
    #[must_use]
    pub fn columns(&self) -> [&[f64]; 14] {
        // No `..` here, so that a forgotten field is a compile error.
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

/// A finished simulation, with its measures and its trace.
#[derive(Debug, Clone)]
pub struct Run {
    /// The measures of the run.
    pub summary: Summary,
    /// Trace of the run; `None` if the run was made without a trace.
    pub trace: Option<Trace>,
}
