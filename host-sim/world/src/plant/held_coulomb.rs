//! A device in a hand, with Coulomb friction. The solution is exact: every stop and start is located within the interval.

mod events;

use nalgebra::{RowSVector, SMatrix, matrix};

use super::device::{Coulomb, Device, Invalid};
use super::flow::{
    apply, columns, flow, flow_integral, quadratic, quadratic_integral, row_sum_norm,
};
use super::hand::Hand;
use super::held::{HeldLinear, drive, drive_matrix};
use super::state::State;
use super::stepper::{Loss, Stepper};
use super::taylor::NORM;
use events::Mode;

/// A device in a hand, with dry friction: the equations of motion of [`super`], with four states and two modes.
///
/// *Sliding*: friction is a constant torque `F_k`, so the total is `w = u - sign(v) F_k` and the step is that of [`HeldLinear`].
/// `u` is the held torque, `v` the device's velocity. *Stuck*: the angle `x` stays the same bit for bit, `v` is exactly zero, and
/// the hand moves against a pad whose other side is fixed. Because the pad oscillates, the velocity may change sign twice in an
/// interval, which the velocity at the interval's end does not show.
///
/// Each step therefore first evaluates a bound that holds in every case. On an interval of length `h` a function `f` stays within
/// `h²/8 max|f''|` of the straight line between its end values. If that leaves no room for a stop or a start, which is nearly
/// always, the precomputed matrix gives the step. The bound is evaluated twice. The first, cheapest form uses the magnitudes of
/// velocities, strains and torque. The second form uses the magnitudes of their rates of change, which are small while a press of
/// the hand is in balance. Otherwise stops and starts are located one after the other, to rounding, on the power series of the
/// exact solution.
///
/// An interval without stop and start gives the same bits as [`HeldLinear`] under the torque `w`. If both levels of friction are
/// zero, intervals in which the velocity changes sign agree with [`HeldLinear`] to rounding only.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldCoulomb {
    sliding: HeldLinear,
    kinetic: f64,
    breakaway: f64,
    /// Factors that bound `h²/8 · |d²v/dt²|` while the device slides, for the interval `h` and the device's velocity `v`. There is
    /// one factor for the magnitude of each entry of `held::Drive` (velocities, strains, torque).
    slide_guard: [f64; 5],
    /// Factors for a finer bound of `h²/8 · |d²v/dt²|` while the device slides, for the interval `h` and the velocity `v`. There is
    /// one factor for the rate of change of each entry of `held::Drive`.
    slide_rate_guard: [f64; 5],
    /// Matrix `M` that gives the rate of change `M y` of the vector `y` (`held::Drive`) while the device slides, by columns.
    rates: [[f64; 5]; 5],
    /// Increment of the hand's angle and velocity in an interval while the device is stuck. One column for each of pad strain, hand
    /// velocity and strain of the hand's spring.
    stuck: [[f64; 2]; 3],
    stuck_loss: [[f64; 3]; 3],
    /// Factors that bound `h²/8` times the second derivative of the pad's torque while the device is stuck, for the interval `h`.
    /// There is one factor for the magnitude of each of pad strain, hand velocity and strain of the hand's spring.
    stick_guard: [f64; 3],
    /// Factors for a finer bound of `h²/8` times the second derivative of the pad's torque while the device is stuck, for the
    /// interval `h`. There is one factor for the rate of change of each of pad strain, hand velocity and strain of the hand's
    /// spring.
    stick_rate_guard: [f64; 3],
    /// Matrix of the rates of pad strain, hand velocity and strain of the hand's spring while the device is stuck, by columns.
    stuck_rates: [[f64; 3]; 3],
    /// Longest time that one power series of the solution covers, s.
    piece_s: f64,
}

/// Largest number of power series in an interval. An interval that needs more is far too long for the plant's own motion.
const MAX_PIECES: f64 = 4096.0;

/// Bounds `h²/8 · |d²f/dt²|` over the interval `h` for `f = row · y` and `y' = M y`, by `h²/8 · |row| |M|² exp(|M| h)`. Returns a
/// factor for the magnitude of each entry of `y`.
fn curvature_guard<const K: usize>(
    row: RowSVector<f64, K>,
    m: &SMatrix<f64, K, K>,
    h: f64,
) -> [f64; K] {
    let m = m.abs();
    let bound = row.abs() * m * m * flow(&m, h) * (h * h / 8.0);
    std::array::from_fn(|column| bound[column])
}

