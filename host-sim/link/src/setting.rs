//! Converts a setting's path and value from a person's texts, and checks them with all settings of a device.

use crate::value::{self, Wrong};
use touchstone_drive::wire::checked;
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::settings::fields::{FIELDS, Field, field};
use touchstone_protocol::{Board, DeviceSettings};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{nearest, renamed};

/// A setting with its new value in postcard's encoding.
pub type Setting = (&'static Field, Vec<u8>);

/// The error for a path or its value.
#[must_use]
pub fn option(path: &str, (problem, fix): Wrong) -> Error {
    Error::Option {
        option: path.to_owned(),
        problem,
        fix,
    }
}

/// The setting with this path.
fn known(path: &str) -> Result<&'static Field> {
    field(path).ok_or_else(|| option(path, unknown(path)))
}

/// Problem and advice for a path that no setting has.
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

/// All settings with one of them changed. Makes the same check as the device before the request is sent, with the same message and
/// advice.
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
        // A setting that was not named can be refused, for what the new value leaves it.
        let problem = without_path(&invalid, field.path);
        return Err(option(field.path, (problem, fix.into())));
    }
    Ok(after)
}

/// Why a setting is refused. Leaves its path out if that is `path`, which the message already names.
#[must_use]
pub fn without_path(invalid: &SettingsError, path: &str) -> String {
    let text = invalid.to_string();
    let rest = text
        .strip_prefix(path)
        .and_then(|rest| rest.strip_prefix(" = ").or_else(|| rest.strip_prefix(": ")));
    rest.map_or_else(|| text.clone(), str::to_owned)
}
