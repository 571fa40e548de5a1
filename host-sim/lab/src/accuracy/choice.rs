//! "To be within one encoder count choose …, it costs …"

use serde::Serialize;

use super::COUNT_RAD;
use super::plant::{Diagram, Point};

/// The cheapest that is within a count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cheapest {
    /// The integration method.
    pub method: &'static str,
    /// Substeps a tick; absent for the exact step.
    pub substeps: Option<u32>,
    /// The method's error, rad.
    pub error_rad: f64,
    /// The method's least time per simulated millisecond, ns.
    pub least_ns: f64,
}

/// The recommended choice for one problem.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Chosen {
    /// The name of the problem.
    pub problem: &'static str,
    /// Cheapest of all; absent: nothing is within a count.
    pub of_all: Option<Cheapest>,
    /// Cheapest without the exact step; it and every finer number of its substeps are within a count.
    pub without_exact: Option<Cheapest>,
    /// How many times the exact step's time that takes.
    pub times_the_exact: Option<f64>,
}

impl Chosen {
    /// The choice from a diagram.
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

/// With events an error does not fall evenly: one that is small by chance is no choice.
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
