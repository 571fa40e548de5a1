//! Changes fields of a scene from the command line: `--set key=value`, `--law`, and files of settings.

use std::path::Path;

use toml::Value;

use super::draft::{Draft, PROFILE_FILE};
use super::experiment::Scene;
use super::origin::Place;
use super::renamed::{environment_of_feel, renamed};
use super::schema::{self, Field, Kind, MOTION_KIND};
use super::unknown::{explain, list, nearest, was_renamed, wrong_unit};
use crate::error::{Error, Result};

/// Value of `--set` that removes an optional field or table from the scene: `--set encoder=none`.
const NOTHING: &str = "none";

impl Scene {
    /// Returns the scene with fields changed, each given as `key=value`. The last value for a field wins. The scene is checked
    /// once, after all changes.
    ///
    /// A key is a dotted path as in the scene file (`device.inertia_kg_m2`), or the end of a path (`k_soft_n_m_per_rad`,
    /// `filter.mass_kg_m2`) if no other path of a field or of an optional table ends so. Text needs no quotes. The value `none`
    /// removes an optional field or table. A new grip replaces `[operator.hand]`. A single value of `operator.hand` changes the
    /// present grip into a custom one. A new kind of motion keeps the values of those fields that both kinds have.
    ///
    /// # Errors
    /// [`Error::Option`] for an unknown or ambiguous key, and for a value that the scene's check refuses.
    pub fn with_overrides<S: AsRef<str>>(&self, sets: &[S]) -> Result<Scene> {
        let mut draft = Draft::from_scene(self);
        for set in sets {
            let set = set.as_ref();
            let option = format!("--set {set}");
            let Some((key, value)) = set.split_once('=') else {
                let fix = "write --set KEY=VALUE, e.g. --set wall.k_desired_n_m_per_rad=20".into();
                return Err(Error::Option {
                    option,
                    problem: "no value".into(),
                    fix,
                });
            };
            apply(&mut draft, key.trim(), value.trim(), option)?;
        }
        draft.build()
    }

    /// Returns the scene with one field changed by an option with its own name. For example, `--law tdpa` calls
    /// `with_option("law.kind", "tdpa", "--law tdpa")`.
    ///
    /// `option` is the text that the user wrote; errors quote it. Otherwise the rules are those of
    /// [`with_overrides`](Scene::with_overrides).
    ///
    /// # Errors
    /// Same as [`with_overrides`](Scene::with_overrides).
    pub fn with_option(&self, key: &str, value: &str, option: &str) -> Result<Scene> {
        let mut draft = Draft::from_scene(self);
        apply(&mut draft, key, value, option.to_owned())?;
        draft.build()
    }
}

/// Tables of a scene whose fields a settings file may change.
const SETTINGS: [&str; 3] = ["timing", "wall", "law"];

/// Line number in the text, from 1, of a TOML syntax error.
fn line_of(text: &str, error: &toml::de::Error) -> usize {
    let end = error.span().map_or(0, |span| span.start);
    1 + text.get(..end).unwrap_or(text).matches('\n').count()
}

impl Scene {
    /// Returns the scene with the fields of `timing`, `wall` and `law` that a settings file gives, such as a file that `tune`
    /// writes. The scene is checked once, after all changes.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read. [`Error::Option`], which names file and field, if the file is not TOML, has an
    /// unknown setting, or has a value that the scene's check refuses.
    pub fn with_settings(&self, file: &Path) -> Result<Scene> {
        let text = crate::input::text(file, crate::input::MOST_OF_SETTINGS).map_err(|error| {
            Error::Io {
                path: file.to_owned(),
                problem: error.to_string(),
                fix: "give a file of settings, such as `touchstone tune --out FILE` writes".into(),
            }
        })?;
        let option = |key: &str| format!("--settings {}: {key}", file.display());
        let table: toml::Table = text
            .parse()
            .map_err(|error: toml::de::Error| Error::Option {
                option: option(&format!("line {}", line_of(&text, &error))),
                problem: error.message().to_owned(),
                fix: "correct the TOML syntax of the file".into(),
            })?;
        let mut leaves = Vec::new();
        flatten("", &table, &mut leaves);
        let mut draft = Draft::from_scene(self);
        for (path, value) in leaves {
            let first = path.split('.').next().unwrap_or_default();
            if !SETTINGS.contains(&first) || schema::at(&path).is_none() {
                return Err(Error::Option {
                    option: option(&path),
                    problem: "no setting of a law".into(),
                    fix: format!("leave it out; settings are fields of {}", list(&SETTINGS)),
                });
            }
            let value = match value {
                Value::String(word) => word.clone(),
                other => other.to_string(),
            };
            apply(&mut draft, &path, &value, option(&path))?;
        }
        draft.build()
    }
}

/// Adds every value of a TOML table to `leaves`, with its dotted path.
fn flatten<'v>(name: &str, table: &'v toml::Table, leaves: &mut Vec<(String, &'v Value)>) {
    for (key, value) in table {
        let path = match name {
            "" => key.clone(),
            name => format!("{name}.{key}"),
        };
        match value {
            Value::Table(inner) => flatten(&path, inner, leaves),
            leaf => leaves.push((path, leaf)),
        }
    }
}

