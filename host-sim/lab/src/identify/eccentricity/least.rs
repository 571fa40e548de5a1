//! Linear least squares over many rows of few columns.

use nalgebra::{Complex, DMatrix, DVector};

/// The normal equations, gathered row by row.
pub(super) struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
    rows: usize,
}

/// Solution of the normal equations.
pub(super) struct Solved {
    pub values: DVector<f64>,
    /// Standard uncertainties, had the rows errors of their own.
    pub uncertainties: DVector<f64>,
    /// Effective value of the residual.
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

    /// Solves the system; `None` where the columns depend on each other or there are too few rows.
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

/// The phasor `A e^(jφ)` of `a cos + b sin`, which is `A sin(· + φ)`.
pub(super) const fn of_cos_sin(cos: f64, sin: f64) -> Complex<f64> {
    Complex::new(sin, cos)
}
