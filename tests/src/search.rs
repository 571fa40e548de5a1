//! Finds the largest value of a function without its gradient, by the matrix adaptation evolution strategy (μ/μ_w, λ)-MA-ES.
//! Source: Beyer and Sendhoff, "Simplify your covariance matrix adaptation evolution strategy", 2017; it is CMA-ES without an
//! eigendecomposition.

use crate::random::Random;

fn normal(random: &mut Random) -> f64 {
    // Box-Muller transform; `real` is between -1 and 1.
    let (u, v) = ((random.real() + 1.0) / 2.0, random.real());
    (-2.0 * (u.max(1e-300)).ln()).sqrt() * (std::f64::consts::PI * v).cos()
}

/// One trial of the evolution strategy: the function's value, the random vector drawn for the trial, and the step from the mean to
/// its point.
type Child = (f64, Vec<f64>, Vec<f64>);

/// Searches for the point with the largest `value`; returns the point and its value. Evaluates the function `evaluations` times (at
/// most one generation more), beginning around the origin with a step size of `step`.
pub fn largest(
    dimensions: usize,
    step: f64,
    evaluations: u32,
    seed: u64,
    mut value: impl FnMut(&[f64]) -> f64,
) -> (Vec<f64>, f64) {
    let n = dimensions as f64;
    let lambda = 4 + (3.0 * n.ln()) as usize;
    let mu = lambda / 2;
    let mut weights: Vec<f64> = (0..mu)
        .map(|i| (mu as f64 + 0.5).ln() - (i as f64 + 1.0).ln())
        .collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    let mu_eff = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
    let cs = (mu_eff + 2.0) / (n + mu_eff + 5.0);
    let c1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
    let cw = (1.0 - c1).min(2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0).powi(2) + mu_eff));
    let ds = 1.0 + cs + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0);
    let expected = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));

    let mut random = Random::new(seed);
    let (mut best, mut best_value) = (vec![0.0; dimensions], f64::NEG_INFINITY);
    let mut spent = 0;
    while spent < evaluations {
        // Restarts whenever a search has converged.
        let mut centre: Vec<f64> = (0..dimensions)
            .map(|_| step * normal(&mut random))
            .collect();
        let mut sigma = step;
        let mut path = vec![0.0; dimensions];
        let mut matrix = vec![vec![0.0; dimensions]; dimensions];
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        let mut stale = 0;
        let mut best_here = f64::NEG_INFINITY;
        while spent < evaluations && stale < 60 + 10 * dimensions && sigma > 1e-6 {
            let mut children: Vec<Child> = (0..lambda)
                .map(|_| {
                    let z: Vec<f64> = (0..dimensions).map(|_| normal(&mut random)).collect();
                    let d: Vec<f64> = matrix
                        .iter()
                        .map(|row| row.iter().zip(&z).map(|(m, z)| m * z).sum())
                        .collect();
                    let x: Vec<f64> = centre.iter().zip(&d).map(|(c, d)| c + sigma * d).collect();
                    let found = value(&x);
                    if found > best_value {
                        (best_value, best) = (found, x);
                    }
                    (found, z, d)
                })
                .collect();
            spent += lambda as u32;
            children.sort_by(|a, b| b.0.total_cmp(&a.0));
            stale += 1;
            if children[0].0 > best_here {
                if children[0].0 > best_here + 1e-3 * best_here.abs() {
                    stale = 0;
                }
                best_here = children[0].0;
            }
            let mean = |of: fn(&Child) -> &Vec<f64>, i: usize| -> f64 {
                (0..mu).map(|k| weights[k] * of(&children[k])[i]).sum()
            };
            let z: Vec<f64> = (0..dimensions).map(|i| mean(|c| &c.1, i)).collect();
            for i in 0..dimensions {
                centre[i] += sigma * mean(|c| &c.2, i);
                path[i] = (1.0 - cs) * path[i] + (mu_eff * cs * (2.0 - cs)).sqrt() * z[i];
            }
            // M (I + c1/2 (p pᵀ - I) + cw/2 (Σ w z zᵀ - I)), row by row.
            for row in &mut matrix {
                let along: f64 = row.iter().zip(&path).map(|(m, p)| m * p).sum();
                let steps: Vec<f64> = (0..mu)
                    .map(|k| row.iter().zip(&children[k].1).map(|(m, z)| m * z).sum())
                    .collect();
                for (j, m) in row.iter_mut().enumerate() {
                    let spread: f64 = (0..mu)
                        .map(|k| weights[k] * steps[k] * children[k].1[j])
                        .sum();
                    *m += c1 / 2.0 * (along * path[j] - *m) + cw / 2.0 * (spread - *m);
                }
            }
            let length = path.iter().map(|p| p * p).sum::<f64>().sqrt();
            sigma *= ((cs / ds) * (length / expected - 1.0)).exp();
        }
    }
    (best, best_value)
}
