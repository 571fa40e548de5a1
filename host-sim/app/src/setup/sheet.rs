//! Prints the measured knob for users: as lines of text, and as a page with the resulting settings.

use super::super::device::cogging::Tried;
use super::super::device::eccentricity;
use super::super::number;
use super::super::report_options::program;
use super::kept::{VALUES, as_json, values};
use std::path::{Path, PathBuf};
use touchstone_lab::identify::eccentricity::Eccentricity;
use touchstone_lab::identify::motor::MeasuredMotor;
use touchstone_link::value;
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::settings::fields::FIELDS;
use touchstone_report::{Block, Section, pages};
use touchstone_sim::error::Result;

/// Name and unit of each measured value.
const NAMES: [(&str, &str); VALUES.len()] = [
    ("resistance of a phase, with the bridge's", "Ω"),
    ("inductance of a phase", "H"),
    ("flux linkage", "Wb"),
    ("torque constant", "N·m/A"),
    ("inertia", "kg·m²"),
    ("viscous damping", "N·m·s/rad"),
    ("dry friction", "N·m"),
];

fn rows(motor: &MeasuredMotor) -> impl Iterator<Item = [String; 3]> {
    let values = values(motor);
    NAMES.into_iter().zip(values).map(|((name, unit), it)| {
        [
            name.to_owned(),
            format!("{:.4e} {unit}", it.value),
            format!("{:.1e}", it.uncertainty),
        ]
    })
}

/// One line of text for each measured value.
pub fn lines(motor: &MeasuredMotor) -> Vec<String> {
    rows(motor)
        .map(|[name, value, uncertainty]| format!("{name:<41} {value} ± {uncertainty}"))
        .collect()
}

fn of_encoder(encoder: &Eccentricity, pole_pairs: f64) -> Block {
    let order = |index: usize| {
        let [value, open, phase] = eccentricity::shown(encoder, index);
        vec![eccentricity::NAMES[index].to_owned(), value + &phase, open]
    };
    let line = |name: &str, value| vec![name.to_owned(), value, String::new()];
    let warning = eccentricity::warning(encoder, pole_pairs);
    Block::Table {
        caption: "Of the shaft, against the field that turned it and against its own coasting. A phase is the sine's at the zero of the calibration that measured; the uncertainty is what the two ways of the field, and field and coasts, leave open.".into(),
        header: ["what", "value", "uncertainty"].map(str::to_owned).to_vec(),
        rows: [order(0), order(1)]
            .into_iter()
            .chain([line("effect", eccentricity::costs(encoder, pole_pairs))])
            .chain(warning.map(|warning| line("the magnet", warning)))
            .collect(),
    }
}

/// Writes the page into a folder; returns the page's path.
pub fn write(
    motor: &MeasuredMotor,
    encoder: Option<&Eccentricity>,
    cogging: Option<&Tried>,
    scene: &str,
    settings: &DeviceSettings,
    who: &str,
    folder: &Path,
) -> Result<PathBuf> {
    let measured = Block::Table {
        caption: "The uncertainty is half of the difference between two parts of the data, or the error of the fit. It does not include a wrong gain of the current sensors.".into(),
        header: ["what", "value", "uncertainty"].map(str::to_owned).to_vec(),
        rows: rows(motor).map(Vec::from).collect(),
    };
    let read = encoder.map(|encoder| of_encoder(encoder, settings.motor.pole_pairs.into()));
    let felt = cogging.map(|tried| Block::Table {
        caption: "The shaft turns slowly, both ways, without the map of the cogging and with it."
            .into(),
        header: ["what", "value"].map(str::to_owned).to_vec(),
        rows: [
            (
                "cogging, effective value",
                format!("{} N·m", number::measured(tried.found.rms_n_m, 3)),
            ),
            (
                "cogging, largest",
                format!("{} N·m", number::measured(tried.found.peak_n_m, 3)),
            ),
            (
                "differs between turns",
                format!("{:.0} %", 100.0 * tried.found.unrepeated),
            ),
            (
                "ripple without the map",
                format!("{:.2e} rad", tried.ripple_rad[0]),
            ),
            ("ripple with it", format!("{:.2e} rad", tried.ripple_rad[1])),
        ]
        .map(|(what, value)| vec![what.to_owned(), value])
        .to_vec(),
    });
    let all = Block::Table {
        caption: "All settings that the board keeps.".into(),
        header: ["setting", "value"].map(str::to_owned).to_vec(),
        rows: FIELDS
            .iter()
            .map(|field| {
                let shown = value::shown(settings, field);
                vec![
                    field.path.to_owned(),
                    format!("{shown}{}", value::unit(field)),
                ]
            })
            .collect(),
    };
    let section = |title: &str, body, folded| Section {
        title: title.to_owned(),
        body,
        folded,
    };
    let result = as_json(motor);
    let command = crate::command_line();
    let page = pages::Page {
        title: "A measured knob",
        intro: who,
        command: &command,
        program: program(),
        sections: &[
            section(
                "The motor and its knob",
                std::iter::once(measured).chain(read).chain(felt).collect(),
                false,
            ),
            section("Settings", vec![all], true),
        ],
        results: ("measured", &result),
        files: &[("knob.toml".to_owned(), scene.to_owned())],
        // Files of an earlier setup in this folder belong to the same board, so that they may be replaced.
        force: true,
    };
    Ok(pages::write(&page, folder)?.page)
}
