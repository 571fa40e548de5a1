//! Options that change a scene.

use super::out::note;
use clap::builder::{PossibleValue, PossibleValuesParser, StringValueParser, TypedValueParser};
use touchstone_control::Choice as _;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run::work::Work;
use touchstone_sim::run::{self as runner, passivity};
use touchstone_sim::scene::{Preset, Scene, choices, path_of};

/// The words of a field, for help and completions; the scene itself refuses any other word, as it does in a file.
#[derive(Debug, Clone, Copy)]
struct Words(&'static str);

impl TypedValueParser for Words {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> std::result::Result<String, clap::Error> {
        let word = StringValueParser::new().parse_ref(command, argument, value)?;
        Ok(match self.0 {
            "law.kind" => super::law_name::of_scene(word),
            _ => word,
        })
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(choices(self.0).iter().map(PossibleValue::new)))
    }
}

/// Options that change a scene, the same for every command that takes one.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SceneOptions {
    /// Control law.
    #[arg(long, value_parser = Words("law.kind"))]
    law: Option<String>,
    /// Desired stiffness k_de, N·m/rad.
    #[arg(long, value_name = "N_M_PER_RAD", allow_negative_numbers = true)]
    k_desired: Option<String>,
    /// Method by which device and hand cross a tick; all but `exact`, the default, divide it into `plant.substeps`.
    #[arg(long, value_parser = Words("plant.integrator"))]
    integrator: Option<String>,
    /// The parameters of the law that the scene does not write itself: tuned, on estimated states, behind the energy guard
    /// (shipped); or below the thesis' own bounds, on measured states, without a guard (thesis).
    #[arg(long, value_name = "NAME", default_value = "shipped", value_parser = preset())]
    preset: Preset,
    /// Takes rate, stiffness and law from a file of settings, as `touchstone tune --out` writes it; --set and the like change them
    /// afterwards.
    #[arg(long, value_name = "FILE.toml")]
    settings: Option<std::path::PathBuf>,
    /// Changes a field of the scene, e.g. device.inertia_kg_m2=2e-4; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Moves the hand by a recording: CSV with a time and an angle column, their units in the header. A trace of a run and a file
    /// of `monitor` are such recordings.
    #[arg(long, value_name = "FILE.csv")]
    operator_motion: Option<std::path::PathBuf>,
    /// Refuses a law beyond its own passivity bounds instead of warning of it (a spring: k_de <= 2 c_i/T; with virtual damping B:
    /// k_de < 2 (c_i - B)/T; the enhanced law: no energy credit), and ends with 3 where the user's port gives energy.
    #[arg(long)]
    strict_passive: bool,
}

impl SceneOptions {
    /// Whether `--strict-passive` was given.
    pub fn strict_passive(&self) -> bool {
        self.strict_passive
    }

    /// The first option that was given, of those that change a scene.
    pub fn first_given(&self) -> Option<&'static str> {
        let given = [
            ("--law", self.law.is_some()),
            ("--k-desired", self.k_desired.is_some()),
            ("--integrator", self.integrator.is_some()),
            ("--preset", self.preset != Preset::default()),
            ("--settings", self.settings.is_some()),
            ("--set", !self.sets.is_empty()),
            ("--operator-motion", self.operator_motion.is_some()),
            ("--strict-passive", self.strict_passive),
        ];
        let first = given.into_iter().find(|(_, given)| *given);
        first.map(|(option, _)| option)
    }

    /// Refuses a change of a field that the command itself replaces, see [`refuse_replaced`].
    pub fn refuse_replaced(&self, command: &str, replaced: &[(&str, &str)]) -> Result<()> {
        refuse_replaced(command, &self.sets, replaced)?;
        let options = [
            ("law.kind", "--law", &self.law),
            ("wall.k_desired_n_m_per_rad", "--k-desired", &self.k_desired),
        ];
        for (path, option, given) in options {
            if let (Some(_), Some((_, what))) = (given, found(path, replaced)) {
                return Err(lost(command, option, what));
            }
        }
        Ok(())
    }

    /// The scene with the options applied and its law checked. Warnings go to standard error.
    pub fn load(&self, name: &str) -> Result<(Scene, Vec<String>)> {
        let mut scene = Scene::load(name)?;
        if let Some(file) = &self.operator_motion {
            scene = scene.with_recording(file)?;
        }
        scene = scene.with_preset(self.preset)?;
        if let Some(file) = &self.settings {
            scene = scene.with_settings(file)?;
        }
        scene = scene.with_overrides(&self.sets)?;
        if let Some(integrator) = &self.integrator {
            scene = scene.with_option("plant.integrator", integrator, "--integrator")?;
        }
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

/// A preset by its word.
fn preset() -> impl TypedValueParser<Value = Preset> {
    PossibleValuesParser::new(Preset::WORDS).map(|word| Preset::of_word(&word).unwrap_or_default())
}

/// Refuses a `--set` of a field or table that a command itself replaces, since it would be lost silently. The error
/// says what the command puts there.
pub fn refuse_replaced(command: &str, sets: &[String], replaced: &[(&str, &str)]) -> Result<()> {
    for set in sets {
        let key = set.split('=').next().unwrap_or_default().trim();
        if let Some((_, what)) = path_of(key).and_then(|path| found(&path, replaced)) {
            return Err(lost(command, &format!("--set {set}"), what));
        }
    }
    Ok(())
}

fn found<'a>(path: &str, replaced: &[(&'a str, &'a str)]) -> Option<(&'a str, &'a str)> {
    replaced.iter().copied().find(|(own, _)| {
        path.strip_prefix(own)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    })
}

fn lost(command: &str, option: &str, what: &str) -> Error {
    Error::Option {
        option: option.to_owned(),
        problem: format!("{command} cannot change it, for it runs {what} of its own"),
        fix: format!("leave it out, or use it with: touchstone run SCENE {option}"),
    }
}

/// Checks the scene's law; prints what leaves a passivity bound, or refuses it.
pub fn check(scene: &Scene, strict: bool) -> Result<Vec<String>> {
    runner::plan::control(scene)?;
    if let (true, Some(refusal)) = (strict, passivity::refusal(scene)?) {
        return Err(strictly(refusal));
    }
    let work = Work::of(scene);
    work.check(scene)?;
    if let Some(long) = work.note() {
        note!("note: {long}");
    }
    let mut said = Vec::new();
    for message in runner::spoken_warnings(scene)? {
        note!("warning: {message}");
        said.push(message.to_string());
    }
    Ok(said)
}

/// The warning as a refusal, which names the option that made it one.
fn strictly(mut message: Error) -> Error {
    let (Error::File { fix, .. }
    | Error::Option { fix, .. }
    | Error::Io { fix, .. }
    | Error::Device { fix, .. }) = &mut message;
    fix.push_str(", or leave out --strict-passive");
    message
}
