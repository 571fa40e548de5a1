//! Results of one run: the summary for `results.json`, and the trace for the plots.

pub use super::measure::DynamicStiffness;
pub use super::summary::Summary;
pub use super::verdict::Verdict;

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
