//! Treats an axis of a translational device as a knob on a lever, and converts a knob's law settings back to the axis. Tools for
//! knobs, such as `touchstone tune`, can thus be used for translational axes.
//!
//! On a lever of length `r`, a mass `M` becomes an inertia `M r²`; damping and stiffness are converted with the same factor. A
//! force `F` becomes a torque `F r`, and a displacement `x` an angle `x/r`. Times and energies do not change, so a control law
//! behaves the same.

use std::fmt::Write;
use touchstone_control::settings::FilterSettings;
use touchstone_control::{EstimatorSettings, Settings, Si};

/// A lever that converts between a translational axis and a knob.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lever {
    /// Length of the lever, m.
    pub length_m: f64,
}

/// Properties of a translational axis that the caller has to give, SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisOfDevice {
    /// Name of the axis, for users.
    pub name: String,
    /// Mass that moves with the axis, kg.
    pub mass_kg: f64,
    /// Viscous damping of the axis, N·s/m.
    pub damping_n_s_per_m: f64,
    /// Dry friction of the axis, N.
    pub friction_n: f64,
    /// Largest force of the axis, N.
    pub force_n: f64,
    /// Resolution of the measured position, m.
    pub count_m: f64,
    /// Time from reading a position until the force computed from it acts, s.
    pub delay_s: f64,
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Requested stiffness of the wall, N/m.
    pub k_desired_n_per_m: f64,
}

/// Inertia of the thesis' knob, kg·m². The simulated hands for one axis were chosen for such a knob.
const KNOB_KG_M2: f64 = 1e-4;
/// Force with which the simulated hand presses the wall, as a fraction of the largest force of the axis.
pub const PRESS_SHARE: f64 = 2.0 / 3.0;

impl Lever {
    /// Makes the lever on which an axis with this mass has the inertia of the thesis' knob.
    #[must_use]
    pub fn of(mass_kg: f64) -> Self {
        Self {
            length_m: (KNOB_KG_M2 / mass_kg).sqrt(),
        }
    }

    /// Text of the scene file (TOML) of this axis as a knob on the lever.
    #[must_use]
    pub fn scene(&self, axis: &AxisOfDevice) -> String {
        let r = self.length_m;
        let square = r * r;
        let mut text = String::new();
        let _ = writeln!(
            text,
            "# An axis of {:.4} kg, {:.3} N·s/m and {:.3} N of friction, as a knob on a lever of {:.4} mm.",
            axis.mass_kg,
            axis.damping_n_s_per_m,
            axis.friction_n,
            1e3 * r
        );
        let _ = writeln!(text, "name = {:?}\n", axis.name);
        let _ = writeln!(text, "[device]");
        let _ = writeln!(text, "inertia_kg_m2 = {:e}", axis.mass_kg * square);
        let damping = axis.damping_n_s_per_m * square;
        let _ = writeln!(text, "damping_n_m_s_per_rad = {damping:e}");
        let _ = writeln!(text, "torque_limit_n_m = {:e}\n", axis.force_n * r);
        if axis.friction_n > 0.0 {
            let _ = writeln!(text, "[device.friction]");
            let _ = writeln!(text, "kinetic_n_m = {:e}\n", axis.friction_n * r);
        }
        let counts = (std::f64::consts::TAU * r / axis.count_m).round();
        let _ = writeln!(text, "[encoder]\ncounts_per_rev = {counts}\n");
        let _ = writeln!(text, "[timing]\nrate_hz = {}", axis.rate_hz);
        let _ = writeln!(text, "computational_delay_s = {:e}", axis.delay_s);
        let _ = writeln!(text, "duration_s = 4.5\n");
        let wall = axis.k_desired_n_per_m * square;
        let _ = writeln!(text, "[wall]\nk_desired_n_m_per_rad = {wall:e}\n");
        let _ = writeln!(text, "[law]\nforce_limit_n_m = {:e}", axis.force_n * r);
        let _ = writeln!(text, "device_damping_n_m_s_per_rad = {damping:e}\n");
        let press = PRESS_SHARE * axis.force_n * r;
        let _ = writeln!(
            text,
            "[operator]\ngrip = \"medium\"\n\n[operator.motion]\nkind = \"touch-and-press\"\npush_torque_n_m = {press:e}\ntouch_torque_n_m = {:e}",
            0.2 * press
        );
        text
    }

    /// Converts a knob's law settings to the axis. The energy guard is not converted.
    #[must_use]
    pub fn settings(&self, knob: &Settings) -> Settings {
        let filter = &knob.filter;
        Settings {
            k_desired: self.linear(knob.k_desired),
            k_soft: self.linear(knob.k_soft),
            device_damping: self.linear(knob.device_damping),
            virtual_damping: self.linear(knob.virtual_damping),
            force_limit: Si::saturating_from_num(knob.force_limit.to_num::<f64>() / self.length_m),
            filter: FilterSettings {
                mass: self.linear(filter.mass),
                stiffness: self.linear(filter.stiffness),
                damping: self.linear(filter.damping),
                ground_damping: self.linear(filter.ground_damping),
            },
            // The estimator's inertia also sets the size of the pulse at the touch.
            estimator: self.estimator(&knob.estimator),
            ..*knob
        }
    }

    /// Converts a knob's settings of the state estimator to the axis.
    #[must_use]
    pub fn estimator(&self, knob: &EstimatorSettings) -> EstimatorSettings {
        EstimatorSettings {
            inertia: self.linear(knob.inertia),
            damping: self.linear(knob.damping),
            ..*knob
        }
    }

    /// Converts an inertia, a damping or a stiffness from knob to axis.
    fn linear(&self, knob: Si) -> Si {
        Si::saturating_from_num(knob.to_num::<f64>() / (self.length_m * self.length_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchstone_sim::scene::Scene;

    #[test]
    fn an_axis_comes_back_as_it_was() {
        let axis = AxisOfDevice {
            name: "x of a device".into(),
            mass_kg: 0.148,
            damping_n_s_per_m: 2.5,
            friction_n: 0.1,
            force_n: 12.0,
            count_m: 1e-5,
            delay_s: 0.0,
            rate_hz: 4000,
            k_desired_n_per_m: 5000.0,
        };
        let lever = Lever::of(axis.mass_kg);
        let scene = Scene::parse(&lever.scene(&axis), Path::new("axis.toml")).expect("a scene");
        assert!((scene.device.inertia_kg_m2 - KNOB_KG_M2).abs() < 1e-15);
        let settings = scene.settings().expect("settings");
        let back = lever.settings(&settings);
        assert!((back.k_desired.to_num::<f64>() - 5000.0).abs() < 1e-3);
        assert!((back.device_damping.to_num::<f64>() - 2.5).abs() < 1e-6);
        assert!((back.force_limit.to_num::<f64>() - 12.0).abs() < 1e-6);
        let told = lever.estimator(&settings.estimator);
        let ratio = told.inertia.to_num::<f64>() / settings.estimator.inertia.to_num::<f64>();
        assert!((ratio / (0.148 / KNOB_KG_M2) - 1.0).abs() < 1e-6);
        // Steps of 0.01 mm at a lever of 26 mm are 16,332 counts a turn.
        let counts = scene.encoder.map(|encoder| encoder.counts_per_rev);
        assert_eq!(counts, Some(16_332.0));
    }
}
