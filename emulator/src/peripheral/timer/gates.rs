//! From the levels of TIM1's outputs to transistors: the gate drivers on a board.
//!
//! Deliberately not taken from the program: a level that the program thinks is "off" and the driver does not must show.

/// State of a transistor pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leg {
    /// Neither transistor conducts.
    Open,
    /// The upper transistor conducts.
    Upper,
    /// The lower transistor conducts.
    Lower,
}

/// The drivers of the three pairs. An input that nothing drives is pulled to its off level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GateDriver {
    /// HIN and LIN switch on when high; both high is refused.
    L6387,
    /// HIN switches on when high, LIN when low; both at once is refused.
    L6398,
    /// An input and an enable a phase: while the enable is high, the input chooses between the two. Both transistors are off while it is
    /// low, and all six while the line EN\FAULT is.
    Stspin830,
    /// One input a channel and one enable for all three, which is wired to the first of the timer's complementary
    /// outputs. A fault that the driver finds switches all three off until it is gone; over-current, until the supply
    /// is off.
    Drv8313,
}

impl GateDriver {
    /// State of a pair for the levels of its two inputs, upper and lower; `None` where the pin is not driven.
    #[must_use]
    pub fn leg(self, levels: Option<(bool, bool)>) -> Leg {
        let Some((upper, second)) = levels else {
            return Leg::Open;
        };
        let lower = match self {
            Self::L6387 => second,
            Self::L6398 => !second,
            Self::Stspin830 | Self::Drv8313 => {
                return match (second, upper) {
                    (false, _) => Leg::Open,
                    (true, true) => Leg::Upper,
                    (true, false) => Leg::Lower,
                };
            }
        };
        match (upper, lower) {
            (true, false) => Leg::Upper,
            (false, true) => Leg::Lower,
            _ => Leg::Open,
        }
    }

    /// The share of the time at the bus of a pair that switches between two states, by the share of the first; `None` where it does
    /// not drive its phase, or only part of the time, which is not modelled.
    #[must_use]
    pub fn share(first: Leg, second: Leg, share: f64) -> Option<f64> {
        match (first, second) {
            (Leg::Upper, Leg::Lower) => Some(share),
            (Leg::Lower, Leg::Upper) => Some(1.0 - share),
            (Leg::Upper, Leg::Upper) => Some(1.0),
            (Leg::Lower, Leg::Lower) => Some(0.0),
            _ => None,
        }
    }
}
