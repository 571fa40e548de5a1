//! Chooses the integration method whose error is within one encoder count at the least computing time.

use serde::Serialize;

use super::COUNT_RAD;
use super::plant::{Diagram, Point};

/// The fastest method whose error is within one encoder count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cheapest {
    /// Name of the integration method.
    pub method: &'static str,
    /// Substeps per tick (control period); absent for the closed-form solution.
    pub substeps: Option<u32>,
    /// Largest error of the method's angle, rad.
    pub error_rad: f64,
    /// Least measured computing time per simulated millisecond, ns.
    pub least_ns: f64,
}

/// The recommended method for one problem.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Chosen {
    /// Name of the test problem.
    pub problem: &'static str,
    /// The fastest of all integration methods; absent if the error of each exceeds one encoder count.
    pub of_all: Option<Cheapest>,
    /// The fastest integration method other than the closed-form solution, with its number of substeps. Its error is within one
    /// encoder count at this number of substeps and at every larger one.
    pub without_exact: Option<Cheapest>,
    /// Computing time of the method in `without_exact`, divided by that of the closed-form solution.
    pub times_the_exact: Option<f64>,
}

impl Chosen {
    /// Picks the fastest methods from the measurements of one problem.
    #[must_use]
    pub fn of(diagram: &Diagram) -> Self {
        let exact = diagram.points.iter().find(|point| point.substeps.is_none());
        let of_all = cheapest(&diagram.points.iter().collect::<Vec<_>>());
        let others: Vec<&Point> = diagram
            .points
            .iter()
            .filter(|point| point.substeps.is_some() && holds_from_here(point, diagram))
            .collect();
        let without_exact = cheapest(&others);
        let times_the_exact = without_exact
            .as_ref()
            .zip(exact)
            .map(|(other, exact)| other.least_ns / exact.time.least_ns);
        Self {
            problem: diagram.problem,
            of_all,
            without_exact,
            times_the_exact,
        }
    }
}

fn within(point: &Point) -> bool {
    point.error_rad.is_some_and(|error| error <= COUNT_RAD)
}

/// Whether a method's error is within one encoder count at this number of substeps and at every larger one. If the device stops and
/// starts, an error does not fall steadily with the substeps, so a single small error may be chance.
fn holds_from_here(point: &Point, diagram: &Diagram) -> bool {
    diagram
        .points
        .iter()
        .filter(|other| other.method == point.method && other.substeps >= point.substeps)
        .all(within)
}

fn cheapest(points: &[&Point]) -> Option<Cheapest> {
    points
        .iter()
        .filter(|point| within(point))
        .min_by(|a, b| a.time.least_ns.total_cmp(&b.time.least_ns))
        .and_then(|point| {
            Some(Cheapest {
                method: point.method,
                substeps: point.substeps,
                error_rad: point.error_rad?,
                least_ns: point.time.least_ns,
            })
        })
}
