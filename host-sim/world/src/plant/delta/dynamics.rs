//! Dynamics of a delta mechanism (three arms that move an effector without turning it).
//!
//! ```text
//! M(x) dv/dt = slopesᵀ (τ - b_θ dθ/dt - I c(x, v)) - b v + hand
//! M = m 1 + I slopesᵀ slopes        c: accelerations of the joints while the effector moves straight on
//! ```
//!
//! `x` and `v` are position and velocity of the effector, `b` its damping, and `hand` the force of the hand. `θ` are the joint
//! angles with damping `b_θ`, and `τ` the motor torques. `slopes` is the derivative of the joint angles over `x`.
//!
//! Two thirds of each forearm's mass count at the elbow and one third at the effector (Codourey, *Dynamic modeling of parallel
//! robots*, Int. J. Robotics Research 17(12), 1998). The moving parts are therefore an inertia `I` at each motor and a mass `m` at
//! the effector. The equations are Lagrange's for the energy `m v²/2 + Σ I (dθ/dt)²/2`, without gravity, which counts as
//! compensated.
//!
//! The equations have no closed-form solution. Each interval is integrated by the classical Runge–Kutta method in substeps. Work
//! and losses are integrated along with the motion, so that the energy balance shows the error of the method.

use super::geometry::{DeltaGeometry, DeltaPose, FALCON_GEOMETRY, Unreachable};
use crate::plant::device::{Invalid, not_negative, positive};
use crate::plant::{Hand, Loss};
use nalgebra::{Matrix3, SVector, Vector3};

/// Masses and inertias of the parts of a delta mechanism.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeltaMasses {
    /// Inertia about each motor's axis of rotor, gear and arm together, kg·m².
    pub arm_kg_m2: f64,
    /// Mass of each elbow, kg.
    pub elbow_kg: f64,
    /// Mass of each forearm, kg: the two long sides of its parallelogram together.
    pub forearm_kg: f64,
    /// Mass of the effector, kg.
    pub effector_kg: f64,
}

/// The parameters of a delta device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeltaDevice {
    /// Lengths of the mechanism.
    pub geometry: DeltaGeometry,
    /// Masses of the mechanism.
    pub masses: DeltaMasses,
    /// Viscous damping of each joint, N·m·s/rad.
    pub joint_damping: f64,
    /// Largest torque of each motor, N·m.
    pub torque_n_m: f64,
    /// Resolution of each joint's encoder, rad.
    pub count_rad: f64,
}

/// Parameters of the Novint Falcon: the lengths of [`FALCON_GEOMETRY`], and the encoder as in the library libnifalcon. The encoder
/// has 320 slots with four edges each, on a capstan drive of 14.25 to 110 mm.
///
/// **Masses, damping and torque are chosen, not measured**: no source gives them. At the centre they make 0.095 kg and 0.94 N·s/m
/// sideways, 0.132 kg and 2.65 N·s/m upwards, and 8 N in every direction, the force that the library CHAI3D assumes.
pub const FALCON: DeltaDevice = DeltaDevice {
    geometry: FALCON_GEOMETRY,
    masses: DeltaMasses {
        arm_kg_m2: 6e-5,
        elbow_kg: 0.003,
        forearm_kg: 0.015,
        effector_kg: 0.060,
    },
    joint_damping: 5e-3,
    torque_n_m: 0.52,
    count_rad: std::f64::consts::TAU / 1280.0 * 14.25 / 110.0,
};

/// Fraction of a forearm's mass that counts at its elbow.
const WITH_ELBOW: f64 = 2.0 / 3.0;

impl DeltaDevice {
    /// Inertia at each motor, kg·m²: rotor, gear and arm, with the masses that count at the elbow.
    #[must_use]
    pub fn joint_inertia_kg_m2(&self) -> f64 {
        let masses = &self.masses;
        let arm = self.geometry.arm_m;
        masses.arm_kg_m2 + arm * arm * (masses.elbow_kg + WITH_ELBOW * masses.forearm_kg)
    }

    /// Mass at the effector, kg, with the forearms' masses that count there.
    #[must_use]
    pub fn effector_mass_kg(&self) -> f64 {
        self.masses.effector_kg + 3.0 * (1.0 - WITH_ELBOW) * self.masses.forearm_kg
    }

    /// Inertia matrix of the effector at a position, kg; it includes the inertias at the motors.
    #[must_use]
    pub fn inertia_kg(&self, pose: &DeltaPose) -> Matrix3<f64> {
        Matrix3::identity() * self.effector_mass_kg()
            + pose.slopes.tr_mul(&pose.slopes) * self.joint_inertia_kg_m2()
    }

