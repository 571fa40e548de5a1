//! Evaluates settings by the eigenvalues of the loop alone, which is a thousand times faster than simulated runs.
//!
//! If the wall does not hold the device in any grip, simulated runs do not show in which direction settings become better;
//! eigenvalues do. A search therefore begins at the settings with the best eigenvalues.

use super::cost::Cost;
use super::eigenvalue::radius;
use super::parameters::{Axis, at};
use super::search::{self, Until};
use crate::certify::contact::Contact;
use crate::certify::state_space::StateSpace;
use crate::scorecard::rivals::Rival;
use nalgebra::{Complex, DMatrix};
use std::f64::consts::TAU;
use touchstone_sim::scene::Scene;

/// Number of settings that a search examines, per tuned parameter.
const LOOKS_PER_PARAMETER: u64 = 60;
/// Frequency at which an oscillating hand should meet the requested stiffness, Hz.
const MOVING_HZ: f64 = 4.0;
/// Cost of settings for which there is no loop, or no finite eigenvalue.
const REFUSED: f64 = 1e3;

/// Cost of settings, from the growth rate of the slowest motion and the deviation of the law's force over position from the
/// requested stiffness at 4 Hz.
fn cost(scene: &Scene) -> f64 {
    let Ok(contact) = Contact::of(scene) else {
        return REFUSED;
    };
    let radius = radius(scene);
    if !radius.is_finite() {
        return REFUSED;
    }
    let period_s = contact.clock.period_s;
    // Growth rate of the slowest motion, as a multiple of 50 1/s, the rate of decay that a brisk hand needs.
    let growth = (radius.ln() / period_s / 50.0).clamp(-1.0, 100.0);
    let stiffness = contact.phases.lasting.last().and_then(|phase| {
        let lag_s = contact.clock.delay_s + 0.5 * period_s;
        response(&contact.law(&phase.law), TAU * MOVING_HZ, period_s, lag_s)
    });
    let off = stiffness.map_or(1.0, |stiffness| {
        (stiffness / contact.k_desired - Complex::new(1.0, 0.0)).norm()
    });
    growth + 3.0 * (off - 0.05).max(0.0)
}

/// Frequency response of a control law from position to force, at the angular frequency `omega` in rad/s, delayed by `lag_s`.
/// `None` if it is infinite.
fn response(law: &StateSpace, omega: f64, period_s: f64, lag_s: f64) -> Option<Complex<f64>> {
    let z = Complex::from_polar(1.0, omega * period_s);
    let order = law.order();
    let complex = |x: f64| Complex::new(x, 0.0);
    let matrix = DMatrix::from_diagonal_element(order, order, z) - law.a.map(complex);
    let state = matrix.lu().solve(&law.b.map(complex))?;
    let through: Complex<f64> = state
        .iter()
        .zip(law.c.iter())
        .map(|(state, c)| state * *c)
        .sum();
    Some((through + complex(law.d)) * Complex::from_polar(1.0, -omega * lag_s))
}

/// Searches the settings with the best eigenvalues of the loop, beginning at the best of `starts`.
pub fn start(
    rival: &Rival,
    scene: &Scene,
    axes: &[Axis],
    starts: &[Vec<f64>],
    seed: u64,
) -> Vec<f64> {
    let until = Until {
        evaluations: LOOKS_PER_PARAMETER * axes.len() as u64,
        worst: -1.0,
        seed,
    };
    search::minimise(
        starts,
        &until,
        |point| Cost {
            value: cost(&at(rival, scene, axes, point)),
            worst: 0.0,
        },
        |_| (),
    )
    .point
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_response_of_a_spring_is_its_stiffness_with_its_lag() {
        let spring = StateSpace::of(1, |state, e| {
            let force = 5.0 * e + 2.0 * (e - state[0]);
            state[0] = e;
            force
        });
        let (omega, period_s) = (TAU * 4.0, 1e-3);
        let found = response(&spring, omega, period_s, 1.5e-3).unwrap();
        // 5 + 2 (1 - exp(-iωT)), rotated by the lag.
        let back = Complex::from_polar(1.0, -omega * period_s);
        let expected =
            (Complex::new(7.0, 0.0) - back * 2.0) * Complex::from_polar(1.0, -omega * 1.5e-3);
        assert!((found - expected).norm() < 1e-12, "{found} {expected}");
    }

    #[test]
    fn a_lost_wall_is_worse_than_a_good_one_and_a_more_lost_one_worse_still() {
        let of = |damping: f64| {
            let mut scene = Rival::named("spring-damper-estimated")
                .unwrap()
                .to_tune(&Scene::load("thesis-knob").unwrap());
            scene.law.virtual_damping_n_m_s_per_rad = damping;
            cost(&scene)
        };
        assert!(
            of(0.02) < of(0.15) && of(0.15) < of(0.3),
            "{} {} {}",
            of(0.02),
            of(0.15),
            of(0.3)
        );
    }
}
