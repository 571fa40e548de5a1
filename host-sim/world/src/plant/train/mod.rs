//! A drive train: the device behind a motor current, with a compliant transmission to the knob, a hand, and nonlinear torques at
//! the motor's shaft. All parts are optional; a scene file names them.
//!
//! ```text
//!  u -> [ current ] -> tau                 k_t, c_t, gap                pad
//!                       |                       |                        |
//!  friction, cogging, [ motor J_m, x ] ----/\/\/--[]---- [ knob J_k ] --/\/\/--[]-- [ hand J_h ] --/\/\/-- r
//!  imbalance --------------/
//! ```
//!
//! `u` is the commanded torque, `tau` the torque of the motor, `x` the shaft angle, `r` the hand's rest point; `J` are inertias,
//! `k_t` and `c_t` stiffness and damping of the transmission.
//!
//! All linear parts are one exact matrix step, as in the other plants of the parent module. The nonlinear parts ([`Shaft`], and the
//! play of a transmission) are torques that are held during a substep. Their values are those at the substep's middle. Friction is
//! consistent with the velocity at the substep's end. A train without nonlinear parts therefore needs no substeps. With nonlinear
//! parts the linear part stays exact, however stiff it is.

mod bristles;
mod friction;
mod links;
mod shaft;
mod state;

pub use friction::{Friction, LuGre, Sliding};
pub use links::{Current, Links, Transmission};
pub use shaft::{Harmonic, Shaft};
pub use state::TrainState;

use super::device::{Invalid, not_negative};
use super::flow::{apply, columns, flow_integral, quadratic, quadratic_integral, within_numbers};
use super::stepper::{Loss, Port, Stepper};
use links::{GAP, REST, SHAFT, TORQUE};

/// A drive train with `N` linear states, prepared for intervals of one length. `K` is `N + 4`, for the states and four values that
/// are constant during a substep: commanded torque, rest point, torque of the play, further torque.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveTrain<const N: usize, const K: usize> {
    links: Links,
    shaft: Shaft,
    /// Increment of the states in a substep for each entry of the drive vector (states and held values).
    step: [[f64; N]; K],
    device_loss: [[f64; K]; K],
    hand_loss: [[f64; K]; K],
    /// Matrix of the motor's work on the shaft in a substep, as a quadratic form of the drive vector. `None` if the motor's torque
    /// is not a state, because it does not lag.
    motor_work: Option<[[f64; K]; K]>,
    substeps: u32,
    substep_s: f64,
    interval_s: f64,
}

impl<const N: usize, const K: usize> DriveTrain<N, K> {
    /// Prepares intervals of `interval_s` seconds (zero or more), each divided into substeps. A train without nonlinear parts
    /// always gets one substep.
    ///
    /// # Errors
    /// [`Invalid`] when a value is out of range, or when the links do not have `N` states.
    pub fn new(
        links: &Links,
        shaft: &Shaft,
        interval_s: f64,
        substeps: u32,
    ) -> Result<Self, Invalid> {
        not_negative("interval_s", interval_s)?;
        let substeps = if shaft.is_smooth() && links.gap() == 0.0 {
            1
        } else {
            substeps.max(1)
        };
        let substep_s = interval_s / f64::from(substeps);
        let made = links::assemble::<N, K>(links)?;
        within_numbers(&made.matrix, substep_s)?;
        let rows = made.matrix.fixed_rows::<N>(0).into_owned();
        let integral = |form| columns(&quadratic_integral(&made.matrix, form, substep_s));
        Ok(Self {
            links: *links,
            shaft: shaft.clone(),
            step: columns(&(rows * flow_integral(&made.matrix, substep_s))),
            device_loss: integral(&made.device_loss),
            hand_loss: integral(&made.hand_loss),
            motor_work: links.current.map(|_| integral(&made.motor_power)),
            substeps,
            substep_s,
            interval_s,
        })
    }

    /// The drive vector: the state with angles relative to the device's angle, and the held inputs. Relative angles make the result
    /// independent of the absolute angle.
    #[inline(always)]
    fn drive(&self, z: &[f64; N], torque: f64, rest: f64) -> [f64; K] {
        let x = z[0];
        let mut drive = [0.0; K];
        drive[..N].copy_from_slice(z);
        let mut angle = 0;
        while angle + 1 < N {
            drive[angle] -= x;
            angle += 2;
        }
        drive[N + TORQUE] = torque;
        drive[N + REST] = rest - x;
        drive
    }

    #[inline(always)]
    fn advance<const ACCOUNT: bool>(
        &self,
        state: &mut TrainState<N>,
        torque: f64,
        rest: f64,
    ) -> Port {
        let mut port = Port::default();
        if self.interval_s == 0.0 {
            return port;
        }
        let (start, before_j) = if ACCOUNT {
            (*state, self.stored_beside_motion_j(state))
        } else {
            (*state, 0.0)
        };
        for _ in 0..self.substeps {
            self.substep::<ACCOUNT>(state, torque, rest, &mut port);
        }
        if ACCOUNT {
            port.force = self.mean_torque(&start, state, torque);
            if self.motor_work.is_none() {
                port.work_j = torque * (state.z[0] - start.z[0]);
            }
            port.stored_j = self.stored_beside_motion_j(state) - before_j;
        }
        port
    }

