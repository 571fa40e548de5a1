//! Scenes: what to simulate, in TOML, every field with its unit in its name.
//!
//! A scene names the effects it wants; what it does not name is `None` here and is not computed. Every field has a
//! default. The types hold what a scene means; [`schema`] holds every field's name, unit and range; `draft` reads,
//! overrides and checks. [`Motion`] turns the operator's intention into the hand's rest point.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

mod check;
mod device;
mod draft;
mod law;
mod motion;
mod operator;
mod origin;
mod overrides;
mod preset;
mod print;
mod problem;
mod renamed;
pub mod schema;
mod shipped;
#[cfg(test)]
mod tests;
mod units;
mod unknown;
mod value;

pub use device::{Device, Encoder, Friction, Timing, Wall};
pub(crate) use law::word;
pub use law::{FilterSettings, Law, Number};
pub use motion::{Curve, Motion, Recording, SMOOTHING_HZ};
pub use operator::{
    APPROACH_RAD, FASTEST_MOTION_HZ, FASTEST_RAMP_S, Grip, Hand, MotionSpec, Operator,
    PressWiggleRelease, RampAndHold, Recorded, Tap, TouchAndPress,
};
pub use origin::Origin;
pub use overrides::path_of;
pub use preset::Preset;
pub use renamed::renamed;
pub use shipped::names;
pub use unknown::{list, nearest};
pub use value::choices;

/// One experiment: a device, a wall, a law and a person.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scene {
    /// Name in tables and results. Default: the file's name without its ending.
    pub name: String,
    /// What the scene shows, for people. Default: empty.
    pub description: String,
    /// What the hand moves.
    pub device: Device,
    /// Position sensor. Absent: the law sees the exact position.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encoder: Option<Encoder>,
    /// Rate, duration, delay.
    pub timing: Timing,
    /// The virtual wall.
    pub wall: Wall,
    /// The law and its parameters.
    pub law: Law,
    /// The person.
    pub operator: Operator,
    /// Where each value was written. No part of the scene's meaning.
    #[serde(skip)]
    pub origin: Origin,
}

impl Scene {
    /// Loads a shipped scene by its name, any other from its file. A file that bears the name of a shipped scene is
    /// meant when it is written as a path: `./tap`.
    ///
    /// # Errors [`Error::Io`] where there is neither, [`Error::File`] for what is wrong in the file.
    pub fn load(name_or_path: &str) -> Result<Scene> {
        if let Some((name, text)) = shipped::SHIPPED
            .iter()
            .find(|(name, _)| *name == name_or_path)
        {
            return Scene::parse(text, Path::new(&format!("scenes/{name}.toml")));
        }
        let path = PathBuf::from(name_or_path);
        let text = std::fs::read_to_string(&path).map_err(|error| {
            let names = names();
            let fix = match (error.kind(), unknown::nearest(name_or_path, &names)) {
                (std::io::ErrorKind::NotFound, Some(near)) => {
                    format!("did you mean the shipped scene {near}?")
                }
                (std::io::ErrorKind::NotFound, None) => {
                    format!(
                        "give the path of a scene's file, or a shipped scene: {}",
                        unknown::list(&names)
                    )
                }
                (std::io::ErrorKind::InvalidData, _) => {
                    "save the scene as plain text in UTF-8".to_owned()
                }
                _ => "give a readable file".to_owned(),
            };
            let problem = match error.kind() {
                std::io::ErrorKind::NotFound => "no such scene or file".to_owned(),
                _ => error.to_string(),
            };
            Error::Io {
                path: path.clone(),
                problem,
                fix,
            }
        })?;
        Scene::parse(&text, &path)
    }

    /// Reads a scene from TOML text; `file` is its name in messages, and relative paths in it start from its folder.
    ///
    /// # Errors
    /// [`Error::File`] for the first problem in the text.
    pub fn parse(text: &str, file: &Path) -> Result<Scene> {
        draft::Draft::from_toml(text, file)?.build()
    }

    /// Checks a scene that was made or changed in code as one that is read from a file.
    ///
    /// # Errors
    /// As [`Scene::parse`]; a field that was never written is reported as [`Error::Option`] under its dotted path.
    pub fn check(&self) -> Result<()> {
        draft::Draft::from_scene(self).build().map(drop)
    }

    /// The scene with fields changed in code, checked as one that is read from a file.
    ///
    /// What is wrong with a changed field is reported with its new value; every other field keeps the place where it was written.
    ///
    /// # Errors
    /// [`Error::Option`] for what the change breaks.
    pub fn with(&self, change: impl FnOnce(&mut Scene)) -> Result<Scene> {
        let mut changed = self.clone();
        change(&mut changed);
        draft::Draft::from_scene(&changed)
            .changed_since(&draft::Draft::from_scene(self))
            .build()
    }

    /// The error for a field of this scene, by its dotted path (`law.k_soft_n_m_per_rad`), with the place where it was
    /// written.
    pub fn error(&self, path: &str, problem: impl Into<String>, fix: impl Into<String>) -> Error {
        self.origin.error(path, problem, fix)
    }

    /// Start and end of the time over which displayed stiffness and limit cycle are judged, s; `None` without a quiet
    /// hold.
    pub fn hold_window_s(&self) -> Option<(f64, f64)> {
        self.operator.motion.hold_window_s()
    }

    /// Angle at which the device starts, rad: the one given, else where the hand's rest point starts.
    pub fn start_rad(&self, motion: &Motion) -> f64 {
        self.device
            .initial_angle_rad
            .unwrap_or_else(|| motion.rest_rad(0.0))
    }

    /// Lets a recording move the hand instead of the scene's own motion (`--operator-motion FILE`).
    ///
    /// The recording's mean is placed on the wall's surface, unscaled, so that the hand goes in and out of the wall;
    /// the run takes as long as the recording; the device starts at rest where the hand starts. `--set
    /// motion.scale=…` and `--set motion.offset_rad=…` change the placement afterwards. [`Motion::note`] says in
    /// words what was chosen.
    ///
    /// # Errors Whatever is wrong with the recording, see [`Recording::read`]; [`Error::Option`] where the scene has
    /// no hand.
    pub fn with_recording(&self, file: &Path) -> Result<Scene> {
        let option = format!("--operator-motion {}", file.display());
        if self.operator.hand().is_none() {
            let problem = format!("nobody holds the device in the scene {}", self.name);
            return Err(Error::Option {
                option,
                problem,
                fix: "add --set operator.grip=medium before it".into(),
            });
        }
        let recording = Recording::read(file)?;
        let mut scene = self.clone();
        scene.operator.motion = MotionSpec::Recorded(Recorded::new(file.to_owned()));
        scene.timing.duration_s = recording.length_s();
        scene.device.initial_angle_rad = None;
        scene.device.initial_velocity_rad_per_s = 0.0;
        for path in [
            "operator.motion.file",
            "operator.motion",
            "timing.duration_s",
        ] {
            scene
                .origin
                .put(path, origin::Place::Option(option.clone()));
        }
        scene.check()?;
        Ok(scene)
    }
}
