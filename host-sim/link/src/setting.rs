//! Reads a setting's path and value from texts that a person wrote, and checks the value together with all other settings of the
//! device.

use crate::value::{self, Wrong};
use touchstone_drive::wire::checked;
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::settings::fields::{FIELDS, Field, field};
use touchstone_protocol::{Board, DeviceSettings};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{nearest, renamed};

/// A setting, and its new value in the encoding of the crate postcard.
pub type Setting = (&'static Field, Vec<u8>);

/// The error message for a setting's path or its value: problem and advice.
#[must_use]
pub fn option(path: &str, (problem, fix): Wrong) -> Error {
    Error::Option {
        option: path.to_owned(),
        problem,
        fix,
    }
}

/// Finds the setting with this path; an error if there is none.
fn known(path: &str) -> Result<&'static Field> {
    field(path).ok_or_else(|| option(path, unknown(path)))
}

/// Problem and advice for a path that names no setting.
#[must_use]
pub fn unknown(path: &str) -> Wrong {
    let paths: Vec<&str> = FIELDS.iter().map(|field| field.path).collect();
    let fix = match renamed(path).or_else(|| nearest(path, &paths)) {
        Some(near) => format!("did you mean {near}?"),
        None => "`touchstone config schema` lists all settings".into(),
    };
    ("there is no such setting".into(), fix)
}

/// Reads a setting's path and its new value from two texts.
///
/// # Errors
/// There is no such setting, or the value is not allowed.
pub fn parsed(path: &str, text: &str) -> Result<Setting> {
    let field = known(path)?;
    let bytes = value::parse(field, text).map_err(|wrong| option(path, wrong))?;
    Ok((field, bytes))
}

/// Returns the device's settings with one of them changed. The program makes the same check as the device, with the same message
/// and advice, before it sends the change.
///
/// # Errors
/// A device on this board would refuse the settings.
pub fn changed(
    before: &DeviceSettings,
    (field, bytes): &Setting,
    board: Board,
) -> Result<DeviceSettings> {
    let mut after = before.clone();
    after
        .set(field.path, bytes)
        .map_err(|_| option(field.path, value::wanted(field)))?;
    if let Err(invalid) = checked(&after, board) {
        let fix = "choose another value, or change several settings at once with: touchstone config import";
        // The new value can make another setting invalid, which is then the refused one.
        let problem = without_path(&invalid, field.path);
        return Err(option(field.path, (problem, fix.into())));
    }
    Ok(after)
}

/// The reason for which a setting is refused, as text. Leaves out the refused setting's path if it is `path`, which the message
/// already names.
#[must_use]
pub fn without_path(invalid: &SettingsError, path: &str) -> String {
    let text = invalid.to_string();
    let rest = text
        .strip_prefix(path)
        .and_then(|rest| rest.strip_prefix(" = ").or_else(|| rest.strip_prefix(": ")));
    rest.map_or_else(|| text.clone(), str::to_owned)
}
