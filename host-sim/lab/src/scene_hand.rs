//! The hands of the plant as hands of a scene.

use touchstone_sim::scene;
use touchstone_world::plant::Hand;

/// Least stiffness of a simulated hand's spring, N·m/rad. A hand that holds no position pushes through a spring this soft, which
/// acts as a constant force.
const LEAST_STIFFNESS: f64 = 2e-3;

/// Converts a hand from the plant's form to that of a scene.
#[must_use]
pub fn of_plant(hand: &Hand) -> scene::Hand {
    scene::Hand {
        inertia_kg_m2: hand.inertia,
        damping_n_m_s_per_rad: hand.damping,
        stiffness_n_m_per_rad: hand.stiffness.max(LEAST_STIFFNESS),
        pad_damping_n_m_s_per_rad: hand.pad_damping,
        pad_stiffness_n_m_per_rad: hand.pad_stiffness,
    }
}
