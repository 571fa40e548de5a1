//! The settings that a user chooses, in SI units, as exact decimal fractions without floating point. So a microcontroller validates
//! the same values with the same code as a desktop computer.

use crate::choices::*;
use crate::quotient::{Si, over};

macro_rules! structs {
    (
        timing { $($timing:tt)* } wall { $($wall:tt)* } law { $($law:tt)* }
        $($(#[$doc:meta])* $group:ident $Group:ident { $($rows:tt)* })+
    ) => {
        structs! { @struct
            /// All settings of a control law, its wall, the estimator and the guard, in SI units.
            Settings { $($timing)* $($wall)* $($law)* } {
                $($(#[$doc])* $group $Group)+
                /// Resolution of the measured position. It follows from the encoder, so no row of the table of settings sets it.
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
    /// The settings of the thesis for its enhanced law: measured positions instead of estimated ones, no energy guard, and
    /// stiffnesses within the passivity bounds.
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

/// Resolution of the measured position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PositionSettings {
    /// Angle or length of one encoder count, rad (m); 0 means a position without steps. The sensor's other errors belong in
    /// [`Settings::position_error`].
    pub count: Si,
}

impl PositionSettings {
    /// The resolution of an encoder with this number of counts per turn, at least one; rounded up.
    #[must_use]
    pub fn of_counts_per_rev(counts: u32) -> Self {
        let counts = Si::saturating_from_num(counts.max(1));
        Self {
            count: over(Si::TAU, counts).saturating_add(Si::DELTA),
        }
    }

    /// Twice the largest error of a measured position, rad (m). `error` is the largest error other than the rounding to counts.
    #[must_use]
    pub const fn uncertainty(&self, error: Si) -> Si {
        self.count.saturating_add(error).saturating_add(error)
    }
}

impl Default for PositionSettings {
    /// The encoder of the thesis, which has 40,000 counts per turn.
    fn default() -> Self {
        Self {
            count: const { Si::lit("0.000157079633") },
        }
    }
}
