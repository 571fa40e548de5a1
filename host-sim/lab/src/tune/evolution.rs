//! The search method CMA-ES (evolution strategy with covariance matrix adaptation), without the loop around it.
//!
//! It is the (μ/μ_w, λ)-CMA-ES with negative weights. Constants are those of N. Hansen, *The CMA Evolution Strategy: A Tutorial*
//! (arXiv:1604.00772v2), section B. A caller requests the points of a generation, computes their costs in any order, and passes the
//! costs back.

use crate::random_device::Random;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// The search ends if the costs of this generation and the least costs of the last generations differ by less than this. It also
/// ends if the largest standard deviation of the points is at most this.
const FLAT: f64 = 1e-12;
/// Largest squared ratio of the search distribution's axes. Above it the covariance matrix is not numerically reliable, and the
/// search ends.
const WORST_CONDITION: f64 = 1e14;

/// Constants that depend on the number of dimensions and on the population.
#[derive(Debug)]
struct Constants {
    /// Weights of the points by rank, the best point first. Those of the better half sum to 1; the others are negative.
    weights: Vec<f64>,
    /// Number of points per generation with a positive weight.
    parents: usize,
    /// Effective number of parents, `1 / Σw²` over the positive weights `w`.
    effective: f64,
    c_sigma: f64,
    d_sigma: f64,
    c_path: f64,
    c_one: f64,
    c_mu: f64,
    /// Expected length of a vector with standard normal entries.
    length: f64,
}

