//! Reads a torque profile from a CSV file with a column of angles and a column of torques, whose units are in the header.

use std::f64::consts::TAU;
use std::path::Path;

use super::motion::column::{cell, cut, find, rows};
use super::motion::line_of;
use super::units::Dimension;
use crate::error::{Error, Result};
use crate::input;
use touchstone_control::environment::{MOST_POINTS, WHOLE};

/// Largest number of rows of a profile's file.
const MOST_ROWS: usize = 256;
/// Largest deviation of a row's angle from equal spacing, as a fraction of a step, for which the rows count as equally spaced.
/// Angles in rad with four decimals meet this for 96 rows over a radian.
const EVEN: f64 = 0.01;
/// Example of a header, for error messages.
const HEADER: &str = "angle_deg,torque_n_m";

/// A profile in the form of the scene's fields.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawn {
    pub per_rev: u32,
    pub start_rad: f64,
    pub end_rad: f64,
    pub strength_n_m: f64,
    pub shape: Vec<f64>,
    /// Sentence for the user that says how the points differ from the file's rows; `None` if the points are the rows.
    pub note: Option<String>,
}

/// Reads a profile from a file. The profile is repeated `per_rev` times per turn; with 0 it exists once.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read; [`Error::File`] with line and column for the first mistake in it.
pub(super) fn read(file: &Path, per_rev: u32) -> Result<Drawn> {
    let text = input::text(file, input::MOST_OF_SCENE).map_err(|error| {
        let fix = match error.kind() {
            std::io::ErrorKind::NotFound => {
                "give the path of a CSV file with angle and torque, relative to the scene's folder"
            }
            std::io::ErrorKind::InvalidData => "save the profile as CSV in UTF-8",
            std::io::ErrorKind::FileTooLarge => {
                "give a file with one row for each point, at most 256"
            }
            _ => "give a readable file",
        };
        let problem = match error.kind() {
            std::io::ErrorKind::NotFound => "no such file".to_owned(),
            _ => error.to_string(),
        };
        Error::Io {
            path: file.to_owned(),
            problem,
            fix: fix.to_owned(),
        }
    })?;
    parse(&text, file, per_rev)
}

/// One row of the file: its line, its angle in rad and its torque in N·m.
#[derive(Debug, Clone, Copy)]
struct Row {
    line: usize,
    angle: f64,
    torque: f64,
}

