//! Writes all settings of a device as a TOML file with units, ranges and comments, and reads such a file. Errors name the line.

use super::unknown;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use toml::de::{DeTable, DeValue};
use touchstone_link::value::{self, Wrong};
use touchstone_link::words::described;
use touchstone_protocol::settings::fields::{FIELDS, Field, Kind, field};
use touchstone_protocol::{DeviceSettings, Identity};
use touchstone_sim::error::{Error, Result};

/// Beginning of a settings file that [`write()`] makes. A file with this beginning but without the last line `END` was cut off.
const BEGIN: &str = "# Settings of ";
const END: &str = "# End of the settings.";

/// All settings as the text of a TOML file.
pub fn write(settings: &DeviceSettings, identity: &Identity) -> String {
    let mut text = format!("{BEGIN}{}.\n", described(identity));
    text.push_str("# Back with: touchstone config import FILE\n");
    for table in tables() {
        // Writing into a string cannot fail.
        let _ = write!(text, "\n[{table}]\n");
        for field in FIELDS.iter().filter(|field| split(field.path).0 == table) {
            let quote = match field.kind {
                Kind::Choice(_) => "\"",
                _ => "",
            };
            let _ = writeln!(
                text,
                "# {}; {}{}\n{} = {quote}{}{quote}",
                field.about,
                value::range(field),
                value::unit(field),
                split(field.path).1,
                value::shown(settings, field),
            );
        }
    }
    text.push('\n');
    text.push_str(END);
    text.push('\n');
    text
}

/// The names of the tables in the order of the file, each once.
fn tables() -> Vec<&'static str> {
    let mut tables = Vec::new();
    for field in FIELDS {
        let table = split(field.path).0;
        if !tables.contains(&table) {
            tables.push(table);
        }
    }
    tables
}

/// Splits the path of a setting into the table and the name within the table.
fn split(path: &str) -> (&str, &str) {
    path.rsplit_once('.').unwrap_or(("", path))
}

/// For each setting that a file has, the number of its line.
pub type Lines = BTreeMap<&'static str, usize>;

/// Reads settings from the text of a TOML file. Settings that the file leaves out keep their values in `before`.
///
/// # Errors
/// The first line with an unknown setting or with an invalid value.
pub fn read(text: &str, file: &Path, before: &DeviceSettings) -> Result<(DeviceSettings, Lines)> {
    let line = |offset: usize| 1 + text.get(..offset).unwrap_or(text).matches('\n').count();
    let wrong = |offset: usize, field: &str, (problem, fix): Wrong| Error::File {
        file: file.to_owned(),
        line: line(offset),
        field: field.to_owned(),
        problem,
        fix,
    };
    if text.starts_with(BEGIN) && !text.lines().any(|line| line == END) {
        let problem = format!("the file was cut: its last line, `{END}`, is missing");
        let fix = "export it again; or, to import it as it is, remove its first line";
        return Err(wrong(text.len(), "end", (problem, fix.into())));
    }
    let table = DeTable::parse(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        let problem = error.message().to_owned();
        wrong(
            offset,
            "TOML",
            (problem, "correct the TOML syntax of the file".into()),
        )
    })?;
    let mut leaves = Vec::new();
    flatten("", table.get_ref(), &mut leaves);
    // In the order of the file, so that the first error is the first line.
    leaves.sort_by_key(|(_, offset, _)| *offset);
    let (mut settings, mut lines) = (before.clone(), Lines::new());
    for (path, offset, value) in leaves {
        let Some(field) = field(&path) else {
            return Err(wrong(offset, &path, unknown(&path)));
        };
        let no_value = || wrong(offset, &path, value::wanted(field));
        let text = text_of(field, value).ok_or_else(no_value)?;
        let bytes = value::parse(field, &text).map_err(|problem| wrong(offset, &path, problem))?;
        settings.set(&path, &bytes).map_err(|_| no_value())?;
        lines.insert(field.path, line(offset));
    }
    if lines.is_empty() {
        let problem = "the file contains no settings".to_owned();
        let fix = "`touchstone config export FILE` writes one";
        return Err(wrong(0, "file", (problem, fix.into())));
    }
    Ok((settings, lines))
}

/// One value of a TOML file: its path, its position in the text, and the value.
type Leaf<'v, 't> = (String, usize, &'v DeValue<'t>);

fn flatten<'v, 't>(table: &str, values: &'v DeTable<'t>, leaves: &mut Vec<Leaf<'v, 't>>) {
    for (key, value) in values {
        let name = key.get_ref();
        let path = match table {
            "" => name.to_string(),
            table => format!("{table}.{name}"),
        };
        match value.get_ref() {
            DeValue::Table(inner) => flatten(&path, inner, leaves),
            leaf => leaves.push((path, key.span().start, leaf)),
        }
    }
}

/// A value as text, as it stands in the file: numbers are not converted to a float, which would lose digits.
fn text_of(field: &Field, value: &DeValue<'_>) -> Option<String> {
    match (field.kind, value) {
        (Kind::Number { .. }, DeValue::Float(number)) => Some(number.as_str().to_owned()),
        (Kind::Number { .. } | Kind::Whole { .. }, DeValue::Integer(number)) => {
            (number.radix() == 10).then(|| number.as_str().to_owned())
        }
        (Kind::Choice(_), DeValue::String(word)) => Some(word.to_string()),
        (Kind::Flag, DeValue::Boolean(flag)) => Some(flag.to_string()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_protocol::Board;

    #[test]
    fn what_is_written_is_read_to_the_bit() {
        let identity = Identity {
            protocol_version: 1,
            settings_version: 1,
            firmware_version: "0.1.0".try_into().unwrap_or_default(),
            board: Board::NucleoG474re,
            unique_id: [0; 12],
            reset_reason: touchstone_protocol::ResetReason::PowerOn,
            build_hash: 0,
        };
        let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
        // Values of the fixed-point format that a float of 53 bits cannot represent.
        settings.wall.k_desired_n_m_per_rad =
            touchstone_control::Si::from_bits((5000_i64 << 32) + 1);
        settings.wall.surface_rad = touchstone_control::Si::from_bits(-(7_i64 << 32) - 3);
        let text = write(&settings, &identity);
        let other = DeviceSettings::defaults(Board::BG431bEsc1);
        let (read, lines) = read(&text, Path::new("x.toml"), &other).expect("own file");
        assert_eq!(read, settings);
        assert_eq!(lines.len(), FIELDS.len());
    }
}
