//! Reads a recording of board and shaft, made while a hand carried out the scorecard's actions, from a CSV table.

use super::super::cases::Deed;
use super::deed_word;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::input;
use touchstone_sim::run::Tick;
use touchstone_sim::run::wall::Inside;
use touchstone_sim::scene::{Grip, Scene};

/// Columns of the recording: the board's telemetry, then quantities that only a test stand measures.
const COLUMNS: [&str; 10] = [
    "grip",
    "deed",
    "penetration_rad",
    "force_n_m",
    "state",
    "angle_rad",
    "velocity_rad_per_s",
    "motor_force_n_m",
    "absorbed_j",
    "device_loss_j",
];

/// Optional column: angle of the wall's surface in rad, if it differs from the scene's.
const SURFACE: &str = "surface_rad";

/// Numbers of one row of the recording (one control period), in the order of the columns.
type Row = [f64; 7];

/// A recording of a board, sorted by grip and action of the hand.
#[derive(Debug, Clone)]
pub struct BoardRecording {
    file: PathBuf,
    surface_rad: Option<f64>,
    deeds: BTreeMap<(String, String), Vec<Row>>,
}

impl BoardRecording {
    /// Reads a recording from a file.
    ///
    /// # Errors
    /// The file cannot be read or is not a recording of the scorecard's actions, or the wall was off in one of its ticks.
    pub fn read(file: &Path) -> Result<Self> {
        let wrong = |problem: String| {
            Error::Io {
            path: file.to_owned(),
            problem,
            fix: "give a recording of the file of `touchstone scorecard --programme`, from a test stand or `touchstone-emulator play`".into(),
        }
        };
        let text = input::text(file, input::MOST_OF_RECORDING);
        let text = text.map_err(|error| wrong(error.to_string()))?;
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| wrong(error.to_string()))?;
        let mut places = [0; COLUMNS.len()];
        for (place, name) in places.iter_mut().zip(COLUMNS) {
            let found = header.iter().position(|column| column == name);
            *place = found.ok_or_else(|| wrong(format!("has no column {name}")))?;
        }
        let surface = header.iter().position(|column| column == SURFACE);
        let mut surface_rad = None;
        let mut deeds: BTreeMap<(String, String), Vec<Row>> = BTreeMap::new();
        for record in reader.records() {
            let record = record.map_err(|error| wrong(error.to_string()))?;
            let line = record.position().map_or(0, csv::Position::line);
            let cell = |column: usize| record.get(places[column]).unwrap_or_default();
            if cell(4) != "armed" {
                return Err(wrong(format!("line {line}: the wall was {}", cell(4))));
            }
            let mut row = [0.0; 7];
            for (value, column) in row.iter_mut().zip([2, 3, 5, 6, 7, 8, 9]) {
                let number = cell(column).parse::<f64>().ok().filter(|it| it.is_finite());
                *value = number.ok_or_else(|| {
                    let name = COLUMNS[column];
                    wrong(format!(
                        "line {line}, {name}: `{}` is not a number",
                        cell(column)
                    ))
                })?;
            }
            let here = surface.and_then(|column| record.get(column)?.parse::<f64>().ok());
            if surface_rad.is_some() && here != surface_rad {
                return Err(wrong(format!("line {line}: the wall's place changes")));
            }
            surface_rad = here;
            let deed = (cell(0).to_owned(), cell(1).to_owned());
            deeds.entry(deed).or_default().push(row);
        }
        Ok(Self {
            file: file.to_owned(),
            surface_rad,
            deeds,
        })
    }

    /// The scene with the wall's surface at the recorded angle.
    ///
    /// # Errors
    /// The recorded surface is more than an encoder count from the scene's.
    pub(super) fn scene(&self, scene: &Scene) -> Result<Scene> {
        let mut here = scene.clone();
        let Some(surface_rad) = self.surface_rad else {
            return Ok(here);
        };
        let step = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
        let off = (surface_rad - scene.wall.surface_rad).abs();
        if off > step {
            return Err(self.wrong("the device's wall is not where the scene's is"));
        }
        here.wall.surface_rad = surface_rad;
        Ok(here)
    }

    /// Makes an error about the recording as a whole.
    pub(super) fn wrong(&self, problem: impl Into<String>) -> Error {
        Error::Io {
            path: self.file.clone(),
            problem: problem.into(),
            fix: "give the scene of which touchstone scorecard wrote the programme".into(),
        }
    }

    /// The ticks of an action in the form of the simulator's loop; `None` if the action was not recorded.
    ///
    /// # Errors
    /// The recorded action has another length than the scene's, or was made with another wall.
    pub fn ticks(&self, scene: &Scene, grip: Grip, deed: Deed) -> Result<Option<Vec<Tick>>> {
        let word = deed_word(deed);
        let Some(rows) = self.deeds.get(&(grip.name().to_owned(), word.clone())) else {
            return Ok(None);
        };
        let wrong = |problem: String| self.wrong(format!("{}, {word}: {problem}", grip.name()));
        // The last row only gives the state after the last tick.
        let ticks = scene.timing.ticks() as usize;
        if rows.len() != ticks + 1 {
            return Err(wrong(format!(
                "{} ticks instead of {ticks}",
                rows.len() - 1
            )));
        }
        let surface = scene.wall.surface_rad;
        let step = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
        // Measured and true angle differ by half a count, and by the motion between sample and reading.
        let off = rows.iter().map(|row| (row[2] - surface - row[0]).abs());
        let near = off.filter(|off| *off <= 1.5 * step).count();
        if step > 0.0 && near < rows.len() * 9 / 10 {
            return Err(wrong(
                "the device's wall is not where the scene's is".into(),
            ));
        }
        let period_s = scene.timing.period_s();
        let tick = |(index, pair): (usize, &[Row])| {
            let [penetration, force, angle, speed, motor, absorbed, loss] = pair[0];
            Tick {
                index: index as u64,
                time_s: index as f64 * period_s,
                angle_rad: angle,
                velocity_rad_per_s: speed,
                angle_after_rad: pair[1][2],
                velocity_after_rad_per_s: pair[1][3],
                hand_rad: angle,
                rest_rad: f64::NAN,
                told_rad: penetration,
                force_n_m: force,
                motor_force_n_m: motor,
                absorbed_j: absorbed,
                device_loss_j: loss,
                stored_j: 0.0,
                inside: Inside {
                    energy_j: f64::NAN,
                    offset_rad: f64::NAN,
                    mass_rad: None,
                    guard: None,
                    beyond_reach: false,
                },
            }
        };
        Ok(Some(rows.windows(2).enumerate().map(tick).collect()))
    }
}
