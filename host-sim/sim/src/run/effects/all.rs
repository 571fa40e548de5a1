//! The complete list of simulated effects, joined from its parts, and functions that search it.

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

/// All effects: first those from the sensor to the hand, then environments (walls, detents), then velocity filters.
pub const EFFECTS: &[Effect] = &ALL;

/// Finds an effect by its name.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Effect> {
    EFFECTS.iter().find(|effect| effect.name == name)
}

/// Whether two effects set the same setting to different values, so that a scene can have only one of them.
#[must_use]
pub fn exclude_each_other(a: &Effect, b: &Effect) -> bool {
    let one_thing = |of: fn(&Effect) -> bool| of(a) && of(b);
    a.name != b.name
        && (one_thing(|it| ["current-loop", "windings"].contains(&it.name))
            || one_thing(|it| it.field == "law.velocity.from"))
}
