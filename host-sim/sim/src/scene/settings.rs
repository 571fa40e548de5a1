//! Converts the control law and wall of a scene to the control crate's settings: fixed-point numbers whose ranges the crate checks.

use touchstone_control::{PositionSettings, Settings, Si, setting_path};

use super::experiment::Scene;
use crate::error::Result;

/// Converts one value of a scene to the control crate's setting, by the type of the value (number, flag or choice).
macro_rules! row {
    ($scene:ident $path:expr, $law:expr, $name:ident: number $range:tt) => {
        si($scene, $path, $law.$name)?
    };
    ($scene:ident $path:expr, $law:expr, $name:ident: flag ()) => {
        $law.$name
    };
    ($scene:ident $path:expr, $law:expr, $name:ident: choice $choice:tt) => {
        $law.$name
    };
    ($scene:ident $path:expr, $law:expr, $name:ident: choice_of_law $choice:tt) => {
        $law.$name()
    };
}

macro_rules! settings {
    (
        timing { $($timing:tt)* }
        wall { $($w_variant:ident $w_field:ident, $w_name:ident: number $w_range:tt = $w_default:tt, $w_unit:literal, $w_about:literal;)+ }
        law { $($l_variant:ident $l_field:ident, $l_name:ident: $l_kind:ident $l_range:tt = $l_default:tt, $l_unit:literal, $l_about:literal;)+ }
        $($(#[$doc:meta])* $group:ident $Group:ident {
            $($variant:ident $field:ident, $name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
        })+
    ) => {
        impl Scene {
            /// Settings of the scene's law for the control crate.
            ///
            /// # Errors
            /// A value that the control crate cannot represent.
            pub fn settings(&self) -> Result<Settings> {
                let (wall, law) = (&self.wall, &self.law);
                Ok(Settings {
                    rate_hz: self.timing.rate_hz,
                    $($w_field: si(self, setting_path!((wall) $w_name), wall.$w_name)?,)+
                    $($l_field: row!(self setting_path!((law) $l_name), law, $l_name: $l_kind $l_range),)+
                    $($group: touchstone_control::settings::$Group {
                        $($field: row!(self setting_path!((law $group) $name), law.$group, $name: $kind $range),)+
                    },)+
                    position: self.position_settings(),
                })
            }
        }
    };
}
touchstone_control::law_settings!(settings);

impl Scene {
    /// Encoder resolution of the scene for the control crate; 0 (a position without steps) for a scene without an encoder.
    fn position_settings(&self) -> PositionSettings {
        let count = self
            .encoder
            .as_ref()
            .map_or(0.0, |encoder| encoder.step_rad());
        PositionSettings {
            // The count is rounded up by one step of the format, so that it is not below the true value.
            count: Si::saturating_from_num(count).saturating_add(if count > 0.0 {
                Si::DELTA
            } else {
                Si::ZERO
            }),
        }
    }
}

/// Converts a value of a scene in SI units to the control crate's fixed-point format.
fn si(scene: &Scene, path: &str, value: f64) -> Result<Si> {
    Si::checked_from_num(value).ok_or_else(|| {
        scene.error(
            path,
            format!("{value} is too large"),
            "give a value below 2e9",
        )
    })
}
