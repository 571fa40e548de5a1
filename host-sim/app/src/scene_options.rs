//! Command-line options that change a scene.

use super::out::note;
use clap::builder::{PossibleValue, PossibleValuesParser, StringValueParser, TypedValueParser};
use touchstone_control::Choice as _;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run::work::Work;
use touchstone_sim::run::{self as runner, passivity};
use touchstone_sim::scene::{Preset, Scene, choices, path_of};

/// Parser of an option that sets the scene field with this path. Help and completions list the field's allowed values. Other values
/// are rejected later, with the scene, as in a file.
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

/// Options that change a scene, the same for every command that reads one.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SceneOptions {
    /// Control law.
    #[arg(long, value_parser = Words("law.kind"))]
    law: Option<String>,
    /// Desired stiffness k_de, N·m/rad.
    #[arg(long, value_name = "N_M_PER_RAD", allow_negative_numbers = true)]
    k_desired: Option<String>,
    /// Integration method for device and hand within a control period; all but `exact`, the default, divide it into
    /// `plant.substeps`.
    #[arg(long, value_parser = Words("plant.integrator"))]
    integrator: Option<String>,
    /// Defaults for the parameters of the control law that the scene leaves out. shipped: tuned, with estimated position and
    /// velocity and the energy guard; thesis: below the thesis' own bounds, with measured position and velocity, without a guard.
    #[arg(long, value_name = "NAME", default_value = "shipped", value_parser = preset())]
    preset: Preset,
    /// Reads control rate, stiffness and control law from a settings file, as `touchstone tune --out` writes it. Options such as
    /// --set override it.
    #[arg(long, value_name = "FILE.toml")]
    settings: Option<std::path::PathBuf>,
    /// Changes a field of the scene, e.g. device.inertia_kg_m2=2e-4; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Moves the hand by a recording: CSV with a time and an angle column, units in the header. Traces of a run and files of
    /// `monitor` are such recordings.
    #[arg(long, value_name = "FILE.csv")]
    operator_motion: Option<std::path::PathBuf>,
    /// Rejects a control law beyond its own passivity bounds instead of warning, and ends with 3 if the wall gives energy to the
    /// user. The bounds on the stiffness k_de, for device damping c_i and control period T, are 2 c_i/T for a spring and 2 (c_i -
    /// B)/T with virtual damping B; the enhanced law must have no energy credit.
    #[arg(long)]
    strict_passive: bool,
}

impl SceneOptions {
    /// Whether `--strict-passive` was given.
    pub fn strict_passive(&self) -> bool {
        self.strict_passive
    }

    /// Name of the first of these options that the user gave; `None` if the user gave none, so that the scene is unchanged.
    pub fn first_given(&self) -> Option<&'static str> {
        // Without `..`: a new option that is missing here does not compile.
        let Self {
            law,
            k_desired,
            integrator,
            preset,
            settings,
            sets,
            operator_motion,
            strict_passive,
        } = self;
        let given = [
            ("--law", law.is_some()),
            ("--k-desired", k_desired.is_some()),
            ("--integrator", integrator.is_some()),
            ("--preset", *preset != Preset::default()),
            ("--settings", settings.is_some()),
            ("--set", !sets.is_empty()),
            ("--operator-motion", operator_motion.is_some()),
            ("--strict-passive", *strict_passive),
        ];
        let first = given.into_iter().find(|(_, given)| *given);
        first.map(|(option, _)| option)
    }

    /// Returns an error if an option changes a field that the command itself replaces, see [`refuse_replaced`].
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

    /// Reads a scene, applies the options and checks the control law. Returns the scene and its warnings, which are also printed on
    /// standard error.
    pub fn load(&self, name: &str) -> Result<(Scene, Vec<String>)> {
        let mut scene = Scene::load(name)?;
        say_notes(&scene);
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

/// Prints notes on values that were changed when the scene was read, and on parts of the scene that have no effect.
pub fn say_notes(scene: &Scene) {
    for sentence in scene.origin.notes() {
        note!("note: {sentence}");
    }
    let around = scene.environment.as_ref();
    if around.is_some_and(|it| it.acting_list().is_some() && it.profile.is_some()) {
        note!(
            "note: environment.detent_list takes the place of environment.profile, which is left out"
        );
    }
}

/// Parser of the option `--preset`.
fn preset() -> impl TypedValueParser<Value = Preset> {
    PossibleValuesParser::new(Preset::WORDS).map(|word| Preset::of_word(&word).unwrap_or_default())
}

/// Returns an error if `--set` names a field or table that the command itself overwrites, because the user's value would be lost.
/// The error says which value the command writes there.
pub fn refuse_replaced(command: &str, sets: &[String], replaced: &[(&str, &str)]) -> Result<()> {
    for set in sets {
        let key = set.split('=').next().unwrap_or_default().trim();
        if let Some((_, what)) = path_of(key).and_then(|path| found(&path, replaced)) {
            return Err(lost(command, &format!("--set {set}"), what));
        }
    }
    Ok(())
}

/// Returns an error if `--set` names the kind of the control law, for a command that takes it by its own option `--law`.
pub fn refuse_law(command: &str, sets: &[String]) -> Result<()> {
    for set in sets {
        let key = set.split('=').next().unwrap_or_default().trim();
        if path_of(key).as_deref() == Some("law.kind") {
            return Err(Error::Option {
                option: format!("--set {set}"),
                problem: format!("{command} takes the control law by an option of its own"),
                fix: "use --law NAME".to_owned(),
            });
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
        problem: format!("{command} cannot change it, because it runs its own {what}"),
        fix: format!("leave it out, or use it with: touchstone run SCENE {option}"),
    }
}

/// Checks the scene's control law. Prints and returns a warning for each passivity bound that is exceeded; with `strict`, returns
/// an error instead.
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

/// Adds to an error message that the user may leave out `--strict-passive`.
fn strictly(mut message: Error) -> Error {
    let (Error::File { fix, .. }
    | Error::Option { fix, .. }
    | Error::Io { fix, .. }
    | Error::Device { fix, .. }) = &mut message;
    fix.push_str(", or leave out --strict-passive");
    message
}
