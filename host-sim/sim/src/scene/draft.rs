//! Reads a scene from TOML text into a list of fields, each with its line, which overrides can change. Checks all fields
//! afterwards.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use toml::Value;
use toml::de::{DeTable, DeValue};

use super::check;
use super::experiment::Scene;
use super::operator::{Grip, Hand};
use super::origin::{Origin, Place};
use super::problem::Problem;
use super::profile_file;
use super::renamed::environment_of_feel;
use super::schema::{self, Field, Kind, MOTION_KIND};
use super::shipped;
use super::unknown::{explain, join, list, nearest};
use super::value::{choices, leaf_value, shown, wrong_type, wrong_value};
use crate::error::{Error, Result};
use crate::harmless;

/// Top-level key of a scene file that names the shipped scene on which the file builds. A scene that has been read has no such key.
const BASE: &str = "base";

/// Key of a scene file that names the CSV file of a torque profile. A scene that has been read has the profile's points instead.
pub(crate) const PROFILE_FILE: &str = "environment.profile.file";

/// A scene that has not been checked yet: values by the dotted paths of their fields.
#[derive(Debug, Clone)]
pub(crate) struct Draft {
    pub fields: BTreeMap<String, Value>,
    /// Tables whose heading the text contains, including empty ones: `[encoder]` alone adds an encoder.
    pub tables: BTreeSet<String>,
    pub origin: Origin,
}

impl Draft {
    /// Reads the fields that a TOML text gives, without those of its base. `file` is the name of the text in error messages.
    pub fn of_text(text: &str, file: &Path) -> Result<Self> {
        let table = DeTable::parse(text).map_err(|error| syntax_error(text, file, &error))?;
        let mut draft = Draft {
            fields: BTreeMap::new(),
            tables: BTreeSet::new(),
            origin: Origin::of_file(file),
        };
        // The line ends are searched only once, because a file may have a hundred thousand keys.
        let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        let line = |offset| 1 + ends.partition_point(|end| *end < offset);
        draft.take("", table.get_ref(), &line);
        Ok(draft)
    }

    /// Takes the fields of tables that do not come from a file.
    pub fn of_tables(tables: toml::Table) -> Self {
        let mut draft = Draft {
            fields: BTreeMap::new(),
            tables: BTreeSet::new(),
            origin: Origin::default(),
        };
        draft.take_values("", tables);
        draft
    }

    /// Reads a scene from TOML text. Only the TOML syntax is checked here.
    pub fn from_toml(text: &str, file: &Path) -> Result<Self> {
        let mut draft = Self::of_text(text, file)?;
        draft.take_profile(file)?;
        let stem = file.file_stem();
        let mut draft = draft.completed(stem.map(|it| it.to_string_lossy().into_owned()))?;
        // The path of a recording is relative to the scene's folder, not to the current folder.
        if let (Some(Value::String(recording)), Some(folder)) =
            (draft.fields.get_mut("operator.motion.file"), file.parent())
        {
            *recording = folder.join(&*recording).to_string_lossy().into_owned();
        }
        Ok(draft)
    }

    /// Adds the fields of the base, this name if the scene has none, and the custom grip if the scene describes its hand.
    pub fn completed(mut self, name: Option<String>) -> Result<Self> {
        self.take_base()?;
        if let Some(name) = name {
            self.fields
                .entry("name".into())
                .or_insert(Value::String(name));
        }
        if self.has_table("operator.hand") && !self.fields.contains_key("operator.grip") {
            self.fields.insert(
                "operator.grip".into(),
                Value::String(Grip::Custom.name().into()),
            );
        }
        Ok(self)
    }

