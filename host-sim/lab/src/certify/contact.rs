//! The input of a certificate: a control law in contact with a hand. It has the loop's matrix for each linear phase of the law, and
//! quantities that the matrices do not contain.

use super::estimator::Estimator;
use super::law::{Phases, Switching};
use super::linear_law::LinearLaw;
use super::plant::{Clock, Mechanics, sampled};
use super::state_space::{Mode, StateSpace};
use crate::scorecard::cases::{MOST_OF_THE_TORQUE, most_torque_n_m};
use nalgebra::{DMatrix, DVector};
use touchstone_control::AnyLaw;
use touchstone_sim::error::Result;
use touchstone_sim::run::{plan, settings};
use touchstone_sim::scene::{MotionSpec, Scene};
use touchstone_world::plant::{Device, Hand};

/// Torque of the simulated press in N·m for a scene without a press.
const PRESS_N_M: f64 = 0.1;

/// Assumed amplitude of a press' oscillation that dry friction has to end, as a multiple of the press' depth. After a press as a
/// step, the amplitude of the oscillation is the press' depth.
pub const SWING: f64 = 1.25;

/// A control law on a device, in the form that the certificate examines.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The linear phases of the control law.
    pub phases: Phases,
    /// The device. Its dry friction is not in the matrices; it is only used to judge which motions friction may stop.
    pub device: Device,
    /// Control period, and delay from sample to force.
    pub clock: Clock,
    /// Bandwidth of the current controller, Hz, from the options of the certificate; a scene's `device.current_loop` is not used.
    pub current_loop_hz: Option<f64>,
    /// State estimator between encoder and law; absent if the law uses measured penetrations.
    pub estimator: Option<Estimator>,
    /// Angle of one encoder count, rad; `None` without an encoder.
    pub count_rad: Option<f64>,
    /// Requested stiffness `k_de`, N·m/rad.
    pub k_desired: f64,
    /// Torque of the scene's press, with the amplitude of an oscillation around it, N·m; absent if the hand's motion in the scene
    /// has no press.
    pub press_n_m: Option<f64>,
    /// Torque of the press that is simulated, N·m: the scene's press, or else a torque that the wall can give.
    pub played_press_n_m: f64,
    /// Torque of the light touch before the press, N·m; absent if the hand's motion in the scene has none.
    pub touch_n_m: Option<f64>,
    /// Duration of the scene's last hold, s; absent if the hand's motion in the scene has none.
    pub hold_s: Option<f64>,
    /// Damping of the device that the control law assumes, N·m·s/rad.
    pub c_i: f64,
}

impl Contact {
    /// Makes the contact of law, device and hand that a scene describes. The law's coefficients are those of its implementation in
    /// `f64`.
    ///
    /// # Errors
    /// The control law does not accept the scene's settings.
    pub fn of(scene: &Scene) -> Result<Self> {
        let controller = AnyLaw::<f64>::new(&scene.settings()?)
            .map_err(|error| settings::refused(scene, &error))?;
        let press_n_m = match &scene.operator.motion {
            MotionSpec::RampAndHold(press) => Some(press.push_torque_n_m),
            MotionSpec::TouchAndPress(press) => Some(press.push_torque_n_m),
            MotionSpec::PressWiggleRelease(press) => {
                Some(press.push_torque_n_m + press.wiggle_amplitude_n_m)
            }
            MotionSpec::None
            | MotionSpec::Tap(_)
            | MotionSpec::Turn(_)
            | MotionSpec::Recorded(_) => None,
        };
        Ok(Self {
            phases: Phases::of(&controller),
            device: plan::device(scene),
            clock: Clock {
                period_s: scene.timing.period_s(),
                delay_s: scene.timing.computational_delay_s,
            },
            current_loop_hz: None,
            estimator: Estimator::of(scene)?,
            count_rad: scene.encoder.as_ref().map(|encoder| encoder.step_rad()),
            k_desired: scene.wall.k_desired_n_m_per_rad,
            touch_n_m: match &scene.operator.motion {
                MotionSpec::TouchAndPress(press) => Some(press.touch_torque_n_m),
                _ => None,
            },
            press_n_m,
            played_press_n_m: press_n_m
                .unwrap_or(PRESS_N_M.min(MOST_OF_THE_TORQUE * most_torque_n_m(scene))),
            hold_s: scene.hold_window_s().map(|(from, to)| 2.0 * (to - from)),
            c_i: scene.law.device_damping_n_m_s_per_rad,
        })
    }

    /// Assumed amplitude of the press' oscillation in encoder counts; `None` without a press or an encoder.
    #[must_use]
    pub fn swing_counts(&self) -> Option<f64> {
        Some(SWING * self.press_n_m? / self.k_desired / self.count_rad?)
    }

    /// Device, hand, delay and current controller as one discrete linear system. `None` if a value is not physically possible.
    #[must_use]
    pub fn plant(&self, hand: Option<&Hand>) -> Option<StateSpace> {
        let mechanics = Mechanics {
            device: self.device,
            hand: hand.copied(),
            current_loop_hz: self.current_loop_hz,
        };
        sampled(&mechanics, self.clock).ok()
    }

