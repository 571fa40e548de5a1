//! All settings of a device as one tree. Each setting (leaf) has a path whose name ends in its unit, and a range.
//!
//! ```text
//! person's text <-> leaf (path, value) <-> DeviceSettings --validate--> control::Settings, drive
//! ```
//!
//! Device and desktop validate by the same code, so the device accepts what the desktop accepts. All code here is generated from
//! two tables: that of the control law's settings ([`touchstone_control::law_settings`]) and that of the device's own, `table.rs`.

#[cfg(feature = "wire")]
mod access;
#[cfg(feature = "large")]
pub mod cogging;
pub(crate) mod decimal;
#[cfg(feature = "large")]
pub mod environment;
pub mod fields;
mod gimbal_kit;
#[cfg(feature = "large")]
pub mod kept;
#[cfg(feature = "wire")]
mod leaf;
#[cfg(feature = "large")]
pub mod parts;
mod refusal;
mod table;
mod untold_motor;
mod validate;

use crate::Board;
#[cfg(feature = "wire")]
use serde::{Deserialize, Serialize};
use touchstone_control as law;
use touchstone_control::choices::*;
use touchstone_control::{setting_type, setting_value};

#[cfg(feature = "wire")]
pub use access::{KeyError, VALUE_MAX};
pub use decimal::Decimal;
#[cfg(feature = "wire")]
pub use refusal::{Invalid, PATH_MAX, PathText};
pub use refusal::{Reason, SettingsError};
use table::device_settings;
pub use table::{DriveKind, EncoderKind};
pub use validate::refused;

macro_rules! tree {
    (
        own_wall { $($own_wall:tt)* } own { $($(#[$own_doc:meta])* $own:ident $Own:ident { $($own_rows:tt)* })+ }
        timing { $($timing:tt)* }
        wall { $($w_variant:ident $w_field:ident, $w_name:ident: $w_kind:ident $w_range:tt = $w_default:tt, $w_unit:literal, $w_about:literal;)+ }
        law { $($l_variant:ident $l_field:ident, $l_name:ident: $l_kind:ident $l_range:tt = $l_default:tt, $l_unit:literal, $l_about:literal;)+ }
        $($(#[$doc:meta])* $group:ident $Group:ident {
            $($variant:ident $field:ident, $name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
        })+
    ) => {
        tree! { @table
            /// Position and stiffness of the wall.
            WallSettings { $($own_wall)* $($w_name: $w_kind $w_range = $w_default, $w_unit, $w_about;)+ } {}
        }
        tree! { @table
            /// The wall's control law: all its settings except the wall's stiffness and the control rate.
            LawSettings { $($l_name: $l_kind $l_range = $l_default, $l_unit, $l_about;)+ } { $($(#[$doc])* $group $Group)+ }
        }
        $(tree! { @table $(#[$doc])* $Group { $($name: $kind $range = $default, $unit, $about;)+ } {} })+
        $(tree! { @table $(#[$own_doc])* $Own { $($own_rows)* } {} })+

        /// All settings of a device.
        #[derive(Debug, Clone, PartialEq, Eq, Default)]
        #[cfg_attr(feature = "wire", derive(Serialize, Deserialize, miniconf::Tree), serde(deny_unknown_fields))]
        pub struct DeviceSettings {
            /// Position and stiffness of the wall.
            pub wall: WallSettings,
            /// The wall's control law.
            pub law: LawSettings,
            $($(#[$own_doc])* pub $own: $Own,)+
        }

        impl DeviceSettings {
            /// The settings of the control law in the form that the control crate takes. They are not validated.
            #[must_use]
            pub fn law(&self) -> law::Settings {
                law::Settings {
                    rate_hz: self.timing.rate_hz,
                    $($w_field: self.wall.$w_name,)+
                    $($l_field: self.law.$l_name,)+
                    $($group: law::settings::$Group { $($field: self.law.$group.$name,)+ },)+
                    position: law::settings::PositionSettings::of_counts_per_rev(self.encoder.counts_per_rev),
                }
            }
        }
    };
    (@table $(#[$doc:meta])* $Table:ident {
        $($name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
    } { $($(#[$group_doc:meta])* $group:ident $Group:ident)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Eq)]
        #[cfg_attr(feature = "wire", derive(Serialize, Deserialize, miniconf::Tree), serde(deny_unknown_fields))]
        pub struct $Table {
            $(
                #[doc = concat!("Gives ", $about, "; ", $unit, " `", stringify!($kind $range), "`")]
                #[cfg_attr(feature = "wire", serde(with = "leaf"), tree(with = leaf))]
                pub $name: setting_type!($kind $range),
            )+
            $($(#[$group_doc])* pub $group: $Group,)*
        }

        impl Default for $Table {
            fn default() -> Self {
                Self {
                    $($name: setting_value!($default: $kind $range),)+
                    $($group: $Group::default(),)*
                }
            }
        }
    };
}
device_settings!(tree);

macro_rules! thesis {
    ($law:ident: $($place:tt $field:ident, $name:ident = $value:literal;)+) => {
        $(thesis!(@set $law $place $name = $value);)+
    };
    (@set $law:ident (law) $name:ident = $value:literal) => {
        $law.$name = const { law::Si::lit($value) };
    };
    (@set $law:ident (law $group:ident) $name:ident = $value:literal) => {
        $law.$group.$name = const { law::Si::lit($value) };
    };
}

impl LawSettings {
    /// The settings of the thesis whose control laws this project uses: same as [`law::Settings::thesis`].
    #[must_use]
    pub fn thesis() -> Self {
        let mut law = Self {
            states: StatesKind::Measured,
            ..Self::default()
        };
        law.guard.on = false;
        touchstone_control::thesis_settings!(thesis law:);
        law
    }
}

impl DeviceSettings {
    /// The first settings of a board. The NUCLEO-G474RE with X-NUCLEO-IHM08M1 and the B-G431B-ESC1 get the shipped wall of 5
    /// N·m/rad with a gimbal-type motor at 24 V; these values are valid but are from no real motor's data sheet. The boards with
    /// the X-NUCLEO-IHM16M1 get a soft wall with their kit's motor at 12 V. The SimpleFOC Mini gets no motor at all: the user has
    /// to enter its values.
    #[must_use]
    pub fn defaults(board: Board) -> Self {
        let mut settings = Self::default();
        // Every board reads its encoder once more when the force changes.
        settings.law.guard.change = ChangeOfForce::Measured;
        match board {
            Board::NucleoG474re => {}
            Board::BG431bEsc1 => {
                // The board has no SPI on its connectors.
                settings.encoder.kind = EncoderKind::Incremental;
                // The board is made for six lithium cells.
                settings.limits.bus_max_v = const { law::Si::lit("26") };
            }
            Board::NucleoG474reIhm16m1 | Board::NucleoG431rbIhm16m1 => {
                gimbal_kit::fit(&mut settings);
            }
            Board::NucleoG474reSimplefocMini => untold_motor::fit(&mut settings),
        }
        settings
    }
}