    /// Replaces the key that names a torque profile's file by the profile's points.
    fn take_profile(&mut self, scene: &Path) -> Result<()> {
        let Some(named) = self.fields.remove(PROFILE_FILE) else {
            return Ok(());
        };
        let Value::String(name) = &named else {
            let problem = format!("must be text, is {}", shown(&named));
            let fix = "give the path of a CSV file in quotes";
            return Err(self.origin.error(PROFILE_FILE, problem, fix));
        };
        let given = ["start_rad", "end_rad", "strength_n_m", "shape"]
            .map(|field| format!("environment.profile.{field}"));
        if let Some(twice) = given.iter().find(|path| self.fields.contains_key(*path)) {
            let problem = format!("{name} gives it too");
            let fix = "leave it out, or leave file out";
            return Err(self.origin.error(twice, problem, fix));
        }
        let per_rev = match self.fields.get("environment.profile.per_rev") {
            None => Some(0),
            Some(value) => value.as_integer().and_then(|it| u32::try_from(it).ok()),
        };
        // A wrong number of copies is reported with all other wrong values.
        let Some(per_rev) = per_rev else {
            return Ok(());
        };
        let file = scene.parent().unwrap_or(Path::new("")).join(name);
        let drawn = profile_file::read(&file, per_rev)?;
        let values = [
            Value::Float(drawn.start_rad),
            Value::Float(drawn.end_rad),
            Value::Float(drawn.strength_n_m),
            Value::Array(drawn.shape.into_iter().map(Value::Float).collect()),
        ];
        let place = self.origin.place(PROFILE_FILE);
        for (path, value) in given.into_iter().zip(values) {
            self.origin.put(&path, place.clone());
            self.fields.insert(path, value);
        }
        let copies = Value::Integer(per_rev.into());
        self.fields
            .insert("environment.profile.per_rev".to_owned(), copies);
        if let Some(note) = drawn.note {
            self.origin.note(note);
        }
        Ok(())
    }

    /// Fills in the fields that the text leaves out with the values of the shipped scene that the key `base` names.
    fn take_base(&mut self) -> Result<()> {
        let Some(base) = self.fields.remove(BASE) else {
            return Ok(());
        };
        let names = shipped::names();
        let found = base.as_str().and_then(shipped::text);
        let Some((text, file)) = found else {
            let near = base.as_str().and_then(|name| nearest(name, &names));
            let fix = match near {
                Some(near) => format!("did you mean \"{near}\"?"),
                None => format!("give a shipped scene: {}", list(&names)),
            };
            let problem = format!("no shipped scene {}", shown(&base));
            return Err(self.origin.error(BASE, problem, fix));
        };
        let below = Draft::from_toml(text, &file)?;
        // A hand or motion in the text replaces that of the base scene as a whole.
        let writes_hand =
            self.fields.contains_key("operator.grip") || self.has_table("operator.hand");
        let motion = match self.fields.get(MOTION_KIND) {
            Some(Value::String(kind)) => Some(kind.clone()),
            _ => None,
        };
        let is_taken = |path: &str| {
            let field = schema::at(path);
            let suits = motion
                .as_deref()
                .is_none_or(|kind| field.is_none_or(|it| it.suits(kind)));
            let is_hand = path == "operator.grip" || path.starts_with("operator.hand");
            path != "name" && suits && !(writes_hand && is_hand)
        };
        self.tables
            .extend(below.tables.into_iter().filter(|path| is_taken(path)));
        for (path, value) in below.fields.into_iter().filter(|(path, _)| is_taken(path)) {
            self.fields.entry(path).or_insert(value);
        }
        Ok(())
    }

    /// Lists the fields of a checked scene, each with the file and line, or the option, that gave its value.
    pub fn from_scene(scene: &Scene) -> Self {
        let mut draft = Draft {
            fields: BTreeMap::new(),
            tables: BTreeSet::new(),
            origin: scene.origin.clone(),
        };
        let table = toml::Table::try_from(scene)
            .expect("a scene is a plain tree of tables, numbers, words and flags");
        draft.take_values("", table);
        draft
    }

    /// Marks every field that differs from `before` as changed in code, so that errors quote its new value instead of a file's
    /// line.
    pub fn changed_since(mut self, before: &Draft) -> Self {
        for (path, value) in &self.fields {
            if before.fields.get(path) != Some(value) {
                let place = Place::Option(format!("{path} = {}", shown(value)));
                self.origin.put(path, place);
            }
        }
        self
    }

    fn take(&mut self, table: &str, values: &DeTable<'_>, line: &dyn Fn(usize) -> usize) {
        let twice = values.contains_key("environment");
        for (key, value) in values {
            let path = named(table, key.get_ref(), twice);
            self.origin.put(&path, Place::Line(line(key.span().start)));
            match value.get_ref() {
                DeValue::Table(inner) => {
                    self.tables.insert(path.clone());
                    self.take(&path, inner, line);
                }
                leaf => {
                    self.fields.insert(path, leaf_value(leaf));
                }
            }
        }
    }

