//! Reads recordings of a hand's motion: CSV files with a column of time and a column of angle, whose units are in the header.

use std::path::{Path, PathBuf};

use super::resample::{Curve, MOST_STEPS, median_interval_s, step_s};
use crate::error::{Error, Result};
use crate::input;
use crate::scene::operator::Recorded;
use crate::scene::units::{self, Dimension, UNITS};

/// Angle columns of Touchstone's own files, in the order of preference. A simulation's trace knows the hand's rest point; the
/// record of a device has only the device's angle.
const OWN_ANGLES: [&str; 5] = [
    "rest_rad",
    "hand_rad",
    "angle_rad",
    "angle_measured_rad",
    "penetration_rad",
];
/// Columns that identify a file of this program: a simulation's trace or a record of `touchstone monitor`.
const OWN_MARKS: [&str; 2] = ["time_s", "force_n_m"];

/// Largest number of samples in a recording: an hour at 1 kHz.
const MOST_SAMPLES: usize = 3_600_000;
/// Smallest time stamp, in the file's unit, whose fall to less than half is explained as a counter's wrap. The smallest counter, of
/// 8 bits, ends at 255.
const LEAST_OF_COUNTER: f64 = 255.0;
/// Shortest accepted recording, s.
const SHORTEST_S: f64 = 1e-5;
/// Largest accepted angle of either sign, rad.
const LARGEST_RAD: f64 = 1e6;

/// A recorded hand motion: sample times in s from 0, angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    file: PathBuf,
    /// Header name of the angle's column.
    angle: String,
    /// Time of the first sample on the clock of the file, s; [`times_s`](Self::times_s) counts from it.
    begins_s: f64,
    times_s: Vec<f64>,
    angles_rad: Vec<f64>,
}

/// The column of a CSV file from which times or angles are read, with the factor that converts its unit to SI.
struct Column {
    index: usize,
    name: String,
    si: f64,
}

impl Recording {
    /// Reads a recording from a CSV file.
    ///
    /// The file has a header line; lines that begin with `#` are skipped. One column's name must end in a unit of time (`time_s`,
    /// `t_ms`, `Time [us]`), one in a unit of angle (`angle_deg`, `position_rad`, `theta_mrad`, `turn_rev`). Other columns are
    /// ignored. Times must rise; their steps need not be equal. Time counts from the first sample.
    ///
    /// A trace of a simulation and a file of `touchstone monitor` have several columns of angles. From such a file the first
    /// existing column of `rest_rad`, `hand_rad`, `angle_rad`, `angle_measured_rad` and `penetration_rad` is read.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read. [`Error::File`] with line and column for a missing or ambiguous column, fewer than
    /// two rows, a missing or non-finite number, times that do not rise, or more than 3.6 million steps.
    pub fn read(file: &Path) -> Result<Recording> {
        let text = input::text(file, input::MOST_OF_RECORDING).map_err(|error| {
            let (problem, fix) = match error.kind() {
                std::io::ErrorKind::NotFound => (
                    "no such file".to_owned(),
                    "give the path of a CSV file with time and angle",
                ),
                std::io::ErrorKind::InvalidData => {
                    (error.to_string(), "export the recording as CSV in UTF-8")
                }
                std::io::ErrorKind::FileTooLarge => (
                    error.to_string(),
                    "cut the recording, or keep time and angle alone",
                ),
                _ => (error.to_string(), "give a readable file"),
            };
            Error::Io {
                path: file.to_owned(),
                problem,
                fix: fix.to_owned(),
            }
        })?;
        Recording::parse(&text, file)
    }

