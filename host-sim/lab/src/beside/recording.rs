//! Reads the recorded control periods (ticks) of a device from the CSV file that `touchstone monitor` writes.

use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::input;
use touchstone_sim::scene::{Encoder, Scene};

/// Names of the CSV columns that are read.
const COLUMNS: [&str; 7] = [
    "tick",
    "time_s",
    "count",
    "penetration_rad",
    "force_n_m",
    "state",
    "limits",
];

/// The longest part of a recording in which the wall was on and no control period (tick) is missing.
#[derive(Debug, Clone)]
pub struct WallRecording {
    /// Path of the recording, for messages.
    pub file: PathBuf,
    /// Time of each tick in the recording, s.
    pub time_s: Vec<f64>,
    /// Encoder count at each tick (control period).
    pub count: Vec<f64>,
    /// Penetration at each tick (control period), rad.
    pub penetration_rad: Vec<f64>,
    /// Force commanded out of the wall at each tick, N·m.
    pub force_n_m: Vec<f64>,
    /// For each tick, whether the device limited the force.
    pub limited: Vec<bool>,
    /// Number of ticks that are missing in the whole recording.
    pub lost_ticks: u32,
}

/// One CSV row of the recording: one tick.
struct Row {
    tick: u32,
    numbers: [f64; 4],
    armed: bool,
    limited: bool,
}

impl WallRecording {
    /// Reads, between two times in seconds, the longest part of a recording in which the wall was on and no tick is missing.
    ///
    /// # Errors
    /// The file cannot be read, was not written by `monitor`, or has no tenth of a second in which the wall was on without a lost
    /// tick.
    pub fn read(file: &Path, from_s: f64, to_s: f64) -> Result<Self> {
        let rows = rows(file, EVERY_PERIOD)?;
        let mut told = Self {
            file: file.to_owned(),
            time_s: Vec::new(),
            count: Vec::new(),
            penetration_rad: Vec::new(),
            force_n_m: Vec::new(),
            limited: Vec::new(),
            lost_ticks: 0,
        };
        let wanted = |row: &Row| row.armed && (from_s..=to_s).contains(&row.numbers[0]);
        // The current stretch without a gap, and the longest one so far.
        let (mut stretch, mut longest) = (0..0, 0..0);
        for (index, row) in rows.iter().enumerate() {
            let before = index.checked_sub(1).map(|before| rows[before].tick);
            let gap = before.map_or(0, |before| row.tick.wrapping_sub(before).saturating_sub(1));
            told.lost_ticks += gap;
            stretch = match (wanted(row), gap) {
                (false, _) => index + 1..index + 1,
                (true, 0) => stretch.start..index + 1,
                (true, _) => index..index + 1,
            };
            if stretch.len() > longest.len() {
                longest = stretch.clone();
            }
        }
        for row in &rows[longest] {
            let [time, count, penetration, force] = row.numbers;
            told.time_s.push(time);
            told.count.push(count);
            told.penetration_rad.push(penetration);
            told.force_n_m.push(force);
            told.limited.push(row.limited);
        }
        let length_s = told.time_s.last().zip(told.time_s.first());
        if length_s.is_none_or(|(last, first)| last - first < SHORTEST_S) {
            return Err(told.wrong(
                format!("the compared part has no {SHORTEST_S} s with the wall on and without a lost record"),
                "record while the device is armed: touchstone monitor --csv FILE",
            ));
        }
        Ok(told)
    }

    /// Angle of the device's wall surface, so that the real and the simulated encoder step at the same angles.
    ///
    /// # Errors
    /// The scene has no encoder, or another one than the recorded device.
    pub fn surface_rad(&self, scene: &Scene) -> Result<f64> {
        let counts = self.count.iter().copied();
        let places = counts.zip(self.penetration_rad.iter().copied());
        surface_rad(&self.file, encoder(scene)?, places)
    }

    /// Makes an error about this recording, with the problem and its remedy.
    pub fn wrong(&self, problem: impl Into<String>, fix: &str) -> Error {
        wrong(&self.file, problem, fix)
    }
}

