//! Writes the folder of a map: cells as CSV and Parquet with their origin, maps as SVG, and `results.json`.

use super::map::{self, Over, Overlay};
use super::measure::{REFUSED, VERDICT, verdicts};
use super::store::{CELLS, Cells, Shard};
use super::{Sweep, lines};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use touchstone_report::folder;
use touchstone_report::json::tabular;
use touchstone_report::origin::{SCHEMA_VERSION, sha256};
#[cfg(feature = "parquet")]
use touchstone_report::parquet::{Values, table};
use touchstone_report::staging::io_error;
use touchstone_report::{drawn, svg::Size};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::input;
use touchstone_sim::run::verdict::WORDS;

const SIZE: Size = Size {
    width: 760,
    height: 560,
};
const SCENE: &str = "scene.toml";

/// Options for drawing the maps.
#[derive(Clone, Default)]
pub struct Drawing<'a> {
    /// Points from a user's measurements, drawn over the map.
    pub points: Option<Overlay>,
    /// Leaves out the boundary of the stability certificate.
    pub no_certificate: bool,
    /// Function that is called while certificates are computed.
    pub progress: Option<&'a lines::Progress<'a>>,
}

/// Reads points of a user's measurements from a CSV file: two columns of numbers under a header, in the axes' units. The points are
/// named after the file without its extension.
///
/// # Errors
/// The file cannot be read or has another format.
pub fn overlay(file: &Path) -> Result<Overlay> {
    let wrong = |problem: String| Error::Io {
        path: file.to_owned(),
        problem,
        fix: "give a CSV file of two columns under a header: x and y in the axes' units".to_owned(),
    };
    let text = input::text(file, input::MOST_OF_RECORDING);
    let text = text.map_err(|error| wrong(error.to_string()))?;
    let points = csv::Reader::from_reader(text.as_bytes())
        .deserialize()
        .collect::<std::result::Result<Vec<(f64, f64)>, _>>()
        .map_err(|error| wrong(error.to_string()))?;
    if points.is_empty() {
        return Err(wrong("has no row of numbers".to_owned()));
    }
    let is_finite = |(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
    if let Some(row) = points.iter().position(|point| !is_finite(point)) {
        return Err(wrong(format!("row {} is not finite", row + 1)));
    }
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    Ok(Overlay {
        name: name.replace('-', " "),
        points,
    })
}

/// The results as JSON: settings of the sweep, number of cells for each verdict, and range of each measure.
#[must_use]
pub fn results(sweep: &Sweep, shard: Shard, cells: &Cells, over: &Over, files: &[String]) -> Value {
    let axis = |axis: &super::axis::Axis| {
        json!({
            "field": axis.field.path,
            "unit": axis.field.unit_shown(),
            "log": axis.log,
            "values": axis.values,
        })
    };
    let counts: serde_json::Map<String, Value> = verdicts()
        .into_iter()
        .map(|word| {
            let count = cells.values().filter(|row| row.3 == word).count();
            (word.to_owned(), count.into())
        })
        .collect();
    let measures: Vec<Value> = sweep
        .measures
        .iter()
        .enumerate()
        .map(|(index, measure)| {
            let values = || cells.values().filter_map(|row| row.4[index]);
            json!({
                "name": measure.name,
                "unit": measure.unit,
                "meaning": measure.meaning,
                "cells": values().count(),
                "least": values().reduce(f64::min),
                "most": values().reduce(f64::max),
            })
        })
        .collect();
    let lines: Vec<&str> = over.lines.iter().map(|line| line.name).collect();
    json!({
        "schema_version": SCHEMA_VERSION,
        "program": sweep.program,
        "command": sweep.command,
        "inputs": sweep.inputs,
        "files": files,
        "scene": sweep.grid.base.name,
        "scene_sha256": sha256(sweep.grid.base.to_toml().as_bytes()),
        "shard": {"index": shard.index, "of": shard.of},
        "x": axis(&sweep.grid.x),
        "y": axis(&sweep.grid.y),
        "cells": cells.len(),
        "verdicts": counts,
        "measures": measures,
        "lines": lines,
    })
}

/// Writes the map's folder; returns the contents of `results.json` and the paths of the files. A shard gets only its cells; maps
/// are drawn for the whole sweep.
///
/// # Errors
/// The errors of [`folder::publish`].
pub fn write(
    sweep: &Sweep,
    shard: Shard,
    cells: &Cells,
    drawing: &Drawing,
    folder: &Path,
    force: bool,
) -> Result<(Value, Vec<PathBuf>)> {
    let mut over = Over::default();
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    let columns = columns(sweep);
    let described: Vec<[&str; 4]> = columns
        .iter()
        .map(|c| c.each_ref().map(String::as_str))
        .collect();
    let from = origin(sweep, shard, &described);
    files.push((CELLS.to_owned(), comma_separated(sweep, cells)?));
    files.push((
        format!("{CELLS}-metadata.json"),
        tabular(CELLS, &described, &from).into_bytes(),
    ));
    #[cfg(feature = "parquet")]
    files.push((
        "cells.parquet".to_owned(),
        parquet(sweep, cells, &from).map_err(|error| io_error(folder, &error))?,
    ));
    files.push((SCENE.to_owned(), sweep.grid.base.to_toml().into_bytes()));
    if shard == Shard::WHOLE {
        over = Over {
            lines: lines::all(
                &sweep.grid,
                !drawing.no_certificate,
                drawing.progress.unwrap_or(&|_, _| {}),
            ),
            points: drawing.points.clone(),
        };
        let mut draw = |name: String, figure: touchstone_report::figure::Figure| {
            let text = drawn(&figure.title.clone(), &[figure], SIZE);
            files.push((name, text.into_bytes()));
        };
        draw(map::file(None), map::of_verdicts(sweep, cells, &over));
        for (index, measure) in sweep.measures.iter().enumerate() {
            let figure = map::of_measure(sweep, cells, index, measure, &over);
            draw(map::file(Some(measure)), figure);
        }
    }
    let mut names: Vec<String> = files.iter().map(|(name, _)| name.clone()).collect();
    names.push("results.json".to_owned());
    let results = results(sweep, shard, cells, &over, &names);
    files.push((
        "results.json".to_owned(),
        format!("{results:#}\n").into_bytes(),
    ));
    let paths = folder::publish(folder, &sweep.command, force, &files)?;
    Ok((results, paths))
}

/// Name, type, meaning and unit of every column of the cells' table.
fn columns(sweep: &Sweep) -> Vec<[String; 4]> {
    let axis = |axis: &super::axis::Axis| {
        let kind = if axis.numbers().is_some() {
            "number"
        } else {
            "string"
        };
        [
            axis.field.path.to_owned(),
            kind.to_owned(),
            axis.field.about.to_owned(),
            axis.field.unit_shown().to_owned(),
        ]
    };
    let words: Vec<&str> = WORDS.iter().map(|(word, _)| *word).collect();
    let text = |parts: [&str; 4]| parts.map(str::to_owned);
    let mut columns = vec![
        text(["cell", "number", "number of the cell, row by row", "1"]),
        axis(&sweep.grid.x),
        axis(&sweep.grid.y),
        [
            VERDICT.to_owned(),
            "string".to_owned(),
            format!(
                "how the run ended: {}; {REFUSED}: there is no such run",
                words.join(", ")
            ),
            String::new(),
        ],
    ];
    columns.extend(
        sweep
            .measures
            .iter()
            .map(|it| text([&it.column(), "number", it.meaning, it.unit])),
    );
    columns
}

/// Metadata on the origin of the cells (program, command, scene), as keys and values.
fn origin(sweep: &Sweep, shard: Shard, columns: &[[&str; 4]]) -> Vec<(&'static str, String)> {
    let plan = sweep.plan();
    let of = |index: usize| -> serde_json::Map<String, Value> {
        columns
            .iter()
            .map(|column| (column[0].to_owned(), column[index].into()))
            .collect()
    };
    let toml = sweep.grid.base.to_toml();
    vec![
        ("schema_version", SCHEMA_VERSION.to_string()),
        ("program", json!(sweep.program).to_string()),
        ("command", sweep.command.clone()),
        ("inputs", plan["inputs"].to_string()),
        (
            "sweep",
            json!({"x": plan["x"], "y": plan["y"], "shard": {"index": shard.index, "of": shard.of}})
                .to_string(),
        ),
        ("scene_sha256", sha256(toml.as_bytes())),
        ("scene_toml", toml),
        ("columns", Value::Object(of(2)).to_string()),
        ("units", Value::Object(of(3)).to_string()),
    ]
}

fn comma_separated(sweep: &Sweep, cells: &Cells) -> Result<Vec<u8>> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(false)
        .from_writer(Vec::new());
    let wrong = |error: csv::Error| io_error(Path::new(CELLS), &error.into());
    writer.write_record(sweep.header()).map_err(wrong)?;
    for row in cells.values() {
        writer.serialize(row).map_err(wrong)?;
    }
    writer
        .into_inner()
        .map_err(|error| io_error(Path::new(CELLS), error.error()))
}

