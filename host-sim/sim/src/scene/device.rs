//! The parts of a scene other than control law and hand: device, encoder, timing, wall.

use serde::{Deserialize, Serialize};

use super::effects::{Cogging, CurrentLoop, CurrentSensor, Imbalance, Transmission};
use touchstone_control::{Settings, choice};

/// A knob with one degree of freedom: `inertia · x'' + damping · x' + friction = torques`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DeviceSpec {
    /// Moment of inertia, kg·m², above 0. Default 1e-4.
    pub inertia_kg_m2: f64,
    /// Viscous damping, N·m·s/rad, 0 or more. Default 4e-4.
    pub damping_n_m_s_per_rad: f64,
    /// Angle at the start, rad. Absent: the device starts where the hand's rest point starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial_angle_rad: Option<f64>,
    /// Velocity at the start, rad/s, positive into the wall. Default 0.
    pub initial_velocity_rad_per_s: f64,
    /// Largest torque that the drive delivers, N·m, above 0. Absent: no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_limit_n_m: Option<f64>,
    /// Smallest step of the torque that the amplifier makes, N·m, above 0. Absent: no steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplifier_step_n_m: Option<f64>,
    /// Dry friction. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<Friction>,
    /// Cogging of the motor; absent means none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cogging: Option<Cogging>,
    /// Torque of an eccentric weight. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imbalance: Option<Imbalance>,
    /// Errors of the current sensor. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub current_sensor: Option<CurrentSensor>,
    /// Lag of the motor's torque behind its command. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub current_loop: Option<CurrentLoop>,
    /// A flexible transmission between motor and knob. Absent: motor and knob are rigidly connected.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmission: Option<Transmission>,
}

impl Default for DeviceSpec {
    fn default() -> Self {
        DeviceSpec {
            // The thesis gives no inertia. Chosen between a bare gimbal motor (2e-6 to 2e-5) and a measured student
            // paddle (7e-4), as a motor that can hold the thesis' pushes of 0.1 N·m is no gimbal motor.
            inertia_kg_m2: 1e-4,
            // The thesis found 5e-4 by feel with a finger on the knob, so that value holds the finger's damping too.
            // This much in the device and 3.4e-4 in a medium fingertip come near it.
            damping_n_m_s_per_rad: 4e-4,
            initial_angle_rad: None,
            initial_velocity_rad_per_s: 0.0,
            torque_limit_n_m: None,
            amplifier_step_n_m: None,
            friction: None,
            cogging: None,
            imbalance: None,
            current_sensor: None,
            current_loop: None,
            transmission: None,
        }
    }
}

/// Coulomb friction with a higher break-away torque.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Friction {
    /// Torque while sliding, N·m, 0 or more. Default 1e-3.
    pub kinetic_n_m: f64,
    /// Torque that a resting device bears before it slides, N·m, at least the kinetic one. Absent: equal to it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub static_n_m: Option<f64>,
    /// Difference of friction from its kinetic value: added in the positive direction, subtracted in the negative one, N·m, at most
    /// the kinetic one. Absent: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asymmetry_n_m: Option<f64>,
    /// Velocity at which friction has come down from its static to its kinetic value (Stribeck), rad/s, above 0. Absent: it is kinetic as
    /// soon as the device moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stribeck_rad_per_s: Option<f64>,
    /// Stiffness of the surfaces' bristles in the LuGre friction model, N·m/rad, above 0. Absent: rigid bristles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bristle_stiffness_n_m_per_rad: Option<f64>,
    /// Damping of the bristles, N·m·s/rad, 0 or more. Absent: the root of their stiffness times the inertia.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bristle_damping_n_m_s_per_rad: Option<f64>,
}

impl Friction {
    /// Break-away torque, N·m: the one given, else the kinetic torque.
    pub fn static_n_m(&self) -> f64 {
        self.static_n_m.unwrap_or(self.kinetic_n_m)
    }
}

impl Default for Friction {
    fn default() -> Self {
        // Small direct-drive motors have 0.5 to 3 mN·m (sweep it: no maker publishes it).
        Friction {
            kinetic_n_m: 1e-3,
            static_n_m: None,
            asymmetry_n_m: None,
            stribeck_rad_per_s: None,
            bristle_stiffness_n_m_per_rad: None,
            bristle_damping_n_m_s_per_rad: None,
        }
    }
}