/// The bound of [`curvature_guard`], with factors for the entries of the rate of change `M y`, which contains one factor of `M`
/// already.
fn rate_guard<const K: usize>(row: RowSVector<f64, K>, m: &SMatrix<f64, K, K>, h: f64) -> [f64; K] {
    let m = m.abs();
    let bound = row.abs() * m * flow(&m, h) * (h * h / 8.0);
    std::array::from_fn(|column| bound[column])
}

#[inline(always)]
fn guard<const K: usize>(factors: &[f64; K], drive: &[f64; K]) -> f64 {
    factors
        .iter()
        .zip(drive)
        .map(|(factor, entry)| factor * entry.abs())
        .sum()
}

/// Norm of the plant's matrix of rates, 1/s. Angles are scaled by the fastest eigenfrequency so that all rates are comparable. The
/// norm decides over which time a power series converges.
fn fastest_rate(device: &Device, hand: &Hand, m: &SMatrix<f64, 5, 5>) -> f64 {
    let (k_p, k_h) = (hand.pad_stiffness, hand.stiffness);
    let scale = (k_p / device.inertia)
        .max(k_p / hand.inertia)
        .max(k_h / hand.inertia)
        .sqrt()
        .max(f64::MIN_POSITIVE);
    let scales = [1.0, scale, 1.0, scale];
    let scaled = SMatrix::<f64, 4, 4>::from_fn(|row, column| {
        m[(row, column)] * scales[row] / scales[column]
    });
    row_sum_norm(&scaled)
}

/// Allowance for rounding: fraction of the coarse bound (`slide_guard` or `stick_guard`) that is added to the finer bound, which
/// may be zero.
const ROUNDING: f64 = 1e-9;

impl HeldCoulomb {
    /// Prepares steps of `interval_s` seconds (zero or more).
    ///
    /// # Errors
    /// [`Invalid`] when device, hand or interval are out of range, when the device has no friction, or when the interval is
    /// thousands of times longer than the plant's fastest motion.
    pub fn new(device: &Device, hand: &Hand, interval_s: f64) -> Result<Self, Invalid> {
        let sliding = HeldLinear::new(device, hand, interval_s)?;
        let Coulomb { kinetic, breakaway } = device.required_friction()?;

        let (k_p, b_p) = (hand.pad_stiffness, hand.pad_damping);
        let (b_h, k_h) = (hand.damping, hand.stiffness);
        let j_h = hand.inertia;
        let m = drive_matrix(device, hand);
        let stuck = matrix![
            0.0,        1.0,                0.0;
            -k_p / j_h, -(b_p + b_h) / j_h, k_h / j_h;
            0.0,        -1.0,               0.0
        ];
        let stuck_rates = matrix![
            0.0,        1.0,                0.0;
            -k_p / j_h, -(b_p + b_h) / j_h, k_h / j_h
        ];
        let stuck_viscous = matrix![0.0, 0.0, 0.0; 0.0, b_p + b_h, 0.0; 0.0, 0.0, 0.0];

        let rate = fastest_rate(device, hand, &m);
        if rate * interval_s > NORM * MAX_PIECES {
            return Err(Invalid {
                field: "interval_s",
                value: interval_s,
                needs: "at most some thousand times the shortest time constant of device and pad",
            });
        }

        Ok(Self {
            sliding,
            kinetic,
            breakaway,
            slide_guard: curvature_guard(matrix![1.0, 0.0, 0.0, 0.0, 0.0], &m, interval_s),
            slide_rate_guard: rate_guard(matrix![1.0, 0.0, 0.0, 0.0, 0.0], &m, interval_s),
            rates: columns(&m),
            stuck: columns(&(stuck_rates * flow_integral(&stuck, interval_s))),
            stuck_loss: columns(&quadratic_integral(&stuck, &stuck_viscous, interval_s)),
            stick_guard: curvature_guard(matrix![k_p, b_p, 0.0], &stuck, interval_s),
            stick_rate_guard: rate_guard(matrix![k_p, b_p, 0.0], &stuck, interval_s),
            stuck_rates: columns(&stuck),
            piece_s: NORM / rate,
        })
    }