    /// Reads a recording from text; `file` is its name in messages.
    ///
    /// # Errors
    /// Same as [`Recording::read`].
    pub fn parse(text: &str, file: &Path) -> Result<Recording> {
        let error = |line: usize, field: &str, problem: String, fix: &str| Error::File {
            file: file.to_owned(),
            line,
            field: field.to_owned(),
            problem,
            fix: fix.to_owned(),
        };
        // A byte-order mark is not part of the first column's name.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let mut rows = reader.records();
        let not_csv = |cause: csv::Error| {
            let line = cause
                .position()
                .map_or(1, |position| position.line() as usize);
            error(
                line,
                "row",
                format!("not valid CSV: {cause}"),
                "separate the columns by commas",
            )
        };
        let Some(header) = rows.next().transpose().map_err(not_csv)? else {
            return Err(error(
                1,
                "header",
                "the file is empty".into(),
                "give a header such as time_s,angle_deg and a row a sample",
            ));
        };
        let header_line = line_of(text, &header);
        if header.len() == 1 && header[0].contains([';', '\t']) {
            let problem = "the columns are not separated by commas".into();
            return Err(error(
                header_line,
                "header",
                problem,
                "separate them by commas, with a point in the numbers",
            ));
        }
        let column = |dimension, what| {
            find(&header, dimension, what)
                .map_err(|(problem, fix)| error(header_line, what, problem, &fix))
        };
        let time = column(Dimension::Time, "time")?;
        let angle = match own_angle(&header) {
            Some(angle) => angle,
            None => column(Dimension::Angle, "angle")?,
        };
        let (mut times_s, mut angles_rad) = (Vec::new(), Vec::new());
        let (mut first, mut previous) = (None, f64::NEG_INFINITY);
        for row in rows {
            let row = row.map_err(not_csv)?;
            let line = || line_of(text, &row);
            let cell = |column: &Column| {
                cell(&row, column)
                    .map_err(|(problem, fix)| error(line(), &column.name, problem, fix))
            };
            if row.len() < header.len()
                || row.iter().skip(header.len()).any(|more| !more.is_empty())
            {
                let problem = format!("{} cells, where the header has {}", row.len(), header.len());
                let fix =
                    "put texts and numbers with commas in quotes, or write decimals with a point";
                return Err(error(line(), "row", problem, fix));
            }
            let (t, x) = (cell(&time)?, cell(&angle)?);
            if (x * angle.si).abs() > LARGEST_RAD {
                let problem = format!(
                    "{} is no angle of a hand, above {LARGEST_RAD} rad",
                    short(x)
                );
                return Err(error(
                    line(),
                    &angle.name,
                    problem,
                    "check the column and its unit",
                ));
            }
            if times_s.len() == MOST_SAMPLES {
                let problem = format!("more than {MOST_SAMPLES} samples");
                return Err(error(
                    line(),
                    "row",
                    problem,
                    "cut the recording to an hour, at 1 kHz",
                ));
            }
            if t <= previous {
                let problem = format!(
                    "{} comes after {}, but times must rise",
                    short(t),
                    short(previous)
                );
                return Err(error(
                    line(),
                    &time.name,
                    problem,
                    // A counter that wraps falls to less than half in one step.
                    match t < 0.5 * previous && previous >= LEAST_OF_COUNTER {
                        true => {
                            "where a counter wrapped, add its range to what follows; else sort the rows by time"
                        }
                        false => "sort the rows by time and remove repeated ones",
                    },
                ));
            }
            previous = t;
            times_s.push((t - *first.get_or_insert(t)) * time.si);
            angles_rad.push(x * angle.si);
        }
        if times_s.len() < 2 {
            let problem = format!(
                "{} row of numbers is no motion",
                ["no", "one"][times_s.len()]
            );
            return Err(error(
                header_line + times_s.len(),
                &time.name,
                problem,
                "give two rows or more, one a sample",
            ));
        }
        let recording = Recording {
            file: file.to_owned(),
            angle: angle.name,
            begins_s: first.unwrap_or(0.0) * time.si,
            times_s,
            angles_rad,
        };
        if recording.length_s() < SHORTEST_S {
            let problem = format!("the recording takes {:e} s", recording.length_s());
            return Err(error(
                header_line,
                &time.name,
                problem,
                "check the unit of time: 10 µs is the least",
            ));
        }
        let steps = recording.length_s() / step_s(recording.length_s(), recording.times_s.len());
        if steps > MOST_STEPS {
            let problem = format!(
                "the recording takes {} s, too long to smooth in steps of at most 1 ms",
                short(recording.length_s())
            );
            return Err(error(
                header_line,
                &time.name,
                problem,
                "check the unit of time, or cut the recording to an hour",
            ));
        }
        Ok(recording)
    }

