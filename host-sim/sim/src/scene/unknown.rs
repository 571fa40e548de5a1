//! Explains an unknown field name in a scene: a wrong unit, the wrong table or a typing error.

use toml::Value;

use super::renamed::{environment_of_feel, renamed};
use super::schema::{self, Field, Kind};
use super::units;

/// Problem and remedy, as text, for a field or table name that does not exist.
///
/// `motion` is the name of the scene's motion, if known: it decides which fields `[operator.motion]` has.
pub(crate) fn explain(path: &str, motion: Option<&str>, value: Option<&Value>) -> (String, String) {
    let (table, name) = path.rsplit_once('.').unwrap_or(("", path));
    if let Some(field) = schema::at(path) {
        return (
            format!(
                "the motion `{}` has no such field",
                motion.unwrap_or("none")
            ),
            format!("remove it, or use it with {}", list(field.motions)),
        );
    }
    if let Some(new) = renamed(path) {
        return was_renamed(new);
    }
    if environment_of_feel(path) != path {
        let problem = "[environment] is the same table".to_owned();
        return (problem, "move its fields there".to_owned());
    }
    let here: Vec<&Field> = schema::FIELDS
        .iter()
        .filter(|field| field.table() == table && motion.is_none_or(|motion| field.suits(motion)))
        .collect();
    if let Some(answer) = wrong_unit(name, &here, value) {
        return answer;
    }
    if let Some(field) = schema::FIELDS.iter().find(|field| field.name() == name) {
        return (
            format!("unknown field in {}", heading(table)),
            format!("move it to {}", heading(field.table())),
        );
    }
    let names = schema::inside(table);
    let names: Vec<&str> = names
        .into_iter()
        .filter(|name| {
            schema::is_table(&join(table, name)) || here.iter().any(|field| field.name() == *name)
        })
        .collect();
    let what = if matches!(value, Some(Value::Table(_))) {
        "table"
    } else {
        "field"
    };
    let problem = format!("unknown {what}");
    match nearest(name, &names).or_else(|| nearest_stem(name, &here)) {
        Some(near) => (problem, format!("did you mean {near}?")),
        None => (problem, format!("{} has {}", heading(table), list(&names))),
    }
}

/// Problem and remedy, as text, for a setting that is now called `new`.
pub(crate) fn was_renamed(new: &str) -> (String, String) {
    let fix = if new.ends_with("_per_ms") {
        // The former setting was a fraction per control period; the new one is a fraction per millisecond.
        format!("write {new}, of the value times timing.rate_hz/1000")
    } else {
        format!("write {new}")
    };
    ("this setting has a new name".to_owned(), fix)
}

/// Problem and remedy, as text, if `name` is one of the given fields with a wrong unit or without a unit; else `None`.
pub(crate) fn wrong_unit(
    name: &str,
    fields: &[&Field],
    value: Option<&Value>,
) -> Option<(String, String)> {
    // Fields with the longest name first, because `touch_ramp_…` also begins with `touch`.
    let mut stems: Vec<(&str, &Field)> = fields
        .iter()
        .filter_map(|field| Some((field.stem()?, *field)))
        .collect();
    stems.sort_by_key(|(stem, _)| std::cmp::Reverse(stem.len()));
    for (stem, field) in stems {
        let Some(rest) = name.strip_prefix(stem) else {
            continue;
        };
        if rest.is_empty() {
            let problem = format!(
                "the unit is missing, this field is in {}",
                field.unit_shown()
            );
            return Some((problem, format!("write {}", field.name())));
        }
        let Some(end) = rest
            .strip_prefix('_')
            .filter(|end| units::looks_like_unit(end))
        else {
            continue;
        };
        let problem = format!("wrong unit, this field is in {}", field.unit_shown());
        return Some((problem, converted(field, end, value)));
    }
    None
}

/// Remedy such as "write inertia_kg_m2 = 1e-5". The value is converted to the field's unit if the unit that the user wrote is
/// known.
fn converted(field: &Field, given: &str, value: Option<&Value>) -> String {
    let own = units::by_suffix(field.unit).expect("a field with a stem has a unit");
    let known = units::by_suffix(given).filter(|unit| unit.dimension == own.dimension);
    let value = match value {
        Some(Value::Float(value)) => Some(*value),
        Some(Value::Integer(value)) => Some(*value as f64),
        _ => None,
    };
    match (known, value) {
        (Some(unit), Some(value)) => {
            let value = value * unit.si / own.si;
            let whole = matches!(field.kind, Kind::Whole(..)) && value.fract() == 0.0;
            let value = if whole {
                format!("{value:.0}")
            } else {
                units::tidy(value)
            };
            format!("write {} = {value}", field.name())
        }
        (Some(unit), None) => {
            format!(
                "write {} (1 {} = {} {})",
                field.name(),
                unit.shown,
                units::tidy(unit.si / own.si),
                own.shown
            )
        }
        (None, _) => format!("write {} and give the value in {}", field.name(), own.shown),
    }
}

/// Guesses which of `names` the user meant by `name`. It is the only one that begins with all words of `name`, else the most
/// similar one, if at most a quarter of the letters of `name` (at least one) differ. Capital letters, and underscores in place of
/// hyphens, make no difference.
pub fn nearest<'a>(name: &str, names: &[&'a str]) -> Option<&'a str> {
    // No field has such a long name, and the time to compare grows with the product of the lengths.
    if name.len() > 200 {
        return None;
    }
    let plain = |name: &str| name.to_lowercase().replace('_', "-");
    let wanted = plain(name);
    let begins = |candidate: &&&str| plain(candidate).starts_with(&format!("{wanted}-"));
    let mut longer = names.iter().filter(begins);
    if let (Some(only), None) = (longer.next(), longer.next()) {
        return Some(only);
    }
    let near = |candidate: &str| strsim::damerau_levenshtein(&wanted, &plain(candidate));
    let best = names
        .iter()
        .copied()
        .min_by_key(|candidate| near(candidate))?;
    (near(best) <= (name.len() / 4).max(1)).then_some(best)
}

/// The field whose name, without its unit, is most similar to `name` without a unit.
fn nearest_stem(name: &str, fields: &[&Field]) -> Option<&'static str> {
    let stems: Vec<&str> = fields.iter().filter_map(|field| field.stem()).collect();
    let stem = nearest(name, &stems)?;
    fields
        .iter()
        .find(|field| field.stem() == Some(stem))
        .map(|field| field.name())
}

/// Heading of a table for messages, such as `[law.filter]`; a phrase for the top level of the file.
fn heading(table: &str) -> String {
    if table.is_empty() {
        "the top of the scene".to_owned()
    } else {
        format!("[{table}]")
    }
}

/// Joins table and name with a dot.
pub(crate) fn join(table: &str, name: &str) -> String {
    if table.is_empty() {
        name.to_owned()
    } else {
        format!("{table}.{name}")
    }
}

/// Joins words to a phrase such as "a, b or c".
pub fn list(words: &[&str]) -> String {
    match words {
        [] => "nothing".to_owned(),
        [one] => (*one).to_owned(),
        [most @ .., last] => format!("{} or {last}", most.join(", ")),
    }
}