    /// Damping matrix of the effector at a position, N·s/m, that results from the damping of the joints.
    #[must_use]
    pub fn damping_n_s_per_m(&self, pose: &DeltaPose) -> Matrix3<f64> {
        pose.slopes.tr_mul(&pose.slopes) * self.joint_damping
    }

    /// Motor torques that make a force at the effector, N·m. If one torque exceeds its motor's limit, all three are scaled down by
    /// the same factor, so that the force keeps its direction.
    #[must_use]
    pub fn limited_torques_n_m(&self, pose: &DeltaPose, force_n: Vector3<f64>) -> Vector3<f64> {
        let wanted = pose.torques_n_m(force_n);
        let most = wanted.amax();
        if most <= self.torque_n_m {
            return wanted;
        }
        wanted * (self.torque_n_m / most)
    }

    /// Position and joint angles as the encoders measure them: the joint angles are rounded to whole counts.
    ///
    /// # Errors
    /// No position of the effector belongs to these counts.
    pub fn measured(&self, pose: &DeltaPose) -> Result<DeltaPose, Unreachable> {
        let counted = pose
            .joints_rad
            .map(|angle| libm::round(angle / self.count_rad) * self.count_rad);
        self.geometry.place(counted, pose.place_m)
    }

    fn validate(&self) -> Result<(), Invalid> {
        positive("masses.effector_kg", self.masses.effector_kg)?;
        not_negative("masses.arm_kg_m2", self.masses.arm_kg_m2)?;
        not_negative("masses.elbow_kg", self.masses.elbow_kg)?;
        not_negative("masses.forearm_kg", self.masses.forearm_kg)?;
        not_negative("joint_damping", self.joint_damping)?;
        positive("torque_n_m", self.torque_n_m)?;
        positive("count_rad", self.count_rad)
    }
}

/// State of a delta device in a hand: positions and velocities of effector and hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeltaState {
    /// Position of the effector, m.
    pub place_m: Vector3<f64>,
    /// Velocity of the effector, m/s.
    pub velocity: Vector3<f64>,
    /// Position of the hand's mass, m.
    pub hand_m: Vector3<f64>,
    /// Velocity of the hand's mass, m/s.
    pub hand_velocity: Vector3<f64>,
}

impl DeltaState {
    /// The state with effector and hand at rest at a position.
    #[must_use]
    pub fn at_rest(place_m: [f64; 3]) -> Self {
        let place_m = Vector3::from(place_m);
        Self {
            place_m,
            velocity: Vector3::zeros(),
            hand_m: place_m,
            hand_velocity: Vector3::zeros(),
        }
    }
}

/// The integrated vector: the twelve numbers of a [`DeltaState`], the work of the motors, and the losses of device and hand.
type Entries = SVector<f64, 15>;

/// Work of the motors and losses in one simulated interval, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DeltaWork {
    /// Work of the motors on the device.
    pub motors_j: f64,
    /// Energy dissipated in device and hand.
    pub loss: Loss,
}

/// A delta device, free or held by a hand, with the length of the interval by which each [`DeltaPlant::step`] advances it, s.
#[derive(Debug, Clone, PartialEq)]
pub struct DeltaPlant {
    device: DeltaDevice,
    hand: Option<Hand>,
    interval_s: f64,
    substeps: u32,
}

/// Longest substep of the Runge–Kutta method, s.
const SUBSTEP_S: f64 = 1.25e-4;

impl DeltaPlant {
    /// Prepares a delta device, with or without a hand.
    ///
    /// # Errors
    /// [`Invalid`] for a device or hand that is out of range.
    pub fn new(
        device: &DeltaDevice,
        hand: Option<&Hand>,
        interval_s: f64,
    ) -> Result<Self, Invalid> {
        device.validate()?;
        if let Some(hand) = hand {
            hand.validate()?;
        }
        not_negative("interval_s", interval_s)?;
        Ok(Self {
            device: *device,
            hand: hand.copied(),
            interval_s,
            substeps: libm::ceil(interval_s / SUBSTEP_S - 1e-9).max(1.0) as u32,
        })
    }

    /// Returns the same plant with `substeps` substeps per interval.
    #[must_use]
    pub fn in_substeps(mut self, substeps: u32) -> Self {
        self.substeps = substeps.max(1);
        self
    }