    /// Header name of the angle's column.
    pub(super) fn angle(&self) -> &str {
        &self.angle
    }

    /// Time from the first to the last sample, s.
    pub fn length_s(&self) -> f64 {
        self.times_s.last().copied().unwrap_or(0.0)
    }

    /// Median interval between samples, s.
    pub fn interval_s(&self) -> f64 {
        median_interval_s(&self.times_s)
    }

    /// Time of the first sample on the clock of the file, s.
    #[must_use]
    pub fn begins_s(&self) -> f64 {
        self.begins_s
    }

    /// Sample times, s, counted from the first sample.
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Recorded angles, rad, one per sample time.
    pub fn angles_rad(&self) -> &[f64] {
        &self.angles_rad
    }

    /// Mean angle over time, rad. It is integrated by trapezoids, so that unequal sample intervals do not shift it.
    pub fn mean_rad(&self) -> f64 {
        let areas = self
            .times_s
            .windows(2)
            .zip(self.angles_rad.windows(2))
            .map(|(t, x)| 0.5 * (x[0] + x[1]) * (t[1] - t[0]));
        areas.sum::<f64>() / self.length_s()
    }

    /// The smoothed rest point over time, placed against the wall: `surface + offset + scale·(angle - mean)`, rad.
    pub(super) fn placed(&self, surface_rad: f64, spec: &Recorded) -> Curve {
        let mean = self.mean_rad();
        let rest: Vec<f64> = self
            .angles_rad
            .iter()
            .map(|angle| surface_rad + spec.offset_rad + spec.scale * (angle - mean))
            .collect();
        Curve::smooth(&self.times_s, &rest)
    }

    /// Describes in one line how the recording was placed against the wall and smoothed.
    pub(super) fn note(&self, surface_rad: f64, spec: &Recorded, curve: &Curve) -> String {
        let (low, high) = curve.range();
        let odd: String = self.odd().iter().map(|odd| format!("; {odd}")).collect();
        // Names of file and column are shown as the user wrote them.
        crate::harmless::one_line(&format!(
            "{}, {}: {} samples, {:.2} s at {:.0} Hz; rest point = surface {:.3} rad + offset {:.3} rad + {} × (angle - mean {:.3} rad), \
             from {:.3} to {:.3} rad, inside the wall {:.0} % of the time{odd}",
            self.file.display(),
            self.angle,
            self.times_s.len(),
            self.length_s(),
            (self.times_s.len() - 1) as f64 / self.length_s(),
            surface_rad,
            spec.offset_rad,
            spec.scale,
            self.mean_rad(),
            low,
            high,
            100.0 * curve.share_above(surface_rad),
        ))
    }
}

/// Writes a number in a short form: a huge number without its hundreds of digits.
fn short(number: f64) -> String {
    match number.abs() < 1e15 {
        true => number.to_string(),
        false => format!("{number:e}"),
    }
}

/// Line number in the file of a CSV row. The reader's own number does not count comments and empty lines before the row.
fn line_of(text: &str, row: &csv::StringRecord) -> usize {
    let Some(position) = row.position() else {
        return 1;
    };
    let skipped = |line: &&str| line.trim_end().is_empty() || line.starts_with('#');
    let rest = text.get(position.byte() as usize..).unwrap_or("");
    position.line() as usize + rest.lines().take_while(skipped).count()
}

/// The angle's column in a file that this program wrote; `None` for other files.
fn own_angle(header: &csv::StringRecord) -> Option<Column> {
    let place = |wanted: &str| header.iter().position(|name| name == wanted);
    OWN_MARKS
        .into_iter()
        .try_for_each(|mark| place(mark).map(drop))?;
    OWN_ANGLES.into_iter().find_map(|name| {
        Some(Column {
            index: place(name)?,
            name: name.to_owned(),
            si: 1.0,
        })
    })
}

/// Words with which the name of a time column begins.
const TIMES: [&str; 7] = [
    "time",
    "t",
    "timestamp",
    "zeit",
    "temps",
    "elapsed",
    "clock",
];

