//! The reasons why an environment's settings are refused.

use crate::{SettingsError, Si};

/// Why an environment's settings are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refused {
    /// There are more walls than [`super::MOST_WALLS`].
    TooManyWalls,
    /// A setting of the law or of the guard is refused.
    Law(SettingsError),
    /// A setting of one wall is refused. The number is the wall's index, counted from 0.
    Wall(u8, SettingsError),
    /// The distance between detents is out of its range; holds the given distance, rad (m).
    Pitch(Si),
    /// The number of detents, or of a profile's copies, per turn is outside 1 to 6283; holds the given number.
    PerTurn(u16),
    /// The detents' largest force is below 0 or above the force limit, N·m (N).
    Strength {
        /// The given strength, N·m (N).
        strength: Si,
        /// The force limit, N·m (N).
        limit: Si,
    },
    /// A torque profile has fewer than 2 points, or more than [`super::MOST_POINTS`]; holds the number of points.
    Points(usize),
    /// A point of a torque profile is beyond -10,000 to 10,000; holds the given value.
    Point(i16),
    /// The distance between the ends of a torque profile is out of its range; holds the given distance, rad (m).
    Length(Si),
    /// The strength of a torque profile (its largest force) is below 0 or above the force limit, N·m (N).
    ProfileStrength {
        /// The given strength, N·m (N).
        strength: Si,
        /// The force limit, N·m (N).
        limit: Si,
    },
    /// A setting of a part of the feel (spring to a centre, friction, click, inertia) is outside its range.
    Part {
        /// Path of the setting in a scene.
        path: &'static str,
        /// The given value.
        value: Si,
        /// Smallest allowed value.
        least: Si,
        /// Largest allowed value.
        most: Si,
    },
    /// A part's coefficient does not fit the number format.
    PartOfFormat {
        /// Path of the setting in a scene.
        path: &'static str,
        /// The given value.
        value: Si,
    },
}

/// Refuses a value outside its range, with the setting's path in a scene.
pub(super) fn within(path: &'static str, value: Si, least: Si, most: Si) -> Result<(), Refused> {
    if value < least || value > most {
        return Err(Refused::Part {
            path,
            value,
            least,
            most,
        });
    }
    Ok(())
}
