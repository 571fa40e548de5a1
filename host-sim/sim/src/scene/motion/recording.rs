//! Reads recordings of a hand's motion: CSV files with a column of time and a column of angle, whose units are in the header.

use std::path::{Path, PathBuf};

use super::column::{Column, cell, cut, find, own_angle, rows};
use super::resample::{Curve, MOST_STEPS, median_interval_s, step_s};
use crate::error::{Error, Result};
use crate::input;
use crate::scene::Timing;
use crate::scene::operator::Recorded;
use crate::scene::units::Dimension;

/// Largest number of samples in a recording: an hour at 1 kHz.
const MOST_SAMPLES: usize = 3_600_000;
/// Smallest time stamp, in the file's unit, after which a fall to less than half is explained as the wrap of a counter. The
/// smallest counter, of 8 bits, ends at 255.
const LEAST_OF_COUNTER: f64 = 255.0;
/// Shortest duration of an accepted recording, s.
const SHORTEST_S: f64 = 1e-5;
/// Largest accepted angle of either sign, rad.
const LARGEST_RAD: f64 = 1e6;

/// A recorded hand motion: sample times in s from 0, angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    file: PathBuf,
    /// Name of the angle column in the file's header.
    angle: String,
    /// Time of the first sample as written in the file, s. [`times_s`](Self::times_s) counts from this time.
    begins_s: f64,
    times_s: Vec<f64>,
    angles_rad: Vec<f64>,
}

impl Recording {
    /// Reads a recording from a file that is not kept: see [`Recording::read`].
    pub(super) fn read_anew(file: &Path) -> Result<Recording> {
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
                    "cut the recording, or remove all columns but time and angle",
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
        let (text, mut reader) = rows(text);
        let mut records = reader.records();
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
        let Some(header) = records.next().transpose().map_err(not_csv)? else {
            return Err(error(
                1,
                "header",
                "the file is empty".into(),
                "give a header such as time_s,angle_deg and one row for each sample",
            ));
        };
        let header_line = line_of(text, &header);
        if header.len() == 1 {
            let problem = format!("{} is one column", cut(&header[0]));
            let fix = "separate time and angle by commas, with a point in the numbers";
            return Err(error(header_line, "header", problem, fix));
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
        for row in records {
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
                    "{} is above {LARGEST_RAD} rad, more than a hand turns",
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
                            "if a counter wrapped, add its range to the times after it; otherwise sort the rows by time"
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
                "{} row of numbers is not a motion",
                ["no", "one"][times_s.len()]
            );
            return Err(error(
                header_line + times_s.len(),
                &time.name,
                problem,
                "give two rows or more, one for each sample",
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
                "check the unit of time: the least duration is 10 µs",
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

    /// Name of the angle column in the file's header.
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

    /// Time of the first sample as written in the file, s.
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

    /// Mean angle over time, rad. The trapezoidal rule weights each sample by time, so that uneven intervals do not shift the mean.
    pub fn mean_rad(&self) -> f64 {
        let areas = self
            .times_s
            .windows(2)
            .zip(self.angles_rad.windows(2))
            .map(|(t, x)| 0.5 * (x[0] + x[1]) * (t[1] - t[0]));
        areas.sum::<f64>() / self.length_s()
    }

    /// Computes the smoothed rest point over time, `surface + offset + scale·(angle - mean angle)`, rad. Offset and scale come from
    /// `spec`.
    pub(super) fn placed(&self, surface_rad: f64, spec: &Recorded) -> Curve {
        let mean = self.mean_rad();
        let rest: Vec<f64> = self
            .angles_rad
            .iter()
            .map(|angle| surface_rad + spec.offset_rad + spec.scale * (angle - mean))
            .collect();
        Curve::smooth(&self.times_s, &rest)
    }

    /// The file's name as the user wrote it, for a note of one line.
    pub(super) fn shown(&self) -> String {
        crate::harmless::one_line(&self.file.display().to_string())
    }

    /// Says that the run ends before the recording; `None` if it plays the whole recording.
    pub(super) fn cut_by(&self, timing: &Timing) -> Option<String> {
        let (played_s, length_s) = (timing.duration_s, self.length_s());
        // A run lasts a whole number of control periods, so its end can be half a period before the recording's.
        let is_cut = played_s + timing.period_s() < length_s;
        is_cut.then(|| {
            format!("the run plays the first {played_s} s: give timing.duration_s = {length_s:.3} for all of it")
        })
    }

    /// Describes in one line, for users, how the recording was placed on the wall and smoothed.
    pub(super) fn note(&self, surface_rad: f64, spec: &Recorded, curve: &Curve) -> String {
        let (low, high) = curve.range();
        let odd: String = self.odd().iter().map(|odd| format!("; {odd}")).collect();
        // Names of file and column are shown as the user wrote them.
        crate::harmless::one_line(&format!(
            "{}, {}: {} samples, {:.2} s at {} Hz; rest point = surface {:.3} rad + offset {:.3} rad + {} × (angle - mean {:.3} rad), \
             from {:.3} to {:.3} rad, inside the wall {:.0} % of the time{odd}",
            self.file.display(),
            self.angle,
            self.times_s.len(),
            self.length_s(),
            rate_shown((self.times_s.len() - 1) as f64 / self.length_s()),
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

/// A sampling rate in Hz for messages; a slow one with its decimals.
fn rate_shown(rate_hz: f64) -> String {
    match rate_hz >= 10.0 {
        true => format!("{rate_hz:.0}"),
        false => format!("{rate_hz:.3}"),
    }
}

/// Writes a number for messages in a short form; a huge number is not written out to its last digit.
fn short(number: f64) -> String {
    match number.abs() < 1e15 {
        true => number.to_string(),
        false => format!("{number:e}"),
    }
}

/// Line number of a CSV row in the file. The CSV reader's own line number omits comments and empty lines before the row.
pub(in crate::scene) fn line_of(text: &str, row: &csv::StringRecord) -> usize {
    let Some(position) = row.position() else {
        return 1;
    };
    let skipped = |line: &&str| line.trim_end().is_empty() || line.starts_with('#');
    let rest = text.get(position.byte() as usize..).unwrap_or("");
    position.line() as usize + rest.lines().take_while(skipped).count()
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_slow_recording_has_a_rate() {
        let shown = [1000.4, 10.0, 1.0, 0.1].map(super::rate_shown);
        assert_eq!(shown, ["1000", "10", "1.000", "0.100"]);
    }
}
