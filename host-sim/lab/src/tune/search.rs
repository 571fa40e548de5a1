//! The search for settings of least cost: covariance matrix adaptation (CMA-ES) with a seed.

use super::cost::Cost;
use super::evolution::Evolution;

/// Result of a search for settings.
#[derive(Debug, Clone)]
pub struct SearchResult {
    /// The point with the least cost. Its coordinates are natural logarithms of settings divided by their start values.
    pub point: Vec<f64>,
    /// Cost of the point with the least cost.
    pub cost: Cost,
    /// Number of points whose cost was computed.
    pub evaluations: u64,
}

/// Standard deviation of the first generation, as the natural logarithm of a ratio.
const STEP: f64 = 0.3;

/// Limits at which a search ends, and the seed of its random numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Until {
    /// Largest number of points to examine.
    pub evaluations: u64,
    /// Value of [`Cost::worst`] (largest ratio of a measure to its limit) at which the search also ends.
    pub worst: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Minimises `cost`, starting at the best of `starts`. The same seed gives the same result on any number of cores.
pub fn minimise(
    starts: &[Vec<f64>],
    until: &Until,
    cost: impl Fn(&[f64]) -> Cost + Sync,
    mut progress: impl FnMut(u64),
) -> SearchResult {
    use rayon::prelude::*;
    let costs: Vec<Cost> = starts.par_iter().map(|start| cost(start)).collect();
    let mut done = starts.len() as u64;
    progress(done);
    let mut best = starts
        .iter()
        .zip(&costs)
        .min_by(|a, b| a.1.value.total_cmp(&b.1.value))
        .map(|(point, cost)| (point.clone(), *cost))
        .unwrap_or((
            Vec::new(),
            Cost {
                value: f64::INFINITY,
                worst: f64::INFINITY,
            },
        ));
    let dimensions = best.0.len();
    if dimensions > 0 {
        let population = 6 + (3.0 * (dimensions as f64).ln()) as u64;
        let generations = until.evaluations.saturating_sub(done) / population;
        let mut search = Evolution::new(&best.0, STEP, population as usize, until.seed);
        for _ in 0..generations {
            if best.1.worst <= until.worst {
                break;
            }
            let points = search.ask();
            let costs: Vec<Cost> = points.par_iter().map(|point| cost(point)).collect();
            let values: Vec<f64> = costs.iter().map(|cost| cost.value).collect();
            // Of two points with equal cost the first is kept.
            for (point, cost) in points.into_iter().zip(costs) {
                if cost.value.total_cmp(&best.1.value).is_lt() {
                    best = (point, cost);
                }
            }
            done += population;
            progress(done);
            if !search.tell(&values) {
                break;
            }
        }
    }
    SearchResult {
        point: best.0,
        cost: best.1,
        evaluations: done,
    }
}
