//! JSON schemas of the two files that a user writes: a scene and a device's settings. They are made from the tables of fields that
//! the file parsers use. `docs/schema/` holds the printed schemas.

use serde_json::{Value, json};
use touchstone_protocol::settings::fields;
use touchstone_sim::scene::names;
use touchstone_sim::scene::schema::{self as scene, Range};

/// JSON schema of a device's settings file, which `touchstone config import` reads.
pub fn settings() -> Value {
    let leaves = fields::FIELDS.iter().map(|field| {
        let value = match field.kind {
            fields::Kind::Number { least, most } => {
                json!({"type": "number", "minimum": exact(&least), "maximum": exact(&most)})
            }
            fields::Kind::Whole { least, most } => {
                json!({"type": "integer", "minimum": least, "maximum": most})
            }
            fields::Kind::Choice(words) => json!({"enum": words}),
            fields::Kind::Flag => json!({"type": "boolean"}),
        };
        (field.path, described(value, field.about, field.unit))
    });
    file("Settings of a device of Touchstone", leaves)
}

/// JSON schema of a scene file, which `touchstone run` reads.
pub fn scene() -> Value {
    let leaves = scene::FIELDS.iter().map(|field| {
        let value = match field.kind {
            scene::Kind::Number(range) => number(range),
            scene::Kind::Whole(least, most) => {
                json!({"type": "integer", "minimum": least, "maximum": most})
            }
            scene::Kind::Choice(words) => json!({"enum": words}),
            scene::Kind::Flag => json!({"type": "boolean"}),
            scene::Kind::Text => json!({"type": "string"}),
            scene::Kind::Numbers(fewest, most, low, high) => json!({
                "type": "array",
                "minItems": fewest,
                "maxItems": most,
                "items": {"type": "number", "minimum": low, "maximum": high},
            }),
        };
        let about = match field.absent {
            Some(absent) => format!("{}; left out: {absent}", field.about),
            None => field.about.to_owned(),
        };
        (field.path, described(value, &about, field.unit_shown()))
    });
    let about = "the shipped scene that gives all values that this file leaves out";
    let base = json!({"type": "string", "enum": names()});
    let base = std::iter::once(("base", described(base, about, "")));
    let about = "CSV file of the profile, with a column of angles and one of torques; in place of start_rad, end_rad, strength_n_m and shape";
    let file_of = described(json!({"type": "string"}), about, "");
    let profile = std::iter::once(("environment.profile.file", file_of));
    let mut schema = file("A scene of Touchstone", base.chain(leaves).chain(profile));
    schema["properties"]["feel"] =
        json!({"$ref": "#/properties/environment", "description": "another name of environment"});
    schema["not"] = json!({"required": ["environment", "feel"]});
    schema
}

fn number(range: Range) -> Value {
    let mut value = json!({"type": "number"});
    let mut also = |key: &str, bound: Value| value[key] = bound;
    match range {
        Range::Any => {}
        Range::NotZero => also("not", json!({"const": 0})),
        Range::Positive => also("exclusiveMinimum", json!(0)),
        Range::NotNegative => also("minimum", json!(0)),
        Range::AtLeast(least) => also("minimum", json!(least)),
        Range::UpTo(most) => {
            also("exclusiveMinimum", json!(0));
            also("maximum", json!(most));
        }
        Range::Within(least, most) => {
            also("minimum", json!(least));
            also("maximum", json!(most));
        }
        Range::Exactly(least, most) => {
            also("minimum", exact(&least));
            also("maximum", exact(&most));
        }
    }
    value
}

/// Converts a field's limit to a JSON number: an integer if possible, else a float, else a string.
fn exact(decimal: &impl std::fmt::Display) -> Value {
    let text = decimal.to_string();
    // Parses the text to a number, so that JSON writes the limit in the same format as all other numbers.
    let whole = text.parse::<i64>().map(Value::from);
    let number = whole.or_else(|_| text.parse::<f64>().map(Value::from));
    number.unwrap_or(Value::String(text))
}

fn described(mut value: Value, about: &str, unit: &str) -> Value {
    value["description"] = match unit {
        "" => about.into(),
        unit => format!("{about}; {unit}").into(),
    };
    value
}

/// JSON schema of a file with these fields. All fields are optional: a field that the file omits has its default value.
fn file(title: &str, leaves: impl Iterator<Item = (&'static str, Value)>) -> Value {
    let table = || json!({"type": "object", "additionalProperties": false, "properties": {}});
    let mut root = table();
    root["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    root["title"] = title.into();
    for (path, leaf) in leaves {
        let (tables, name) = path.rsplit_once('.').unwrap_or(("", path));
        let mut place = &mut root;
        for name in tables.split('.').filter(|name| !name.is_empty()) {
            place = &mut place["properties"][name];
            if place.is_null() {
                *place = table();
            }
        }
        place["properties"][name] = leaf;
    }
    root
}
