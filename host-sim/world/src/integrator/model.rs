//! The equations of motion that the integration methods solve.

use nalgebra::SMatrix;

use crate::plant::device::{not_negative, positive};
use crate::plant::flow::{apply, columns, flow_integral, within_numbers};
use crate::plant::{Coulomb, Device, Hand, Invalid, Loss};

/// Equations of motion `z' = A z + B [u, r] - e₁ friction(v)/J` of a linear plant with dry friction at the device, in absolute
/// angles.
///
/// `z` is the state; its second entry is the device's velocity `v`, in row `e₁`. `u` is the held torque in N·m, `r` the held rest
/// point of the hand in rad, `J` the device's inertia.
#[derive(Debug, Clone, PartialEq)]
pub struct Model<const N: usize> {
    pub(super) matrix: SMatrix<f64, N, N>,
    rates: [[f64; N]; N],
    input: [[f64; N]; 2],
    device: Device,
    hand: Option<Hand>,
}

impl Model<2> {
    /// Equations of a device without a hand, with the state `[x, v]` (angle, velocity): those of [`crate::plant::BareLinear`] and
    /// [`crate::plant::BareCoulomb`].
    ///
    /// # Errors
    /// [`Invalid`] when the device is out of range.
    pub fn bare(device: &Device) -> Result<Self, Invalid> {
        let (j, b) = (device.inertia, device.damping);
        let matrix = nalgebra::matrix![0.0, 1.0; 0.0, -b / j];
        Self::new(matrix, [[0.0, 1.0 / j], [0.0; 2]], device, None)
    }
}

impl Model<3> {
    /// Equations of a device without a hand whose torque follows its command `u` with a lag of first order, `torque' = 2π f (u -
    /// torque)`. The state is `[x, v, torque]` (angle, velocity, torque).
    ///
    /// # Errors
    /// [`Invalid`] when the device or the bandwidth `f` in Hz is out of range.
    pub fn with_current_loop(device: &Device, bandwidth_hz: f64) -> Result<Self, Invalid> {
        positive("bandwidth_hz", bandwidth_hz)?;
        let (j, b) = (device.inertia, device.damping);
        let pole = std::f64::consts::TAU * bandwidth_hz;
        let matrix = nalgebra::matrix![
            0.0, 1.0, 0.0;
            0.0, -b / j, 1.0 / j;
            0.0, 0.0, -pole
        ];
        Self::new(matrix, [[0.0, 0.0, pole], [0.0; 3]], device, None)
    }
}

impl Model<4> {
    /// Equations of a device in a hand, with the state `[x, v, x_h, v_h]` (angle and velocity of device and hand): those of
    /// [`crate::plant::HeldLinear`] and [`crate::plant::HeldCoulomb`].
    ///
    /// # Errors
    /// [`Invalid`] when device or hand are out of range.
    pub fn held(device: &Device, hand: &Hand) -> Result<Self, Invalid> {
        hand.validate()?;
        let (j, b) = (device.inertia, device.damping);
        let (j_h, b_h, k_h) = (hand.inertia, hand.damping, hand.stiffness);
        let (k_p, b_p) = (hand.pad_stiffness, hand.pad_damping);
        let matrix = nalgebra::matrix![
            0.0,        1.0,            0.0,                0.0;
            -k_p / j,   -(b + b_p) / j, k_p / j,            b_p / j;
            0.0,        0.0,            0.0,                1.0;
            k_p / j_h,  b_p / j_h,      -(k_p + k_h) / j_h, -(b_p + b_h) / j_h
        ];
        let input = [[0.0, 1.0 / j, 0.0, 0.0], [0.0, 0.0, 0.0, k_h / j_h]];
        Self::new(matrix, input, device, Some(*hand))
    }
}

impl<const N: usize> Model<N> {
    fn new(
        matrix: SMatrix<f64, N, N>,
        input: [[f64; N]; 2],
        device: &Device,
        hand: Option<Hand>,
    ) -> Result<Self, Invalid> {
        device.validate()?;
        Ok(Self {
            rates: columns(&matrix),
            matrix,
            input,
            device: *device,
            hand,
        })
    }

    /// Dry friction of the device; `None` for a device without friction.
    #[inline(always)]
    pub(super) fn friction(&self) -> Option<Coulomb> {
        self.device.friction
    }

    /// The device's inertia, kg·m².
    pub(super) fn inertia(&self) -> f64 {
        self.device.inertia
    }

    /// Time derivative of the state without dry friction, `A z + B [u, r]`: state `z`, held torque `u`, held rest point `r`.
    #[inline(always)]
    pub(super) fn rate(&self, state: &[f64; N], held: [f64; 2]) -> [f64; N] {
        let (free, driven) = (apply(&self.rates, state), apply(&self.input, &held));
        std::array::from_fn(|i| free[i] + driven[i])
    }

