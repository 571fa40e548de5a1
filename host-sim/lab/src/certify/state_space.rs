//! Discrete linear systems with one input and one output, their loops and their eigenvalues.

use nalgebra::linalg::{Schur, balancing::balance_parlett_reinsch};
use nalgebra::{Complex, DMatrix, DVector};
use touchstone_world::plant::spectral_radius;

/// A discrete linear system `s' = a s + b w`, `y = c s + d w`, one step per control period: state `s`, input `w`, output `y`.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// Matrix from the state to the next state.
    pub a: DMatrix<f64>,
    /// Vector from the input to the next state.
    pub b: DVector<f64>,
    /// Vector from the state to the output.
    pub c: DVector<f64>,
    /// Factor from the input to the output of the same tick.
    pub d: f64,
}

impl StateSpace {
    /// Builds the matrices from a function. `step` gets state and input, changes the state and returns the output.
    ///
    /// `step` must be linear: each column of the matrices is its result for a unit vector.
    #[must_use]
    pub fn of(order: usize, step: impl Fn(&mut [f64], f64) -> f64) -> Self {
        let mut system = Self {
            a: DMatrix::zeros(order, order),
            b: DVector::zeros(order),
            c: DVector::zeros(order),
            d: 0.0,
        };
        for column in 0..=order {
            let mut state = vec![0.0; order];
            let mut input = 0.0;
            match state.get_mut(column) {
                Some(entry) => *entry = 1.0,
                None => input = 1.0,
            }
            let output = step(&mut state, input);
            if column < order {
                system.a.set_column(column, &DVector::from_vec(state));
                system.c[column] = output;
            } else {
                system.b = DVector::from_vec(state);
                system.d = output;
            }
        }
        system
    }

    /// Number of state variables.
    #[must_use]
    pub fn order(&self) -> usize {
        self.b.len()
    }

    /// Advances by one control period: changes the state and returns the output.
    pub fn advance(&self, state: &mut DVector<f64>, input: f64) -> f64 {
        let output = self.c.dot(state) + self.d * input;
        *state = &self.a * &*state + &self.b * input;
        output
    }

    /// Matrix of the closed loop of a plant (`self`) and a control law. The plant goes from command to position, without a direct
    /// path. The law goes from position to force; it reads `gain` times the position, and the command is minus its force. The
    /// plant's states come first, then the law's.
    #[must_use]
    pub fn closed_by(&self, law: &StateSpace, gain: f64) -> DMatrix<f64> {
        debug_assert!(self.d == 0.0, "an algebraic loop");
        let (n, m) = (self.order(), law.order());
        let mut matrix = DMatrix::zeros(n + m, n + m);
        let read = self.c.transpose() * gain;
        matrix
            .view_mut((0, 0), (n, n))
            .copy_from(&(&self.a - &self.b * &read * law.d));
        matrix
            .view_mut((0, n), (n, m))
            .copy_from(&(-&self.b * law.c.transpose()));
        matrix.view_mut((n, 0), (m, n)).copy_from(&(&law.b * &read));
        matrix.view_mut((n, n), (m, m)).copy_from(&law.a);
        matrix
    }
}

/// Eigenvalues of a loop's matrix, the largest first; `None` if the iteration does not converge or an entry is not finite.
///
/// The matrix is balanced first, because positions, velocities and forces differ by orders of magnitude.
#[must_use]
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if matrix.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let mut balanced = matrix.clone();
    balance_parlett_reinsch(&mut balanced);
    let schur = Schur::try_new(balanced, f64::EPSILON, 100 * matrix.nrows().max(10))?;
    let mut values: Vec<_> = schur.complex_eigenvalues().iter().copied().collect();
    values.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    Some(values)
}

/// The motion of a loop that decays slowest or grows fastest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Magnitude of the loop's largest eigenvalue; the loop is stable below 1.
    pub radius: f64,
    /// Angle of the eigenvalue, rad per control period, 0 to π; NaN if only the magnitude was found.
    pub angle_rad: f64,
}

impl Mode {
    /// The largest eigenvalue of a matrix; infinite for a matrix with entries that are not finite.
    #[must_use]
    pub fn dominant(matrix: &DMatrix<f64>) -> Self {
        match eigenvalues(matrix) {
            Some(values) => values.first().map_or(
                Self {
                    radius: 0.0,
                    angle_rad: 0.0,
                },
                |value| Self {
                    radius: value.norm(),
                    angle_rad: value.arg().abs(),
                },
            ),
            None if matrix.iter().all(|entry| entry.is_finite()) => Self {
                // The spectral radius needs no eigenvalue iteration, so it cannot fail.
                radius: spectral_radius(matrix),
                angle_rad: f64::NAN,
            },
            None => Self {
                radius: f64::INFINITY,
                angle_rad: f64::NAN,
            },
        }
    }

    /// Rate at which the motion decays, 1/s, at a control rate in Hz; negative if the motion grows.
    #[must_use]
    pub fn decay_per_s(&self, rate_hz: f64) -> f64 {
        -self.radius.ln() * rate_hz
    }

    /// Frequency of the motion, Hz.
    #[must_use]
    pub fn frequency_hz(&self, rate_hz: f64) -> f64 {
        self.angle_rad * rate_hz / std::f64::consts::TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn dominant_mode_of_known_matrices() {
        let turned = dmatrix![0.6, -0.8; 0.8, 0.6] * 0.99;
        let mode = Mode::dominant(&turned);
        assert!((mode.radius - 0.99).abs() < 1e-14);
        assert!((mode.angle_rad - 0.8_f64.atan2(0.6)).abs() < 1e-14);
        assert!((mode.decay_per_s(1000.0) + 1000.0 * 0.99_f64.ln()).abs() < 1e-9);
        // Badly scaled, and with the zero eigenvalues of a delay line.
        let scaled = dmatrix![0.9, 1e9, 0.0; 0.0, 0.0, 1.0; 0.0, 0.0, 0.0];
        assert!((Mode::dominant(&scaled).radius - 0.9).abs() < 1e-12);
        assert_eq!(Mode::dominant(&dmatrix![f64::NAN]).radius, f64::INFINITY);
    }

    #[test]
    fn a_loop_does_what_its_two_parts_do_in_turn() {
        let plant = StateSpace::of(2, |s, u| {
            let x = s[0];
            s[0] += 0.5 * s[1];
            s[1] = 0.9 * s[1] + u;
            x
        });
        let law = StateSpace::of(1, |s, e| {
            let f = 3.0 * e + 2.0 * (e - s[0]);
            s[0] = e;
            f
        });
        let matrix = plant.closed_by(&law, 0.5);
        let mut whole = DVector::from_vec(vec![1.0, -0.2, 0.3]);
        let (mut p, mut l) = (whole.rows(0, 2).into_owned(), whole.rows(2, 1).into_owned());
        for _ in 0..20 {
            whole = &matrix * whole;
            let x = plant.c.dot(&p);
            let f = law.advance(&mut l, 0.5 * x);
            plant.advance(&mut p, -f);
        }
        assert!((whole.rows(0, 2) - p).norm() < 1e-12);
        assert!((whole.rows(2, 1) - l).norm() < 1e-12);
    }
}