/// Units that headers spell as words, each with the suffix that it stands for.
const WORDS: [(&str, &str); 15] = [
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("msec", "ms"),
    ("millis", "ms"),
    ("milliseconds", "ms"),
    ("usec", "us"),
    ("micros", "us"),
    ("microseconds", "us"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radians", "rad"),
    ("turns", "rev"),
    ("revolutions", "rev"),
];

/// Puts a column's name in lower case, with `_` between the words: `Angle [deg]` and `angle (deg)` become `angle_deg`. `°/s`
/// becomes `deg_per_s`, which is a speed.
fn plain(name: &str) -> String {
    let name = name
        .to_lowercase()
        .replace('°', "_deg")
        .replace(['µ', 'μ'], "u")
        .replace('/', "_per_")
        .replace(|c: char| !c.is_alphanumeric(), "_");
    let words: Vec<&str> = name.split('_').filter(|word| !word.is_empty()).collect();
    words.join("_")
}

/// The unit with which a column's name ends; `None` if it ends with none.
fn unit_of(name: &str) -> Option<&'static units::Unit> {
    let plain = plain(name);
    let (stem, last) = plain.rsplit_once('_').unwrap_or(("", &plain));
    match WORDS.iter().find(|(word, _)| *word == last) {
        Some((_, suffix)) if stem != "per" && !stem.ends_with("_per") => units::by_suffix(suffix),
        Some(_) => None,
        None => units::at_end_of(&plain),
    }
}

/// Finds the only column whose name ends in a unit of this dimension. Error: problem and remedy, if no column or several fit.
fn find(
    header: &csv::StringRecord,
    dimension: Dimension,
    what: &str,
) -> std::result::Result<Column, (String, String)> {
    let accepted: Vec<String> = UNITS
        .iter()
        .filter(|unit| unit.dimension == dimension)
        .map(|unit| format!("_{}", unit.suffix))
        .collect();
    let accepted = accepted.join(", ");
    let mut found: Vec<Column> = header
        .iter()
        .enumerate()
        .filter_map(|(index, name)| {
            let unit = unit_of(name).filter(|unit| unit.dimension == dimension)?;
            Some(Column {
                index,
                name: name.to_owned(),
                si: unit.si,
            })
        })
        .collect();
    // `axis_s` ends like a time. If exactly one column's name also begins with a word for time, that column is used.
    if dimension == Dimension::Time && found.len() > 1 {
        let is_named = |column: &Column| {
            TIMES.contains(&plain(&column.name).split('_').next().unwrap_or_default())
        };
        if found.iter().filter(|column| is_named(column)).count() == 1 {
            found.retain(is_named);
        }
    }
    let mut found = found.into_iter();
    // An unclosed quote makes the whole rest of the file one column name, so names are cut for the message.
    let cut = |name: &str| -> String {
        name.split(['\n', '\r'])
            .next()
            .unwrap_or_default()
            .chars()
            .take(40)
            .collect()
    };
    let names: Vec<String> = header.iter().take(20).map(cut).collect();
    let names = names.join(", ");
    match (found.next(), found.next()) {
        (Some(column), None) => Ok(column),
        (Some(one), Some(other)) => Err((
            format!(
                "both {} and {} look like it",
                cut(&one.name),
                cut(&other.name)
            ),
            "keep one of the two columns".to_owned(),
        )),
        (None, _) => {
            let article = if what.starts_with('a') { "an" } else { "a" };
            let problem = format!("no column with {article} {what} unit among {names}");
            Err((
                problem,
                format!("end the column's name in one of {accepted}"),
            ))
        }
    }
}

/// Reads the finite number in one cell of the CSV file.
fn cell(
    row: &csv::StringRecord,
    column: &Column,
) -> std::result::Result<f64, (String, &'static str)> {
    // The CSV reader has checked that rows are as long as the header.
    let text = row.get(column.index).unwrap_or_default();
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err((
            format!("{text} is not a finite number"),
            "remove the row or fill the gap",
        )),
        Err(_) if text.is_empty() => Err(("is empty".to_owned(), "complete or remove the row")),
        Err(_) => Err((
            format!("\"{text}\" is not a number"),
            "write numbers such as 0.25 or 2.5e-1",
        )),
    }
}
