//! The search itself: covariance matrix adaptation, by seed.

use super::cost::Cost;
use cmaes::{CMAESOptions, DVector};

/// What a search found.
#[derive(Debug, Clone)]
pub struct Found {
    /// The best point.
    pub point: Vec<f64>,
    /// What it costs.
    pub cost: Cost,
    /// Points that were looked at.
    pub evaluations: u64,
}

/// First step, as the logarithm of a ratio.
const STEP: f64 = 0.3;

/// When a search ends, and the seed of its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Until {
    /// Most points.
    pub evaluations: u64,
    /// It also ends where [`Cost::worst`] of the best point is this or less.
    pub worst: f64,
    /// Seed.
    pub seed: u64,
}

/// Minimises `cost` from the best of `starts`. The same seed finds the same, on any number of cores.
pub fn minimise(
    starts: &[Vec<f64>],
    until: &Until,
    cost: impl Fn(&[f64]) -> Cost + Sync,
    mut progress: impl FnMut(u64),
) -> Found {
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
        let looked = std::sync::Mutex::new(Vec::new());
        let objective = |x: &DVector<f64>| {
            let found = cost(x.as_slice());
            // Only the least is kept, so the order in which they come does not matter.
            if let Ok(mut looked) = looked.lock() {
                looked.push((x.as_slice().to_vec(), found));
            }
            found.value
        };
        let generations = until.evaluations.saturating_sub(done) / population;
        let mut search = CMAESOptions::new(best.0.clone(), STEP)
            .population_size(population as usize)
            .seed(until.seed)
            // A plain objective on the threads of its own pool: one generation is one parallel step.
            .build(objective)
            .ok();
        for _ in 0..generations {
            if best.1.worst <= until.worst {
                break;
            }
            let Some(running) = &mut search else { break };
            let ended = running.next_parallel().is_some();
            if let Ok(mut looked) = looked.lock() {
                for (point, cost) in looked.drain(..) {
                    let less = cost.value.total_cmp(&best.1.value);
                    // Of two equal ones the one with the lesser coordinates: no matter which was ready first.
                    if less.is_lt() || (less.is_eq() && lesser(&point, &best.0)) {
                        best = (point, cost);
                    }
                }
            }
            done += population;
            progress(done);
            if ended {
                break;
            }
        }
    }
    Found {
        point: best.0,
        cost: best.1,
        evaluations: done,
    }
}

fn lesser(a: &[f64], b: &[f64]) -> bool {
    a.iter()
        .zip(b)
        .map(|(a, b)| a.total_cmp(b))
        .find(|order| order.is_ne())
        .is_some_and(std::cmp::Ordering::is_lt)
}
