//! The reasons why an environment's settings are refused.

use crate::{SettingsError, Si};
use core::fmt;

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

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyWalls => write!(f, "more than {} walls", super::MOST_WALLS),
            Self::Law(error) => error.fmt(f),
            Self::Wall(_, error) => error.fmt(f),
            Self::Pitch(pitch) => write!(
                f,
                "a pitch of {pitch:.6} rad is outside {} to {} rad",
                super::detents::FINEST,
                super::detents::COARSEST
            ),
            Self::PerTurn(per_turn) => write!(
                f,
                "{per_turn} in a turn are outside 1 to {}",
                super::detents::MOST
            ),
            Self::Points(points) => {
                write!(f, "{points} points are outside 2 to {}", super::MOST_POINTS)
            }
            Self::Point(point) => {
                write!(f, "a point of {point} is outside -{0} to {0}", super::WHOLE)
            }
            Self::Length(length) => write!(
                f,
                "a profile of {length:.6} rad is outside {} to {} rad",
                super::profile::SHORTEST,
                super::profile::LONGEST
            ),
            Self::Part {
                path,
                value,
                least,
                most,
            } => write!(f, "{path} = {value:.6} is outside {least:.6} to {most:.6}"),
            Self::PartOfFormat { path, value } => {
                write!(f, "{path} = {value:.6} does not fit the number format")
            }
            Self::Strength { strength, limit } | Self::ProfileStrength { strength, limit } => {
                write!(
                    f,
                    "{strength:.6} N·m is outside 0 to the force limit of {limit:.6} N·m"
                )
            }
        }
    }
}

// This implementation computes nothing, so the model checker's build leaves it out.
#[cfg(not(kani))]
impl core::error::Error for Refused {}
