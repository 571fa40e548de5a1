//! Checks whether a loop stays stable while one gain of its control law changes from tick to tick.
//!
//! Two loop matrices that differ by a matrix of rank one, `A1 = A0 + b c`, belong to the values 0 and 1 of a gain in one path of
//! the loop. The circle criterion in discrete time is a condition under which the loop stays stable while the gain changes in any
//! way between these values (Jury and Lee, IEEE TAC 9(1) 51, 1964; cited from memory). `A1` has to be stable, `A0` may have at
//! most an integrator on the unit circle, and
//!
//! ```text
//! Re (1 + P(z)) > 0 for |z| = 1,   1 + P(z) = det(zI - A1)/det(zI - A0)               (16)
//! ```
//!
//! So only the eigenvalues of `A0` and `A1` are needed. The criterion is sufficient, not necessary.

use super::state_space::eigenvalues;
use nalgebra::{Complex, DMatrix};

/// Number of angles on the unit circle that are examined, from the lowest frequency to half the sampling rate.
const ANGLES: i32 = 400;

/// Smallest cosine of the angle of `1 + P` on the unit circle (equation (16) of the module). The circle criterion holds above 0.
/// `None` if one of the two loop matrices is not stable, or its eigenvalues were not found.
#[must_use]
pub fn least_cosine(from: &DMatrix<f64>, to: &DMatrix<f64>) -> Option<f64> {
    let (zero, one) = (eigenvalues(from)?, eigenvalues(to)?);
    let integrator = |value: &Complex<f64>| (value - 1.0).norm() < 1e-7;
    let inside = |value: &Complex<f64>| value.norm() < 1.0;
    let integrators = zero.iter().filter(|value| integrator(value)).count();
    let usable = one.iter().all(inside)
        && integrators <= 1
        && zero.iter().all(|value| inside(value) || integrator(value));
    if !usable {
        return None;
    }
    let spread = (0..=ANGLES).map(|index| {
        std::f64::consts::PI * 10f64.powf(-6.0 * (1.0 - f64::from(index) / f64::from(ANGLES)))
    });
    // A resonance is narrow: the nearer its eigenvalue is to the unit circle, the narrower.
    let near = zero.iter().chain(&one).flat_map(|value| {
        let (angle, width) = (value.arg().abs(), 1.0 - value.norm());
        (-8..=8).map(move |step| angle + 0.4 * f64::from(step) * width)
    });
    let cosine = |angle: f64| {
        let z = Complex::from_polar(1.0, angle);
        let turned: f64 = one.iter().map(|value| (z - value).arg()).sum::<f64>()
            - zero.iter().map(|value| (z - value).arg()).sum::<f64>();
        turned.cos()
    };
    Some(
        spread
            .chain(near)
            .filter(|angle| (1e-7..=std::f64::consts::PI).contains(angle))
            .map(cosine)
            .fold(1.0, f64::min),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn a_gain_that_may_only_shrink_a_first_order_lag_is_safe() {
        // x' = (0.9 - 0.5 g) x.
        assert!(least_cosine(&dmatrix![0.9], &dmatrix![0.4]).unwrap() > 0.0);
        // An integrator with and without feedback.
        assert!(least_cosine(&dmatrix![1.0], &dmatrix![0.7]).unwrap() > 0.0);
        // The loop at a gain of 1 is unstable.
        assert_eq!(least_cosine(&dmatrix![0.9], &dmatrix![-1.2]), None);
    }

    #[test]
    fn an_undamped_spring_that_may_switch_between_two_stiffnesses_is_not() {
        // Both ends decay slowly. If the gain changes with the sign of x v, stiff outward and soft inward, such an oscillator
        // grows.
        let swing = |stiffness: f64| {
            let t: f64 = 0.01;
            dmatrix![1.0 - 0.5 * stiffness * t * t, t; -stiffness * t, 1.0 - 0.0005]
        };
        assert!(least_cosine(&swing(1.0), &swing(4.0)).unwrap() < 0.0);
    }
}
