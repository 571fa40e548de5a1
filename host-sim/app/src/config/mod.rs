//! `touchstone config`: shows and changes the settings of a device, one by one or all at once.

pub mod environment;
pub mod toml_file;

use super::out::{self, note, print, say, tell};
use super::port::PortOption;
use super::whole::{Named, Overwrite};
use clap::Subcommand;
use std::path::{Path, PathBuf};
use touchstone_device::Client;
use touchstone_drive::wire::checked;
use touchstone_link::guard;
use touchstone_link::setting::{self, Setting, option, parsed, unknown, without_path};
use touchstone_link::value;
use touchstone_protocol::settings::fields::{FIELDS, Field};
use touchstone_protocol::{Board, DeviceSettings, Request};
use touchstone_sim::error::{Error, Result};

/// Options of the command `touchstone config`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(flatten)]
    port: PortOption,
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Clone, Subcommand)]
enum Action {
    /// Shows settings: those named, those below a table such as `wall`, or all.
    Get {
        /// Paths of settings or tables.
        paths: Vec<String>,
    },
    /// Changes one setting, which takes effect from the next calibration on; `save` keeps it.
    Set {
        /// The path of the setting, e.g. wall.k_desired_n_m_per_rad.
        path: String,
        /// The value, in the unit that the setting's name ends with.
        #[arg(allow_hyphen_values = true)]
        value: String,
    },
    /// Writes all settings as TOML, with units, ranges and comments.
    Export {
        /// The file to write; without it, standard output.
        file: Option<PathBuf>,
        #[command(flatten)]
        overwrite: Overwrite,
    },
    /// Takes settings from TOML: all are checked before any is changed. Settings that the file leaves out do not
    /// change.
    Import {
        /// The TOML file to read.
        file: PathBuf,
        /// Only checks the file, and shows what would change.
        #[arg(long)]
        dry_run: bool,
        /// Also accepts settings that weaken the energy guard: a guard that is off, or less delay, more damping, a larger energy
        /// account or faster refill than is certain. THE BOUNDS OF docs/guard-promise.md THEN NO LONGER HOLD FOR A HAND.
        #[arg(long)]
        weaken_guard: bool,
    },
    /// Sets all settings to the defaults of the board; `save` keeps them.
    Defaults,
    /// Saves the settings in the device's flash, so that they outlast a restart.
    Save,
    /// Shows or changes what the device renders besides the wall: further walls, end stops, detents, from a scene. Takes effect at
    /// once, also under a hand; `save` keeps it.
    Environment(environment::EnvironmentOptions),
    /// Lists all settings with units, ranges and meanings; needs no device.
    Schema {
        /// Prints the JSON schema of a settings file instead.
        #[arg(long)]
        json_schema: bool,
    },
}

impl Options {
    /// Whether the command prints the settings as TOML; TOML has no JSON form.
    pub fn exports(&self) -> bool {
        matches!(self.action, Action::Export { .. })
    }
}

/// Runs the command `touchstone config`.
pub fn main(options: &Options) -> Result<()> {
    let connect = || options.port.connect();
    match &options.action {
        Action::Get { paths } => {
            let shown = select(paths)?;
            get(&mut connect()?, &shown)
        }
        Action::Set { path, value } => {
            // A value that no device accepts is refused before a connection is made.
            let setting = parsed(path, value)?;
            let mut client = connect()?;
            let (before, after) = set(&mut client, &setting)?;
            note_weaker(&before, &after, client.identity().board);
            changed(&before, &after)
        }
        Action::Export { file, overwrite } => {
            let place = file.as_deref().map(|path| Named {
                path,
                option: "its name",
                replaces: overwrite.force,
            });
            place.map_or(Ok(()), |place| place.check())?;
            export(&mut connect()?, place)
        }
        Action::Import {
            file,
            dry_run,
            weaken_guard,
        } => {
            let text = touchstone_sim::input::text(file, touchstone_sim::input::MOST_OF_SETTINGS)
                .map_err(|error| io(file, &error))?;
            // A file that is wrong for every device is refused before a connection is made.
            toml_file::read(&text, file, &DeviceSettings::defaults(Board::NucleoG474re))?;
            import(&mut connect()?, file, &text, (*dry_run, *weaken_guard))
        }
        Action::Defaults => {
            let mut client = connect()?;
            let before = client.settings()?;
            client.tell(&Request::Defaults)?;
            let after = client.settings()?;
            note_weaker(&before, &after, client.identity().board);
            changed(&before, &after)
        }
        Action::Save => {
            connect()?.tell(&Request::Save)?;
            out::result(
                || serde_json::json!({ "saved": true }),
                || {
                    tell!("saved");
                    Ok(())
                },
            )
        }
        Action::Environment(options) => environment::main(&mut connect()?, options),
        Action::Schema { json_schema: true } => {
            print(format_args!("{:#}\n", crate::json_schema::settings()))
        }
        Action::Schema { json_schema: false } => schema(),
    }
}

/// The settings that the paths name: one for each setting's path, several for a table's. An empty list names all settings.
fn select(paths: &[String]) -> Result<Vec<&'static Field>> {
    let mut shown: Vec<&'static Field> = Vec::new();
    for path in paths {
        let table = format!("{path}.");
        let before = shown.len();
        shown.extend(
            FIELDS
                .iter()
                .filter(|field| field.path == path || field.path.starts_with(&table)),
        );
        if shown.len() == before {
            return Err(option(path, unknown(path)));
        }
    }
    if paths.is_empty() {
        shown.extend(FIELDS);
    }
    Ok(shown)
}

