//! Settings: what a person chooses, in SI, exact and without floats, so that a microcontroller validates the very same
//! values by the very same code as the desktop.

/// An SI value in `I32F32`: ±2.1e9 in steps of 2.3e-10.
pub type Si = fixed::types::I32F32;

use crate::ObserverForm;

crate::choice! {
    /// Which law.
    LawKind {
        /// Virtual spring (1.6).
        Spring = "spring",
        /// Virtual spring with virtual damping (§1.2.6).
        SpringDamper = "spring-damper",
        /// Time-domain passivity approach.
        Tdpa = "tdpa",
        /// Force bounding approach.
        Fba = "fba",
        /// Original successive force augmentation.
        Sfa = "sfa",
        /// Successive force augmentation with the offset changed at every inward tick.
        SfaContinuous = "sfa-continuous",
        /// Enhanced successive force augmentation.
        #[default]
        EnhancedSfa = "enhanced-sfa",
    }
}

crate::choice! {
    /// What happens to the force when the first contact ends.
    FirstContact {
        /// The offset is set so that the force goes on (2.17).
        KeepForce = "keep-force",
        /// The offset stays zero and the force drops to the soft spring's (§3.2): the stable choice.
        #[default]
        ZeroOffset = "zero-offset",
    }
}

crate::choice! {
    /// Which stiffness the offset regulates.
    Regulate {
        /// Force over position of the virtual mass, towards `k_de`: the HIP feels less, by (3.4).
        Mass = "mass",
        /// The same, towards the stiffness of (3.5), so that the HIP feels `k_de`; needs `k_de < k_f`.
        MassCompensated = "mass-compensated",
        /// Force over position of the HIP, towards `k_de` (3.6).
        #[default]
        Hip = "hip",
    }
}

crate::choice! {
    /// When the offset is changed.
    OffsetUpdate {
        /// When the motion turns from outward to inward (2.14).
        TurnInward = "turn-inward",
        /// At every inward tick (3.2, Algorithm 3.1).
        Inward = "inward",
        /// At every tick of contact, in the direction of the error. Inward-only is a ratchet: it moves on only as long as
        /// something jitters, and overshoots what it cannot take back; see the README for the difference.
        #[default]
        EveryTick = "every-tick",
    }
}

crate::choice! {
    /// What the offset's ideal step supposes of the hand.
    IdealStep {
        /// The position stays: `|k_de e - |f||/k_v` (3.7). A soft hand gives way by as much as the offset grows, so that this
        /// step is too long by `k_de/k_v`, and `c` must be chosen anew for every `k_de`.
        Position = "position",
        /// The force stays and the position follows the offset: `|e - |f|/k_de|`, the way that the HIP still has to go. One `c`
        /// then serves all stiffnesses.
        #[default]
        Force = "force",
    }
}

macro_rules! structs {
    (
        timing { $($timing:tt)* } wall { $($wall:tt)* } law { $($law:tt)* }
        $($(#[$doc:meta])* $group:ident $Group:ident { $($rows:tt)* })+
    ) => {
        structs! { @struct
            /// Everything that a law needs to know, in SI.
            Settings { $($timing)* $($wall)* $($law)* } { $($(#[$doc])* $group $Group)+ }
        }
        $(structs! { @struct $(#[$doc])* $Group { $($rows)* } {} })+
    };
    (@struct $(#[$doc:meta])* $name:ident {
        $($variant:ident $field:ident, $path:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
    } { $($(#[$group_doc:meta])* $group:ident $Group:ident)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $name {
            $(
                #[doc = concat!("Gives ", $about, "; ", $unit, " `", stringify!($kind $range), "`")]
                pub $field: crate::setting_type!($kind $range),
            )+
            $($(#[$group_doc])* pub $group: $Group,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self {
                    $($field: crate::setting_value!($default: $kind $range),)+
                    $($group: $Group::default(),)*
                }
            }
        }
    };
}
crate::law_settings!(structs);