impl Constants {
    fn new(dimensions: usize, population: usize) -> Self {
        let n = dimensions as f64;
        let parents = population / 2;
        let raw: Vec<f64> = (1..=population)
            .map(|rank| ((population as f64 + 1.0) / 2.0).ln() - (rank as f64).ln())
            .collect();
        let effective = |weights: &[f64]| {
            let sum: f64 = weights.iter().sum();
            sum * sum / weights.iter().map(|w| w * w).sum::<f64>()
        };
        let (best, rest) = raw.split_at(parents);
        let (mu, mu_minus) = (effective(best), effective(rest));
        let c_sigma = (mu + 2.0) / (n + mu + 5.0);
        let c_path = (4.0 + mu / n) / (n + 4.0 + 2.0 * mu / n);
        let c_one = 2.0 / ((n + 1.3).powi(2) + mu);
        let c_mu = (2.0 * (0.25 + mu + 1.0 / mu - 2.0) / ((n + 2.0).powi(2) + mu)).min(1.0 - c_one);
        // Equations 50 to 52: the matrix stays positive definite.
        let negative = (1.0 + c_one / c_mu)
            .min(1.0 + 2.0 * mu_minus / (mu + 2.0))
            .min((1.0 - c_one - c_mu) / (n * c_mu));
        let (plus, minus): (f64, f64) = (best.iter().sum(), rest.iter().map(|w| w.abs()).sum());
        let weight = |w: f64| {
            if w >= 0.0 {
                w / plus
            } else {
                negative * w / minus
            }
        };
        Self {
            weights: raw.iter().map(|w| weight(*w)).collect(),
            parents,
            effective: mu,
            c_sigma,
            d_sigma: 1.0 + 2.0 * (((mu - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma,
            c_path,
            c_one,
            c_mu,
            length: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
        }
    }
}

/// A normal distribution of search points that moves to where costs are small.
#[derive(Debug)]
pub struct Evolution {
    constants: Constants,
    random: Random,
    mean: DVector<f64>,
    step: f64,
    covariance: DMatrix<f64>,
    /// Principal axes of the covariance matrix as columns. `deviations` has the standard deviations along them.
    axes: DMatrix<f64>,
    deviations: DVector<f64>,
    path_sigma: DVector<f64>,
    path_c: DVector<f64>,
    generations: i32,
    /// Points of this generation relative to the mean, in units of the step size.
    drawn: Vec<DVector<f64>>,
    /// Least cost of each generation, the newest last.
    least: Vec<f64>,
}

impl Evolution {
    /// Makes a distribution around `start` with a standard deviation of `step` along each axis.
    ///
    /// # Panics
    /// `start` has no dimension, or a generation has fewer than four points.
    #[must_use]
    pub fn new(start: &[f64], step: f64, population: usize, seed: u64) -> Self {
        let n = start.len();
        assert!(
            n > 0 && population >= 4,
            "{n} dimensions, {population} points"
        );
        Self {
            constants: Constants::new(n, population),
            random: Random::new(seed),
            mean: DVector::from_column_slice(start),
            step,
            covariance: DMatrix::identity(n, n),
            axes: DMatrix::identity(n, n),
            deviations: DVector::repeat(n, 1.0),
            path_sigma: DVector::zeros(n),
            path_c: DVector::zeros(n),
            generations: 0,
            drawn: Vec::new(),
            least: Vec::new(),
        }
    }

    /// Draws the points of the next generation.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        self.drawn.clear();
        for _ in 0..self.constants.weights.len() {
            let normal = DVector::from_fn(self.mean.len(), |_, _| normal(&mut self.random));
            let drawn = &self.axes * normal.component_mul(&self.deviations);
            self.drawn.push(drawn);
        }
        let point = |drawn: &DVector<f64>| (&self.mean + drawn * self.step).as_slice().to_vec();
        self.drawn.iter().map(point).collect()
    }

    /// Receives the costs of the points that [`ask`](Self::ask) returned, in the same order. Returns `false` when the search has
    /// ended.
    pub fn tell(&mut self, costs: &[f64]) -> bool {
        debug_assert_eq!(costs.len(), self.drawn.len());
        let mut ranks: Vec<usize> = (0..costs.len()).collect();
        ranks.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        let Constants {
            parents,
            effective,
            c_sigma,
            d_sigma,
            c_path,
            c_one,
            c_mu,
            length,
            ..
        } = self.constants;
        let n = self.mean.len() as f64;
        self.generations += 1;
        let of_rank = |rank: usize| &self.drawn[ranks[rank]];
        let mut moved = DVector::zeros(self.mean.len());
        for rank in 0..parents {
            moved.axpy(self.constants.weights[rank], of_rank(rank), 1.0);
        }
        self.mean.axpy(self.step, &moved, 1.0);

        let white = self.whitened(&moved);
        self.path_sigma *= 1.0 - c_sigma;
        self.path_sigma
            .axpy((c_sigma * (2.0 - c_sigma) * effective).sqrt(), &white, 1.0);
        let size = self.path_sigma.norm();
        let grown = (1.0 - (1.0 - c_sigma).powi(2 * self.generations)).sqrt();
        let is_steady = size / grown < (1.4 + 2.0 / (n + 1.0)) * length;
        self.path_c *= 1.0 - c_path;
        if is_steady {
            self.path_c
                .axpy((c_path * (2.0 - c_path) * effective).sqrt(), &moved, 1.0);
        }

        let lost = if is_steady {
            0.0
        } else {
            c_path * (2.0 - c_path)
        };
        let sum: f64 = self.constants.weights.iter().sum();
        self.covariance *= 1.0 + c_one * lost - c_one - c_mu * sum;
        self.covariance.ger(c_one, &self.path_c, &self.path_c, 1.0);
        for (rank, &weight) in self.constants.weights.iter().enumerate() {
            let drawn = &self.drawn[ranks[rank]];
            let weight = if weight < 0.0 {
                weight * n / self.whitened(drawn).norm_squared().max(f64::MIN_POSITIVE)
            } else {
                weight
            };
            self.covariance.ger(c_mu * weight, drawn, drawn, 1.0);
        }
        self.step *= ((c_sigma / d_sigma) * (size / length - 1.0)).exp();
        self.least.push(costs[ranks[0]]);
        self.goes_on(costs, &ranks)
    }

    /// The vector multiplied by `C^(-1/2)`, where `C` is the covariance matrix.
    fn whitened(&self, vector: &DVector<f64>) -> DVector<f64> {
        &self.axes * self.axes.tr_mul(vector).component_div(&self.deviations)
    }

    /// Decomposes the covariance matrix for the next generation. Returns `false` if the search has ended.
    fn goes_on(&mut self, costs: &[f64], ranks: &[usize]) -> bool {
        let (least, most) = (costs[ranks[0]], costs[ranks[ranks.len() - 1]]);
        let long = 10 + (30.0 * self.mean.len() as f64 / costs.len() as f64).ceil() as usize;
        let is_flat = self.least.len() >= long && {
            let recent = &self.least[self.least.len() - long..];
            let low = recent.iter().copied().fold(least, f64::min);
            let high = recent.iter().copied().fold(most, f64::max);
            high - low < FLAT
        };
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = SymmetricEigen::new(self.covariance.clone());
        let (low, high) = (eigenvalues.min(), eigenvalues.max());
        let is_sound = low > 0.0 && high.is_finite() && high < WORST_CONDITION * low;
        let reach = self.step * high.sqrt();
        if is_flat || !is_sound || !(reach > FLAT && reach.is_finite()) {
            return false;
        }
        self.axes = eigenvectors;
        self.deviations = eigenvalues.map(f64::sqrt);
        true
    }
}

/// Draws a standard normal number by Marsaglia's polar method.
fn normal(random: &mut Random) -> f64 {
    loop {
        let [u, v] = [(); 2].map(|()| 2.0 * random.unit() - 1.0);
        let s = u * u + v * v;
        if s > 0.0 && s < 1.0 {
            return u * (-2.0 * s.ln() / s).sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of points that a search examines until the cost of its mean is below `1e-9`; `None` if the search ends before.
    fn looked(start: &[f64], seed: u64, cost: impl Fn(&[f64]) -> f64) -> Option<usize> {
        let population = 4 + (3.0 * (start.len() as f64).ln()) as usize;
        let mut search = Evolution::new(start, 0.3, population, seed);
        for generation in 1..3_000 {
            let points = search.ask();
            let costs: Vec<f64> = points.iter().map(|point| cost(point)).collect();
            if cost(search.mean.as_slice()) < 1e-9 {
                return Some(generation * population);
            }
            if !search.tell(&costs) {
                return None;
            }
        }
        None
    }

    /// Median number of points that a search examines, over eleven seeds. The bounds in the tests are twice the values of the
    /// present code.
    fn median(start: &[f64], cost: impl Fn(&[f64]) -> f64) -> usize {
        let mut all: Vec<usize> = (0..11)
            .map(|seed| looked(start, seed, &cost).unwrap_or(usize::MAX))
            .collect();
        all.sort_unstable();
        all[all.len() / 2]
    }

    fn ellipsoid(x: &[f64], ratio: f64) -> f64 {
        let last = (x.len() - 1) as f64;
        let term = |(i, x): (usize, &f64)| ratio.powf(i as f64 / last) * x * x;
        x.iter().enumerate().map(term).sum()
    }

    fn rosenbrock(x: &[f64]) -> f64 {
        let term =
            |two: &[f64]| 100.0 * (two[1] - two[0] * two[0]).powi(2) + (1.0 - two[0]).powi(2);
        x.windows(2).map(term).sum()
    }

    #[test]
    fn known_functions_are_minimised() {
        let start = [1.0; 6];
        let sphere = median(&start, |x| ellipsoid(x, 1.0));
        let long = median(&start, |x| ellipsoid(x, 1e6));
        let curved = median(&[0.0; 6], rosenbrock);
        println!("sphere {sphere}, ellipsoid {long}, Rosenbrock {curved}");
        assert!(sphere < 1_800, "{sphere}");
        assert!(long < 3_900, "{long}");
        assert!(curved < 4_800, "{curved}");
    }

    /// Checks that the search minimises an ellipsoid equally well for any direction of its axes.
    #[test]
    fn a_turned_ellipsoid_is_no_harder_than_a_straight_one() {
        let (sin, cos) = 0.7_f64.sin_cos();
        let turned = |x: &[f64]| {
            let mut y = x.to_vec();
            for i in 1..y.len() {
                (y[i - 1], y[i]) = (cos * y[i - 1] - sin * y[i], sin * y[i - 1] + cos * y[i]);
            }
            ellipsoid(&y, 1e6)
        };
        let start = [1.0; 6];
        let straight = median(&start, |x| ellipsoid(x, 1e6));
        let turned = median(&start, turned);
        println!("straight {straight}, turned {turned}");
        assert!(turned < straight * 3 / 2, "{turned} against {straight}");
    }

    /// Checks that the search uses only the ranks of costs: it also finds the minimum if all costs are multiplied by 0.001, and if
    /// they are infinite in a part of the plane.
    #[test]
    fn ranks_alone_decide() {
        let plain = looked(&[1.0, 1.0], 7, |x| ellipsoid(x, 4.0));
        let squashed = looked(&[1.0, 1.0], 7, |x| ellipsoid(x, 4.0) * 1e-3);
        let walled = looked(&[1.0, 1.0], 7, |x| {
            if x[0] < -0.5 {
                f64::INFINITY
            } else {
                ellipsoid(x, 4.0)
            }
        });
        assert!(plain.is_some() && squashed.is_some() && walled.is_some());
        assert!(squashed <= plain);
    }

    #[test]
    fn it_ends_where_nothing_is_left_to_find() {
        let mut search = Evolution::new(&[1.0, 2.0], 0.3, 6, 1);
        let flat = (0..1_000).take_while(|_| {
            search.ask();
            search.tell(&[1.0; 6])
        });
        assert!(flat.count() < 50);
        // A single dimension is searched as well.
        assert!(looked(&[3.0], 1, |x| x[0] * x[0]).is_some());
    }

    #[test]
    fn draws_are_normal() {
        let mut random = Random::new(5);
        let count = 100_000;
        let draws: Vec<f64> = (0..count).map(|_| normal(&mut random)).collect();
        let moment = |power| draws.iter().map(|x| x.powi(power)).sum::<f64>() / f64::from(count);
        // Four standard errors; the variances of x, x² and x⁴ are 1, 2 and 96.
        let bound = |variance: f64| 4.0 * (variance / f64::from(count)).sqrt();
        assert!(moment(1).abs() < bound(1.0));
        assert!((moment(2) - 1.0).abs() < bound(2.0));
        assert!((moment(4) - 3.0).abs() < bound(96.0));
    }
}
