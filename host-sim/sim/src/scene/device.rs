//! The parts of a scene other than control law and hand: device, encoder, timing, wall.

use serde::{Deserialize, Serialize};

use super::effects::{Cogging, CurrentLoop, CurrentSensor, Imbalance, Transmission};
use touchstone_control::{Settings, choice};

/// A knob with one degree of freedom. Its angle `x` in rad obeys `inertia · x'' + damping · x' + friction = torques`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DeviceSpec {
    /// Moment of inertia, kg·m², above 0. Default 1e-4.
    pub inertia_kg_m2: f64,
    /// Viscous damping, N·m·s/rad, 0 or more. Default 4e-4.
    pub damping_n_m_s_per_rad: f64,
    /// Angle of the device at the start, rad. Absent: the device starts at the first rest point of the hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial_angle_rad: Option<f64>,
    /// Velocity at the start, rad/s, positive into the wall. Default 0.
    pub initial_velocity_rad_per_s: f64,
    /// Largest torque that the drive delivers, N·m, above 0. Absent: no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_limit_n_m: Option<f64>,
    /// Resolution of the amplifier: smallest step between two torques that it can make, N·m, above 0. Absent: no steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplifier_step_n_m: Option<f64>,
    /// Dry friction of the device. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<Friction>,
    /// Cogging torque of the motor. Absent: none.
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
            // The thesis gives no inertia. The value lies between that of a bare gimbal motor (2e-6 to 2e-5 kg·m²) and
            // that measured on a haptic paddle for students (7e-4 kg·m²), because a motor that can hold the thesis'
            // pushes of 0.1 N·m is larger than a gimbal motor.
            inertia_kg_m2: 1e-4,
            // The thesis found 5e-4 by feel with a finger on the knob, so that value includes the finger's damping.
            // The default damping of the device and that of a medium fingertip together come near this value.
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

/// Dry (Coulomb) friction, whose break-away torque may be higher than the torque while sliding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Friction {
    /// Torque while sliding, N·m, 0 or more. Default 1e-3.
    pub kinetic_n_m: f64,
    /// Torque that the device at rest withstands before it slides, N·m, at least `kinetic_n_m`. Absent: equal to `kinetic_n_m`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub static_n_m: Option<f64>,
    /// Asymmetry of the friction torque, N·m, at most `kinetic_n_m`. It is added to the friction of a motion in the positive
    /// direction and subtracted in the negative direction. Absent: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asymmetry_n_m: Option<f64>,
    /// Stribeck velocity, rad/s, above 0. At this velocity the friction torque has fallen from its static value so far that `1/e`
    /// of the difference to its kinetic value is left. Absent: the friction is kinetic as soon as the device moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stribeck_rad_per_s: Option<f64>,
    /// Stiffness of the surfaces' bristles in the LuGre friction model, N·m/rad, above 0. Absent: rigid bristles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bristle_stiffness_n_m_per_rad: Option<f64>,
    /// Damping of the bristles, N·m·s/rad, 0 or more. Absent: `sqrt(k J)`, with bristle stiffness `k` and
    /// the device's inertia `J`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bristle_damping_n_m_s_per_rad: Option<f64>,
}

impl Friction {
    /// Break-away torque, N·m: `static_n_m` if the scene gives it, else `kinetic_n_m`.
    pub fn static_n_m(&self) -> f64 {
        self.static_n_m.unwrap_or(self.kinetic_n_m)
    }
}

impl Default for Friction {
    fn default() -> Self {
        // Small direct-drive motors have 0.5 to 3 mN·m. No maker publishes the value, so it should be varied.
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

/// A position sensor with finite resolution: the control law receives whole encoder counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Encoder {
    /// Encoder counts per turn, above 0. Default 40,000.
    pub counts_per_rev: f64,
}

impl Encoder {
    /// Angle of one encoder count, rad.
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
    /// Integration method that advances device and hand over a control period.
    Integrator {
        /// Closed-form solution of the equations of motion over a whole control period: no numerical step size.
        #[default]
        Exact = "exact",
        /// Implicit Euler; dry friction is solved exactly in each step, including sticking (set-valued friction).
        ImplicitEuler = "implicit-euler",
        /// Implicit midpoint rule; dry friction is solved exactly in each step, including sticking (set-valued friction).
        ImplicitMidpoint = "implicit-midpoint",
        /// Semi-implicit Euler; dry friction takes at most the torque that stops the device.
        SemiImplicitEuler = "semi-implicit-euler",
        /// Classical Runge–Kutta of order 4; dry friction is smoothed around zero velocity.
        RungeKutta4 = "runge-kutta-4",
    }
}

/// The integration method of device and hand, for comparisons of numerical methods with the closed-form solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plant {
    /// The integration method. Default `exact`, the closed-form solution.
    #[serde(
        serialize_with = "super::law::word",
        deserialize_with = "super::law::of_word"
    )]
    pub integrator: Integrator,
    /// Integration steps per control period, 1 to 100,000. The method `exact` uses them only for effects that need substeps.
    /// Default 16.
    pub substeps: u32,
}

impl Default for Plant {
    fn default() -> Self {
        Plant {
            integrator: Integrator::default(),
            // Enough for an explicit method with a pole of a few kilohertz, at a control rate of 1 kHz.
            substeps: 16,
        }
    }
}

/// Control rate, duration of a run, and delay from a sample to its torque command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Timing {
    /// Control rate, Hz, 1 to 100,000. Default 1000.
    pub rate_hz: u32,
    /// Simulated time, s, above 0, at most a day. Default 3.
    pub duration_s: f64,
    /// Computational delay, s, 0 to 1: time from the position sample to the moment at which its torque command acts on the motor.
    /// It need not be a whole number of control periods. Default 0.
    pub computational_delay_s: f64,
    /// Jitter: largest lateness of a position sample, s, 0 to one control period. Each sample is late by a random time up to this
    /// value. Absent: no sample is late.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jitter_s: Option<f64>,
    /// Largest random time that is added to the computational delay of a torque command, s, 0 to 1. It is drawn anew for each
    /// command. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latency_spread_s: Option<f64>,
    /// Fraction of control periods in which the control law does not run, 0 to 0.9; the motor then keeps its torque. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_share: Option<f64>,
}

impl Timing {
    /// Control period `T`, s.
    pub fn period_s(&self) -> f64 {
        1.0 / f64::from(self.rate_hz)
    }

    /// Number of ticks (control periods) in the run, at least 1.
    pub fn ticks(&self) -> u64 {
        ((self.duration_s * f64::from(self.rate_hz)).round() as u64).max(1)
    }
}

impl Default for Timing {
    fn default() -> Self {
        Timing {
            // The control rate of both devices of the thesis.
            rate_hz: Settings::default().rate_hz,
            // The default press (2.5 s) and half a second to see that the released device comes to rest.
            duration_s: 3.0,
            // The thesis' bounds hold without a delay.
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
    /// Position `x_s` of the wall's surface before the control law moves it, rad. Default 0.5.
    pub surface_rad: f64,
    /// Stiffness `k_de` that the wall should display to the hand, N·m/rad, 0 to 500,000. Default 5.
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
