//! Converts a setting's value between the text that a person writes and the bytes that are sent to the board.

use touchstone_protocol::DeviceSettings;
use touchstone_protocol::settings::fields::{Field, Kind};
use touchstone_protocol::settings::{Decimal, VALUE_MAX};
use touchstone_sim::scene::{list, nearest};

/// A problem with a text that a person wrote, and advice.
pub type Wrong = (String, String);

/// Converts the text that a person wrote to the setting's value in the encoding of the crate postcard. Numbers are converted
/// exactly, without floating point.
///
/// # Errors
/// The text is no valid value of this setting.
pub fn parse(field: &Field, text: &str) -> Result<Vec<u8>, Wrong> {
    let mut buffer = [0; VALUE_MAX];
    let no = |problem: String| Err((problem, wanted(field).1));
    let outside = |value: &dyn std::fmt::Display| format!("{value} is outside {}", range(field));
    let bytes = match field.kind {
        Kind::Number { least, most } => match text.replace('_', "").parse::<Decimal>() {
            Err(_) => return no(format!("`{text}` is not a decimal number")),
            Ok(value) if value < least || value > most => return no(outside(&value)),
            Ok(value) => postcard::to_slice(&value, &mut buffer),
        },
        Kind::Whole { least, most } => match text.replace('_', "").parse::<u32>() {
            Err(_) => return no(format!("`{text}` is not a whole number")),
            Ok(value) if value < least || value > most => return no(outside(&value)),
            Ok(value) => postcard::to_slice(&value, &mut buffer),
        },
        Kind::Choice(words) => match (0_u32..).zip(words).find(|(_, word)| **word == text) {
            Some((number, _)) => postcard::to_slice(&number, &mut buffer),
            None => {
                let fix = match nearest(text, words) {
                    Some(near) => format!("did you mean {near}?"),
                    None => wanted(field).1,
                };
                return Err((format!("`{text}` is not one of its words"), fix));
            }
        },
        Kind::Flag => match text.parse::<bool>() {
            Err(_) => return no(format!("`{text}` is neither true nor false")),
            Ok(flag) => postcard::to_slice(&flag, &mut buffer),
        },
    };
    Ok(bytes.expect("VALUE_MAX bytes hold every value").to_vec())
}

/// Problem and advice for a refused value if no more exact reason is known: names the values that the setting allows.
#[must_use]
pub fn wanted(field: &Field) -> Wrong {
    (
        "is not a value of this setting".into(),
        format!("give {}{}", range(field), unit(field)),
    )
}

/// The values that a setting allows, as text.
#[must_use]
pub fn range(field: &Field) -> String {
    match field.kind {
        Kind::Number { least, most } => format!("{least} to {most}"),
        Kind::Whole { least, most } => format!("a whole number, {least} to {most}"),
        Kind::Choice(words) => list(words),
        Kind::Flag => "true or false".into(),
    }
}

/// The setting's unit after a space; empty for a setting without unit.
#[must_use]
pub fn unit(field: &Field) -> String {
    match field.unit {
        "" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// The present value of a setting as text, in the form that [`parse`] reads.
#[must_use]
pub fn shown(settings: &DeviceSettings, field: &Field) -> String {
    let mut buffer = [0; VALUE_MAX];
    // Cannot fail: the test below reads every setting of the table.
    let bytes = settings
        .get(field.path, &mut buffer)
        .expect("every field is a leaf");
    match field.kind {
        Kind::Number { .. } => postcard::from_bytes::<Decimal>(bytes).map(|it| it.to_string()),
        Kind::Whole { .. } => postcard::from_bytes::<u32>(bytes).map(|it| it.to_string()),
        Kind::Choice(words) => postcard::from_bytes::<u32>(bytes).map(|number| {
            let word = words.get(number as usize).copied();
            word.unwrap_or("unknown").to_owned()
        }),
        Kind::Flag => postcard::from_bytes::<bool>(bytes).map(|it| it.to_string()),
    }
    .expect("the leaf has the type that the table says")
}

/// The present value of a setting as JSON for programs: a JSON number if the setting is a number.
#[must_use]
pub fn as_json(settings: &DeviceSettings, field: &Field) -> serde_json::Value {
    let text = shown(settings, field);
    match field.kind {
        // The nearest 64-bit float, because most readers of JSON have no other numbers.
        Kind::Number { .. } => text
            .parse::<f64>()
            .map_or(serde_json::Value::Null, serde_json::Value::from),
        Kind::Whole { .. } => text
            .parse::<u32>()
            .map_or(serde_json::Value::Null, serde_json::Value::from),
        Kind::Flag => (text == "true").into(),
        Kind::Choice(_) => text.into(),
    }
}

/// Path, type, range, unit and meaning of a setting, as JSON for programs.
#[must_use]
pub fn json(field: &Field) -> serde_json::Value {
    use serde_json::json;
    let value = match field.kind {
        Kind::Number { least, most } => {
            json!({ "type": "number", "min": least.to_string(), "max": most.to_string() })
        }
        Kind::Whole { least, most } => json!({ "type": "integer", "min": least, "max": most }),
        Kind::Choice(words) => json!({ "type": "word", "words": words }),
        Kind::Flag => json!({ "type": "boolean" }),
    };
    json!({ "path": field.path, "unit": field.unit, "about": field.about, "value": value })
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_protocol::Board;
    use touchstone_protocol::settings::fields::FIELDS;

    #[test]
    fn every_value_is_read_as_it_is_shown() {
        for board in Board::ALL {
            let settings = DeviceSettings::defaults(board);
            for field in FIELDS {
                let text = shown(&settings, field);
                let mut again = settings.clone();
                let bytes = parse(field, &text).expect(field.path);
                again.set(field.path, &bytes).expect(field.path);
                assert_eq!(again, settings, "{}", field.path);
                if let Kind::Choice(words) = field.kind {
                    for word in words {
                        let bytes = parse(field, word).expect(word);
                        again.set(field.path, &bytes).expect(word);
                        assert_eq!(shown(&again, field), *word);
                    }
                }
            }
        }
    }
}