    /// A linear phase of the control law as a system from position to force, including the state estimator if there is one.
    #[must_use]
    pub fn law(&self, phase: &LinearLaw) -> StateSpace {
        match &self.estimator {
            Some(estimator) => phase.on_estimated(estimator),
            None => phase.on_measured(),
        }
    }

    /// Largest eigenvalue over the linear phases in which the control law can stay, and the name of the phase that has it.
    #[must_use]
    pub fn worst(&self, hand: Option<&Hand>) -> (Mode, &'static str) {
        let lost = Mode {
            radius: f64::INFINITY,
            angle_rad: f64::NAN,
        };
        let Some(plant) = self.plant(hand) else {
            return (lost, "no plant");
        };
        let modes = self.phases.lasting.iter().map(|phase| {
            let matrix = plant.closed_by(&self.law(&phase.law), 1.0);
            (Mode::dominant(&matrix), phase.name)
        });
        modes
            .reduce(|a, b| if b.0.radius > a.0.radius { b } else { a })
            .unwrap_or((lost, "no phase"))
    }

    /// Largest magnitude of an eigenvalue over the linear phases in which the control law can stay.
    #[must_use]
    pub fn radius(&self, hand: Option<&Hand>) -> f64 {
        self.worst(hand).0.radius
    }

    /// Largest magnitude of an eigenvalue of the loop while every measured penetration is multiplied by `gain`.
    #[must_use]
    pub fn radius_at_gain(&self, hand: Option<&Hand>, gain: f64) -> f64 {
        let Some(plant) = self.plant(hand) else {
            return f64::INFINITY;
        };
        self.phases
            .lasting
            .iter()
            .map(|phase| Mode::dominant(&plant.closed_by(&self.law(&phase.law), gain)).radius)
            .fold(0.0, f64::max)
    }

    /// Largest magnitude of an eigenvalue over gains between two linear phases of the control law; 0 for a law without such gains.
    #[must_use]
    pub fn radius_between(&self, hand: Option<&Hand>) -> f64 {
        let (Switching::Between(ends), Some(plant)) = (&self.phases.switching, self.plant(hand))
        else {
            return 0.0;
        };
        SHARES
            .map(|share| {
                let law = LinearLaw::between(&ends[0], &ends[1], share);
                Mode::dominant(&plant.closed_by(&self.law(&law), 1.0)).radius
            })
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// The same contact with the device's inertia multiplied by a factor. The inertia that the estimator assumes does not change.
    #[must_use]
    pub fn with_inertia(&self, factor: f64) -> Self {
        let mut other = self.clone();
        other.device.inertia *= factor;
        other
    }

    /// The same contact with additional delay, s.
    #[must_use]
    pub fn with_delay(&self, more_s: f64) -> Self {
        let mut other = self.clone();
        other.clock.delay_s += more_s;
        other
    }

    /// The same contact with additional viscous damping of the device, N·m·s/rad.
    #[must_use]
    pub fn with_damping(&self, more: f64) -> Self {
        let mut other = self.clone();
        other.device.damping += more;
        other
    }

    /// Motion at rest that rounding to encoder counts causes, in counts: `(root mean square, largest)`.
    ///
    /// The root mean square assumes rounding errors that are independent from tick to tick. The largest value is the worst case,
    /// half the sum of the impulse response. `None` if a phase is not stable, or if its impulse response is too long to be summed.
    #[must_use]
    pub fn rounding(&self, hand: Option<&Hand>) -> Option<(f64, f64)> {
        let plant = self.plant(hand)?;
        let mut most = (0.0_f64, 0.0_f64);
        for phase in &self.phases.lasting {
            let law = self.law(&phase.law);
            let matrix = plant.closed_by(&law, 1.0);
            let (square, sum) = impulse(&plant, &law, &matrix)?;
            most = (most.0.max((square / 12.0).sqrt()), most.1.max(0.5 * sum));
        }
        Some(most)
    }
}

/// Gains between two linear phases that are tried: 0 would be the first phase, 1 the second.
const SHARES: [f64; 8] = [0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85];

/// Largest number of ticks (control periods) over which an impulse response is summed.
const LONGEST: usize = 300_000;

/// Sum of squares and sum of magnitudes of the position's response to one encoder reading that is wrong by 1.
fn impulse(plant: &StateSpace, law: &StateSpace, matrix: &DMatrix<f64>) -> Option<(f64, f64)> {
    let radius = Mode::dominant(matrix).radius;
    if radius >= 1.0 {
        return None;
    }
    // Until the response has decayed to a thousandth.
    let ticks = (7.0 / -radius.ln()).ceil();
    if ticks > LONGEST as f64 {
        return None;
    }
    let (n, m) = (plant.order(), law.order());
    let mut state = DVector::zeros(n + m);
    state.rows_mut(0, n).copy_from(&(-&plant.b * law.d));
    state.rows_mut(n, m).copy_from(&law.b);
    let mut next = state.clone();
    let (mut square, mut sum) = (0.0, 0.0);
    for _ in 0..(ticks as usize).max(2 * (n + m)) {
        square += state[0] * state[0];
        sum += state[0].abs();
        next.gemv(1.0, matrix, &state, 0.0);
        std::mem::swap(&mut state, &mut next);
    }
    Some((square, sum))
}
