//! The table made of its parts, and how to find one's way in it.

use super::{Effect, WORLD, touch};

const ALL: [Effect; WORLD.len() + touch::ROWS.len()] = {
    let mut all = [WORLD[0]; WORLD.len() + touch::ROWS.len()];
    let mut row = 0;
    while row < all.len() {
        all[row] = if row < WORLD.len() {
            WORLD[row]
        } else {
            touch::ROWS[row - WORLD.len()]
        };
        row += 1;
    }
    all
};

/// All effects, from the sensor to the hand; then what there is to touch, and how a damper comes to its velocity.
pub const EFFECTS: &[Effect] = &ALL;

/// The effect of this name.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Effect> {
    EFFECTS.iter().find(|effect| effect.name == name)
}

/// Whether two effects are two values of one thing, so that a scene has one of them at most.
#[must_use]
pub fn exclude_each_other(a: &Effect, b: &Effect) -> bool {
    let one_thing = |of: fn(&Effect) -> bool| of(a) && of(b);
    a.name != b.name
        && (one_thing(|it| ["current-loop", "windings"].contains(&it.name))
            || one_thing(|it| it.field == "law.velocity.from"))
}