/// A position sensor with steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Encoder {
    /// Steps in one turn, above 0. Default 40,000.
    pub counts_per_rev: f64,
}

impl Encoder {
    /// Width of one encoder step, rad.
    pub fn step_rad(&self) -> f64 {
        std::f64::consts::TAU / self.counts_per_rev
    }
}

impl Default for Encoder {
    fn default() -> Self {
        // An optical disc of 10,000 lines, read at four edges a line. A 14-bit magnetic sensor has 16,384.
        Encoder {
            counts_per_rev: 40_000.0,
        }
    }
}

choice! {
    /// Integration method for device and hand.
    Integrator {
        /// The exact step, with no step size.
        #[default]
        Exact = "exact",
        /// Implicit Euler with set-valued friction.
        ImplicitEuler = "implicit-euler",
        /// Implicit midpoint with set-valued friction.
        ImplicitMidpoint = "implicit-midpoint",
        /// Semi-implicit Euler.
        SemiImplicitEuler = "semi-implicit-euler",
        /// Classical Runge–Kutta, with smoothed friction.
        RungeKutta4 = "runge-kutta-4",
    }
}

/// The integration method of the plant, to compare other methods with the exact step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plant {
    /// The method. Default `exact`.
    #[serde(
        serialize_with = "super::law::word",
        deserialize_with = "super::law::of_word"
    )]
    pub integrator: Integrator,
    /// Substeps per control period, 1 to 100,000. The exact step uses them only for effects that need substeps. Default 16.
    pub substeps: u32,
}

impl Default for Plant {
    fn default() -> Self {
        Plant {
            integrator: Integrator::default(),
            // Enough for an explicit method beside a pole of a few kilohertz at 1 kHz.
            substeps: 16,
        }
    }
}

/// Rate and duration of a run, and delay of the law's command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Timing {
    /// Control rate, Hz, 1 to 100,000. Default 1000.
    pub rate_hz: u32,
    /// Simulated time, s, above 0, at most a day. Default 3.
    pub duration_s: f64,
    /// Time from a sample to its command on the motor, s, 0 to 1; it may be a fraction of a period or several.
    /// Default 0.
    pub computational_delay_s: f64,
    /// Largest lateness of a sample, s, 0 to one control period; each sample is late by a random time up to it. Absent: none is
    /// late.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jitter_s: Option<f64>,
    /// Largest additional time from a sample to its command, s, 0 to 1; each command takes a random time up to it. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latency_spread_s: Option<f64>,
    /// Fraction of control periods that are lost, 0 to 0.9; the motor then keeps its torque. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_share: Option<f64>,
}

impl Timing {
    /// Control period `T`, s.
    pub fn period_s(&self) -> f64 {
        1.0 / f64::from(self.rate_hz)
    }

    /// Number of ticks in the run, at least 1.
    pub fn ticks(&self) -> u64 {
        ((self.duration_s * f64::from(self.rate_hz)).round() as u64).max(1)
    }
}

impl Default for Timing {
    fn default() -> Self {
        Timing {
            // Both devices of the thesis.
            rate_hz: Settings::default().rate_hz,
            // The default press (2.5 s) and half a second to see that the released device comes to rest.
            duration_s: 3.0,
            // The thesis' bounds are those without delay.
            computational_delay_s: 0.0,
            jitter_s: None,
            latency_spread_s: None,
            lost_share: None,
        }
    }
}

/// The virtual wall: all angles beyond its surface are inside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wall {
    /// Undeformed surface `x_s`, rad. Default 0.5.
    pub surface_rad: f64,
    /// Requested stiffness `k_de`, N·m/rad, 0 to 500,000. Default 5.
    pub k_desired_n_m_per_rad: f64,
}

impl Default for Wall {
    fn default() -> Self {
        Wall {
            // Thesis Fig. 5.1.
            surface_rad: 0.5,
            // The hardest wall of the thesis' comparison, §5.1: five times the critical stiffness.
            k_desired_n_m_per_rad: Settings::default().k_desired.to_num(),
        }
    }
}
