//! Loads scenes: shipped scenes, files, text, and changed copies of other scenes.

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
    /// Loads a shipped scene by its name, any other from its file. Write `./tap` for a file that bears the name of a
    /// shipped scene.
    ///
    /// # Errors
    /// [`Error::Io`] where there is neither, [`Error::File`] for a problem in the file.
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

    /// Reads a scene from TOML text; `file` is its name in messages, and relative paths in it start from its folder.
    ///
    /// # Errors
    /// [`Error::File`] for the first problem in the text.
    pub fn parse(text: &str, file: &Path) -> Result<Scene> {
        Draft::from_toml(text, file)?.build()
    }

    /// Checks a scene made or changed in code by the same rules as one read from a file.
    ///
    /// # Errors
    /// Same as [`Scene::parse`]; a field that no file has is reported as [`Error::Option`] under its dotted path.
    pub fn check(&self) -> Result<()> {
        Draft::from_scene(self).build().map(drop)
    }

    /// Finds a contradiction between fields of a scene whose single fields are all in range: the part of [`Scene::check`] that
    /// depends on several fields.
    pub fn contradiction(&self) -> Option<Error> {
        super::check::scene(self).map(|found| self.error(&found.path, found.problem, found.fix))
    }

    /// The scene with fields changed in code, checked like one from a file.
    ///
    /// A problem of a changed field is reported with its new value; every other field keeps the place where it was
    /// written.
    ///
    /// # Errors
    /// [`Error::Option`] for a change that breaks the scene.
    pub fn with(&self, change: impl FnOnce(&mut Scene)) -> Result<Scene> {
        let mut changed = self.clone();
        change(&mut changed);
        Draft::from_scene(&changed)
            .changed_since(&Draft::from_scene(self))
            .build()
    }

    /// Lets a recording move the hand instead of the scene's own motion (`--operator-motion FILE`).
    ///
    /// The recording's mean is placed on the wall's surface, unscaled, so that the hand goes in and out of the wall.
    /// The run takes as long as the recording; the device starts at rest where the hand starts. `--set
    /// motion.scale=…` and `--set motion.offset_rad=…` change the placement afterwards. [`RestPath::note`](super::RestPath::note) says in
    /// words what was chosen.
    ///
    /// # Errors Whatever is wrong with the recording, see [`Recording::read`]; a path that is not UTF-8; [`Error::Option`] where the
    /// scene has no hand.
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
        // A scene is text, and so is the name of the recording in it.
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
