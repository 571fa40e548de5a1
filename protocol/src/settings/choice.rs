//! The settings that are one of a few words.
//!
//! Those of the wall mirror the enums of the control law, variant by variant: the wire has its own, so that reordering the
//! law's does not change what bytes mean. On the wire a choice is its number, for people its word.

use serde::{Deserialize, Serialize};
use touchstone_control as law;

macro_rules! choice {
    (
        $(#[$doc:meta])* $name:ident {
            $($(#[$variant_doc:meta])* $variant:ident = $word:literal,)+
        }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$variant_doc])* #[serde(rename = $word)] $variant,)+
        }

        impl $name {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)+];
            /// Their words, in the order of [`Self::ALL`].
            pub const WORDS: &'static [&'static str] = &[$($word,)+];

            /// Its word.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self { $(Self::$variant => $word,)+ }
            }
        }
    };
}

/// From and to the law's own.
macro_rules! mirror {
    ($name:ident of $other:ty: $($variant:ident)+) => {
        impl From<$other> for $name {
            fn from(other: $other) -> Self {
                match other { $(<$other>::$variant => Self::$variant,)+ }
            }
        }
        impl From<$name> for $other {
            fn from(own: $name) -> Self {
                match own { $($name::$variant => Self::$variant,)+ }
            }
        }
    };
}

mirror!(Law of law::LawKind: Spring SpringDamper Tdpa Fba Sfa SfaContinuous EnhancedSfa);
mirror!(Observer of law::ObserverForm: Exact Thesis);
mirror!(FirstContact of law::FirstContact: KeepForce ZeroOffset);
mirror!(Regulate of law::Regulate: Mass MassCompensated Hip);
mirror!(OffsetUpdate of law::OffsetUpdate: TurnInward Inward EveryTick);
mirror!(IdealStep of law::IdealStep: Position Force);

choice! {
    /// Which law the wall follows.
    Law {
        /// Virtual spring.
        Spring = "spring",
        /// Virtual spring with virtual damping.
        SpringDamper = "spring-damper",
        /// Time-domain passivity approach.
        Tdpa = "tdpa",
        /// Force bounding approach.
        Fba = "fba",
        /// Original successive force augmentation.
        Sfa = "sfa",
        /// The same with the offset changed at every inward tick.
        SfaContinuous = "sfa-continuous",
        /// Enhanced successive force augmentation.
        EnhancedSfa = "enhanced-sfa",
    }
}
choice! {
    /// Which force an observer pairs with a displacement.
    Observer {
        /// The previous one: the true energy.
        Exact = "exact",
        /// The new one, as the thesis writes it.
        Thesis = "thesis",
    }
}
choice! {
    /// What happens to the force when the first contact ends.
    FirstContact {
        /// It goes on.
        KeepForce = "keep-force",
        /// It drops to the soft spring's.
        ZeroOffset = "zero-offset",
    }
}
choice! {
    /// Which stiffness the offset regulates.
    Regulate {
        /// That of the virtual mass, towards `k_de`.
        Mass = "mass",
        /// That of the virtual mass, so that the hand feels `k_de`.
        MassCompensated = "mass-compensated",
        /// That of the hand.
        Hip = "hip",
    }
}
choice! {
    /// When the offset is changed.
    OffsetUpdate {
        /// When the motion turns inward.
        TurnInward = "turn-inward",
        /// At every inward tick.
        Inward = "inward",
        /// At every tick of contact.
        EveryTick = "every-tick",
    }
}
choice! {
    /// What the offset's ideal step supposes of the hand.
    IdealStep {
        /// The position stays.
        Position = "position",
        /// The force stays.
        Force = "force",
    }
}
choice! {
    /// Which encoder is connected.
    EncoderKind {
        /// A and B into the timer.
        Incremental = "incremental",
        /// AS5047P over SPI, parity checked.
        As5047p = "as5047p",
        /// MT6701 over SPI (SSI frame), CRC checked.
        Mt6701 = "mt6701",
    }
}
choice! {
    /// What moves the shaft.
    DriveKind {
        /// The board's bridge and its current loop.
        ThreePhase = "three-phase",
        /// A voltage to an external servo amplifier, which controls the current.
        Analogue = "analogue",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_numbers_stand_in_the_same_order() {
        for (number, (law, word)) in Law::ALL.iter().zip(Law::WORDS).enumerate() {
            let mut buffer = [0; 4];
            let bytes = postcard::to_slice(law, &mut buffer).expect("one byte");
            assert_eq!(bytes, [number as u8]);
            assert_eq!(law.word(), *word);
        }
    }
}