    /// Largest number of power series that cover one interval with a stop or start; each stop or start needs one more. It is 1 for
    /// a plant that is not stiff.
    #[must_use]
    pub fn series(device: &Device, hand: &Hand, interval_s: f64) -> u64 {
        let rate = fastest_rate(device, hand, &drive_matrix(device, hand));
        ((interval_s * rate / NORM).ceil().min(MAX_PIECES) as u64).max(1)
    }

    /// Torque on the device at rest without friction, N·m: the held torque plus the pad's torque.
    #[inline(always)]
    fn torque_at_rest(&self, strain: f64, v_h: f64, torque: f64) -> f64 {
        let hand = &self.sliding.hand;
        torque + (hand.pad_stiffness * strain + hand.pad_damping * v_h)
    }

    /// Advances by one interval. Computes the losses only if `LOSS` is true.
    #[inline(always)]
    fn advance<const LOSS: bool>(&self, state: &mut State<4>, torque: f64, rest: f64) -> Loss {
        let full = drive(state, torque, rest);
        let [v, strain, v_h, hand_strain, _] = full;
        let at_rest = self.torque_at_rest(strain, v_h, torque);
        // At rest the torque decides the direction; the sign of -0.0 does not.
        let sign = if v != 0.0 {
            1.0_f64.copysign(v)
        } else if at_rest.abs() <= self.breakaway {
            return self.hold::<LOSS>(state, [strain, v_h, hand_strain], at_rest, torque, rest);
        } else {
            1.0_f64.copysign(at_rest)
        };
        let mut sliding = full;
        sliding[4] = torque - sign * self.kinetic;
        let increment = self.sliding.increment(&sliding);
        let slowest = (sign * v).min(sign * (v + increment[1]));
        // The comparison is false for a NaN bound too, which then decides nothing.
        let rough = guard(&self.slide_guard, &sliding);
        let clear = slowest > rough || {
            let fine = guard(&self.slide_rate_guard, &apply(&self.rates, &sliding));
            slowest > fine + ROUNDING * rough
        };
        if !clear && let Some(loss) = self.follow::<LOSS>(state, torque, rest, Mode::Sliding(sign))
        {
            return loss;
        }
        state.add(&increment);
        if !LOSS {
            return Loss::default();
        }
        let mut loss = self.sliding.viscous_loss(&sliding);
        loss.device_j += self.kinetic * increment[0].abs();
        loss
    }

    /// Advances by one interval at whose start the device is stuck by friction.
    #[inline(always)]
    fn hold<const LOSS: bool>(
        &self,
        state: &mut State<4>,
        stuck: [f64; 3],
        at_rest: f64,
        torque: f64,
        rest: f64,
    ) -> Loss {
        let increment = apply(&self.stuck, &stuck);
        let at_end = self.torque_at_rest(stuck[0] + increment[0], stuck[1] + increment[1], torque);
        let most = at_rest.abs().max(at_end.abs());
        let rough = guard(&self.stick_guard, &stuck);
        let clear = most + rough <= self.breakaway || {
            let fine = guard(&self.stick_rate_guard, &apply(&self.stuck_rates, &stuck));
            most + (fine + ROUNDING * rough) <= self.breakaway
        };
        if !clear && let Some(loss) = self.follow::<LOSS>(state, torque, rest, Mode::Stuck) {
            return loss;
        }
        state.0[2] += increment[0];
        state.0[3] += increment[1];
        let hand_j = if LOSS {
            quadratic(&self.stuck_loss, &stuck)
        } else {
            0.0
        };
        Loss {
            device_j: 0.0,
            hand_j,
        }
    }
}

impl Stepper for HeldCoulomb {
    type State = State<4>;

    fn interval_s(&self) -> f64 {
        self.sliding.interval_s()
    }

    #[inline]
    fn step(&self, state: &mut State<4>, force: f64, rest: f64) {
        self.advance::<false>(state, force, rest);
    }

    #[inline]
    fn step_with_loss(&self, state: &mut State<4>, force: f64, rest: f64) -> Loss {
        self.advance::<true>(state, force, rest)
    }

    fn stored_energy_j(&self, state: &State<4>, rest: f64) -> f64 {
        self.sliding.stored_energy_j(state, rest)
    }
}
