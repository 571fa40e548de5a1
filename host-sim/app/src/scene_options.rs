//! Options that change a scene.

use touchstone_control::Warning;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run as runner;
use touchstone_sim::scene::Scene;

/// Options that change a scene, the same for every command that takes one.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SceneOptions {
    /// Control law: spring, spring-damper, tdpa, fba, sfa, sfa-continuous, enhanced-sfa.
    #[arg(long)]
    law: Option<String>,
    /// Desired stiffness k_de, N·m/rad.
    #[arg(long, value_name = "N_M_PER_RAD")]
    k_desired: Option<String>,
    /// Changes a field of the scene, e.g. device.inertia_kg_m2=2e-4; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Moves the hand by a recording: CSV with a time and an angle column, their units in the header.
    #[arg(long, value_name = "FILE.csv")]
    operator_motion: Option<std::path::PathBuf>,
    /// Refuses settings beyond a passivity bound instead of warning of them.
    #[arg(long)]
    strict_passive: bool,
}

impl SceneOptions {
    /// The scene with the options applied and its law checked. Warnings go to standard error.
    pub fn load(&self, name: &str) -> Result<(Scene, Vec<String>)> {
        let mut scene = Scene::load(name)?;
        if let Some(file) = &self.operator_motion {
            scene = scene.with_recording(file)?;
        }
        scene = scene.with_overrides(&self.sets)?;
        if let Some(law) = &self.law {
            scene = scene.with_option("law.kind", law, "--law")?;
        }
        if let Some(stiffness) = &self.k_desired {
            scene = scene.with_option("wall.k_desired_n_m_per_rad", stiffness, "--k-desired")?;
        }
        let warnings = check(&scene, self.strict_passive)?;
        Ok((scene, warnings))
    }
}

/// Checks the scene's law; prints what leaves a passivity bound, or refuses it.
pub fn check(scene: &Scene, strict: bool) -> Result<Vec<String>> {
    runner::plan::control(scene)?;
    let mut said = Vec::new();
    for (warning, message) in runner::warnings(scene)? {
        if strict {
            return Err(strictly(message));
        }
        // The credit is a documented default; it is named in the results, and refused above.
        if !matches!(warning, Warning::EnergyCredit { .. }) {
            eprintln!("warning: {message}");
            said.push(message.to_string());
        }
    }
    Ok(said)
}

/// The warning as a refusal: says which option asked for it.
fn strictly(mut message: Error) -> Error {
    let (Error::File { fix, .. }
    | Error::Option { fix, .. }
    | Error::Io { fix, .. }
    | Error::Device { fix, .. }) = &mut message;
    fix.push_str(", or leave out --strict-passive");
    message
}
