//! The loop's largest eigenvalue, for a search.

use crate::certify::contact::Contact;
use crate::certify::hands::GRIPS;
use touchstone_sim::scene::Scene;

/// Gains of the position that a loop should survive: counts, friction and a touch that is lost at times all act as such.
const GAINS: [f64; 3] = [0.7, 1.0, 1.3];

/// Largest eigenvalue of the loop over grips, phases and `GAINS`; infinite for settings that the law refuses.
#[must_use]
pub fn radius(scene: &Scene) -> f64 {
    let Ok(contact) = Contact::of(scene) else {
        return f64::INFINITY;
    };
    GRIPS
        .iter()
        .flat_map(|(_, hand)| GAINS.map(|gain| contact.radius_at_gain(Some(hand), gain)))
        .fold(0.0, f64::max)
}