    fn take_values(&mut self, table: &str, values: toml::Table) {
        let twice = values.contains_key("environment");
        for (key, value) in values {
            let path = named(table, &key, twice);
            match value {
                Value::Table(inner) => {
                    self.tables.insert(path.clone());
                    self.take_values(&path, inner);
                }
                leaf => {
                    self.fields.insert(path, leaf);
                }
            }
        }
    }

    /// Whether the text contains the table, by its heading or by a field in the table.
    pub fn has_table(&self, table: &str) -> bool {
        let inside = |path: &String| {
            path.strip_prefix(table)
                .is_some_and(|rest| rest.starts_with('.'))
        };
        self.tables.contains(table) || self.fields.keys().any(inside)
    }

    /// Removes the table and all its fields.
    pub fn remove_table(&mut self, table: &str) {
        let inside = |path: &String| {
            path == table
                || path
                    .strip_prefix(table)
                    .is_some_and(|rest| rest.starts_with('.'))
        };
        self.tables.retain(|path| !inside(path));
        self.fields.retain(|path, _| !inside(path));
    }

    /// Writes the present grip's values into `[operator.hand]`, so that one of them can be changed.
    pub fn spell_out_hand(&mut self) {
        let grip = self
            .fields
            .get("operator.grip")
            .and_then(Value::as_str)
            .unwrap_or("none");
        let preset = [Grip::Light, Grip::Medium, Grip::Firm]
            .into_iter()
            .find(|preset| preset.name() == grip);
        let hand = preset.and_then(Grip::hand).unwrap_or_else(Hand::default);
        let values = toml::Table::try_from(hand).expect("a hand is a table of numbers");
        self.take_values("operator.hand", values);
        self.fields.insert(
            "operator.grip".into(),
            Value::String(Grip::Custom.name().into()),
        );
    }

    /// Name of the hand's motion in the text, valid or not; the name `none` for a scene without a motion. `None` if the table
    /// `operator.motion` has no kind, or one that is not text.
    pub fn motion(&self) -> Option<&str> {
        match self.fields.get(MOTION_KIND) {
            Some(Value::String(kind)) => Some(kind),
            Some(_) => None,
            None => (!self.has_table("operator.motion")).then_some("none"),
        }
    }

    /// Checks all fields and builds the scene. Of several errors, the one that comes first in the file is returned.
    pub fn build(mut self) -> Result<Scene> {
        let mut problems = self.problems();
        // Problems of overrides come first, then those of the file by line; on one line the outermost field comes first.
        problems
            .sort_by_cached_key(|problem| (self.origin.place(&problem.path), problem.path.len()));
        if let Some(Problem { path, problem, fix }) = problems.into_iter().next() {
            return Err(self.origin.error(&path, problem, fix));
        }
        for (path, value) in &mut self.fields {
            let number = matches!(
                schema::at(path),
                Some(Field {
                    kind: Kind::Number(_),
                    ..
                })
            );
            if let (true, Value::Integer(whole)) = (number, &*value) {
                *value = Value::Float(*whole as f64);
            }
        }
        let mut scene: Scene = self.nested().try_into().map_err(|error: toml::de::Error| {
            self.origin.error(
                "",
                error.message().lines().next().unwrap_or("not a scene"),
                "compare with a shipped scene",
            )
        })?;
        // Name and description are printed in tables and logs, where they must be one line.
        scene.name = harmless::one_line(&scene.name);
        scene.description = harmless::one_line(&scene.description);
        scene.origin = self.origin;
        match check::scene(&scene) {
            Some(Problem { path, problem, fix }) => Err(scene.origin.error(&path, problem, fix)),
            None => Ok(scene),
        }
    }

