//! Named sets of the control law's parameters.

use super::experiment::Scene;
use super::origin::Place;
use crate::error::Result;
use touchstone_control::setting_path;

macro_rules! rows {
    ($($table:tt $field:ident, $name:ident = $value:literal;)+) => {
        &[
            ("law.states", "measured"),
            ("law.guard.on", "false"),
            $((setting_path!($table $name), $value),)+
        ]
    };
}

touchstone_control::choice! {
    /// A named set of law parameters, which fills in the parameters that a scene leaves out.
    Preset {
        /// The control law as this project ships it: tuned, with estimated position and velocity, behind the energy guard. Its
        /// values are the defaults of the fields.
        #[default]
        Shipped = "shipped",
        /// The control law as the thesis builds it: within its own passivity bounds, with measured position and velocity, without
        /// energy guard.
        Thesis = "thesis",
    }
}

impl Preset {
    /// Fields of the preset whose values differ from the defaults, each with its value as text.
    #[must_use]
    pub const fn fields(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Shipped => &[],
            Self::Thesis => touchstone_control::thesis_settings!(rows),
        }
    }
}

impl Scene {
    /// Returns the scene with the preset's values in all fields that neither the scene file nor an option gives.
    ///
    /// # Errors
    /// Same as [`Scene::with_overrides`].
    pub fn with_preset(&self, preset: Preset) -> Result<Scene> {
        let sets: Vec<String> = preset
            .fields()
            .iter()
            .filter(|(path, _)| !self.origin.is_written(path))
            .map(|(path, value)| format!("{path}={value}"))
            .collect();
        let mut scene = self.with_overrides(&sets)?;
        for (path, _) in preset.fields() {
            if !self.origin.is_written(path) {
                let option = format!("--preset {}", touchstone_control::Choice::word(preset));
                scene.origin.put(path, Place::Option(option));
            }
        }
        Ok(scene)
    }
}
