//! What one run leaves behind: the summary that goes into `results.json` and the trace that the plots are drawn from.

use serde::Serialize;

/// The law that made the force, by its name in scenes, on the command line and in results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawKind {
    /// Virtual spring, thesis (1.6).
    Spring,
    /// Virtual spring with virtual damping, thesis §1.2.6.
    SpringDamper,
    /// Time-domain passivity approach, thesis (2.1)–(2.6).
    Tdpa,
    /// Force bounding approach, thesis (2.6a)–(2.10).
    Fba,
    /// Original successive force augmentation, thesis (2.11)–(2.17).
    Sfa,
    /// Successive force augmentation with the offset changed at every inward tick, thesis (3.2)–(3.3).
    SfaContinuous,
    /// Enhanced successive force augmentation, thesis Algorithm 3.1 and Fig. 3.18.
    EnhancedSfa,
}

/// How a run ended. The order is from good to bad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Came to rest; the user never got more energy out of the device than was put in.
    Passive,
    /// Came to rest, but at some time the device had given the user more energy than it had got.
    Active,
    /// Keeps oscillating without growing beyond the wall's neighbourhood.
    LimitCycle,
    /// Leaves the wall again and again, hits the torque limit, or grows without bound.
    Unstable,
}

/// One run in numbers, all SI. `None` stands for "does not apply", e.g. no hold in the scene.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Scene name.
    pub scene: String,
    /// Law.
    pub law: LawKind,
    /// Number format of the law: `fixed32`, `fixed16`, `f32` or `f64`.
    pub number: String,
    /// Desired stiffness `k_de`, N·m/rad.
    pub k_desired: f64,
    /// Grip: `none`, `light`, `medium`, `firm` or `custom`.
    pub grip: String,
    /// Encoder counts per revolution; `None` for an exact position.
    pub encoder_counts_per_rev: Option<f64>,
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// How it ended.
    pub verdict: Verdict,
    /// Stiffness displayed at the end of the hold, mean force over mean penetration, N·m/rad.
    pub k_displayed: Option<f64>,
    /// Stiffness on the first contact: slope of force over measured penetration up to the first reversal, N·m/rad.
    pub k_first_contact: Option<f64>,
    /// Largest peak-to-peak motion of the HIP at the end of the hold, rad.
    pub limit_cycle_peak_to_peak: Option<f64>,
    /// Lowest true energy of the wall's port, J (negative: the wall gave energy away).
    pub energy_true_min: f64,
    /// Lowest true energy of the user's port: the wall's plus what the device dissipated, J.
    pub energy_user_min: f64,
    /// Most that the user's port ever gave beyond what it had taken, J, 0 or more: what [`energy_user_min`](Self::energy_user_min)
    /// lies below zero by, where that is more than the rounding of its sums.
    pub energy_out: f64,
    /// Lowest energy that the law's own observer reported, J; `None` for laws without one.
    pub energy_observed_min: Option<f64>,
    /// From the first contact until the displayed stiffness stays within 5 % of its final value, s.
    pub settle_time: Option<f64>,
    /// Deepest true penetration of the wall, rad, 0 if it was never reached; infinite for a run that left all numbers.
    pub penetration_max: f64,
    /// Largest force command, N·m.
    pub force_max: f64,
    /// Ticks simulated.
    pub ticks: u64,
    /// Ticks with a force from the wall.
    pub contact_ticks: u64,
}

/// The columns of a run, one entry a tick. All vectors have the same length.
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
    /// Force of the law, pushing out of the wall, N·m, after its limit.
    pub force_n_m: Vec<f64>,
    /// Undeformed wall surface `x_s`, rad.
    pub surface_rad: Vec<f64>,
    /// Shifted surface `x_s - O` (the offset deforms the virtual spring further), rad.
    pub surface_shifted_rad: Vec<f64>,
    /// Position of the virtual filter mass where the law has one and it is in use, else the HIP, rad.
    pub mass_rad: Vec<f64>,
    /// Energy that the law's own observer reports, J (NaN: the law has none).
    pub energy_observed_j: Vec<f64>,
    /// True energy of the wall's port under the zero-order hold, J.
    pub energy_true_j: Vec<f64>,
    /// Energy that the device dissipated so far (viscous and dry friction), J.
    pub energy_device_loss_j: Vec<f64>,
}

/// One finished run.
#[derive(Debug, Clone)]
pub struct Run {
    /// Its numbers.
    pub summary: Summary,
    /// Its trace; `None` when logging was off.
    pub trace: Option<Trace>,
}