    #[inline(always)]
    fn substep<const ACCOUNT: bool>(
        &self,
        state: &mut TrainState<N>,
        torque: f64,
        rest: f64,
        port: &mut Port,
    ) {
        let [x, v] = [state.z[0], state.z[1]];
        let mut drive = self.drive(&state.z, torque, rest);
        drive[N + SHAFT] = self.shaft.turned_by(x + 0.5 * self.substep_s * v);
        if let Some(transmission) = self.links.transmission.filter(|it| it.gap > 0.0) {
            let twist = -drive[2] + 0.5 * self.substep_s * (v - drive[3]);
            drive[N + GAP] = transmission.free_play_torque(twist);
        }
        let mut increment = apply(&self.step, &drive);
        let response = &self.step[N + SHAFT];
        let bristle = state.bristle;
        let opposed = self.shaft.opposed_by(
            [v, v + increment[1]],
            response[1],
            &mut state.bristle,
            self.substep_s,
        );
        if let Some(opposed) = opposed {
            for (change, per_torque) in increment.iter_mut().zip(response) {
                *change -= opposed.torque * per_torque;
            }
            drive[N + SHAFT] -= opposed.torque;
        }
        for (entry, change) in state.z.iter_mut().zip(increment) {
            *entry += change;
        }
        if opposed.is_some_and(|opposed| opposed.rests) {
            state.z[1] = 0.0;
            if v == 0.0 {
                state.z[0] = x;
            }
        }
        if ACCOUNT {
            let friction_j = opposed.map_or(0.0, |opposed| opposed.torque * (state.z[0] - x));
            let bristles_j =
                self.shaft.bristle_energy_j(state.bristle) - self.shaft.bristle_energy_j(bristle);
            port.loss.device_j += quadratic(&self.device_loss, &drive) + friction_j - bristles_j;
            port.loss.hand_j += quadratic(&self.hand_loss, &drive);
            if let Some(work) = &self.motor_work {
                port.work_j += quadratic(work, &drive);
            }
        }
    }

    /// Mean of the motor's torque over the interval, N·m.
    fn mean_torque(&self, start: &TrainState<N>, end: &TrainState<N>, torque: f64) -> f64 {
        self.links.current.map_or(torque, |current| {
            // The integral of `tau' = omega (u - tau - D v)`.
            let lag = (end.z[N - 1] - start.z[N - 1]) / current.rate();
            torque - (lag + current.back_emf * (end.z[0] - start.z[0])) / self.interval_s
        })
    }

    /// Energy of the device in J, less the kinetic energy that its whole inertia would have at the shaft's velocity. It is the
    /// energy in springs, gravity and magnets, and a difference of kinetic energies, because the knob has another velocity than the
    /// shaft.
    fn stored_beside_motion_j(&self, state: &TrainState<N>) -> f64 {
        let v = state.z[1];
        let transmission_j = self.links.transmission.map_or(0.0, |transmission| {
            let (twist, knob_v) = (state.z[0] - state.z[2], state.z[3]);
            transmission.spring_energy_j(twist)
                + 0.5 * transmission.knob_inertia * (knob_v * knob_v - v * v)
        });
        transmission_j
            + self.shaft.potential_j(state.z[0])
            + self.shaft.bristle_energy_j(state.bristle)
    }
}

impl<const N: usize, const K: usize> Stepper for DriveTrain<N, K> {
    type State = TrainState<N>;

    fn interval_s(&self) -> f64 {
        self.interval_s
    }

    fn step(&self, state: &mut TrainState<N>, force: f64, rest: f64) {
        self.advance::<false>(state, force, rest);
    }

    fn step_with_loss(&self, state: &mut TrainState<N>, force: f64, rest: f64) -> Loss {
        self.step_with_port(state, force, rest).loss
    }

    fn step_with_port(&self, state: &mut TrainState<N>, force: f64, rest: f64) -> Port {
        self.advance::<true>(state, force, rest)
    }

    fn stored_energy_j(&self, state: &TrainState<N>, rest: f64) -> f64 {
        let v = state.z[1];
        let hand_j = self.links.hand.map_or(0.0, |hand| {
            let [x_h, v_h] = state.hand();
            let [x_d, _] = if self.links.transmission.is_some() {
                [state.z[2], state.z[3]]
            } else {
                [state.z[0], v]
            };
            0.5 * (hand.inertia * v_h * v_h
                + hand.pad_stiffness * (x_h - x_d) * (x_h - x_d)
                + hand.stiffness * (rest - x_h) * (rest - x_h))
        });
        0.5 * self.links.device.inertia * v * v + self.stored_beside_motion_j(state) + hand_j
    }
}
