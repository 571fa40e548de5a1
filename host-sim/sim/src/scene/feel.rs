//! The parts of a knob's feel beside walls, detents and profile: a spring to a centre, viscous and dry friction, a click, and
//! an added inertia.

use serde::{Deserialize, Serialize};

/// A spring that draws the knob to a centre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CentreSpring {
    /// Angle at which the spring gives no torque, rad. Default 0.
    pub centre_rad: f64,
    /// Stiffness, N·m/rad, 0 to 100. Default 0.03.
    pub stiffness_n_m_per_rad: f64,
    /// Largest torque, N·m, from 0 to the force limit of the control law. At larger angles the torque stays at this value. Default
    /// 0.03.
    pub strength_n_m: f64,
}

impl Default for CentreSpring {
    fn default() -> Self {
        CentreSpring {
            centre_rad: 0.0,
            stiffness_n_m_per_rad: 0.03,
            strength_n_m: 0.03,
        }
    }
}

/// Rendered viscous friction: a torque in proportion to the speed, against the motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ViscousFriction {
    /// Damping, N·m·s/rad, from 0 to `J/(4 (T + delay + 1/(2π p)))` with inertia `J` and delay of `[law.estimator]`, control period
    /// `T` and bandwidth `p`. Default 0.0005.
    pub damping_n_m_s_per_rad: f64,
    /// Bandwidth of the low-pass filter of the velocity, Hz, 5 to 500. Default 100.
    pub bandwidth_hz: f64,
}

impl Default for ViscousFriction {
    fn default() -> Self {
        ViscousFriction {
            damping_n_m_s_per_rad: 0.0005,
            bandwidth_hz: 100.0,
        }
    }
}

/// Rendered dry friction: a constant torque against every motion, which also holds the knob at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DryFriction {
    /// Torque while the knob slides, N·m, from 0 to the force limit of the control law. Default 0.005.
    pub strength_n_m: f64,
    /// Angle by which the knob first moves as on a spring before it slides, rad, 0.001 to 1. Default 0.02.
    pub stretch_rad: f64,
}

impl Default for DryFriction {
    fn default() -> Self {
        DryFriction {
            strength_n_m: 0.005,
            stretch_rad: 0.02,
        }
    }
}

/// Clicks: a short torque at evenly spaced angles, first against the motion and then for the same time with it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Clicks {
    /// Number of clicks per turn, 1 to 6283. With 0 the clicks are `pitch_rad` apart. Default 24.
    pub per_rev: u32,
    /// Angle between two neighbouring clicks, rad, 0.001 to a turn. Only used if `per_rev` is 0. Default 0.2.
    pub pitch_rad: f64,
    /// Angle of one of the clicks, rad. Default 0.
    pub centre_rad: f64,
    /// Torque of the pulse, N·m, from 0 to the force limit of the control law. Default 0.02.
    pub strength_n_m: f64,
    /// Length of the pulse, s, 0.001 to 0.1; at least two control periods. Default 0.006.
    pub duration_s: f64,
}

impl Default for Clicks {
    fn default() -> Self {
        Clicks {
            per_rev: 24,
            pitch_rad: 0.2,
            centre_rad: 0.0,
            strength_n_m: 0.02,
            duration_s: 0.006,
        }
    }
}

/// An added inertia: the knob drags a virtual mass by a damper, and feels heavier.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AddedInertia {
    /// Inertia of the virtual mass, kg·m², from 0 to `(J/(4 (T + delay + 1/(2π 100 Hz))) - b)/(2π p)` with inertia `J` and delay of
    /// `[law.estimator]`, control period `T`, damping `b` of `[environment.damper]` and bandwidth `p`. Default 1e-5.
    pub inertia_kg_m2: f64,
    /// Bandwidth, Hz, 5 to 30. Motions below this frequency move the mass; for faster motions only its damper acts. Default 12.
    pub bandwidth_hz: f64,
}

impl Default for AddedInertia {
    fn default() -> Self {
        AddedInertia {
            inertia_kg_m2: 1e-5,
            bandwidth_hz: 12.0,
        }
    }
}