    /// Lists the problems of single fields: wrong types, values out of range, and the first unknown name.
    pub(super) fn problems(&self) -> Vec<Problem> {
        // An unknown motion is reported by itself; its fields are then not checked, because they are unknown too.
        let motion = self
            .motion()
            .filter(|motion| choices(MOTION_KIND).contains(motion));
        let mut problems = Vec::new();
        // Explaining an unknown name takes time, and only the first is reported.
        let mut unknown: Vec<(&String, Option<&Value>)> = Vec::new();
        for table in self.tables.iter().filter(|table| !schema::is_table(table)) {
            match schema::at(table) {
                Some(field) => problems.push(wrong_type(field, "a table")),
                None => unknown.push((table, None)),
            }
        }
        for (path, value) in &self.fields {
            let known =
                schema::at(path).filter(|field| motion.is_none_or(|motion| field.suits(motion)));
            match known {
                Some(field) => problems.extend(wrong_value(field, value)),
                None if schema::is_table(path) => {
                    let names = schema::inside(path);
                    let fix = format!("write a table [{path}] with {}", names.join(", "));
                    problems.push(Problem::new(
                        path,
                        format!("must be a table, is {}", shown(value)),
                        fix,
                    ));
                }
                None => unknown.push((path, Some(value))),
            }
        }
        let first = unknown
            .into_iter()
            .min_by_key(|(path, _)| (self.origin.place(path), path.len()));
        if let Some((path, value)) = first {
            let table = Value::Table(toml::Table::new());
            let (problem, fix) = explain(path, motion, value.or(Some(&table)));
            problems.push(Problem::new(path, problem, fix));
        }
        if self.has_table("operator.motion") && !self.fields.contains_key(MOTION_KIND) {
            problems.push(Problem::new(
                MOTION_KIND,
                "missing",
                format!("give {}", list(choices(MOTION_KIND))),
            ));
        }
        if motion == Some("recorded") && !self.fields.contains_key("operator.motion.file") {
            problems.push(Problem::new(
                "operator.motion.file",
                "missing",
                "give the recording, a CSV file with time and angle",
            ));
        }
        problems
    }

    /// Converts the fields to nested TOML tables.
    fn nested(&self) -> toml::Table {
        let mut top = toml::Table::new();
        for table in &self.tables {
            inner(&mut top, table);
        }
        for (path, value) in &self.fields {
            let (table, name) = path.rsplit_once('.').unwrap_or(("", path));
            inner(&mut top, table).insert(name.to_owned(), value.clone());
        }
        top
    }
}

/// Path of a key in a table. `feel` is `environment`; in a scene that has both (`twice`) it stays an unknown name.
fn named(table: &str, key: &str, twice: bool) -> String {
    let path = join(table, key);
    if twice {
        path
    } else {
        environment_of_feel(&path).into_owned()
    }
}

/// The table at a dotted path; creates it if it does not exist.
fn inner<'a>(top: &'a mut toml::Table, path: &str) -> &'a mut toml::Table {
    path.split('.')
        .filter(|part| !part.is_empty())
        .fold(top, |table, part| {
            let entry = table
                .entry(part)
                .or_insert_with(|| Value::Table(toml::Table::new()));
            entry
                .as_table_mut()
                .expect("no field has the path of a table: that was checked")
        })
}

/// Line number of a byte offset in the text, from 1.
fn line_of(text: &str, offset: usize) -> usize {
    1 + text.as_bytes()[..offset.min(text.len())]
        .iter()
        .filter(|byte| **byte == b'\n')
        .count()
}

/// Converts a TOML syntax error to an error with file and line.
fn syntax_error(text: &str, file: &Path, error: &toml::de::Error) -> Error {
    let offset = error.span().map_or(0, |span| span.start);
    let line = line_of(text, offset);
    let (key, value) = text
        .lines()
        .nth(line - 1)
        .and_then(|line| line.split_once('='))
        .unwrap_or_default();
    let (key, value) = (key.trim(), value.split('#').next().unwrap_or("").trim());
    let plain = |more: &str| {
        value
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || more.contains(c))
    };
    // The two mistakes that the TOML parser's own message explains least.
    let (problem, fix) = if value.starts_with(|c: char| c.is_ascii_alphabetic()) && plain("-_./") {
        (
            "text without quotes".to_owned(),
            format!("write {key} = \"{value}\""),
        )
    } else if value.contains(',') && value.replacen(',', ".", 1).parse::<f64>().is_ok() {
        (
            "a comma in a number".to_owned(),
            format!("write {key} = {}", value.replacen(',', ".", 1)),
        )
    } else {
        let problem = format!(
            "not valid TOML: {}",
            error.message().lines().collect::<Vec<_>>().join(", ")
        );
        (
            problem,
            "write key = value lines under [table] headings, text in quotes".to_owned(),
        )
    };
    Error::File {
        file: file.to_owned(),
        line,
        field: if key.is_empty() {
            "scene".to_owned()
        } else {
            key.to_owned()
        },
        problem,
        fix,
    }
}
