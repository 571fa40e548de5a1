//! Solves linear least squares with many equations and few unknowns.

use nalgebra::{Complex, DMatrix, DVector};

/// Normal equations, summed up equation by equation.
pub(super) struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
    rows: usize,
}

/// Least-squares solution with its uncertainties.
pub(super) struct Solved {
    pub values: DVector<f64>,
    /// Standard uncertainties of the solution, if the errors of the equations are independent.
    pub uncertainties: DVector<f64>,
    /// Root mean square of the equations' residual.
    pub residual_rms: f64,
}

impl Normal {
    pub fn new(columns: usize) -> Self {
        Self {
            matrix: DMatrix::zeros(columns, columns),
            right: DVector::zeros(columns),
            square: 0.0,
            rows: 0,
        }
    }

    pub fn add(&mut self, row: &[f64], value: f64) {
        for (i, a) in row.iter().enumerate() {
            for (j, b) in row.iter().enumerate() {
                self.matrix[(i, j)] += a * b;
            }
            self.right[i] += a * value;
        }
        self.square += value * value;
        self.rows += 1;
    }

    /// Solves the system; `None` if the unknowns are not independent or there are too few equations.
    pub fn solve(self) -> Option<Solved> {
        let columns = self.right.len();
        let free = self.rows.checked_sub(columns).filter(|free| *free > 0)?;
        let decomposed = self.matrix.cholesky()?;
        let values = decomposed.solve(&self.right);
        let left = (self.square - values.dot(&self.right)).max(0.0);
        let variance = left / free as f64;
        let inverse = decomposed.inverse();
        let uncertainties = inverse.diagonal().map(|it| (it * variance).sqrt());
        Some(Solved {
            values,
            uncertainties,
            residual_rms: (left / self.rows as f64).sqrt(),
        })
    }
}

/// The phasor `A e^(jφ)` of `cos · cos(x) + sin · sin(x)`, which equals `A sin(x + φ)`.
pub(super) const fn of_cos_sin(cos: f64, sin: f64) -> Complex<f64> {
    Complex::new(sin, cos)
}