fn wrong(file: &Path, problem: impl Into<String>, fix: &str) -> Error {
    Error::Io {
        path: file.to_owned(),
        problem: problem.into(),
        fix: fix.to_owned(),
    }
}

const SET_ENCODER: &str = "set the scene's encoder to the device's: --set encoder.counts_per_rev=…";

/// The scene's encoder, whose counts a recording has.
///
/// # Errors
/// The scene has none.
pub fn encoder(scene: &Scene) -> Result<&Encoder> {
    scene.encoder.as_ref().ok_or_else(|| Error::Option {
        option: "encoder.counts_per_rev".into(),
        problem: "the scene has no encoder, the device has one".into(),
        fix: SET_ENCODER.into(),
    })
}

/// Encoder counts of all records of a recording.
///
/// # Errors
/// The file cannot be read, was not written by `monitor`, or is of a device with another encoder.
pub fn counts(file: &Path, encoder: &Encoder) -> Result<Vec<f64>> {
    let rows = rows(file, "give a file of `touchstone monitor --csv FILE`")?;
    let places = rows.iter().map(|row| (row.numbers[1], row.numbers[2]));
    surface_rad(file, encoder, places)?;
    Ok(rows.iter().map(|row| row.numbers[1]).collect())
}

/// Step of the recorded penetrations, rad.
const STEP_RAD: f64 = 1.0 / (1 << 24) as f64;

/// Angle of the device's wall surface, from pairs of recorded count and penetration.
fn surface_rad(
    file: &Path,
    encoder: &Encoder,
    places: impl Iterator<Item = (f64, f64)>,
) -> Result<f64> {
    let step = encoder.step_rad();
    let (low, high) = places
        .map(|(count, penetration)| count * step - penetration)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| {
            (low.min(it), high.max(it))
        });
    // A knob at rest moves by few counts, so a tenth of a count must tell one encoder from another.
    if high - low > 0.1 * step + STEP_RAD {
        let problem = format!(
            "its positions are not whole counts of an encoder with {} counts a turn",
            encoder.counts_per_rev
        );
        return Err(wrong(file, problem, SET_ENCODER));
    }
    Ok(0.5 * (low + high))
}

/// Shortest recording that is compared, s.
const SHORTEST_S: f64 = 0.1;

/// Remedy for a file that cannot be compared.
const EVERY_PERIOD: &str =
    "give a file of `touchstone monitor --csv FILE --decimation 1`, which has every control period";

/// Reads all rows of a recording; `fix` is the remedy if this fails.
fn rows(file: &Path, fix: &str) -> Result<Vec<Row>> {
    let wrong = |problem: String| wrong(file, problem, fix);
    let text = input::text(file, input::MOST_OF_RECORDING);
    let text = text.map_err(|error| wrong(error.to_string()))?;
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| wrong(error.to_string()))?;
    let mut places = [0; COLUMNS.len()];
    for (place, name) in places.iter_mut().zip(COLUMNS) {
        *place = header
            .iter()
            .position(|column| column == name)
            .ok_or_else(|| wrong(format!("has no column {name}")))?;
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| wrong(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |column: usize| record.get(places[column]).unwrap_or_default();
        let number = |column: usize| {
            let value = cell(column).parse::<f64>().ok().filter(|it| it.is_finite());
            value.ok_or_else(|| {
                let name = COLUMNS[column];
                wrong(format!(
                    "line {line}, {name}: `{}` is not a number",
                    cell(column)
                ))
            })
        };
        // Of swapped columns too, so that this is not taken for another encoder.
        if number(2)?.fract() != 0.0 {
            let problem = format!("line {line}, count: `{}` is not a whole number", cell(2));
            return Err(wrong(problem));
        }
        rows.push(Row {
            tick: number(0)? as u32,
            numbers: [number(1)?, number(2)?, number(3)?, number(4)?],
            armed: cell(5) == "armed",
            limited: !cell(6).is_empty(),
        });
    }
    Ok(rows)
}