    /// Marks the entries of the state that are positions: their derivative is another entry.
    pub(super) fn positions(&self) -> [bool; N] {
        std::array::from_fn(|i| {
            let row = self.matrix.row(i);
            row.iter().filter(|entry| **entry != 0.0).count() == 1
                && row
                    .iter()
                    .enumerate()
                    .any(|(j, entry)| j != i && *entry == 1.0)
        })
    }

    /// Power that each damper dissipates in a state, W, in the fields of a [`Loss`]; without dry friction.
    #[inline(always)]
    pub(super) fn viscous(&self, state: &[f64; N]) -> Loss {
        let v = state[1];
        let hand_j = self.hand.map_or(0.0, |hand| {
            let (v_h, slip) = (state[N - 1], v - state[N - 1]);
            hand.damping * v_h * v_h + hand.pad_damping * slip * slip
        });
        Loss {
            device_j: self.device.damping * v * v,
            hand_j,
        }
    }

    /// Kinetic energy and energy of the springs in a state, J, as in [`crate::plant::Stepper::stored_energy_j`]. `rest` is the
    /// hand's rest point.
    pub(super) fn stored_energy_j(&self, state: &[f64; N], rest: f64) -> f64 {
        let device = self.device.inertia * state[1] * state[1];
        let hand = self.hand.map_or(0.0, |hand| {
            let (x_h, v_h) = (state[N - 2], state[N - 1]);
            let (pad, spring) = (x_h - state[0], rest - x_h);
            hand.inertia * v_h * v_h
                + hand.pad_stiffness * pad * pad
                + hand.stiffness * spring * spring
        });
        0.5 * (device + hand)
    }

    /// The matrix `(I - share·A)⁻¹`, where `A` is the matrix of the state's rates, 1/s, and `share` a time, s.
    pub(super) fn resolvent(&self, share: f64) -> Result<SMatrix<f64, N, N>, Invalid> {
        let scaled = SMatrix::<f64, N, N>::from_fn(|row, column| {
            f64::from(u8::from(row == column)) - share * self.matrix[(row, column)]
        });
        inverse(scaled).ok_or(Invalid {
            field: "substep_s",
            value: share,
            needs: "such that the step's equations have a solution",
        })
    }
}

/// The inverse of a matrix, by elimination with pivots; `None` for a singular matrix.
fn inverse<const N: usize>(mut m: SMatrix<f64, N, N>) -> Option<SMatrix<f64, N, N>> {
    let mut found = SMatrix::<f64, N, N>::identity();
    for column in 0..N {
        let pivot =
            (column..N).max_by(|&a, &b| m[(a, column)].abs().total_cmp(&m[(b, column)].abs()))?;
        if !m[(pivot, column)].is_normal() {
            return None;
        }
        m.swap_rows(column, pivot);
        found.swap_rows(column, pivot);
        let scale = 1.0 / m[(column, column)];
        for k in 0..N {
            m[(column, k)] *= scale;
            found[(column, k)] *= scale;
        }
        for row in (0..N).filter(|&row| row != column) {
            let factor = m[(row, column)];
            for k in 0..N {
                m[(row, k)] -= factor * m[(column, k)];
                found[(row, k)] -= factor * found[(column, k)];
            }
        }
    }
    Some(found)
}

/// Closed-form step of a linear model without dry friction, for models without a counterpart in [`crate::plant`].
#[derive(Debug, Clone, PartialEq)]
pub struct ExactLinear<const N: usize> {
    flow: [[f64; N]; N],
}

impl<const N: usize> ExactLinear<N> {
    /// Prepares steps of `interval_s` seconds.
    ///
    /// # Errors
    /// [`Invalid`] when the interval is out of range or the model has dry friction.
    pub fn new(model: &Model<N>, interval_s: f64) -> Result<Self, Invalid> {
        not_negative("interval_s", interval_s)?;
        if model.friction().is_some() {
            return Err(Invalid {
                field: "friction",
                value: f64::NAN,
                needs: "absent for a linear step",
            });
        }
        within_numbers(&model.matrix, interval_s)?;
        Ok(Self {
            flow: columns(&flow_integral(&model.matrix, interval_s)),
        })
    }

    /// Advances the state `z` by one interval `h`: `z(h) - z(0) = Ψ(h) z'(0)` with `Ψ(h) = ∫₀ʰ exp(A t) dt` and the matrix `A` of
    /// the rates.
    #[inline(always)]
    pub fn step(&self, model: &Model<N>, state: &mut [f64; N], held: [f64; 2]) {
        let increment = apply(&self.flow, &model.rate(state, held));
        for (entry, change) in state.iter_mut().zip(increment) {
            *entry += change;
        }
    }
}
