//! `touchstone export-fmu`: writes control law and plant of a scene as FMUs for Simulink, OpenModelica, FMPy and other programs.

use super::SceneOptions;
use super::out::{self, say, tell};
use super::whole::{Named, Overwrite};
use std::path::{Path, PathBuf};
use touchstone_fmu::variables::{self, Causality};
use touchstone_fmu::{Half, description, export};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;
use touchstone_sim::scene::Scene;

/// Options of `touchstone export-fmu`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene (see `touchstone scenes`) or path of a scene's TOML file.
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// Which half of the control loop to write. law: from the device's angle to the motor's torque, with encoder and energy guard;
    /// plant: delays, device and hand.
    #[arg(long = "of", value_name = "HALF", default_value = "both")]
    of: Of,
    /// Folder for the files SCENE_law.fmu and SCENE_plant.fmu.
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// The shared library for the FMUs, from `cargo build --release -p touchstone-fmi`. Default: the one beside this program, or in
    /// the folder `lib` beside the program's folder.
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
}

/// The option `--of`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Of {
    Law,
    Plant,
    Both,
}

impl Of {
    fn halves(self) -> &'static [Half] {
        match self {
            Self::Law => &[Half::Law],
            Self::Plant => &[Half::Plant],
            Self::Both => &Half::ALL,
        }
    }
}

/// Runs `touchstone export-fmu`.
pub fn main(options: &Options) -> Result<()> {
    let (scene, _) = options.changes.load(&options.scene)?;
    let library = export::library(&library(options.library.as_deref())?)?;
    let folder = &options.out;
    let halves = options.of.halves();
    let file = |half| folder.join(format!("{}.fmu", description::identifier(&scene, half)));
    let files: Vec<PathBuf> = halves.iter().map(|half| file(*half)).collect();
    let place = |path| Named {
        path,
        option: "--out",
        replaces: options.overwrite.force,
    };
    for file in &files {
        place(file).check()?;
    }
    let wrong = |error: std::io::Error| Error::Io {
        path: folder.clone(),
        problem: error.to_string(),
        fix: "give another folder with --out".to_owned(),
    };
    output::in_folder(folder, wrong, || {
        for (half, file) in halves.iter().zip(&files) {
            place(file).write(export::fmu(&scene, *half, &library)?)?;
        }
        Ok(())
    })?;
    let all = || halves.iter().copied().zip(&files);
    out::result(
        || {
            let fmus = all().map(|(half, file)| value(&scene, half, file));
            serde_json::json!({ "step_s": scene.timing.period_s(), "fmus": fmus.collect::<Vec<_>>() })
        },
        || {
            for (half, file) in all() {
                say!("{}", file.display());
                tell!(
                    "  in   {}",
                    names(&scene, half, Causality::Input).join(", ")
                );
                tell!(
                    "  out  {}",
                    names(&scene, half, Causality::Output).join(", ")
                );
            }
            tell!("step {:?} s: one control period", scene.timing.period_s());
            Ok(())
        },
    )
}

/// Names of an FMU's variables with this causality: the inputs that the importing program sets, or the outputs that it reads.
fn names(scene: &Scene, half: Half, causality: Causality) -> Vec<&'static str> {
    let variables = variables::of(scene, half).filter(|it| it.causality == causality);
    variables.map(|variable| variable.text).collect()
}

fn value(scene: &Scene, half: Half, file: &Path) -> serde_json::Value {
    serde_json::json!({
        "half": half.word(),
        "file": file,
        "inputs": names(scene, half, Causality::Input),
        "outputs": names(scene, half, Causality::Output),
    })
}

/// Path of the shared library for the FMUs.
fn library(given: Option<&Path>) -> Result<PathBuf> {
    if let Some(given) = given {
        return Ok(given.to_owned());
    }
    let name = export::library_name();
    let program = std::env::current_exe().unwrap_or_default();
    let folder = program.parent().unwrap_or(Path::new("."));
    // An installed Python wheel has programs in `bin` and libraries in `lib`.
    let places = [folder.join(&name), folder.join("../lib").join(&name)];
    let found = places.into_iter().find(|place| place.is_file());
    found.ok_or_else(|| Error::Io {
        path: folder.join(&name),
        problem: "the shared library for FMUs is missing".to_owned(),
        fix: format!(
            "build it in a clone with `cargo build --release -p touchstone-fmi`, and give --library target/release/{name}"
        ),
    })
}
