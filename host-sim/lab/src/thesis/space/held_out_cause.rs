//! Finds the cause why a wall of [`super::held_out`] is beyond a limit, by one change at a time.

use super::held_out_draw::Drawn;
use super::mechanism::Mechanism;
use crate::identify::lever::PRESS_SHARE;
use serde::Serialize;

/// Cause why a wall is beyond a limit: the single change with which every measure is within its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeldOutCause {
    /// The push, which needed more force than the motors have. With the scorecard's own push the measures are within their limits.
    MotorsLimit,
    /// The delay of the device. Without the delay the measures are within their limits.
    Delay,
    /// The device's damping, which differs from the damping that the law assumes.
    Damping,
    /// The device's inertia, which differs from the inertia that the law assumes.
    Inertia,
    /// No single change brings all measures of the wall within their limits.
    NoneAlone,
}

impl HeldOutCause {
    /// The causes in the order in which they are tried.
    pub const TRIED: [Self; 4] = [Self::MotorsLimit, Self::Delay, Self::Damping, Self::Inertia];

    /// Description of the cause for readers.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::MotorsLimit => "its push, which asks the motors for more than they have",
            Self::Delay => "its delay",
            Self::Damping => "its damping",
            Self::Inertia => "its inertia",
            Self::NoneAlone => "no single change",
        }
    }

    /// The random wall with this cause removed.
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
