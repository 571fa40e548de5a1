//! Checks the value of a field: type, allowed names and range.

use toml::Value;
use toml::de::DeValue;

use super::problem::Problem;
use super::schema::{self, Field, Kind};
use super::unknown::{list, nearest};

/// Names that the field with this dotted path (such as `law.kind`) accepts as values; empty for a field that takes no name.
pub fn choices(path: &str) -> &'static [&'static str] {
    match schema::at(path) {
        Some(Field {
            kind: Kind::Choice(words),
            ..
        }) => words,
        _ => &[],
    }
}

/// Checks the value of a field; returns the problem, or `None` if the value is valid.
pub(crate) fn wrong_value(field: &Field, value: &Value) -> Option<Problem> {
    match (field.kind, value) {
        (Kind::Text, Value::String(_)) | (Kind::Flag, Value::Boolean(_)) => None,
        (Kind::Choice(words), Value::String(word)) => {
            (!words.contains(&word.as_str())).then(|| {
                let fix = match nearest(word, words) {
                    Some(near) => format!("did you mean {near}?"),
                    None => format!("give {}", list(words)),
                };
                Problem::new(field.path, format!("unknown value {}", shown(value)), fix)
            })
        }
        (Kind::Whole(least, most), Value::Integer(whole)) => (!(least..=most).contains(whole))
            .then(|| {
                let problem = format!("must be between {least} and {most}, is {whole}");
                Problem::new(
                    field.path,
                    problem,
                    format!("give {}", field.about_with_unit()),
                )
            }),
        (Kind::Number(range), Value::Integer(_) | Value::Float(_)) => {
            let number = value
                .as_float()
                .or_else(|| value.as_integer().map(|whole| whole as f64))
                .expect("a number");
            let problem = if !number.is_finite() {
                format!("must be a finite number, is {number}")
            } else if !range.holds(number) {
                format!("must be {}, is {number}", range.words())
            } else {
                return None;
            };
            Some(Problem::new(
                field.path,
                problem,
                format!("give {}", field.about_with_unit()),
            ))
        }
        (Kind::Numbers(fewest, most, low, high), Value::Array(items)) => {
            let problem = if (fewest..=most).contains(&items.len()) {
                let (place, item) = items.iter().enumerate().find(|(_, item)| {
                    let number = item.as_float().or_else(|| Some(item.as_integer()? as f64));
                    !number.is_some_and(|number| (low..=high).contains(&number))
                })?;
                let item = shown(item);
                format!(
                    "every item must be a number between {low} and {high}, item {} is {item}",
                    place + 1
                )
            } else {
                format!("must have {fewest} to {most} items, has {}", items.len())
            };
            let fix = format!("give {}", field.about_with_unit());
            Some(Problem::new(field.path, problem, fix))
        }
        (_, value) => Some(wrong_type(field, &shown(value))),
    }
}

/// Problem of a value whose type is not the type of the field. `is` describes the type that the value has.
pub(crate) fn wrong_type(field: &Field, is: &str) -> Problem {
    let must = match field.kind {
        Kind::Text => "text in quotes".to_owned(),
        Kind::Flag => "true or false".to_owned(),
        Kind::Choice(words) => format!("one of {}, in quotes", words.join(", ")),
        Kind::Whole(..) => "a whole number".to_owned(),
        Kind::Number(_) => "a number".to_owned(),
        Kind::Numbers(..) => "a list of numbers".to_owned(),
    };
    Problem::new(
        field.path,
        format!("must be {must}, is {is}"),
        format!("give {}", field.about_with_unit()),
    )
}

/// Formats a value for a message, on one line and shortened.
pub(crate) fn shown(value: &Value) -> String {
    match value {
        Value::String(text) if text.len() > 40 || text.contains('\n') => "a long text".to_owned(),
        Value::String(text) => format!("\"{text}\""),
        Value::Array(_) => "a list".to_owned(),
        Value::Datetime(_) => "a date or time".to_owned(),
        Value::Table(_) => "a table".to_owned(),
        plain => plain.to_string(),
    }
}

/// Converts a parsed TOML value. An integer beyond 64 bits becomes a float, so that the later error is about type or range.
pub(crate) fn leaf_value(leaf: &DeValue<'_>) -> Value {
    match leaf {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Integer(whole) => match i64::from_str_radix(whole.as_str(), whole.radix()) {
            Ok(value) => Value::Integer(value),
            Err(_) => Value::Float(whole.as_str().parse().unwrap_or(f64::INFINITY)),
        },
        // A float too large for 64 bits is read as infinite and refused as such.
        DeValue::Float(number) => Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Boolean(*flag),
        DeValue::Datetime(time) => Value::Datetime(*time),
        DeValue::Array(items) => Value::Array(
            items
                .iter()
                .map(|item| leaf_value(item.get_ref()))
                .collect(),
        ),
        // The table's content does not matter, because no field accepts a table in a list.
        DeValue::Table(_) => Value::Table(toml::Table::new()),
    }
}
