//! The closed loop of plant, sampler, computational delay and a spring as control law. Its stability limit is a reference value for
//! the whole simulator.
//!
//! With a command held for a control period `T` and delayed by `t_d`, a stiffness `K` on a device with damping `b` is stable up to
//!
//! ```text
//! K_max = b / (T/2 + t_d)
//! ```
//!
//! if the inertia `J` of the device is large against its damping (`b T / J` small). The eigenvalues of the loop's exact matrix give
//! the same limit within a few per cent; [`critical_stiffness`] bisects on them.

use nalgebra::{DMatrix, DVector};

use super::bare::BareLinear;
use super::device::{Device, Invalid, not_negative, positive};
use super::hand::Hand;
use super::held::HeldLinear;
use super::state::State;
use super::stepper::LinearStepper;

/// Matrix of the sampled loop with the command `u = -stiffness · x`, from one sample to the next. `x` is the angle of the device.
///
/// A command takes effect after `whole_ticks` control periods plus the interval of the stepper `before`. The stepper `after` covers
/// the rest of the control period. For a delay of whole periods, `before` has an interval of zero. The loop's state is that of the
/// plant, followed by the commands that have not taken effect yet, the latest first.
#[must_use]
pub fn closed_loop_matrix<const N: usize, S>(
    before: &S,
    after: &S,
    whole_ticks: usize,
    stiffness: f64,
) -> DMatrix<f64>
where
    S: LinearStepper<State = State<N>>,
{
    let fraction = before.interval_s() > 0.0;
    let in_flight = whole_ticks + usize::from(fraction);
    let size = N + in_flight;
    let mut matrix = DMatrix::zeros(size, size);
    for column in 0..size {
        // The image of each unit vector is a column: the steppers are linear.
        let mut unit = DVector::<f64>::zeros(size);
        unit[column] = 1.0;
        let mut state = State::from_array(std::array::from_fn(|row| unit[row]));
        let command = -stiffness * unit[0];
        // Commands by age in ticks: the one computed at this sample has age 0.
        let aged = |age: usize| if age == 0 { command } else { unit[N + age - 1] };
        if fraction {
            before.step(&mut state, aged(whole_ticks + 1), 0.0);
        }
        after.step(&mut state, aged(whole_ticks), 0.0);
        for (row, entry) in state.to_array().into_iter().enumerate() {
            matrix[(row, column)] = entry;
        }
        for age in 0..in_flight {
            matrix[(N + age, column)] = aged(age);
        }
    }
    matrix
}

/// Spectral radius of a matrix: the largest magnitude of an eigenvalue. It is computed by Gelfand's formula `lim |Mⁿ|^(1/n)`, with
/// `n` doubled forty times.
///
/// An eigenvalue iteration could fail to converge, because the delay line makes the loop's matrix defective.
#[must_use]
pub fn spectral_radius(matrix: &DMatrix<f64>) -> f64 {
    let mut power = matrix.clone();
    let mut log_radius = 0.0;
    let mut weight = 1.0;
    for _ in 0..40 {
        let norm = power.norm();
        if norm == 0.0 {
            return 0.0;
        }
        log_radius += weight * libm::log(norm);
        power /= norm;
        // The product is computed entry by entry, because `*` uses processor-dependent kernels that round differently.
        power = DMatrix::from_fn(power.nrows(), power.ncols(), |row, column| {
            power
                .row(row)
                .iter()
                .zip(&power.column(column))
                .map(|(a, b)| a * b)
                .sum()
        });
        weight *= 0.5;
    }
    libm::exp(log_radius)
}