#[cfg(feature = "parquet")]
fn parquet(
    sweep: &Sweep,
    cells: &Cells,
    from: &[(&'static str, String)],
) -> std::io::Result<Vec<u8>> {
    let axis = |axis: &super::axis::Axis, of: fn(&super::measure::Row) -> &str| {
        let texts: Vec<&str> = cells.values().map(of).collect();
        match axis.numbers() {
            Some(_) => Values::Numbers(
                texts
                    .iter()
                    .map(|text| text.parse().unwrap_or(f64::NAN))
                    .collect(),
            ),
            None => Values::Words(texts),
        }
    };
    let header = sweep.header();
    let mut values = vec![
        Values::Numbers(cells.keys().map(|cell| *cell as f64).collect()),
        axis(&sweep.grid.x, |row| &row.1),
        axis(&sweep.grid.y, |row| &row.2),
        Values::Words(cells.values().map(|row| row.3.as_str()).collect()),
    ];
    values.extend((0..sweep.measures.len()).map(|index| {
        let value = |row: &super::measure::Row| row.4[index].unwrap_or(f64::NAN);
        Values::Numbers(cells.values().map(value).collect())
    }));
    let columns: Vec<(&str, Values<'_>)> = header.iter().map(String::as_str).zip(values).collect();
    table(&columns, from)
}
