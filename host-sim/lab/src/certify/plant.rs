//! Device, hand, current controller and delay between two samples, as one discrete system.
//!
//! ```text
//! J   dv/dt   = τ + k_p (x_h - x) + b_p (v_h - v) - b v                  (1)
//! J_h dv_h/dt =   - k_p (x_h - x) - b_p (v_h - v) - b_h v_h - k_h x_h    (2)
//! dτ/dt = 2π f_c (u - τ), or τ = u without a current controller           (3)
//! ```
//!
//! `x`, `v`, `J`, `b` are angle, velocity, inertia and damping of the device. Those of the hand have the index `h`, and `k_h` is
//! the stiffness of the hand's spring. `k_p` and `b_p` are stiffness and damping of the fingertip pad. `τ` is the motor's torque,
//! `f_c` the bandwidth of the current controller.
//!
//! The command `u` is constant between changes. A command that is computed at a sample acts a time `t_d = (w + φ) T` later: `w`
//! whole control periods `T` and a fraction `φ` of one. In the period that begins at sample `n`, `u(n-w-1)` acts for `φ T` and
//! `u(n-w)` for the rest. Each part is integrated exactly (4).

use super::state_space::StateSpace;
use nalgebra::{DMatrix, DVector};
use touchstone_world::plant::{Device, Hand, Invalid};

/// Parameters of device, hand and current controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mechanics {
    /// The device; its dry friction is not part of the linear system.
    pub device: Device,
    /// The hand that holds the device, if any.
    pub hand: Option<Hand>,
    /// Bandwidth of the current controller, Hz; absent if the torque follows its command at once.
    pub current_loop_hz: Option<f64>,
}

/// Control period, and delay until a force acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Control period `T`, s.
    pub period_s: f64,
    /// Time from a sample until the force that is computed from it acts, s.
    pub delay_s: f64,
}

impl Clock {
    /// The delay as a number of whole ticks and the remaining fraction of a tick, from 0 to below 1.
    #[must_use]
    pub fn ticks(&self) -> (usize, f64) {
        let ticks = self.delay_s / self.period_s;
        // A delay that is a whole number of ticks except for rounding stays whole.
        let nearest = ticks.round();
        if (ticks - nearest).abs() < 1e-9 {
            return (nearest as usize, 0.0);
        }
        (ticks.floor() as usize, ticks.fract())
    }
}

/// System matrix and input vector of the continuous states: angle and velocity of the device, then those of a hand and the torque
/// of a current controller, if present. The input is the torque command.
fn rates(mechanics: &Mechanics) -> (DMatrix<f64>, DVector<f64>) {
    let device = &mechanics.device;
    let motion = if mechanics.hand.is_some() { 4 } else { 2 };
    let order = motion + usize::from(mechanics.current_loop_hz.is_some());
    let mut a = DMatrix::zeros(order, order);
    let mut b = DVector::zeros(order);
    a[(0, 1)] = 1.0;
    a[(1, 1)] = -device.damping / device.inertia;
    if let Some(hand) = &mechanics.hand {
        a[(1, 0)] = -hand.pad_stiffness / device.inertia;
        a[(1, 1)] -= hand.pad_damping / device.inertia;
        a[(1, 2)] = hand.pad_stiffness / device.inertia;
        a[(1, 3)] = hand.pad_damping / device.inertia;
        a[(2, 3)] = 1.0;
        a[(3, 0)] = hand.pad_stiffness / hand.inertia;
        a[(3, 1)] = hand.pad_damping / hand.inertia;
        a[(3, 2)] = -(hand.pad_stiffness + hand.stiffness) / hand.inertia;
        a[(3, 3)] = -(hand.pad_damping + hand.damping) / hand.inertia;
    }
    match mechanics.current_loop_hz {
        Some(bandwidth) => {
            let rate = std::f64::consts::TAU * bandwidth;
            a[(1, motion)] = 1.0 / device.inertia;
            a[(motion, motion)] = -rate;
            b[motion] = rate;
        }
        None => b[1] = 1.0 / device.inertia,
    }
    (a, b)
}

/// State matrix and input vector over an interval in seconds with a constant command (Van Loan, IEEE TAC 23(3) 395, 1978).
fn held(a: &DMatrix<f64>, b: &DVector<f64>, interval_s: f64) -> (DMatrix<f64>, DVector<f64>) {
    let order = b.len();
    let mut block = DMatrix::zeros(order + 1, order + 1);
    block
        .view_mut((0, 0), (order, order))
        .copy_from(&(a * interval_s));
    block
        .view_mut((0, order), (order, 1))
        .copy_from(&(b * interval_s));
    let flow = block.exp();
    (
        flow.view((0, 0), (order, order)).into_owned(),
        flow.view((0, order), (order, 1)).column(0).into_owned(),
    )
}

/// Discrete system from torque command to position, one step per control period.
///
/// The states are angle and velocity of the device, those of the hand, the torque of the current controller, then the commands that
/// do not act yet, the latest first. All are deviations from the point where the hand rests without a command.
///
/// # Errors
/// [`Invalid`]: a value of device or hand is out of range.
pub fn sampled(mechanics: &Mechanics, clock: Clock) -> Result<StateSpace, Invalid> {
    let linear = Device {
        friction: None,
        ..mechanics.device
    };
    linear.validate()?;
    if let Some(hand) = &mechanics.hand {
        hand.validate()?;
    }
    let (a, b) = rates(mechanics);
    let (whole, fraction) = clock.ticks();
    let (phi_old, gamma_old) = held(&a, &b, fraction * clock.period_s);
    let (phi_new, gamma_new) = held(&a, &b, (1.0 - fraction) * clock.period_s);
    let (plant, in_flight) = (b.len(), whole + usize::from(fraction > 0.0));
    let order = plant + in_flight;
    let mut system = StateSpace {
        a: DMatrix::zeros(order, order),
        b: DVector::zeros(order),
        c: DVector::zeros(order),
        d: 0.0,
    };
    system.c[0] = 1.0;
    system
        .a
        .view_mut((0, 0), (plant, plant))
        .copy_from(&(&phi_new * &phi_old));
    // The command of this age in ticks: that of this sample is the input, older ones are states.
    let mut acts = |age: usize, effect: &DVector<f64>| {
        for (row, entry) in effect.iter().enumerate() {
            match age {
                0 => system.b[row] += entry,
                _ => system.a[(row, plant + age - 1)] += entry,
            }
        }
    };
    acts(whole, &gamma_new);
    if fraction > 0.0 {
        acts(whole + 1, &(&phi_new * &gamma_old));
    }
    if in_flight > 0 {
        system.b[plant] = 1.0;
        for age in 1..in_flight {
            system.a[(plant + age, plant + age - 1)] = 1.0;
        }
    }
    Ok(system)
}
