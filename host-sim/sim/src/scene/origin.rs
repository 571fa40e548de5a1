//! Remembers in which file and line each value of a scene was written, so that errors found late can name the place.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::Error;

/// The place in a file or on the command line where a field or table of a scene was written.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Place {
    /// The value comes from the command line, as the user wrote it: `--set key=value`.
    Option(String),
    /// The value comes from this line of the scene's file, counted from 1.
    Line(usize),
}

/// The file of a scene, and the line or option that gave each field.
#[derive(Debug, Clone, Default)]
pub struct Origin {
    file: Option<PathBuf>,
    places: BTreeMap<String, Place>,
    notes: Vec<String>,
    /// Whether another program sent the scene to a device, whose force limit then counts.
    pub(crate) is_sent: bool,
}

/// Any two origins are equal, so that a comparison of scenes compares values only.
impl PartialEq for Origin {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Origin {
    /// Origin of a scene read from `file`; the places of its fields are added later.
    pub(crate) fn of_file(file: &Path) -> Self {
        Origin {
            file: Some(file.to_owned()),
            ..Origin::default()
        }
    }

    /// The file, as the user named it; `None` for a scene made in code.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Sentences for the user about values that were changed when the scene was read, such as a resampled torque profile.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Adds a sentence to the notes.
    pub(crate) fn note(&mut self, sentence: String) {
        self.notes.push(sentence);
    }

    /// Records where the field `path` was written.
    pub(crate) fn put(&mut self, path: &str, place: Place) {
        self.places.insert(path.to_owned(), place);
    }

    /// Whether the file or an option gives the field explicitly.
    pub(crate) fn is_written(&self, path: &str) -> bool {
        self.places.contains_key(path)
    }

    /// Place where the field was written, else the place of the innermost table around the field, else the first line of the file.
    pub(crate) fn place(&self, path: &str) -> Place {
        let mut path = path;
        loop {
            if let Some(place) = self.places.get(path) {
                return place.clone();
            }
            match path.rsplit_once('.') {
                Some((table, _)) => path = table,
                None => return Place::Line(1),
            }
        }
    }

    /// Error for a field with the dotted path `path`. It names file and line, or the option that set the field.
    pub fn error(&self, path: &str, problem: impl Into<String>, fix: impl Into<String>) -> Error {
        let (problem, fix) = (problem.into(), fix.into());
        match (self.place(path), &self.file) {
            (Place::Option(option), _) => Error::Option {
                option,
                problem,
                fix,
            },
            (Place::Line(line), Some(file)) => Error::File {
                file: file.clone(),
                line,
                field: path.to_owned(),
                problem,
                fix,
            },
            (Place::Line(_), None) => Error::Option {
                option: path.to_owned(),
                problem,
                fix,
            },
        }
    }
}
