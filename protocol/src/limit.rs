//! Limits that act on the force but are no fault. The device reports them beside the faults, with codes of their own.

/// A limit that acts in a control tick. The number is the limit's bit position on the wire and never changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Limit {
    /// The power stage or the motor is warm, so the device reduces the current limit.
    Temperature = 0,
    /// The requested torque needs more current than is allowed.
    Current = 1,
    /// The bus voltage is too low for the requested current.
    Voltage = 2,
    /// The force of the control law is at the largest force that the law's settings allow.
    Force = 3,
    /// The torque is still fading in after the outputs were switched on (arming).
    FadeIn = 4,
    /// The encoder's reading was bad in this tick. The outputs are off until a reading is good; too many bad ones in a row are a
    /// fault.
    Encoder = 5,
    /// Not a limit but a note: the force is that of an environment (walls, detents, torque profile) and not of the settings' wall
    /// alone.
    Beside = 6,
    /// The knob is more than 20 turns inside a wall, beyond the range of the position's number format: this wall is off.
    Reach = 7,
}

impl Limit {
    /// All limits, in the order of their bits.
    pub const ALL: [Self; 8] = [
        Self::Temperature,
        Self::Current,
        Self::Voltage,
        Self::Force,
        Self::FadeIn,
        Self::Encoder,
        Self::Beside,
        Self::Reach,
    ];

    /// The bit mask of this limit.
    #[must_use]
    pub const fn bit(self) -> u8 {
        1 << (self as u8)
    }
}

/// The set of limits that act in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Limits(u8);

impl Limits {
    /// The empty set: no limit acts.
    pub const NONE: Self = Self(0);

    /// The set of limits from its bits on the serial link; unknown bits are kept.
    #[must_use]
    pub const fn from_wire(bits: u8) -> Self {
        Self(bits)
    }

    /// The bits of the set of limits, for the serial link.
    #[must_use]
    pub const fn to_wire(self) -> u8 {
        self.0
    }

    /// Whether this limit acts, that is whether it is in the set.
    #[must_use]
    pub const fn has(self, limit: Limit) -> bool {
        self.0 & limit.bit() != 0
    }

    /// The set with `limit` added if `acts` is true.
    #[must_use]
    pub const fn with(self, limit: Limit, acts: bool) -> Self {
        if acts {
            Self(self.0 | limit.bit())
        } else {
            self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_limit_has_a_bit_of_its_own() {
        let mut all = Limits::NONE;
        for (bit, limit) in Limit::ALL.into_iter().enumerate() {
            assert_eq!(limit.bit(), 1 << bit);
            assert!(!all.has(limit));
            all = all.with(limit, false);
            assert!(!all.has(limit));
            all = all.with(limit, true);
            assert!(all.has(limit));
        }
        assert_eq!(Limits::from_wire(all.to_wire()), all);
    }
}
