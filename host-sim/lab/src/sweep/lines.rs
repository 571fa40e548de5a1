//! Lines that theory predicts in the plane of a map: where the wall's stiffness reaches a known bound, and where the stability
//! certificate changes its verdict.

use super::grid::{Grid, Scenes};
use crate::certify::{self, hands::Family};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use touchstone_sim::scene::Scene;

/// Number of grid points per axis for a predicted line. Between grid points, bisection finds the position of the line.
const NODES: usize = 49;
/// Number of grid points per axis for the certificate's boundary. Each point needs a certificate, which takes milliseconds to
/// compute.
const NODES_OF_CERTIFICATE: usize = 33;
/// Number of bisections on an edge of the grid that a line crosses.
const HALVINGS: u32 = 20;
const HALVINGS_OF_CERTIFICATE: u32 = 6;

/// A line in the plane of the map, on the axes' scales.
#[derive(Debug, Clone)]
pub struct Line {
    /// CSS class of the line.
    pub role: &'static str,
    /// Name of the line in the legend.
    pub name: &'static str,
    /// Straight pieces of the line, each with its two ends.
    pub pieces: Vec<[(f64, f64); 2]>,
}

/// A bound of the wall's stiffness: CSS class, name, and function that gives its value for a scene in N·m/rad.
type Bound = (&'static str, &'static str, fn(&Scene) -> Option<f64>);

/// Mean delay of a force that is held for a control period, s: half a period plus the computational delay.
fn late_s(scene: &Scene) -> f64 {
    0.5 * scene.timing.period_s() + scene.timing.computational_delay_s
}

/// Bounds of the stiffness of a wall that is a plain spring. For other laws they show where a spring would reach its limit. In
/// the names, `T` is the control period, `t_d` the computational delay, `b` the damping of the device, `b_pad` that of the finger
/// pad, and `F_k` the kinetic friction.
const BOUNDS: [Bound; 3] = [
    // Colgate and Schenkel 1997, with the delay as in Gil et al. 2009; c_i is the damping that the law assumes, thesis §5.1.
    ("kc", "k_c = c_i/(T/2 + t_d)", |scene| {
        Some(scene.law.device_damping_n_m_s_per_rad / late_s(scene))
    }),
    ("law-b", "(b + b_pad)/(T/2 + t_d)", |scene| {
        let pad = scene
            .operator
            .hand()
            .map_or(0.0, |hand| hand.pad_damping_n_m_s_per_rad);
        Some((scene.device.damping_n_m_s_per_rad + pad) / late_s(scene))
    }),
    // Abbott and Okamura 2005: dry friction against the energy that rounding to counts gives out.
    ("law-a", "2 F_k/count", |scene| {
        let friction = scene.device.friction.as_ref()?.kinetic_n_m;
        Some(2.0 * friction / scene.encoder.as_ref()?.step_rad())
    }),
];

/// Function that is called with the number of computed certificates and their total number.
pub type Progress<'a> = dyn Fn(u64, u64) + Sync + 'a;

/// All predicted lines that cross the plane; none if an axis has words. With `certificate` they include the boundary of the
/// stability certificate.
#[must_use]
pub fn all(grid: &Grid, certificate: bool, progress: &Progress) -> Vec<Line> {
    if grid.x.numbers().is_none() || grid.y.numbers().is_none() {
        return Vec::new();
    }
    let mut lines: Vec<Line> = Vec::new();
    for (role, name, bound) in BOUNDS {
        let excess = |scene: &Scene| {
            bound(scene)
                .filter(|bound| *bound > 0.0)
                .map(|bound| (scene.wall.k_desired_n_m_per_rad / bound).ln())
        };
        let pieces = traced(grid, NODES, HALVINGS, &excess, &|_, _| {});
        // Two bounds may coincide, if the law assumes exactly the damping that the device and the hand's pad have.
        let known = lines.iter().any(|line| near(&line.pieces, &pieces));
        if !pieces.is_empty() && !known {
            lines.push(Line { role, name, pieces });
        }
    }
    if certificate {
        let options = certify::CertifyOptions {
            family: Family::Own,
            margins: false,
            current_loop_hz: None,
        };
        let stable = |scene: &Scene| {
            let said = certify::certify(scene, &options).ok()?;
            Some(if said.verdict == certify::Verdict::Stable {
                -1.0
            } else {
                1.0
            })
        };
        let (nodes, halvings) = (NODES_OF_CERTIFICATE, HALVINGS_OF_CERTIFICATE);
        let pieces = traced(grid, nodes, halvings, &stable, progress);
        if !pieces.is_empty() {
            lines.push(Line {
                role: "law-g",
                name: "certified stable within",
                pieces,
            });
        }
    }
    lines
}

