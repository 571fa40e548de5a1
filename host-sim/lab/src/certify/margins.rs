//! Stability margins: how much delay, inertia or stiffness may change before the loop becomes unstable.

use super::contact::Contact;
use serde::Serialize;
use touchstone_sim::scene::Scene;
use touchstone_world::plant::Hand;

/// Stability margins: how much delay, inertia or stiffness may change until the largest eigenvalue of any phase, with any examined
/// hand, reaches magnitude 1.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Margins {
    /// Additional delay at which the loop becomes unstable, s; 0 if the loop is unstable as it is.
    pub delay_s: f64,
    /// Whether the loop was still stable at the longest delay that was examined.
    pub delay_beyond: bool,
    /// Smallest factor on the inertia with which the loop is stable, at least `1/64`, where the search ends. `None` if the loop is
    /// unstable as it is.
    pub inertia_down: Option<f64>,
    /// Largest factor on the inertia with which the loop is stable, at most 64, where the search ends. `None` if the loop is
    /// unstable as it is.
    pub inertia_up: Option<f64>,
    /// Ranges of the requested stiffness `k_de` in N·m/rad in which the loop is stable, between a hundredth and a hundred times the
    /// scene's. The law's other settings are unchanged.
    pub k_desired: Vec<[f64; 2]>,
}

/// Longest additional delay that is examined, in ticks (control periods).
const LONGEST_TICKS: f64 = 16.0;
/// Number of requested stiffnesses that are examined.
const POINTS: i32 = 60;

fn radius(contact: &Contact, hands: &[Hand]) -> f64 {
    if hands.is_empty() {
        return contact.radius(None);
    }
    hands
        .iter()
        .map(|hand| contact.radius(Some(hand)))
        .fold(0.0, f64::max)
}

/// Finds the limit between a stable and an unstable value by bisection; on a logarithmic scale if both values are positive.
fn edge(mut stable: f64, mut unstable: f64, is_stable: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..24 {
        let middle = if stable > 0.0 && unstable > 0.0 {
            (stable * unstable).sqrt()
        } else {
            0.5 * (stable + unstable)
        };
        if is_stable(middle) {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    stable
}

/// Computes the stability margins over the given hands.
#[must_use]
pub fn of(scene: &Scene, contact: &Contact, hands: &[Hand]) -> Margins {
    let stable_now = radius(contact, hands) < 1.0;
    let (delay_s, delay_beyond) = delay(contact, hands, stable_now);
    let inertia = |direction: f64| {
        let is_stable = |factor: f64| radius(&contact.with_inertia(factor), hands) < 1.0;
        let mut last = 1.0;
        for step in 1..=24 {
            let factor = (direction * 64_f64.ln() * f64::from(step) / 24.0).exp();
            if !is_stable(factor) {
                return edge(last, factor, is_stable);
            }
            last = factor;
        }
        last
    };
    Margins {
        delay_s,
        delay_beyond,
        inertia_down: stable_now.then(|| inertia(-1.0)),
        inertia_up: stable_now.then(|| inertia(1.0)),
        k_desired: stiffnesses(scene, contact, hands),
    }
}

fn delay(contact: &Contact, hands: &[Hand], stable_now: bool) -> (f64, bool) {
    if !stable_now {
        return (0.0, false);
    }
    let period = contact.clock.period_s;
    let is_stable = |more_s: f64| radius(&contact.with_delay(more_s), hands) < 1.0;
    let mut last = 0.0;
    let mut step = period / 8.0;
    // The shortest delay that makes the loop unstable is the margin, even if a longer delay is stable again.
    while last < LONGEST_TICKS * period {
        let next = last + step;
        if !is_stable(next) {
            return (edge(last, next, is_stable), false);
        }
        last = next;
        step = (period / 8.0).max(last / 8.0);
    }
    (last, true)
}

fn stiffnesses(scene: &Scene, contact: &Contact, hands: &[Hand]) -> Vec<[f64; 2]> {
    let is_stable = |stiffness: f64| {
        let mut other = scene.clone();
        other.wall.k_desired_n_m_per_rad = stiffness;
        // A stiffness that the law does not accept counts as not stable.
        Contact::of(&other).is_ok_and(|mut other| {
            other.current_loop_hz = contact.current_loop_hz;
            other.estimator = contact.estimator;
            radius(&other, hands) < 1.0
        })
    };
    let at = |index: i32| {
        contact.k_desired * 10f64.powf(4.0 * f64::from(index) / f64::from(POINTS) - 2.0)
    };
    let mut ranges: Vec<[f64; 2]> = Vec::new();
    let mut before = None;
    for index in 0..=POINTS {
        let (value, stable) = (at(index), is_stable(at(index)));
        match (before, stable) {
            (None, true) => ranges.push([value, value]),
            (Some((other, false)), true) => {
                ranges.push([edge(value, other, is_stable), value]);
            }
            (Some((other, true)), false) => {
                if let Some(range) = ranges.last_mut() {
                    range[1] = edge(other, value, is_stable);
                }
            }
            (Some((_, true)), true) => {
                if let Some(range) = ranges.last_mut() {
                    range[1] = value;
                }
            }
            (_, false) => {}
        }
        before = Some((value, stable));
    }
    ranges
}
