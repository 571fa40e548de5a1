//! A device that a hand holds through the fingertip pad, without dry friction.

use nalgebra::{SMatrix, matrix};

use super::device::{Device, Invalid, not_negative};
use super::flow::{apply, columns, flow_integral, quadratic, quadratic_integral, within_numbers};
use super::hand::Hand;
use super::state::State;
use super::stepper::{LinearStepper, Loss, Stepper};

/// The values on which the motion depends: `[v, d, v_h, g, u]`. `v` and `v_h` are the velocities of device and hand, `d = x_h - x`
/// is the strain of the pad, `g = r - x_h` the strain of the hand's spring, and `u` the held torque.
///
/// The vector has no absolute angles, so energies computed from it do not cancel far from angle zero.
pub(super) type Drive = [f64; 5];

/// A device in a hand, without dry friction: the equations of motion of [`super`] with four states. Dry friction of the device is
/// ignored.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldLinear {
    /// Increment of the state `[x, v, x_h, v_h]` (angle and velocity of device and hand) in an interval, for each entry of
    /// [`Drive`].
    step: [[f64; 4]; 5],
    device_loss: [[f64; 5]; 5],
    hand_loss: [[f64; 5]; 5],
    pub(super) device: Device,
    pub(super) hand: Hand,
    interval_s: f64,
}

/// The vector [`Drive`] (velocities, strains, torque) for a state, a torque and a rest point of the hand.
#[inline(always)]
pub(super) fn drive(state: &State<4>, torque: f64, rest: f64) -> Drive {
    let [x, v, x_h, v_h] = state.0;
    [v, x_h - x, v_h, rest - x_h, torque]
}

/// The matrix `M` in `y' = M y`, where `y` is the vector [`Drive`] of velocities, strains and torque.
pub(super) fn drive_matrix(device: &Device, hand: &Hand) -> SMatrix<f64, 5, 5> {
    let (b, k_p, b_p) = (device.damping, hand.pad_stiffness, hand.pad_damping);
    let (b_h, k_h) = (hand.damping, hand.stiffness);
    let (j, j_h) = (device.inertia, hand.inertia);
    matrix![
        -(b + b_p) / j, k_p / j,    b_p / j,            0.0,       1.0 / j;
        -1.0,           0.0,        1.0,                0.0,       0.0;
        b_p / j_h,      -k_p / j_h, -(b_p + b_h) / j_h, k_h / j_h, 0.0;
        0.0,            0.0,        -1.0,               0.0,       0.0;
        0.0,            0.0,        0.0,                0.0,       0.0
    ]
}

impl HeldLinear {
    /// Prepares steps of `interval_s` seconds (zero or more).
    ///
    /// # Errors
    /// [`Invalid`] when device, hand or interval are out of range.
    pub fn new(device: &Device, hand: &Hand, interval_s: f64) -> Result<Self, Invalid> {
        device.validate()?;
        hand.validate()?;
        not_negative("interval_s", interval_s)?;
        let m = drive_matrix(device, hand);
        within_numbers(&m, interval_s)?;
        let mut rates = SMatrix::<f64, 4, 5>::zeros();
        rates[(0, 0)] = 1.0;
        rates.set_row(1, &m.row(0));
        rates[(2, 2)] = 1.0;
        rates.set_row(3, &m.row(2));

        let mut viscous = SMatrix::<f64, 5, 5>::zeros();
        viscous[(0, 0)] = device.damping;
        let pad = hand.pad_damping;
        let mut hand_viscous = SMatrix::<f64, 5, 5>::zeros();
        hand_viscous[(0, 0)] = pad;
        hand_viscous[(0, 2)] = -pad;
        hand_viscous[(2, 0)] = -pad;
        hand_viscous[(2, 2)] = pad + hand.damping;
        Ok(Self {
            step: columns(&(rates * flow_integral(&m, interval_s))),
            device_loss: columns(&quadratic_integral(&m, &viscous, interval_s)),
            hand_loss: columns(&quadratic_integral(&m, &hand_viscous, interval_s)),
            device: *device,
            hand: *hand,
            interval_s,
        })
    }

    /// Increment of the state `[x, v, x_h, v_h]` (angle and velocity of device and hand) in an interval.
    #[inline(always)]
    pub(super) fn increment(&self, drive: &Drive) -> [f64; 4] {
        apply(&self.step, drive)
    }

    /// Energy that the dampers of device and hand dissipate in an interval, J.
    #[inline(always)]
    pub(super) fn viscous_loss(&self, drive: &Drive) -> Loss {
        Loss {
            device_j: quadratic(&self.device_loss, drive),
            hand_j: quadratic(&self.hand_loss, drive),
        }
    }
}

impl Stepper for HeldLinear {
    type State = State<4>;

    fn interval_s(&self) -> f64 {
        self.interval_s
    }

    #[inline(always)]
    fn step(&self, state: &mut State<4>, force: f64, rest: f64) {
        state.add(&self.increment(&drive(state, force, rest)));
    }

    #[inline]
    fn step_with_loss(&self, state: &mut State<4>, force: f64, rest: f64) -> Loss {
        let drive = drive(state, force, rest);
        state.add(&self.increment(&drive));
        self.viscous_loss(&drive)
    }

    fn stored_energy_j(&self, state: &State<4>, rest: f64) -> f64 {
        let [v, pad_strain, v_h, hand_strain, _] = drive(state, 0.0, rest);
        0.5 * (self.device.inertia * v * v
            + self.hand.pad_stiffness * pad_strain * pad_strain
            + self.hand.inertia * v_h * v_h
            + self.hand.stiffness * hand_strain * hand_strain)
    }
}

impl LinearStepper for HeldLinear {}
