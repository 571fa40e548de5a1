//! A table of all settings with their units, ranges and meanings, for validation and for people.

use super::{
    Decimal, DeviceSettings, DriveKind, EncoderKind, Reason, SettingsError, device_settings,
};
use touchstone_control::choices::*;
use touchstone_control::table::equal;
use touchstone_control::{Choice, Si, setting_path};

/// The type of a setting with its allowed values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A decimal number from `least` to `most`.
    Number {
        /// Smallest allowed value.
        least: Decimal,
        /// Largest allowed value.
        most: Decimal,
    },
    /// A whole number from `least` to `most`.
    Whole {
        /// Smallest allowed value.
        least: u32,
        /// Largest allowed value.
        most: u32,
    },
    /// A text, one of the given ones.
    Choice(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
}

impl Kind {
    /// The smallest and largest allowed value as decimals; `None` for a setting without a range.
    #[must_use]
    pub fn range(&self) -> Option<(Decimal, Decimal)> {
        match *self {
            Kind::Number { least, most } => Some((least, most)),
            Kind::Whole { least, most } => {
                Some((Decimal::from_num(least), Decimal::from_num(most)))
            }
            Kind::Choice(_) | Kind::Flag => None,
        }
    }
}

/// One setting of [`DeviceSettings`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// Path of the setting, e.g. `wall.k_desired_n_m_per_rad`.
    pub path: &'static str,
    /// The values that the setting may hold.
    pub kind: Kind,
    /// Unit of the setting. Empty for a choice, a flag, and a number without a unit.
    pub unit: &'static str,
    /// The meaning of the setting, for people.
    pub about: &'static str,
}

/// The setting with this path.
#[must_use]
pub fn field(path: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.path == path)
}

/// Smallest and largest allowed value of the number setting with this path. For use in constants only, so that firmware need not
/// contain the table.
///
/// # Panics
/// No number setting has this path.
#[must_use]
pub const fn range(path: &str) -> (Si, Si) {
    let mut index = 0;
    while index < FIELDS.len() {
        if equal(path, FIELDS[index].path) {
            match FIELDS[index].kind {
                Kind::Number { least, most } => return (least.0, most.0),
                Kind::Whole { least, most } => {
                    return (
                        Si::const_from_int(least as i64),
                        Si::const_from_int(most as i64),
                    );
                }
                Kind::Choice(_) | Kind::Flag => break,
            }
        }
        index += 1;
    }
    panic!("no number has this path")
}

/// Generates the table for people and the check of the numbers, from the tables of the device's settings and of the control law's.
/// Firmware contains the check only, because the compiler leaves out the texts of an unused `const`.
macro_rules! fields {
    (
        own_wall { $($own_wall:tt)* } own { $($(#[$own_doc:meta])* $own:ident $Own:ident { $($own_rows:tt)* })+ }
        timing { $($timing:tt)* }
        wall { $($w_variant:ident $w_field:ident, $w_name:ident: $w_kind:ident $w_range:tt = $w_default:tt, $w_unit:literal, $w_about:literal;)+ }
        law { $($l_variant:ident $l_field:ident, $l_name:ident: $l_kind:ident $l_range:tt = $l_default:tt, $l_unit:literal, $l_about:literal;)+ }
        $($(#[$doc:meta])* $group:ident $Group:ident {
            $($variant:ident $field:ident, $name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
        })+
    ) => {
        fields! { @rows settings:
            (wall) (settings.wall) { $($own_wall)* $($w_name: $w_kind $w_range = $w_default, $w_unit, $w_about;)+ }
            (law) (settings.law) { $($l_name: $l_kind $l_range = $l_default, $l_unit, $l_about;)+ }
            $((law $group) (settings.law.$group) { $($name: $kind $range = $default, $unit, $about;)+ })+
            $(($own) (settings.$own) { $($own_rows)* })+
        }
    };
    (@rows $settings:ident: $($table:tt $place:tt {
        $($name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
    })+) => {
        /// All settings, in the order in which they stand in [`DeviceSettings`].
        pub const FIELDS: &[Field] = &[$($(Field {
            path: setting_path!($table $name),
            kind: fields!(@kind $kind $range),
            unit: $unit,
            about: $about,
        },)+)+];

        /// Checks each number setting against its own range.
        ///
        /// # Errors
        /// The first number outside its range.
        pub(super) fn check($settings: &DeviceSettings) -> Result<(), SettingsError> {
            $($(fields!(@check ($table $name) $place $name $kind $range);)+)+
            Ok(())
        }
    };
    (@kind number ($least:literal, $most:literal)) => {
        Kind::Number { least: Decimal::lit($least), most: Decimal::lit($most) }
    };
    (@kind flag ()) => { Kind::Flag };
    (@kind choice ($choice:ident)) => { Kind::Choice(<$choice as Choice>::WORDS) };
    (@kind choice_of_law ($choice:ident)) => { Kind::Choice(<$choice as Choice>::WORDS) };
    (@kind $whole:ident ($least:literal, $most:literal)) => { Kind::Whole { least: $least, most: $most } };
    // Choices and flags need no check: their types have only allowed values.
    (@check $path:tt $place:tt $name:ident choice $range:tt) => {};
    (@check $path:tt $place:tt $name:ident choice_of_law $range:tt) => {};
    (@check $path:tt $place:tt $name:ident flag ()) => {};
    (@check ($($path:tt)+) ($($place:tt)+) $name:ident $kind:ident $range:tt) => {
        within(
            setting_path!($($path)+),
            fields!(@number $kind $($place)+.$name),
            const { range(setting_path!($($path)+)) },
        )?
    };
    (@number number $value:expr) => { $value };
    (@number $whole:ident $value:expr) => { Si::saturating_from_num($value) };
}
device_settings!(fields);

/// Checks a number against a range.
///
/// # Errors
/// The value is out of range.
pub fn within(path: &'static str, value: Si, (least, most): (Si, Si)) -> Result<(), SettingsError> {
    if value < least || value > most {
        let (value, least, most) = (Decimal(value), Decimal(least), Decimal(most));
        return Err(SettingsError {
            path,
            value,
            reason: Reason::Outside { least, most },
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_control::table::suffix;

    #[test]
    fn a_name_ends_in_its_unit() {
        for field in FIELDS {
            assert!(field.path.ends_with(suffix(field.unit)), "{field:?}");
            assert!(
                !field.about.is_empty() && !field.about.ends_with('.'),
                "{field:?}"
            );
        }
    }

    #[test]
    fn the_defaults_are_within_their_ranges() {
        for board in crate::Board::ALL {
            assert_eq!(check(&DeviceSettings::defaults(board)), Ok(()));
        }
    }

    #[test]
    fn the_law_is_the_one_of_the_tables_defaults() {
        let device = DeviceSettings::default();
        // The encoder's settings are the device's own and in no row of the law's table.
        let law = touchstone_control::Settings {
            position: device.law().position,
            ..touchstone_control::Settings::default()
        };
        assert_eq!(device.law(), law);
        // Every setting of the law is a leaf here too. Only the control rate has another range, that of the device.
        for law in touchstone_control::Field::ALL {
            assert!(field(law.path()).is_some(), "{}", law.path());
        }
    }
}
