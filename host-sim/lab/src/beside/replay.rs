//! Simulates a scene with the hand's motion from a recording.

use super::held::rest_point_rad;
use super::recording::WallRecording;
use super::{HandWas, closest, rms};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;
use std::path::{Path, PathBuf};
use touchstone_report::csv::decimal;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run::run;
use touchstone_sim::scene::{Grip, MotionSpec, Recorded, Scene};
use touchstone_sim::{input, output};

/// Name of the file in the results folder that contains the computed motion of a hand that held the knob.
pub const HAND_FILE: &str = "hand.csv";

/// Length of the part of a released knob's free motion from which its speed is computed, s. The comparison starts in the middle of
/// that part, where the slope of a fitted parabola is most accurate.
const FLIGHT_S: f64 = 0.04;

/// Number of halvings in the search for the start speed. The search starts with steps of half the speed's uncertainty and ends with
/// a hundredth.
const SPEED_HALVINGS: u32 = 6;

/// A recording, with the scene that simulates it.
pub struct Replay<'a> {
    told: &'a WallRecording,
    /// Index of the recording's first tick that is compared with the simulation.
    first: usize,
    scene: Scene,
    /// Uncertainty of the start speed, rad/s; 0 if the hand held the knob.
    unsure_rad_per_s: f64,
}

/// The part of a recording that is compared with the simulation.
pub struct Part<'a> {
    pub time_s: &'a [f64],
    pub penetration_rad: &'a [f64],
    pub force_n_m: &'a [f64],
    pub limited: &'a [bool],
}

/// The part of a simulated run that is compared with the recording.
pub struct Simulated {
    pub penetration_rad: Vec<f64>,
    pub force_n_m: Vec<f64>,
}

impl<'a> Replay<'a> {
    pub fn new(
        scene: &Scene,
        told: &'a WallRecording,
        hand: HandWas,
        folder: &Path,
    ) -> Result<Self> {
        let period_s = fits(scene, told)?;
        let surface_rad = told.surface_rad(scene)?;
        let (first, start_rad, speed, motion) = match hand {
            HandWas::Gone => {
                let flight = flight(told)?;
                let (place, speed) = middle(&told.penetration_rad[flight.clone()], period_s);
                (flight.start + flight.len() / 2, place, speed, None)
            }
            HandWas::Holding => {
                let motion = kept(scene, told, surface_rad, folder)?;
                (0, told.penetration_rad[0], 0.0, Some(motion))
            }
        };
        let ticks = told.time_s.len() - first;
        let scene = scene.with(|scene| {
            scene.wall.surface_rad = surface_rad;
            scene.device.initial_angle_rad = Some(surface_rad + start_rad);
            scene.device.initial_velocity_rad_per_s = speed;
            scene.timing.duration_s = ticks as f64 * period_s;
            scene.operator.motion = match motion {
                None => {
                    scene.operator.grip = Grip::None;
                    scene.operator.hand = None;
                    MotionSpec::None
                }
                Some(file) => MotionSpec::Recorded(Recorded {
                    exact: true,
                    ..Recorded::new(file)
                }),
            };
        })?;
        let step = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
        let unsure_rad_per_s = match hand {
            HandWas::Gone => step / FLIGHT_S,
            HandWas::Holding => 0.0,
        };
        Ok(Self {
            told,
            first,
            scene,
            unsure_rad_per_s,
        })
    }

    /// The scene that simulates the recording.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The part of the recording that is compared.
    pub fn recorded(&self) -> Part<'_> {
        let told = self.told;
        Part {
            time_s: &told.time_s[self.first..],
            penetration_rad: &told.penetration_rad[self.first..],
            force_n_m: &told.force_n_m[self.first..],
            limited: &told.limited[self.first..],
        }
    }

    /// Simulates `scene`, the replay's scene or a slight variation of it, over the compared ticks. A released knob gets the start
    /// speed with which simulated and recorded penetration differ least, rms. The search stays near the recorded speed, about
    /// within the uncertainty that one encoder count causes.
    pub fn run(&self, scene: &Scene) -> Result<Simulated> {
        if self.unsure_rad_per_s == 0.0 {
            return self.run_from(scene, 0.0);
        }
        let recorded = self.recorded().penetration_rad;
        let step = self.unsure_rad_per_s / 2.0;
        let (faster, _) = closest(step, 2, SPEED_HALVINGS, |faster| {
            let run = self.run_from(scene, faster)?;
            Ok(rms(recorded, &run.penetration_rad))
        })?;
        self.run_from(scene, faster)
    }

    fn run_from(&self, scene: &Scene, faster_rad_per_s: f64) -> Result<Simulated> {
        let mut scene = scene.clone();
        scene.device.initial_velocity_rad_per_s += faster_rad_per_s;
        let done = run(&scene, true)?;
        let trace = done.trace.unwrap_or_default();
        let ticks = self.told.time_s.len() - self.first;
        let mut penetration_rad: Vec<f64> = trace
            .angle_measured_rad
            .iter()
            .map(|angle| angle - scene.wall.surface_rad)
            .collect();
        let mut force_n_m = trace.force_n_m;
        // The run's duration may round to one tick more or less.
        let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
        let (at, with) = (last(&penetration_rad), last(&force_n_m));
        penetration_rad.resize(ticks, at);
        force_n_m.resize(ticks, with);
        Ok(Simulated {
            penetration_rad,
            force_n_m,
        })
    }
}

