//! A 64-bit FNV-1a hash (Fowler, Noll, Vo) over every bit of the results of a control period.

use touchstone_control::law::{Contact, View};
use touchstone_control::{Energy, Fixed16, Fixed32, Force, Number, Position};

/// A fixed-point format whose values can be read as sign-extended integers.
pub trait Bits: Number {
    /// A position or force as a sign-extended integer.
    fn signal_bits(x: Self::Signal) -> i32;
    /// An energy as a sign-extended integer.
    fn energy_bits(e: Self::Energy) -> i64;
}

macro_rules! bits {
    ($number:ty) => {
        impl Bits for $number {
            fn signal_bits(x: Self::Signal) -> i32 {
                i32::from(x.to_bits())
            }
            fn energy_bits(e: Self::Energy) -> i64 {
                i64::from(e.to_bits())
            }
        }
    };
}
bits!(Fixed32);
bits!(Fixed16);

/// A hash over the results of all control periods so far.
#[derive(Debug, Clone, Copy)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// The hash of everything that was added so far.
    #[must_use]
    pub fn value(&self) -> u64 {
        self.0
    }

    /// Adds bytes to the hash.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Adds one control period to the hash: penetration, force, and the law's internal values (`view`).
    pub fn tick<N: Bits>(&mut self, e: Position<N>, force: Force<N>, view: &View<N>) {
        self.signal::<N>(e.0);
        self.signal::<N>(force.0);
        self.signal::<N>(view.offset.0);
        let contact = match view.contact {
            Contact::Free => 0,
            Contact::First => 1,
            Contact::Augmenting => 2,
        };
        let present = u8::from(view.energy.is_some()) << 4 | u8::from(view.mass.is_some()) << 5;
        self.bytes(&[contact | present]);
        if let Some(Energy(energy)) = view.energy {
            self.bytes(&N::energy_bits(energy).to_le_bytes());
        }
        if let Some(Position(mass)) = view.mass {
            self.signal::<N>(mass);
        }
    }

    fn signal<N: Bits>(&mut self, x: N::Signal) {
        self.bytes(&N::signal_bits(x).to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::Digest;

    #[test]
    fn the_digest_is_the_published_one() {
        // Test vectors of the FNV reference.
        for (text, expected) in [
            ("", 0xcbf2_9ce4_8422_2325),
            ("a", 0xaf63_dc4c_8601_ec8c),
            ("foobar", 0x8594_4171_f739_67e8),
        ] {
            let mut digest = Digest::default();
            digest.bytes(text.as_bytes());
            assert_eq!(digest.value(), expected, "{text}");
        }
    }
}
