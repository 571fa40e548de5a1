//! Settings: what a user chooses, in SI, exact and without floats. So a microcontroller validates the very same values
//! with the same code as the desktop.

/// An SI value in `I32F32`: ±2.1e9 in steps of 2.3e-10.
pub type Si = fixed::types::I32F32;

use crate::choices::*;
use crate::quotient::over;

macro_rules! structs {
    (
        timing { $($timing:tt)* } wall { $($wall:tt)* } law { $($law:tt)* }
        $($(#[$doc:meta])* $group:ident $Group:ident { $($rows:tt)* })+
    ) => {
        structs! { @struct
            /// Everything that a law needs to know, in SI.
            Settings { $($timing)* $($wall)* $($law)* } {
                $($(#[$doc])* $group $Group)+
                /// How finely the position is measured. Not a row: it follows from the encoder.
                position PositionSettings
            }
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

macro_rules! thesis {
    ($settings:ident: $($place:tt $field:ident, $name:ident = $value:literal;)+) => {
        $(thesis!(@set $settings $place $field = $value);)+
    };
    (@set $settings:ident (law) $field:ident = $value:literal) => {
        $settings.$field = const { Si::lit($value) };
    };
    (@set $settings:ident (law $group:ident) $field:ident = $value:literal) => {
        $settings.$group.$field = const { Si::lit($value) };
    };
}

impl Settings {
    /// The law as the thesis builds it: below its own passivity bounds, on measured states, without a guard.
    #[must_use]
    pub fn thesis() -> Self {
        let mut settings = Self {
            states: StatesKind::Measured,
            ..Self::default()
        };
        settings.guard.on = false;
        crate::thesis_settings!(thesis settings:);
        settings
    }
}

/// How finely the position is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PositionSettings {
    /// A count of the encoder, or else twice the largest error of a measured position, rad (m); 0 where it is exact.
    pub count: Si,
}

impl PositionSettings {
    /// The settings for an encoder with this number of counts a revolution, at least one; rounded up.
    #[must_use]
    pub fn of_counts_per_rev(counts: u32) -> Self {
        let counts = Si::saturating_from_num(counts.max(1));
        Self {
            count: over(Si::TAU, counts).saturating_add(Si::DELTA),
        }
    }
}

impl Default for PositionSettings {
    /// The thesis' encoder, 40,000 counts.
    fn default() -> Self {
        Self {
            count: const { Si::lit("0.000157079633") },
        }
    }
}
