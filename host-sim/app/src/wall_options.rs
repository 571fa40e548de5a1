//! Options that change a scene, for a command that chooses the control laws itself.

use super::scene_options::{refuse_law, refuse_replaced};
use std::path::PathBuf;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// Options for the wall's stiffness and for other fields of the scene.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct WallOptions {
    /// Desired stiffness k_de, N·m/rad; default: the scene's.
    #[arg(long, value_name = "N_M_PER_RAD", allow_negative_numbers = true)]
    k_desired: Option<String>,
    /// Reads control rate, stiffness and control law from a settings file, as `touchstone tune --out` writes it.
    #[arg(long, value_name = "FILE.toml")]
    settings: Option<PathBuf>,
    /// Changes a field of the scene, e.g. device.inertia_kg_m2=2e-4; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
}

/// Fields of the scene that a scorecard overwrites with its own hands, each with a description of the new value. `--set` refuses
/// these fields. It also refuses the kind of the control law, which has its own option.
const REPLACED: [(&str, &str); 2] = [("operator.grip", "grips"), ("operator.hand", "grips")];

impl WallOptions {
    /// Reads a scene and applies the options. `command` is the name of the command that does it, for error messages.
    pub fn load(&self, command: &str, name: &str) -> Result<Scene> {
        refuse_law(command, &self.sets)?;
        refuse_replaced(command, &self.sets, &REPLACED)?;
        let mut scene = Scene::load(name)?;
        if let Some(file) = &self.settings {
            scene = scene.with_settings(file)?;
        }
        let scene = scene.with_overrides(&self.sets)?;
        match &self.k_desired {
            Some(stiffness) => {
                scene.with_option("wall.k_desired_n_m_per_rad", stiffness, "--k-desired")
            }
            None => Ok(scene),
        }
    }
}