fn get(client: &mut Client, shown: &[&Field]) -> Result<()> {
    let settings = client.settings()?;
    let entry = |field: &&Field| {
        serde_json::json!({
            "path": field.path,
            "value": value::as_json(&settings, field),
            "unit": field.unit,
        })
    };
    out::result(
        || serde_json::json!({ "settings": shown.iter().map(entry).collect::<Vec<_>>() }),
        || {
            for field in shown {
                let value = value::shown(&settings, field);
                say!("{} = {value}{}", field.path, value::unit(field));
            }
            // Below the guard's settings, also prints the bound on the hand's energy that follows from them.
            if shown
                .iter()
                .any(|field| field.path == "law.guard.capacity_j")
            {
                tell!("# {}", guard::promise(&settings, client.identity().board));
            }
            Ok(())
        },
    )
}

/// Changes one setting of the device; returns all settings before and after the change.
pub fn set(client: &mut Client, setting: &Setting) -> Result<(DeviceSettings, DeviceSettings)> {
    let before = client.settings()?;
    let after = setting::changed(&before, setting, client.identity().board)?;
    client.tell(&Request::Set {
        path: setting.0.path,
        value: &setting.1,
    })?;
    Ok((before, after))
}

fn export(client: &mut Client, place: Option<Named<'_>>) -> Result<()> {
    let text = toml_file::write(&client.settings()?, client.identity());
    let Some(place) = place else {
        return print(format_args!("{text}"));
    };
    place.write(text)?;
    tell!("{}: {} settings", place.path.display(), FIELDS.len());
    Ok(())
}

fn io(file: &Path, error: &std::io::Error) -> Error {
    Error::Io {
        path: file.to_owned(),
        problem: error.to_string(),
        fix: "choose another file".into(),
    }
}

fn import(
    client: &mut Client,
    file: &Path,
    text: &str,
    (dry_run, weaken_guard): (bool, bool),
) -> Result<()> {
    let before = client.settings()?;
    let board = client.identity().board;
    let (after, lines) = toml_file::read(text, file, &before)?;
    if let Err(invalid) = checked(&after, board) {
        return Err(Error::File {
            file: file.to_owned(),
            // A setting that the file leaves out can be refused, too, because it conflicts with one in the file.
            line: lines.get(invalid.path).copied().unwrap_or(1),
            field: invalid.path.to_string(),
            problem: without_path(&invalid, invalid.path),
            fix: "choose another value; no setting was changed".into(),
        });
    }
    let weaker = guard::weaker(&before, &after, board);
    match weaker.as_slice() {
        [first, rest @ ..] if !weaken_guard => {
            let more = match rest.len() {
                0 => String::new(),
                more => format!(" (and {more} more)"),
            };
            return Err(Error::File {
                file: file.to_owned(),
                line: lines.get(first.path).copied().unwrap_or(1),
                field: first.path.to_string(),
                problem: format!("{}{more}", first.problem),
                fix:
                    "remove the line from the file, or accept it with --weaken-guard; no setting was changed"
                        .into(),
            });
        }
        _ => note_weaker(&before, &after, board),
    }
    tell!("{} of {} settings in the file", lines.len(), FIELDS.len());
    if dry_run {
        return out::result(
            || differences_json(&before, &after, false),
            || {
                differences(&before, &after)?;
                tell!("nothing was written (--dry-run)");
                Ok(())
            },
        );
    }
    if before != after {
        client.tell(&Request::SetAll(after.clone()))?;
    }
    changed(&before, &after)
}

/// Prints a warning for each changed setting that weakens the energy guard's bound on the energy that a hand can receive.
fn note_weaker(before: &DeviceSettings, after: &DeviceSettings, board: Board) {
    for it in guard::weaker(before, after, board) {
        note!("warning: the guard is weaker: {}: {}", it.path, it.problem);
    }
}

/// The settings whose values in `before` and `after` differ.
fn different<'a>(
    before: &'a DeviceSettings,
    after: &'a DeviceSettings,
) -> impl Iterator<Item = &'static Field> + 'a {
    FIELDS
        .iter()
        .filter(|field| value::shown(before, field) != value::shown(after, field))
}

/// Prints the settings that differ, one per line.
fn differences(before: &DeviceSettings, after: &DeviceSettings) -> Result<()> {
    for field in different(before, after) {
        let (old, new) = (value::shown(before, field), value::shown(after, field));
        tell!("{}: {old} -> {new}{}", field.path, value::unit(field));
    }
    Ok(())
}

/// The settings that differ, as JSON.
fn differences_json(
    before: &DeviceSettings,
    after: &DeviceSettings,
    written: bool,
) -> serde_json::Value {
    let entry = |field: &'static Field| {
        serde_json::json!({
            "path": field.path,
            "before": value::as_json(before, field),
            "after": value::as_json(after, field),
            "unit": field.unit,
        })
    };
    serde_json::json!({
        "changed": different(before, after).map(entry).collect::<Vec<_>>(),
        "written": written,
    })
}

/// Prints the settings that were changed, and what the user still has to do for them to take effect.
fn changed(before: &DeviceSettings, after: &DeviceSettings) -> Result<()> {
    out::result(
        || differences_json(before, after, before != after),
        || {
            differences(before, after)?;
            if before == after {
                tell!("nothing to change");
            } else {
                tell!(
                    "takes effect from the next calibration on; to keep it after a restart: touchstone config save"
                );
            }
            Ok(())
        },
    )
}

fn schema() -> Result<()> {
    let list = || FIELDS.iter().map(value::json).collect::<Vec<_>>().into();
    out::result(list, || {
        for field in FIELDS {
            say!("{}", field.path);
            say!("    {}{}", value::range(field), value::unit(field));
            say!("    {}", field.about);
        }
        Ok(())
    })
}
