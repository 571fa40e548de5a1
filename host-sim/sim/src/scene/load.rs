//! Loads scenes by name, from files or from text, and makes changed copies that are checked again.

use std::path::{Path, PathBuf};

use super::draft::Draft;
use super::experiment::Scene;
use super::motion::Recording;
use super::operator::{MotionSpec, Recorded};
use super::origin::Place;
use super::{shipped, unknown};
use crate::error::{Error, Result};
use crate::input;

impl Scene {
    /// Loads a shipped scene by its name, or any other scene from its file. A name that begins with `./` always means a file, even
    /// if a shipped scene has the same name.
    ///
    /// # Errors
    /// [`Error::Io`] if there is no such shipped scene and no readable file, [`Error::File`] for a problem in the file.
    pub fn load(name_or_path: &str) -> Result<Scene> {
        if let Some((text, file)) = shipped::text(name_or_path) {
            return Scene::parse(text, &file);
        }
        let path = PathBuf::from(name_or_path);
        let text = input::text(&path, input::MOST_OF_SCENE).map_err(|error| {
            let names = shipped::names();
            let all = [names.clone(), shipped::feels()].concat();
            let fix = match (error.kind(), unknown::nearest(name_or_path, &all)) {
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
                (std::io::ErrorKind::FileTooLarge, _) => "give the file of a scene".to_owned(),
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

    /// Reads a scene from TOML text. `file` is the name of the text in error messages; its folder is the base of relative paths in
    /// the scene.
    ///
    /// # Errors
    /// [`Error::File`] for the first problem in the text.
    pub fn parse(text: &str, file: &Path) -> Result<Scene> {
        Draft::from_toml(text, file)?.build()
    }

    /// Checks a scene that code made or changed, by the same rules as a scene read from a file.
    ///
    /// # Errors
    /// Same as [`Scene::parse`]. A problem in a field that no file gave is an [`Error::Option`] with the field's dotted path.
    pub fn check(&self) -> Result<()> {
        Draft::from_scene(self).build().map(drop)
    }

    /// Finds a contradiction between fields of a scene, each of which is within its own range. [`Scene::check`] includes this test.
    pub fn contradiction(&self) -> Option<Error> {
        super::check::scene(self).map(|found| self.error(&found.path, found.problem, found.fix))
    }

    /// Returns a copy of the scene that `change` has altered, checked like a scene from a file.
    ///
    /// A problem of a changed field is reported with its new value. Every other field keeps its file and line for error messages.
    ///
    /// # Errors
    /// [`Error::Option`] for a change that makes the scene invalid.
    pub fn with(&self, change: impl FnOnce(&mut Scene)) -> Result<Scene> {
        let mut changed = self.clone();
        change(&mut changed);
        Draft::from_scene(&changed)
            .changed_since(&Draft::from_scene(self))
            .build()
    }

    /// Returns a copy of the scene in which the hand follows the recording `file` (option `--operator-motion FILE`).
    ///
    /// The mean angle of the recording is placed on the wall's surface, unscaled, so that the hand goes in and out of the wall. The
    /// simulation lasts as long as the recording. The device starts at rest at the hand's first position. `--set motion.scale=…`
    /// and `--set motion.offset_rad=…` change the placement afterwards. [`RestPath::note`](super::RestPath::note) describes the
    /// placement.
    ///
    /// # Errors
    /// The recording cannot be used, see [`Recording::read`]; its path is not UTF-8; [`Error::Option`] if the scene has no hand.
    pub fn with_recording(&self, file: &Path) -> Result<Scene> {
        let option = format!("--operator-motion {}", file.display());
        if self.operator.hand().is_none() {
            let problem = format!("no hand holds the device in the scene {}", self.name);
            return Err(Error::Option {
                option,
                problem,
                fix: "add --set operator.grip=medium before it".into(),
            });
        }
        // The path of the recording is a text in the scene, so it must be UTF-8.
        if file.to_str().is_none() {
            return Err(Error::Io {
                path: file.to_owned(),
                problem: "the path is not UTF-8, so no scene can name it".to_owned(),
                fix: "rename the file or its folder".to_owned(),
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
            scene.origin.put(path, Place::Option(option.clone()));
        }
        scene.check()?;
        Ok(scene)
    }
}