fn parse(text: &str, file: &Path, per_rev: u32) -> Result<Drawn> {
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
        let line = cause.position().map_or(1, |place| place.line() as usize);
        let fix = "separate the columns by commas";
        error(line, "row", format!("not valid CSV: {cause}"), fix)
    };
    let begin = format!("begin with a line such as {HEADER}");
    let Some(header) = records.next().transpose().map_err(not_csv)? else {
        return Err(error(1, "header", "the file is empty".into(), &begin));
    };
    let top = line_of(text, &header);
    if header.iter().all(|cell| cell.parse::<f64>().is_ok()) {
        let problem = format!("no header: the first row is the number {}", cut(&header[0]));
        return Err(error(top, "header", problem, &begin));
    }
    if header.len() == 1 {
        let problem = format!("{} is one column", cut(&header[0]));
        let fix = "separate angle and torque by commas, with a point in the numbers";
        return Err(error(top, "header", problem, fix));
    }
    let column = |dimension, what: &str| {
        find(&header, dimension, what).map_err(|(problem, fix)| error(top, what, problem, &fix))
    };
    let angle = column(Dimension::Angle, "angle")?;
    let torque = column(Dimension::Torque, "torque")?;
    let mut rows: Vec<Row> = Vec::new();
    for record in records {
        let record = record.map_err(not_csv)?;
        let line = line_of(text, &record);
        if record.len() != header.len() {
            let (got, wanted) = (record.len(), header.len());
            let problem = format!("{got} cells, where the header has {wanted}");
            let fix = "write decimals with a point, and a cell for every column";
            return Err(error(line, "row", problem, fix));
        }
        if rows.len() == MOST_ROWS {
            let problem = format!("more than {MOST_ROWS} points");
            let fix = "leave rows out, such as every second one";
            return Err(error(line, "row", problem, fix));
        }
        let number = |column| {
            cell(&record, column)
                .map(|value| value * column.si)
                .map_err(|(problem, fix)| error(line, &column.name, problem, fix))
        };
        let row = Row {
            line,
            angle: number(&angle)?,
            torque: number(&torque)?,
        };
        if let Some(last) = rows.last().filter(|last| row.angle <= last.angle) {
            let problem = format!(
                "does not rise: {:.6} rad after {:.6} rad",
                row.angle, last.angle
            );
            let fix = "sort the rows by angle, with each angle once";
            return Err(error(line, &angle.name, problem, fix));
        }
        rows.push(row);
    }
    let few = |problem: &str| {
        let fix = "give 2 to 256 rows of numbers";
        error(top, "row", problem.to_owned(), fix)
    };
    let [first, .., last] = rows[..] else {
        return Err(few(match rows.is_empty() {
            true => "no row of numbers",
            false => "one row of numbers",
        }));
    };
    let strength = rows
        .iter()
        .fold(0.0_f64, |most, it| most.max(it.torque.abs()));
    if strength == 0.0 {
        let fix = "give a torque other than 0, or leave the profile out";
        return Err(error(
            first.line,
            &torque.name,
            "every torque is 0".into(),
            fix,
        ));
    }
    let span = last.angle - first.angle;
    let mut length = span;
    if per_rev > 0 {
        length = TAU / f64::from(per_rev);
        let step = length / rows.len() as f64;
        if span > length + EVEN * step {
            let problem =
                format!("the profile spans {span:.6} rad, but a copy has {length:.6} rad");
            let fix = "leave rows out, or give fewer copies in per_rev (0: once)";
            return Err(error(last.line, &angle.name, problem, fix));
        }
        if span > length - EVEN * step {
            if (last.torque - first.torque).abs() > 1e-3 * strength {
                let problem = "the copy's end has another torque than its start".to_owned();
                let fix = "make both equal, or leave the last row out";
                return Err(error(last.line, &torque.name, problem, fix));
            }
            // The last row is at the start of the next copy and repeats the first row, so it is removed.
            rows.pop();
            if rows.len() < 2 {
                return Err(few("one point in a copy"));
            }
        }
    }
    let curve = Curve {
        rows: &rows,
        copy: (per_rev > 0).then_some(length),
    };
    let (torques, note) = curve.points(file);
    let shape = torques.iter().map(|torque| {
        let whole = f64::from(WHOLE);
        (torque / strength * whole).round() / whole
    });
    Ok(Drawn {
        per_rev,
        start_rad: first.angle,
        end_rad: last.angle,
        strength_n_m: strength,
        shape: shape.collect(),
        note,
    })
}

/// Straight lines between neighbouring rows. If the profile is repeated, a line also joins the last row to the first row of the
/// next copy.
struct Curve<'a> {
    rows: &'a [Row],
    /// Length of a copy, rad; `None` if the profile exists once.
    copy: Option<f64>,
}