/// Whether two lines are equal except for rounding.
fn near(a: &[[(f64, f64); 2]], b: &[[(f64, f64); 2]]) -> bool {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(b.abs()).max(1e-30);
    a.len() == b.len()
        && a.iter()
            .flatten()
            .zip(b.iter().flatten())
            .all(|(a, b)| close(a.0, b.0) && close(a.1, b.1))
}

/// Line on which the function `value` of the scene changes its sign. The line is found by marching squares over a grid, with
/// bisection on each edge that it crosses.
fn traced(
    grid: &Grid,
    nodes: usize,
    halvings: u32,
    value: &(dyn Fn(&Scene) -> Option<f64> + Sync),
    progress: &Progress,
) -> Vec<[(f64, f64); 2]> {
    let (x, y) = (grid.x.span(), grid.y.span());
    if x.0 == x.1 || y.0 == y.1 {
        return Vec::new();
    }
    let share = |index: usize| index as f64 / (nodes - 1) as f64;
    let place = |column: f64, row: f64| (x.0 + (x.1 - x.0) * column, y.0 + (y.1 - y.0) * row);
    let at = |scenes: &mut Scenes<'_>, (x, y): (f64, f64)| {
        let scene = scenes.between(grid.x.unscaled(x), grid.y.unscaled(y))?;
        value(&scene).filter(|value| value.is_finite())
    };
    let (done, total) = (AtomicU64::new(0), AtomicU64::new((nodes * nodes) as u64));
    let count = || progress(done.fetch_add(1, Relaxed) + 1, total.load(Relaxed));
    let values: Vec<Option<f64>> = (0..nodes * nodes)
        .into_par_iter()
        .map_init(
            || grid.scenes(),
            |scenes, node| {
                let value = at(scenes, place(share(node % nodes), share(node / nodes)));
                count();
                value
            },
        )
        .collect();
    let inside = |node: usize| values[node].map(|value| value < 0.0);
    // Each edge once, given by its two grid points.
    let mut edges: Vec<[usize; 2]> = Vec::new();
    for node in 0..nodes * nodes {
        if node % nodes + 1 < nodes {
            edges.push([node, node + 1]);
        }
        if node / nodes + 1 < nodes {
            edges.push([node, node + nodes]);
        }
    }
    edges.retain(|[a, b]| matches!((inside(*a), inside(*b)), (Some(a), Some(b)) if a != b));
    total.fetch_add(edges.len() as u64 * u64::from(halvings), Relaxed);
    let crossed: HashMap<[usize; 2], (f64, f64)> = edges
        .into_par_iter()
        .map_init(
            || grid.scenes(),
            |scenes, [a, b]| {
                let node = |node: usize| place(share(node % nodes), share(node / nodes));
                let (mut near, mut far) = (node(a), node(b));
                let begins = inside(a) == Some(true);
                for _ in 0..halvings {
                    let middle = (0.5 * (near.0 + far.0), 0.5 * (near.1 + far.1));
                    let same = at(scenes, middle).map_or(begins, |value| value < 0.0) == begins;
                    count();
                    if same {
                        near = middle;
                    } else {
                        far = middle;
                    }
                }
                ([a, b], (0.5 * (near.0 + far.0), 0.5 * (near.1 + far.1)))
            },
        )
        .collect();
    let mut pieces = Vec::new();
    for row in 0..nodes - 1 {
        for column in 0..nodes - 1 {
            let corner = row * nodes + column;
            let around = [
                [corner, corner + 1],
                [corner + 1, corner + 1 + nodes],
                [corner + nodes, corner + nodes + 1],
                [corner, corner + nodes],
            ];
            let ends: Vec<(f64, f64)> = around
                .iter()
                .filter_map(|edge| crossed.get(edge).copied())
                .collect();
            // A square has two ends of a line or, at a saddle, four.
            pieces.extend(ends.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
        }
    }
    pieces
}