/// Full path of the field or table that a key of `--set` names; `None` if it names none, or if it is the end of several paths.
pub fn path_of(key: &str) -> Option<String> {
    candidates(&environment_of_feel(key)).ok()
}

fn apply(draft: &mut Draft, key: &str, value: &str, option: String) -> Result<()> {
    let key = &environment_of_feel(key);
    let error = |problem: String, fix: String| Error::Option {
        option: option.clone(),
        problem,
        fix,
    };
    let path = resolve(draft, key, value).map_err(|(problem, fix)| error(problem, fix))?;
    let Some(field) = schema::at(&path) else {
        // A table as a whole can only be removed.
        let optional = schema::OPTIONAL_TABLES
            .iter()
            .any(|(table, _)| *table == path);
        if value != NOTHING || !optional {
            let names: Vec<String> = schema::inside(&path)
                .iter()
                .map(|name| format!("{path}.{name}"))
                .collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            return Err(error(
                format!("{path} is a table"),
                format!("set a field of it: {}", list(&names)),
            ));
        }
        draft.remove_table(&path);
        return Ok(());
    };
    if value == NOTHING && field.absent.is_some() {
        draft.fields.remove(&path);
        return Ok(());
    }
    let value = parse(field, value);
    if path == "operator.grip" && value.as_str() != Some("custom") {
        draft.remove_table("operator.hand");
    }
    if path.starts_with("operator.hand.") && !draft.has_table("operator.hand") {
        draft.spell_out_hand();
    }
    if let (MOTION_KIND, Some(kind)) = (&*path, value.as_str()) {
        draft
            .fields
            .retain(|path, _| schema::at(path).is_none_or(|field| field.suits(kind)));
    }
    draft.fields.insert(path.clone(), value);
    draft.origin.put(&path, Place::Option(option));
    Ok(())
}

/// Full path of the field that a key of `--set` names. Error: the problem and its remedy, as text.
fn resolve(draft: &Draft, key: &str, value: &str) -> std::result::Result<String, (String, String)> {
    candidates(key).map_err(|several| match several[..] {
        [] => unknown(draft, key, value),
        ref several => (
            "several fields end so".into(),
            format!("write {}", list(several)),
        ),
    })
}

/// Full path for a key of `--set`: the key itself, or the only path that ends with it. Error: all paths that end with the key.
fn candidates(key: &str) -> std::result::Result<String, Vec<&'static str>> {
    if schema::at(key).is_some() || schema::is_table(key) {
        return Ok(key.to_owned());
    }
    let ends = |path: &str| {
        path.strip_suffix(key)
            .is_some_and(|rest| rest.ends_with('.'))
    };
    let fields: Vec<&'static str> = schema::FIELDS
        .iter()
        .map(|field| field.path)
        .filter(|path| ends(path))
        .collect();
    let tables: Vec<&'static str> = schema::OPTIONAL_TABLES
        .iter()
        .map(|(table, _)| *table)
        .filter(|path| ends(path))
        .collect();
    match [fields, tables].concat() {
        one if one.len() == 1 => Ok(one[0].to_owned()),
        several => Err(several),
    }
}

/// Problem and remedy, as text, for a key of `--set` that names no field.
fn unknown(draft: &Draft, key: &str, value: &str) -> (String, String) {
    if PROFILE_FILE.ends_with(key) && key.ends_with("file") {
        let problem = "only a scene's file names the file of a profile".to_owned();
        let fix = format!("write a scene with [environment.profile] and file = \"{value}\"");
        return (problem, fix);
    }
    let value = value.parse::<f64>().ok().map(Value::Float);
    if key
        .rsplit_once('.')
        .is_some_and(|(table, _)| schema::is_table(table))
    {
        return explain(key, draft.motion(), value.as_ref());
    }
    if let Some(new) = renamed(key) {
        return was_renamed(new);
    }
    // A key that is the end of a path is compared with the ends of all paths.
    let all: Vec<&Field> = schema::FIELDS.iter().collect();
    if let Some(answer) = wrong_unit(key, &all, value.as_ref()) {
        return answer;
    }
    let name = key.rsplit('.').next().unwrap_or(key);
    let names: Vec<&str> = all.iter().map(|field| field.name()).collect();
    let fix = match nearest(name, &names) {
        Some(near) => format!("did you mean {near}?"),
        None => "see the scene's fields with --print".to_owned(),
    };
    ("unknown field".into(), fix)
}

/// Converts the text after `=` to a TOML value that fits the field. Text fields need no quotes.
fn parse(field: &Field, text: &str) -> Value {
    let toml = text.parse::<Value>().ok();
    match (field.kind, toml) {
        (Kind::Text | Kind::Choice(_), Some(Value::String(quoted))) => Value::String(quoted),
        (Kind::Text | Kind::Choice(_), _) => Value::String(text.to_owned()),
        (_, Some(value)) => value,
        // TOML does not read `.5` and the like as numbers, so they are parsed here. Other text is refused by the check.
        (_, None) => text
            .parse()
            .map_or_else(|_| Value::String(text.to_owned()), Value::Float),
    }
}
