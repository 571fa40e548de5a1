//! Why a wall of [`super::held_out`] is beyond a limit, by one thing changed at a time.

use super::held_out::Drawn;
use super::mechanism::Mechanism;
use crate::identify::lever::PRESS_SHARE;
use serde::Serialize;

/// Why a wall is beyond a limit: the single change that brings every figure within.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeldOutCause {
    /// The push: the motors were at their limit, and are not with the scorecard's own push.
    MotorsLimit,
    /// The delay: without it it is within.
    Delay,
    /// The device's damping, which differs from what the law assumes.
    Damping,
    /// The device's inertia, which differs from what the law assumes.
    Inertia,
    /// No single change.
    NoneAlone,
}

impl HeldOutCause {
    /// The causes that are tried, in this order.
    pub const TRIED: [Self; 4] = [Self::MotorsLimit, Self::Delay, Self::Damping, Self::Inertia];

    /// Text for people.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::MotorsLimit => "its push, which asks the motors for more than they have",
            Self::Delay => "its delay",
            Self::Damping => "its damping",
            Self::Inertia => "its inertia",
            Self::NoneAlone => "no one thing alone",
        }
    }

    /// The wall without it.
    #[must_use]
    pub fn mended(self, drawn: &Drawn) -> Drawn {
        let mut mended = *drawn;
        let deviation = &mut mended.deviation;
        match self {
            Self::MotorsLimit => mended.push_n = PRESS_SHARE * Mechanism::Cartesian.force_n(),
            Self::Delay => deviation.delay_ticks = 0.0,
            Self::Damping => deviation.damping = 1.0,
            Self::Inertia => deviation.inertia = 1.0,
            Self::NoneAlone => {}
        }
        mended
    }
}
