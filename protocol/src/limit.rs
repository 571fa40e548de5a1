//! Limits that reduce the force without being a fault. They are reported beside the faults, with codes of their own.

/// A limit that acts. The numbers are bits on the wire and never change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Limit {
    /// The power stage is warm: the current is derated.
    Temperature = 0,
    /// The wanted torque needs more current than is allowed.
    Current = 1,
    /// The bus voltage is too low for the wanted current.
    Voltage = 2,
    /// The law's force is at the limit that its settings give it.
    Force = 3,
    /// The torque is still being faded in after arming.
    FadeIn = 4,
    /// The encoder's reading was bad in this tick and the outputs are off until it is good again; too many in a row are a fault.
    Encoder = 5,
    /// Nothing is held back, but the force is not that of the wall alone: further walls or detents are at work.
    Beside = 6,
    /// The knob is more than 20 turns inside of a wall, further than positions reach: this wall is off.
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

    /// The set of this one.
    #[must_use]
    pub const fn bit(self) -> u8 {
        1 << (self as u8)
    }
}

/// The limits that act at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Limits(u8);

impl Limits {
    /// No limit acts.
    pub const NONE: Self = Self(0);

    /// Reads the bits from the wire; unknown bits are kept.
    #[must_use]
    pub const fn from_wire(bits: u8) -> Self {
        Self(bits)
    }

    /// The bits on the wire.
    #[must_use]
    pub const fn to_wire(self) -> u8 {
        self.0
    }

    /// Whether this limit acts.
    #[must_use]
    pub const fn has(self, limit: Limit) -> bool {
        self.0 & limit.bit() != 0
    }

    /// Adds this limit, if it acts.
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
