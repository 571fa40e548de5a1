//! Named sets of the law's parameters.

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
    /// A named set of the law's parameters. It fills in parameters that a scene does not give.
    Preset {
        /// The law as this project ships it: tuned, on estimated states, behind the energy guard. The fields' defaults.
        #[default]
        Shipped = "shipped",
        /// The law as the thesis builds it: below its own passivity bounds, on measured states, without a guard.
        Thesis = "thesis",
    }
}

impl Preset {
    /// The preset's fields and values, where these differ from the defaults.
    #[must_use]
    pub const fn fields(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Shipped => &[],
            Self::Thesis => touchstone_control::thesis_settings!(rows),
        }
    }
}

impl Scene {
    /// The scene with a preset's values in the fields that neither its file nor an option wrote.
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
