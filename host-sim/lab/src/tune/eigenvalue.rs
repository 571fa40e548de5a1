//! The largest eigenvalue of the loop of law, device and hand, as a criterion for a search of settings.

use crate::certify::contact::Contact;
use crate::certify::hands::GRIPS;
use touchstone_sim::scene::Scene;

/// Factors on the loop's gain at which the loop should be stable. Encoder counts, friction and a contact that is lost at times
/// have effects like changes of the gain.
const GAINS: [f64; 3] = [0.7, 1.0, 1.3];

/// Largest magnitude of an eigenvalue of the loop, over grips, phases of the law and `GAINS`; infinite if the law refuses its
/// settings.
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
