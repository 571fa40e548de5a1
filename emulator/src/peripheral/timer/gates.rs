//! The gate drivers on a board: they turn the levels of TIM1's outputs into the states of the transistors.
//!
//! The levels that switch a driver off come from the drivers' data, not from the program. So the tests find a program whose "off"
//! levels do not switch the driver off.

/// State of the upper and lower transistor of a phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leg {
    /// Neither transistor conducts.
    Open,
    /// The upper transistor conducts.
    Upper,
    /// The lower transistor conducts.
    Lower,
}

/// The gate drivers of the three phases, by type. A driver input that is not driven is pulled to its off level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GateDriver {
    /// HIN switches the upper transistor on when high, LIN the lower one when high. With HIN and LIN active at once, neither
    /// transistor conducts.
    L6387,
    /// HIN switches the upper transistor on when high, LIN the lower one when low. With HIN and LIN active at once, neither
    /// transistor conducts.
    L6398,
    /// Each phase has an input and an enable. While the enable is high, the input selects the upper or the lower transistor. While
    /// the enable is low, neither conducts. While the line EN\FAULT is low, none of the six transistors conducts.
    Stspin830,
    /// One input per phase, and one enable for all three, which is wired to the first complementary output of the timer. A fault
    /// that the driver detects switches all phases off until the fault is gone; an over-current, until the supply is switched off.
    Drv8313,
}

impl GateDriver {
    /// State of a phase's transistors for the levels of its two inputs, upper and lower; `None` where the pins are not driven.
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

    /// Fraction (0 to 1) of the time for which a phase is connected to the bus voltage. The phase is in state `first` for the
    /// fraction `share`, and in state `second` for the rest. `None` if a state is open; a phase that is driven for a part of the
    /// time only is not modelled.
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