impl Curve<'_> {
    /// Torques at equally spaced angles, N·m. If these are not the file's own rows, also a sentence for the user that says so.
    fn points(&self, file: &Path) -> (Vec<f64>, Option<String>) {
        let (n, start) = (self.rows.len(), self.rows[0].angle);
        let step = self.step(n);
        let is_even = (self.rows.iter().enumerate())
            .all(|(i, row)| (row.angle - start - step * i as f64).abs() <= EVEN * step);
        if is_even && n <= MOST_POINTS {
            return (self.rows.iter().map(|row| row.torque).collect(), None);
        }
        let step = self.step(MOST_POINTS);
        let points: Vec<f64> = (0..MOST_POINTS)
            .map(|i| self.at(start + step * i as f64))
            .collect();
        // Both curves consist of straight lines, so they differ most at a row of the file or at a point. At the points they are
        // equal.
        let off = self.rows.iter().map(|row| {
            let place = ((row.angle - start) / step).clamp(0.0, MOST_POINTS as f64);
            let (before, way) = (place.floor() as usize, place.fract());
            let point = |i: usize| match self.copy {
                Some(_) => points[i % MOST_POINTS],
                None => points[i.min(MOST_POINTS - 1)],
            };
            (point(before) * (1.0 - way) + point(before + 1) * way - row.torque).abs()
        });
        let off = off.fold(0.0, f64::max);
        let why = match is_even {
            true => "more than the profile has",
            false => "not equally spaced",
        };
        let note = format!(
            "{}: {n} points, {why}, became {MOST_POINTS} equally spaced ones; the torque differs by at most {off:.2e} N·m",
            file.display()
        );
        (points, Some(note))
    }

    /// Distance between `n` equally spaced points of the profile, rad.
    fn step(&self, n: usize) -> f64 {
        match self.copy {
            Some(length) => length / n as f64,
            None => (self.rows[self.rows.len() - 1].angle - self.rows[0].angle) / (n - 1) as f64,
        }
    }

    /// Torque at an angle that is not below that of the first row, N·m.
    fn at(&self, angle: f64) -> f64 {
        let after = self.rows.partition_point(|row| row.angle <= angle).max(1);
        let before = self.rows[after - 1];
        let after = match (self.rows.get(after), self.copy) {
            (Some(row), _) => *row,
            (None, Some(length)) => Row {
                angle: self.rows[0].angle + length,
                ..self.rows[0]
            },
            (None, None) => return before.torque,
        };
        let way = (angle - before.angle) / (after.angle - before.angle);
        before.torque + way * (after.torque - before.torque)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, per_rev: u32) -> Result<Drawn> {
        parse(text, Path::new("p.csv"), per_rev)
    }

    /// CSV text with one row per given angle in degrees. The torque is a sine with a period of six degrees.
    fn wave(angles_deg: impl Iterator<Item = f64>) -> String {
        let row = |deg: f64| format!("{deg},{}\n", 0.01 * (deg * TAU / 6.0).sin());
        format!(
            "angle_deg,torque_n_m\n{}",
            angles_deg.map(row).collect::<String>()
        )
    }

    #[test]
    fn equally_spaced_rows_are_the_points() {
        let drawn = read(
            "# by hand\nTorque [mN·m],angle (°)\n0,-90\n10,0\n-20,90\n",
            0,
        )
        .unwrap();
        assert_eq!(drawn.shape, [0.0, 0.5, -1.0]);
        let quarter = TAU / 4.0;
        assert!(
            (drawn.start_rad + quarter).abs() < 1e-12 && (drawn.end_rad - quarter).abs() < 1e-12
        );
        assert!((drawn.strength_n_m - 0.02).abs() < 1e-15);
        assert_eq!((drawn.per_rev, drawn.note), (0, None));
    }

    #[test]
    fn a_copy_may_be_written_with_its_end_or_without() {
        let open = read("angle_deg,torque_n_m\n0,0\n15,0.01\n30,0\n45,-0.01\n", 6).unwrap();
        let closed = read(
            "angle_deg,torque_n_m\n0,0\n15,0.01\n30,0\n45,-0.01\n60,0\n",
            6,
        )
        .unwrap();
        assert_eq!(open.shape, [0.0, 1.0, 0.0, -1.0]);
        assert_eq!(open.shape, closed.shape);
        assert_eq!((open.per_rev, open.note.is_none()), (6, true));
    }

    /// Tests that rows at unequal angles become equally spaced points on the same lines, and that the note gives the largest
    /// difference.
    #[test]
    fn other_rows_are_put_at_equal_distances_with_a_note() {
        let text = "angle_rad,torque_n_m\n0,0\n0.1,0.02\n0.95,0\n";
        let drawn = read(text, 0).unwrap();
        assert_eq!(drawn.shape.len(), MOST_POINTS);
        let step = 0.95 / (MOST_POINTS - 1) as f64;
        for (i, value) in drawn.shape.iter().enumerate() {
            let angle = step * i as f64;
            let line = if angle < 0.1 {
                angle / 0.1
            } else {
                (0.95 - angle) / 0.85
            };
            assert!((value - line).abs() < 1e-4, "{i}: {value} {line}");
        }
        // The corner at 0.1 rad lies on a point: the steps are 0.01 rad.
        let note = drawn.note.unwrap();
        assert!(
            note.starts_with("p.csv: 3 points, not equally spaced, became 96"),
            "{note}"
        );
        let off = |note: &str| -> f64 {
            let (_, off) = note.rsplit_once("at most ").unwrap();
            off.trim_end_matches(" N·m").parse().unwrap()
        };
        assert!(off(&note) < 1e-6, "{note}");
        // A corner between two points is cut off. The lost torque follows from the slopes of the two lines and the distance to the
        // points.
        let cut = read("angle_rad,torque_n_m\n0,0\n0.105,0.02\n0.95,0\n", 0).unwrap();
        let lost = 0.02 * 0.5 * (0.005 / 0.105 + 0.005 / 0.845);
        assert!((off(&cut.note.unwrap()) - lost).abs() < 0.02 * lost);
    }

    #[test]
    fn more_rows_than_points_are_thinned_and_said_up_to_256() {
        let drawn = read(&wave((0..200).map(|i| 0.03 * f64::from(i))), 60).unwrap();
        let note = drawn.note.unwrap();
        assert!(
            note.contains("200 points, more than the profile has"),
            "{note}"
        );
        for (i, value) in drawn.shape.iter().enumerate() {
            let sine = (TAU * i as f64 / MOST_POINTS as f64).sin();
            assert!((value - sine).abs() < 2e-3, "{i}: {value} {sine}");
        }
        assert!(read(&wave((0..256).map(|i| 0.02 * f64::from(i))), 0).is_ok());
        let long = read(&wave((0..257).map(|i| 0.02 * f64::from(i))), 0).unwrap_err();
        let said = "p.csv:258: row: more than 256 points; leave rows out, such as every second one";
        assert_eq!(long.to_string(), said);
    }

    #[test]
    fn every_mistake_has_line_and_remedy() {
        let head = "angle_deg,torque_n_m\n";
        let cases = [
            (
                "".to_owned(),
                0,
                "p.csv:1: header: the file is empty; begin with a line such as angle_deg,torque_n_m",
            ),
            (
                "0,0\n1,0.01\n".to_owned(),
                0,
                "p.csv:1: header: no header: the first row is the number 0; begin with a line such as angle_deg,torque_n_m",
            ),
            (
                "angle_deg;torque_n_m\n0;0\n".to_owned(),
                0,
                "p.csv:1: header: angle_deg;torque_n_m is one column; separate angle and torque by commas, with a point in the numbers",
            ),
            (
                "angle,torque_n_m\n".to_owned(),
                0,
                "p.csv:1: angle: no column with an angle unit among angle, torque_n_m; end the column's name in one of _rad, _mrad, _deg, _rev",
            ),
            (
                "angle_deg,torque\n".to_owned(),
                0,
                "p.csv:1: torque: no column with a torque unit among angle_deg, torque; end the column's name in one of _n_m, _nm, _mn_m, _mnm, _n_cm, _n_mm",
            ),
            (
                "# mine\nangle_deg,a_rad,torque_nm\n".to_owned(),
                0,
                "p.csv:2: angle: both angle_deg and a_rad fit; keep one of the two columns",
            ),
            (
                head.to_owned(),
                6,
                "p.csv:1: row: no row of numbers; give 2 to 256 rows of numbers",
            ),
            (
                format!("{head}0,0.1\n60,0.1\n"),
                6,
                "p.csv:1: row: one point in a copy; give 2 to 256 rows of numbers",
            ),
            (
                format!("{head}0,0\n"),
                0,
                "p.csv:1: row: one row of numbers; give 2 to 256 rows of numbers",
            ),
            (
                format!("{head}0,0\n1,0.01\n1,0.02\n"),
                0,
                "p.csv:4: angle_deg: does not rise: 0.017453 rad after 0.017453 rad; sort the rows by angle, with each angle once",
            ),
            (
                format!("{head}0,0\n1,a lot\n"),
                0,
                "p.csv:3: torque_n_m: \"a lot\" is not a number; write numbers such as 0.25 or 2.5e-1",
            ),
            (
                format!("{head}0,0\n1,inf\n"),
                0,
                "p.csv:3: torque_n_m: inf is not a finite number; remove the row or fill the gap",
            ),
            (
                format!("{head}0,0\n1,0,01\n"),
                0,
                "p.csv:3: row: 3 cells, where the header has 2; write decimals with a point, and a cell for every column",
            ),
            (
                format!("{head}0,0\n1,0\n"),
                0,
                "p.csv:2: torque_n_m: every torque is 0; give a torque other than 0, or leave the profile out",
            ),
            (
                format!("{head}0,0\n50,0.01\n70,0\n"),
                6,
                "p.csv:4: angle_deg: the profile spans 1.221730 rad, but a copy has 1.047198 rad; leave rows out, or give fewer copies in per_rev (0: once)",
            ),
            (
                format!("{head}0,0\n30,0.01\n60,0.01\n"),
                6,
                "p.csv:4: torque_n_m: the copy's end has another torque than its start; make both equal, or leave the last row out",
            ),
        ];
        for (text, per_rev, said) in cases {
            assert_eq!(read(&text, per_rev).unwrap_err().to_string(), said);
        }
    }
}