    /// Advances by one interval under constant motor torques and a constant rest point of the hand.
    ///
    /// # Errors
    /// The effector left the positions that the mechanism can reach. The state is then unchanged.
    pub fn step(
        &self,
        state: &mut DeltaState,
        torques_n_m: Vector3<f64>,
        rest_m: [f64; 3],
    ) -> Result<DeltaWork, Unreachable> {
        let rest = Vector3::from(rest_m);
        let step_s = self.interval_s / f64::from(self.substeps);
        let mut entries = Entries::zeros();
        entries.fixed_rows_mut::<3>(0).copy_from(&state.place_m);
        entries.fixed_rows_mut::<3>(3).copy_from(&state.velocity);
        entries.fixed_rows_mut::<3>(6).copy_from(&state.hand_m);
        entries
            .fixed_rows_mut::<3>(9)
            .copy_from(&state.hand_velocity);
        for _ in 0..self.substeps {
            let rate = |at: &Entries| self.rate(at, torques_n_m, rest);
            let first = rate(&entries)?;
            let second = rate(&(entries + first * (0.5 * step_s)))?;
            let third = rate(&(entries + second * (0.5 * step_s)))?;
            let fourth = rate(&(entries + third * step_s))?;
            entries += (first + (second + third) * 2.0 + fourth) * (step_s / 6.0);
        }
        *state = DeltaState {
            place_m: entries.fixed_rows::<3>(0).into(),
            velocity: entries.fixed_rows::<3>(3).into(),
            hand_m: entries.fixed_rows::<3>(6).into(),
            hand_velocity: entries.fixed_rows::<3>(9).into(),
        };
        Ok(DeltaWork {
            motors_j: entries[12],
            loss: Loss {
                device_j: entries[13],
                hand_j: entries[14],
            },
        })
    }

    fn rate(
        &self,
        at: &Entries,
        torques_n_m: Vector3<f64>,
        rest: Vector3<f64>,
    ) -> Result<Entries, Unreachable> {
        let place: Vector3<f64> = at.fixed_rows::<3>(0).into();
        let velocity: Vector3<f64> = at.fixed_rows::<3>(3).into();
        let device = &self.device;
        let pose = device.geometry.pose(place)?;
        let turning = pose.slopes * velocity;
        let straight = device.geometry.curvature(&pose, velocity);
        let damping = turning * device.joint_damping;
        let torques = torques_n_m - damping - straight * device.joint_inertia_kg_m2();
        let mut force = pose.force_n(torques);
        let mut rate = Entries::zeros();
        rate[13] = damping.dot(&turning);
        match &self.hand {
            None => {
                rate.fixed_rows_mut::<3>(6).copy_from(&velocity);
            }
            Some(hand) => {
                let hand_at: Vector3<f64> = at.fixed_rows::<3>(6).into();
                let hand_velocity: Vector3<f64> = at.fixed_rows::<3>(9).into();
                let apart = hand_velocity - velocity;
                let pad = (hand_at - place) * hand.pad_stiffness + apart * hand.pad_damping;
                force += pad;
                let on_hand =
                    (rest - hand_at) * hand.stiffness - hand_velocity * hand.damping - pad;
                rate.fixed_rows_mut::<3>(6).copy_from(&hand_velocity);
                rate.fixed_rows_mut::<3>(9)
                    .copy_from(&(on_hand / hand.inertia));
                rate[14] = hand.pad_damping * apart.norm_squared()
                    + hand.damping * hand_velocity.norm_squared();
            }
        }
        let acceleration = device
            .inertia_kg(&pose)
            .try_inverse()
            .ok_or(Unreachable::Flat)?
            * force;
        rate.fixed_rows_mut::<3>(0).copy_from(&velocity);
        rate.fixed_rows_mut::<3>(3).copy_from(&acceleration);
        rate[12] = torques_n_m.dot(&turning);
        Ok(rate)
    }

    /// Kinetic energy and energy of the springs of device and hand, J.
    ///
    /// # Errors
    /// The mechanism cannot reach the state's position.
    pub fn stored_energy_j(
        &self,
        state: &DeltaState,
        rest_m: [f64; 3],
    ) -> Result<f64, Unreachable> {
        let pose = self.device.geometry.pose(state.place_m)?;
        let inertia = self.device.inertia_kg(&pose);
        let mut energy = 0.5 * state.velocity.dot(&(inertia * state.velocity));
        if let Some(hand) = &self.hand {
            let springs = hand.pad_stiffness * (state.hand_m - state.place_m).norm_squared()
                + hand.stiffness * (Vector3::from(rest_m) - state.hand_m).norm_squared();
            energy += 0.5 * (hand.inertia * state.hand_velocity.norm_squared() + springs);
        }
        Ok(energy)
    }
}
