//! Writes tuned settings as source text, in Rust and in C, for a firmware that uses this project's libraries.
//!
//! The energy guard's settings have the delay and lag of the scene's device, at least its encoder count, and at most its damping.
//! They assume one position reading per tick (control period), as in `Controller::tick` and `ts_wall_tick`.

use super::Tuned;
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use touchstone_control::{
    ChangeOfForce, Choice, Controller, Device, Field, Fixed32, PositionSettings, Settings, Si,
};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::harmless::one_line;
use touchstone_sim::scene::Scene;

/// Longest line of the Rust text, in characters.
const LINE_MAX: usize = 100;

/// The kind of C file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CFile {
    /// A source file, which defines the function.
    Source,
    /// A header, which has the function as `static inline`.
    Header,
}

/// One setting in the generated file.
struct Row {
    field: Field,
    /// Name of the field in [`Settings`] or in the setting's group.
    name: &'static str,
    unit: &'static str,
    /// Type of a setting with named choices, which the Rust text imports.
    choice: Option<&'static str>,
    /// The value as a Rust expression.
    rust: String,
    /// The value as a decimal number or a word, in the form that `Settings::set_by_path` accepts.
    word: String,
    is_default: bool,
}

/// The settings of one struct.
struct Group {
    /// Field and type of the struct in [`Settings`]; `None` for [`Settings`] itself.
    place: Option<(&'static str, &'static str)>,
    rows: Vec<Row>,
}

/// Makes, from a setting's value, the type of its choice, its Rust expression and its word.
macro_rules! value {
    ($value:expr, number $range:tt) => {
        (None, format!("Si::lit(\"{}\")", $value), $value.to_string())
    };
    ($value:expr, choice ($Choice:ident)) => {
        (
            Some(stringify!($Choice)),
            format!(concat!(stringify!($Choice), "::{:?}"), $value),
            Choice::word($value).to_owned(),
        )
    };
    ($value:expr, choice_of_law $choice:tt) => {
        value!($value, choice $choice)
    };
    ($value:expr, $kind:ident $range:tt) => {
        (None, $value.to_string(), $value.to_string())
    };
}