/// Checks that recording and scene have the same control rate; returns the control period, s.
fn fits(scene: &Scene, told: &WallRecording) -> Result<f64> {
    let period_s = scene.timing.period_s();
    let steps = (told.time_s.len() - 1) as f64;
    let recorded = (told.time_s[told.time_s.len() - 1] - told.time_s[0]) / steps;
    if (recorded / period_s - 1.0).abs() > 1e-3 {
        return Err(told.wrong(
            format!(
                "was recorded at {:.1} Hz, the scene runs at {} Hz",
                1.0 / recorded,
                scene.timing.rate_hz
            ),
            "set the scene's rate to the device's: --set timing.rate_hz=…",
        ));
    }
    Ok(period_s)
}

/// Range of ticks in which a released knob moves freely just before it reaches the wall; an odd number of ticks. The hand has most
/// likely let go by then.
///
/// # Errors
/// The knob never reached the wall, or the recording starts too close to the wall.
fn flight(told: &WallRecording) -> Result<Range<usize>> {
    let touch = told.penetration_rad.iter().position(|it| *it > 0.0);
    let no_flight = |problem: &str| {
        told.wrong(
            problem,
            "flick the knob towards the wall and let go well before it reaches the wall; or hold it, with --hand held",
        )
    };
    let touch = touch.ok_or_else(|| no_flight("the knob never reached the wall"))?;
    let period = told.time_s[1] - told.time_s[0];
    let half = ((FLIGHT_S / 2.0 / period).round() as usize).max(5);
    let start = touch.checked_sub(2 * half + 1);
    let start = start.ok_or_else(|| no_flight("begins at the wall or inside of it"))?;
    Ok(start..touch)
}

/// Position in rad and speed in rad/s in the middle of a free motion, by a least-squares parabola, because friction slows the knob
/// evenly.
fn middle(penetration_rad: &[f64], period_s: f64) -> (f64, f64) {
    let half = penetration_rad.len() as f64 / 2.0;
    let time = |row: usize| (row as f64 + 0.5) / half - 1.0;
    let rows = penetration_rad.len();
    let powers = DMatrix::from_fn(rows, 3, |row, power| time(row).powi(power as i32));
    let values = DVector::from_column_slice(penetration_rad);
    // A matrix of three different powers has full rank.
    let found = powers.svd(true, true).solve(&values, 1e-12);
    let found = found.unwrap_or_else(|_| DVector::zeros(3));
    (found[0], found[1] / (half * period_s))
}

/// Writes the hand's motion to a file that `--operator-motion` can read; returns the path of the file.
fn kept(scene: &Scene, told: &WallRecording, surface_rad: f64, folder: &Path) -> Result<PathBuf> {
    use std::fmt::Write as _;
    let rest = rest_point_rad(scene, told)?;
    let mut text = String::from("time_s,rest_rad\n");
    for (time, rest) in told.time_s.iter().zip(rest) {
        // Writing into a string cannot fail.
        let row = [time - told.time_s[0], rest + surface_rad].map(decimal);
        let _ = writeln!(text, "{}", row.join(","));
    }
    let file = folder.join(HAND_FILE);
    // An earlier comparison of the same recording, ended before its results were complete, may have written the same file.
    let is_there = file.symlink_metadata().is_ok_and(|meta| meta.is_file())
        && input::text(&file, input::MOST_OF_RECORDING).is_ok_and(|there| there == text);
    if is_there {
        return Ok(file);
    }
    // In a folder with results the file belongs to them and is replaced. In any other folder an existing file is not overwritten.
    let wrong = |error: std::io::Error| Error::Io {
        path: file.clone(),
        problem: error.to_string(),
        fix: "choose another folder with --out, or remove the file".into(),
    };
    output::in_folder(folder, wrong, || {
        match folder.join("results.json").is_file() {
            true => output::write(&file, text),
            false => output::write_new(&file, text),
        }
        .map_err(wrong)
    })?;
    Ok(file)
}
