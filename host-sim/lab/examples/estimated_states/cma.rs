//! Covariance matrix adaptation (Hansen, "The CMA evolution strategy: a tutorial", arXiv:1604.00772), as small as it gets.

use nalgebra::{DMatrix, DVector};

/// A small generator of normal deviates, by seed.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed ^ 0x9e37_79b9_7f4a_7c15)
    }
    pub fn unit(&mut self) -> f64 {
        // SplitMix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.unit().max(1e-300).ln()).sqrt() * (std::f64::consts::TAU * self.unit()).cos()
    }
}

/// Minimises; returns the best point and value.
pub fn minimise(
    start: &[f64],
    sigma: f64,
    generations: usize,
    seed: u64,
    cost: impl Fn(&[f64]) -> f64 + Sync,
) -> (Vec<f64>, f64) {
    let n = start.len();
    let nf = n as f64;
    let lambda = 4 + (3.0 * nf.ln()) as usize + 2;
    let mu = lambda / 2;
    let raw: Vec<f64> = (0..mu)
        .map(|i| (mu as f64 + 0.5).ln() - (i as f64 + 1.0).ln())
        .collect();
    let sum: f64 = raw.iter().sum();
    let weights: Vec<f64> = raw.iter().map(|w| w / sum).collect();
    let mu_eff = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
    let c_sigma = (mu_eff + 2.0) / (nf + mu_eff + 5.0);
    let d_sigma = 1.0 + 2.0 * (((mu_eff - 1.0) / (nf + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma;
    let c_c = (4.0 + mu_eff / nf) / (nf + 4.0 + 2.0 * mu_eff / nf);
    let c_1 = 2.0 / ((nf + 1.3).powi(2) + mu_eff);
    let c_mu = (1.0 - c_1).min(2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((nf + 2.0).powi(2) + mu_eff));
    let chi = nf.sqrt() * (1.0 - 1.0 / (4.0 * nf) + 1.0 / (21.0 * nf * nf));

    let mut random = Random::new(seed);
    let mut mean = DVector::from_row_slice(start);
    let mut sigma = sigma;
    let mut c = DMatrix::<f64>::identity(n, n);
    let (mut p_s, mut p_c) = (DVector::zeros(n), DVector::zeros(n));
    let mut best = (start.to_vec(), cost(start));
    for generation in 0..generations {
        let eigen = c.clone().symmetric_eigen();
        let roots = eigen.eigenvalues.map(|l| l.max(1e-20).sqrt());
        let b = &eigen.eigenvectors;
        let steps: Vec<DVector<f64>> = (0..lambda)
            .map(|_| {
                let z = DVector::from_fn(n, |_, _| random.normal());
                b * roots.component_mul(&z)
            })
            .collect();
        let points: Vec<Vec<f64>> = steps
            .iter()
            .map(|y| (&mean + y * sigma).iter().copied().collect())
            .collect();
        use rayon::prelude::*;
        let costs: Vec<f64> = points.par_iter().map(|p| cost(p)).collect();
        let mut order: Vec<usize> = (0..lambda).collect();
        order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        if costs[order[0]] < best.1 {
            best = (points[order[0]].clone(), costs[order[0]]);
        }
        let mut y_w = DVector::zeros(n);
        for (w, i) in weights.iter().zip(&order) {
            y_w += &steps[*i] * *w;
        }
        mean += &y_w * sigma;
        let whitened = b * (b.transpose() * &y_w).component_div(&roots);
        p_s = p_s * (1.0 - c_sigma) + whitened * (c_sigma * (2.0 - c_sigma) * mu_eff).sqrt();
        let norm = p_s.norm();
        let stalled = norm / (1.0 - (1.0 - c_sigma).powi(2 * (generation as i32 + 1))).sqrt()
            > (1.4 + 2.0 / (nf + 1.0)) * chi;
        let h = if stalled { 0.0 } else { 1.0 };
        p_c = p_c * (1.0 - c_c) + &y_w * (h * (c_c * (2.0 - c_c) * mu_eff).sqrt());
        c = &c * (1.0 - c_1 - c_mu + (1.0 - h) * c_1 * c_c * (2.0 - c_c))
            + &p_c * p_c.transpose() * c_1;
        for (w, i) in weights.iter().zip(&order) {
            c += &steps[*i] * steps[*i].transpose() * (c_mu * w);
        }
        sigma *= ((c_sigma / d_sigma) * (norm / chi - 1.0)).exp();
    }
    best
}