macro_rules! groups {
    (
        $settings:ident $defaults:ident:
        timing { $($timing:tt)* } wall { $($wall:tt)* } law { $($law:tt)* }
        $($(#[$doc:meta])* $group:ident $Group:ident { $($rows:tt)* })+
    ) => {
        vec![
            Group { place: None, rows: groups!(@rows $settings, $defaults; $($timing)* $($wall)* $($law)*) },
            $(Group {
                place: Some((stringify!($group), stringify!($Group))),
                rows: groups!(@rows $settings.$group, $defaults.$group; $($rows)*),
            },)+
        ]
    };
    (@rows $settings:expr, $defaults:expr; $($variant:ident $field:ident, $name:ident:
        $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+) => {
        vec![$({
            let (choice, rust, word) = value!($settings.$field, $kind $range);
            Row {
                field: Field::$variant,
                name: stringify!($field),
                unit: $unit,
                choice,
                rust,
                word,
                is_default: $settings.$field == $defaults.$field,
            }
        },)+]
    };
}

/// Tuned settings for a firmware that uses this project's libraries.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnFirmware {
    /// The settings that the generated text sets.
    pub settings: Settings,
    /// The device of the scene in the form of the libraries.
    pub device: Device,
    counts_per_rev: u32,
    /// Lines of the comment at the top of the generated file.
    comment: Vec<String>,
}

/// Settings for a firmware from a scene's law, and the encoder's counts per turn. The energy guard gets the scene's delay, and an
/// encoder count that is not smaller than the scene's.
///
/// # Errors
/// The scene has no encoder, or the libraries refuse the settings.
pub fn settings(scene: &Scene) -> Result<(Settings, u32)> {
    let Some(encoder) = &scene.encoder else {
        return Err(scene.error(
            "encoder",
            "the scene has no encoder, and the energy guard of a device needs its count",
            "give encoder.counts_per_rev",
        ));
    };
    // A fraction of a count is dropped, which only makes the encoder coarser. Numbers that do not fit saturate.
    let counts_per_rev = (encoder.counts_per_rev.floor() as u32).max(1);
    let mut settings = scene.settings()?;
    let device = device(scene, counts_per_rev, &settings);
    settings.position = device.position;
    settings.guard.change = ChangeOfForce::Estimated;
    device.hold(&mut settings);
    if let Err(refused) = Controller::<Fixed32>::new(&settings) {
        return Err(Error::Option {
            option: "--out".to_owned(),
            problem: format!("the firmware would reject these settings: {refused}"),
            fix: "shorten the delay, or lower timing.rate_hz".to_owned(),
        });
    }
    Ok((settings, counts_per_rev))
}

/// The scene's device in the form of the libraries.
fn device(scene: &Scene, counts_per_rev: u32, settings: &Settings) -> Device {
    let si = Si::saturating_from_num::<f64>;
    Device {
        rate_hz: scene.timing.rate_hz,
        inertia: si(scene.device.inertia_kg_m2),
        damping: si(scene.device.damping_n_m_s_per_rad),
        position: PositionSettings::of_counts_per_rev(counts_per_rev),
        position_error: settings.position_error,
        force_limit: settings.force_limit,
        delay: si(longest_delay_s(scene)),
        lag: si(lag_s(scene)),
    }
}

/// Longest time from a position reading until its force begins to act, s.
fn longest_delay_s(scene: &Scene) -> f64 {
    scene.timing.computational_delay_s + scene.timing.latency_spread_s.unwrap_or(0.0)
}

/// Time constant of the motor's torque, s: its mean delay after a step of the command.
fn lag_s(scene: &Scene) -> f64 {
    let current_loop = scene.device.current_loop.as_ref();
    current_loop.map_or(0.0, |it| 1.0 / (TAU * it.bandwidth_hz))
}

impl OwnFirmware {
    /// The settings that [`tune`](super::tune()) found.
    ///
    /// # Errors
    /// Same as [`settings`].
    pub fn new(tuned: &Tuned) -> Result<Self> {
        let scene = &tuned.scene;
        let (settings, counts_per_rev) = settings(scene)?;
        // A backslash at the end of a line would continue a comment of C.
        let title = super::settings::title(tuned.rival, scene);
        let title = one_line(&title).replace('\\', "/");
        let guard = &settings.guard;
        let comment = vec![
            title,
            format!(
                "found by touchstone tune (seed {}, {} settings tried).",
                tuned.seed, tuned.evaluations
            ),
            format!(
                "The device: {} control periods a second, inertia {:e} kg·m², damping {:e} N·m·s/rad,",
                settings.rate_hz,
                scene.device.inertia_kg_m2,
                scene.device.damping_n_m_s_per_rad
            ),
            format!(
                "{counts_per_rev} encoder counts a turn, force limit {} N·m, delay {:e} s from reading to torque, torque lag {:e} s.",
                settings.force_limit,
                longest_delay_s(scene),
                lag_s(scene),
            ),
            format!(
                "The guard relies on {:e} N·m·s/rad of the damping. It assumes that the encoder is read once per control period.",
                (guard.share_of_damping.saturating_mul(guard.damping)).to_num::<f64>()
            ),
            "Measure your own device: the energy bound fails with less damping, a larger count, or another delay or lag.".to_owned(),
            "Settings that are missing here have the library's defaults; use program and library of the same release.".to_owned(),
        ];
        Ok(Self {
            device: device(scene, counts_per_rev, &settings),
            settings,
            counts_per_rev,
            comment,
        })
    }

    /// Settings that differ from their defaults. Those on which the guard's bound depends are always included.
    fn groups(&self) -> Vec<Group> {
        let (settings, defaults) = (&self.settings, Settings::default());
        let mut groups: Vec<Group> = touchstone_control::law_settings!(groups settings defaults:);
        for Group { place, rows } in &mut groups {
            let is_guard = *place == Some(("guard", "GuardSettings"));
            let is_device = |row: &Row| {
                matches!(
                    row.field,
                    Field::RateHz | Field::KDesired | Field::ForceLimit | Field::PositionError
                )
            };
            rows.retain(|row| !row.is_default || is_guard || is_device(row));
        }
        groups.retain(|group| !group.rows.is_empty());
        groups
    }

    fn comment(&self) -> String {
        let lines = self.comment.iter().map(|line| format!("// {line}\n"));
        lines.collect()
    }

    /// The settings as a Rust file for the crate `touchstone-control`.
    #[must_use]
    pub fn rust(&self) -> String {
        let groups = self.groups();
        let mut names = BTreeSet::from(["Device", "PositionSettings", "Settings", "Si"]);
        names.extend(groups.iter().filter_map(|it| it.place).map(|(_, it)| it));
        let rows = groups.iter().flat_map(|it| &it.rows);
        names.extend(rows.filter_map(|row| row.choice));
        let mut text = self.comment() + "\nuse touchstone_control::{\n";
        let mut line = String::from("   ");
        for name in names {
            if line.len() + name.len() + 2 > LINE_MAX {
                text += &format!("{line}\n");
                line = String::from("   ");
            }
            line += &format!(" {name},");
        }
        text += &format!("{line}\n}};\n\n/// The tuned settings.\n");
        text += "pub fn tuned_settings() -> Settings {\n    Settings {\n";
        for Group { place, rows } in &groups {
            let deep = match place {
                None => "        ",
                Some((field, kind)) => {
                    text += &format!("        {field}: {kind} {{\n");
                    "            "
                }
            };
            for row in rows {
                let comment = match row.unit {
                    "" => String::new(),
                    unit => format!(" // {unit}"),
                };
                text += &format!("{deep}{}: {},{comment}\n", row.name, row.rust);
            }
            if let Some((field, kind)) = place {
                if leaves_out(field, rows.len()) {
                    text += &format!("{deep}..{kind}::default()\n");
                }
                text += "        },\n";
            }
        }
        text += &format!(
            "        position: PositionSettings::of_counts_per_rev({}),\n        ..Settings::default()\n    }}\n}}\n",
            self.counts_per_rev
        );
        text + &self.rust_device()
    }

    /// A Rust function that returns the device, for a force of the firmware's own behind the guard.
    fn rust_device(&self) -> String {
        let Device {
            rate_hz,
            inertia,
            damping,
            position: _,
            position_error,
            force_limit,
            delay,
            lag,
        } = self.device;
        let mut text = String::from(
            "\n/// The device for which the settings were tuned: `tuned_device().own_force()` puts a force of your own before its guard.\n",
        );
        text += "pub fn tuned_device() -> Device {\n    Device {\n";
        text += &format!("        rate_hz: {rate_hz}, // Hz\n");
        for (name, value, unit) in [
            ("inertia", inertia, "kg·m²"),
            ("damping", damping, "N·m·s/rad"),
            ("position_error", position_error, "rad"),
            ("force_limit", force_limit, "N·m"),
            ("delay", delay, "s"),
            ("lag", lag, "s"),
        ] {
            text += &format!("        {name}: Si::lit(\"{value}\"), // {unit}\n");
        }
        text += &format!(
            "        position: PositionSettings::of_counts_per_rev({}),\n    }}\n}}\n",
            self.counts_per_rev
        );
        text
    }

    /// The settings as a C file for `touchstone.h`.
    #[must_use]
    pub fn c(&self, file: CFile) -> String {
        const SIGNATURE: &str = "ts_status tuned_settings(ts_settings *settings)";
        let mut text = self.comment() + "\n";
        if file == CFile::Header {
            text += "#ifndef TUNED_SETTINGS_H\n#define TUNED_SETTINGS_H\n\n";
        }
        text += "#include \"touchstone.h\"\n\n";
        text += "/* Sets all settings. Returns TS_OK, or why a setting was not set. */\n";
        text += &match file {
            CFile::Source => format!("{SIGNATURE};\n{SIGNATURE} {{\n"),
            CFile::Header => format!("static inline {SIGNATURE} {{\n"),
        };
        text += "  static const char *const values[][2] = {\n";
        for row in self.groups().iter().flat_map(|it| &it.rows) {
            let comment = match row.unit {
                "" => String::new(),
                unit => format!(" /* {unit} */"),
            };
            let (path, word) = (row.field.path(), &row.word);
            text += &format!("    {{\"{path}\", \"{word}\"}},{comment}\n");
        }
        text += "  };\n";
        text += "  ts_status status = ts_settings_init(settings);\n";
        text += "  size_t i;\n";
        text += "  for (i = 0; status == TS_OK && i < sizeof values / sizeof values[0]; i++) {\n";
        text += "    status = ts_settings_set(settings, values[i][0], values[i][1]);\n";
        text += "  }\n";
        text += "  if (status == TS_OK) {\n";
        text += &format!(
            "    status = ts_settings_set_counts_per_rev(settings, {});\n",
            self.counts_per_rev
        );
        text += "  }\n  return status;\n}\n";
        if file == CFile::Header {
            text += "\n#endif\n";
        }
        text
    }
}

/// Whether a group has more settings than the generated file sets.
fn leaves_out(group: &str, set: usize) -> bool {
    let start = format!("law.{group}.");
    let of_group = |field: &&Field| field.path().starts_with(&start);
    Field::ALL.iter().filter(of_group).count() > set
}
