//! Builds JSON schemas of flat records from lists of their fields.

use serde_json::{Map, Value, json};

/// A field: name, type, and meaning with unit. Types are `number`, `integer`, `string` and `boolean`; a trailing `?` also allows
/// null.
pub type Field = (&'static str, &'static str, &'static str);

fn leaf((_, kind, meaning): &Field) -> Value {
    match kind.strip_suffix('?') {
        Some(kind) => json!({"type": [kind, "null"], "description": meaning}),
        None => json!({"type": kind, "description": meaning}),
    }
}

/// Schema of an object with these fields, and with further fields whose schemas are given.
pub fn object(fields: &[Field], further: &[(&str, Value)]) -> Value {
    let mut properties: Map<String, Value> = fields
        .iter()
        .map(|field| (field.0.to_owned(), leaf(field)))
        .collect();
    properties.extend(
        further
            .iter()
            .map(|(name, value)| ((*name).to_owned(), value.clone())),
    );
    let required: Vec<&String> = properties.keys().collect();
    json!({
        "type": "object",
        "required": required,
        "additionalProperties": false,
        "properties": properties,
    })
}

/// Schema of a [`ProgramVersion`](super::ProgramVersion).
pub fn program() -> Value {
    object(
        &[
            ("name", "string", "the program"),
            ("version", "string", "its version"),
            ("commit", "string?", "commit that it was built from"),
            (
                "modified",
                "boolean",
                "whether its sources differed from the commit",
            ),
        ],
        &[],
    )
}

/// Schema of an array whose entries have the schema `items`.
pub fn array(items: Value) -> Value {
    json!({"type": "array", "items": items})
}

/// The whole schema document with title and description.
pub fn document(title: &str, description: &str, mut object: Value) -> Value {
    object["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    object["title"] = title.into();
    object["description"] = description.into();
    object
}

/// Path of the first part of a value that does not fit a schema made by this module; `None` if the value fits. Used by tests.
pub fn misfit(schema: &Value, value: &Value, path: &str) -> Option<String> {
    let types: Vec<&str> = match &schema["type"] {
        Value::String(one) => vec![one],
        Value::Array(several) => several.iter().filter_map(Value::as_str).collect(),
        _ => return Some(format!("{path}: the schema names no type")),
    };
    let fits = types.iter().any(|kind| match *kind {
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => false,
    });
    if !fits {
        return Some(format!("{path}: {value} is not {types:?}"));
    }
    if let Some(items) = value.as_array() {
        return items
            .iter()
            .enumerate()
            .find_map(|(index, item)| misfit(&schema["items"], item, &format!("{path}[{index}]")));
    }
    let fields = value.as_object()?;
    let properties = schema["properties"].as_object()?;
    if let Some(missing) = properties.keys().find(|name| !fields.contains_key(*name)) {
        return Some(format!("{path}.{missing} is missing"));
    }
    fields
        .iter()
        .find_map(|(name, value)| match properties.get(name) {
            Some(schema) => misfit(schema, value, &format!("{path}.{name}")),
            None => Some(format!("{path}.{name} is not in the schema")),
        })
}
