//! What a message says about a refused setting of an environment.

use super::Refused;
use core::fmt;

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