/// Smallest stiffness at which the sampled loop is unstable, N·m/rad, by bisection on the spectral radius.
///
/// `delay_s` is the time from a sample to its command, of any length. Dry friction of the device is ignored, because it would hide
/// the oscillation without removing the instability. The result is infinite if no stiffness up to 1e12 times the estimated limit is
/// unstable. It is zero if 1e-6 of the estimated limit is already unstable (in particular without any damping).
///
/// # Errors
/// [`Invalid`] when device, hand, rate or delay are out of range.
pub fn critical_stiffness(
    device: &Device,
    hand: Option<&Hand>,
    rate_hz: f64,
    delay_s: f64,
) -> Result<f64, Invalid> {
    positive("rate_hz", rate_hz)?;
    not_negative("delay_s", delay_s)?;
    let period = 1.0 / rate_hz;
    let whole = (delay_s * rate_hz).floor();
    // Rounding may put a delay of whole ticks slightly below or above a tick; the rest must not become negative.
    let before_s = (delay_s - whole * period).clamp(0.0, period);
    let after_s = period - before_s;
    let whole = whole as usize;

    let damping = device.damping + hand.map_or(0.0, |hand| hand.pad_damping + hand.damping);
    let expected = damping / (0.5 * period + delay_s);
    match hand {
        None => {
            let before = BareLinear::new(device, before_s)?;
            let after = BareLinear::new(device, after_s)?;
            Ok(least_unstable(expected, |k| {
                spectral_radius(&closed_loop_matrix(&before, &after, whole, k))
            }))
        }
        Some(hand) => {
            let before = HeldLinear::new(device, hand, before_s)?;
            let after = HeldLinear::new(device, hand, after_s)?;
            Ok(least_unstable(expected, |k| {
                spectral_radius(&closed_loop_matrix(&before, &after, whole, k))
            }))
        }
    }
}

/// Smallest stiffness at which the spectral radius of the loop is one or more.
///
/// A hand can make a stiffer loop stable again, so there may be several stable ranges. The search therefore goes up from a low
/// stiffness in steps of a tenth, and bisects the first unstable step.
fn least_unstable(expected: f64, radius: impl Fn(f64) -> f64) -> f64 {
    let mut stable = 1e-6 * expected;
    if stable == 0.0 || radius(stable) >= 1.0 {
        return 0.0;
    }
    while radius(1.1 * stable) < 1.0 {
        stable *= 1.1;
        if stable > 1e12 * expected {
            return f64::INFINITY;
        }
    }
    let mut unstable = 1.1 * stable;
    while (unstable - stable) > 1e-12 * unstable {
        let middle = 0.5 * (stable + unstable);
        if radius(middle) < 1.0 {
            stable = middle
        } else {
            unstable = middle
        }
    }
    stable
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn spectral_radius_of_known_matrices() {
        let turned = dmatrix![0.6, -0.8; 0.8, 0.6] * 0.99;
        assert!((spectral_radius(&turned) - 0.99).abs() < 1e-11);
        assert_eq!(spectral_radius(&dmatrix![0.0, 5.0; 0.0, 0.0]), 0.0);
        // A defective matrix, a Jordan block.
        assert!((spectral_radius(&dmatrix![0.5, 1e6; 0.0, 0.5]) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn commands_in_flight_move_up_by_one_each_tick() {
        let device = Device {
            inertia: 1.0,
            damping: 0.0,
            friction: None,
        };
        let whole = BareLinear::new(&device, 1.0).unwrap();
        let none = BareLinear::new(&device, 0.0).unwrap();
        // A double integrator with T = 1: x' = x + v + u/2, v' = v + u, where u is -3 times the x of two ticks before.
        let expected = dmatrix![
            1.0, 1.0, 0.0, 0.5;
            0.0, 1.0, 0.0, 1.0;
            -3.0, 0.0, 0.0, 0.0;
            0.0, 0.0, 1.0, 0.0
        ];
        assert_eq!(closed_loop_matrix(&none, &whole, 2, 3.0), expected);
        // A delay of half a tick: the old command acts in the first half of the tick, the new one in the second.
        let half = BareLinear::new(&device, 0.5).unwrap();
        let expected = dmatrix![
            1.0 - 3.0 * 0.125, 1.0, 0.375;
            -1.5, 1.0, 0.5;
            -3.0, 0.0, 0.0
        ];
        assert_eq!(closed_loop_matrix(&half, &half, 0, 3.0), expected);
    }
}
