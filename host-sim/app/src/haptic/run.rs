//! `touchstone device run`: a wall on a haptic device, in real time.

use super::account::Account;
use super::choice::{HapticKind, SimulatedHand, WhichDevice};
use super::device_wall::{ChosenWall, WallOptions};
use super::ended::ended;
use super::scorecard::{self, HandProgramme, PressedGrip};
use super::trace::DeviceTrace;
use crate::out::{note, path_line, tell};
use crate::whole::Named;
use crate::{interrupt, number};
use std::fmt;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::atomic::Ordering;
use std::time::Instant;
use touchstone_control::Choice;
use touchstone_device::haptic::HapticDevice;
use touchstone_device::servo::{
    DevicePace, Pace, RealTime, ServoLimits, ServoTick, SimulatedPace, play, real_time,
};
use touchstone_device::{DeviceWall, Obstacle};
use touchstone_lab::thesis::space::Object;
use touchstone_mesh::Mesh;
use touchstone_report as report;
use touchstone_sim::error::{Error, Result};
use touchstone_world::plant::OMEGA3;

/// The virtual object in the device's workspace.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Scenery {
    /// A floor or a slope through the workspace's centre, or a ball with a radius of 30 mm around the centre. Holds the object's
    /// name on the command line, too.
    Known(&'static str, Object),
    /// A mesh around the workspace's centre, from a file.
    Mesh(PathBuf),
}

/// File name extensions of the mesh formats that the program reads.
const MESHES: [&str; 3] = ["stl", "obj", "ply"];

const KNOWN: [(&str, Object); 3] = [
    ("plane", Object::Horizontal),
    ("inclined", Object::Inclined),
    ("sphere", Object::Sphere),
];

impl FromStr for Scenery {
    type Err = String;

    fn from_str(word: &str) -> std::result::Result<Self, String> {
        if let Some((name, object)) = KNOWN.iter().find(|(name, _)| *name == word) {
            return Ok(Self::Known(name, *object));
        }
        let path = PathBuf::from(word);
        let ending = path.extension().and_then(|ending| ending.to_str());
        match ending.is_some_and(|own| MESHES.iter().any(|ending| own.eq_ignore_ascii_case(ending)))
        {
            true => Ok(Self::Mesh(path)),
            false => Err(format!(
                "\"{word}\" is not an object; {}",
                touchstone_sim::scene::nearest(word, &KNOWN.map(|(name, _)| name)).map_or_else(
                    || "give plane, inclined, sphere or a file that ends in .stl, .obj or .ply"
                        .to_owned(),
                    |near| format!("did you mean {near}?")
                )
            )),
        }
    }
}

/// Options of `device run`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// plane (a floor through the centre), inclined (a slope in none of the axes), sphere (30 mm around the centre), or a mesh: a
    /// file of STL, OBJ or PLY.
    #[arg(value_name = "OBJECT")]
    object: Scenery,
    /// Unit of the coordinates in the mesh's file, m; the file itself does not state it.
    #[arg(long, alias = "stl-unit-m", value_name = "M", default_value_t = 1e-3, allow_negative_numbers = true, value_parser = number::up_to(1e3, "in m"))]
    mesh_unit_m: f64,
    #[command(flatten)]
    which: WhichDevice,
    #[command(flatten)]
    scored: scorecard::ScoreOptions,
    #[command(flatten)]
    wall: WallOptions,
    /// Ends after this many seconds; without this option, at Ctrl-C.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::up_to(1e6, "of seconds"))]
    seconds: Option<f64>,
    /// Writes every control period as CSV; needs --seconds, or --programme scorecard.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Runs a simulated device faster than real time.
    #[arg(long)]
    fast: bool,
    /// Lateness of a control period that ends the run, as its force is held for too long, ms. Raise it only to run without a real
    /// device on a machine that stalls.
    #[arg(long, value_name = "MS", default_value_t = 10.0, allow_negative_numbers = true, value_parser = number::up_to(1000.0, "of milliseconds"))]
    late_limit_ms: f64,
}

impl Scenery {
    /// Object around which a simulated hand moves. At a mesh the hand moves as at a floor: it touches from above.
    fn object(&self) -> Object {
        match self {
            Self::Known(_, object) => *object,
            Self::Mesh(_) => Object::Horizontal,
        }
    }

    fn mesh(&self, unit_m: f64) -> Result<Option<Mesh>> {
        match self {
            Self::Known(..) => Ok(None),
            Self::Mesh(path) => Mesh::read(path, unit_m).map(Some),
        }
    }
}

impl fmt::Display for Scenery {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Known(name, _) => f.write_str(name),
            Self::Mesh(path) => f.write_str(&path_line(path)),
        }
    }
}

/// Runs `touchstone device run`.
pub fn main(options: &Options) -> Result<ExitCode> {
    let kind = options.which.model();
    let simulated = kind.is_some_and(HapticKind::is_simulated);
    if options.fast && !simulated {
        return Err(Error::Option {
            option: "--fast".into(),
            problem: "a real device runs in real time only".into(),
            fix: "give --device simulated, or leave it out".into(),
        });
    }
    let command = crate::command_line();
    let seconds = options.seconds;
    options
        .scored
        .check(simulated, seconds, options.csv.is_some())?;
    let csv = options.csv.as_deref().map(|path| Named {
        path,
        option: "--csv",
        replaces: options.scored.force,
    });
    csv.map_or(Ok(()), |place| place.check())?;
    if let Some(folder) = &options.scored.out {
        report::check_folder(folder, &command, options.scored.force)?;
    }
    let mesh = options.object.mesh(options.mesh_unit_m)?;
    let object = options.object.object();
    // This is done before the motors are switched on. From here on Ctrl-C only ends the loop, so that the motors are switched off
    // afterwards.
    let stop = interrupt::noted()?;
    let simulated_hz = options
        .wall
        .rate_hz
        .unwrap_or(kind.map_or(OMEGA3.rates_hz.1, HapticKind::own_rate_hz));
    let turn = match options.scored.programme {
        HandProgramme::Explore => None,
        HandProgramme::Scorecard => {
            let sheet = options.which.open(SimulatedHand::Still)?.sheet().clone();
            let played = options.wall.chosen(&sheet)?;
            let grip: PressedGrip = options.scored.grip;
            Some(scorecard::turn(
                &sheet,
                &played.settings,
                played.force_n,
                object,
                grip,
            ))
        }
    };
    let hand = match turn {
        None => SimulatedHand::Moves(object, simulated_hz),
        Some(turn) => SimulatedHand::InTurn(object, turn),
    };
    let mut device = options.which.open(hand)?;
    let sheet = device.sheet().clone();
    let ChosenWall {
        rate_hz,
        force_n,
        settings,
        source,
        caution,
    } = options.wall.chosen(&sheet)?;
    let obstacle = || {
        mesh.as_ref()
            .map_or_else(|| Obstacle::Shape(object.shape()), Obstacle::of)
    };
    let mut wall = DeviceWall::new(&settings, obstacle()).map_err(|why| Error::Option {
        option: "device run".into(),
        problem: why.to_string(),
        fix: "change --law, --k-desired, --rate-hz or --force-limit-n".into(),
    })?;
    tell!("device    {}", sheet.name);
    if let Some(mesh) = &mesh {
        tell!(
            "mesh      {} triangles, {} mm across, {} left out because they have no area",
            mesh.triangles(),
            match mesh.size_m() < 1e4 {
                true => format!("{:.1}", 1e3 * mesh.size_m()),
                false => format!("{:.3e}", 1e3 * mesh.size_m()),
            },
            mesh.left_out()
        );
        let reach = sheet.workspace;
        let most = [reach.radius_m, reach.radius_m, reach.half_height_m];
        for odd in mesh.notes([most.map(|value| -value), most]) {
            note!("note: {}: {odd}", options.object);
        }
    }
    tell!(
        "wall      {}, {} {} N/mm at {rate_hz} Hz, {source}; up to {force_n} N, {}",
        options.object,
        settings.law.law.word(),
        // A stiffness that was converted with a lever's length has many digits, so it is rounded for the text.
        settings.law.k_desired.to_num::<f64>().round() / 1e3,
        if options.wall.no_guard {
            "no guard"
        } else {
            "guard of 40 mJ and 0.5 mW"
        }
    );
    if let Some(caution) = &caution {
        note!("note: {caution}");
    }
    let limits = ServoLimits {
        force_n,
        late_s: 1e-3 * options.late_limit_ms,
        ..ServoLimits::of(&sheet)
    };
    let mut pace: Box<dyn Pace> = match (options.fast, sheet.sets_the_pace) {
        (true, _) => Box::new(SimulatedPace),
        (false, true) => Box::new(DevicePace::new(rate_hz)),
        (false, false) => Box::new(RealTime::new(rate_hz)),
    };
    // The run ends after `seconds` of real time, or with `--fast` after `most` control periods.
    let programme = turn.map(|turn| turn.ticks());
    let seconds = options
        .seconds
        .or(programme.map(|ticks| ticks as f64 / f64::from(rate_hz)));
    let most = seconds.map(|seconds| (seconds * f64::from(rate_hz)).ceil() as u64);
    let kept = options.csv.is_some() || options.scored.out.is_some() || turn.is_some();
    let mut trace = DeviceTrace::for_ticks(most.filter(|_| kept).unwrap_or(0))?;
    let priority = (!options.fast).then(real_time);
    let begun = Instant::now();
    let more = |tick: &ServoTick| {
        trace.keep(tick);
        let over = match (options.fast, seconds, most) {
            (false, Some(seconds), _) => begun.elapsed().as_secs_f64() >= seconds,
            (true, _, Some(most)) => tick.number + 1 >= most,
            _ => false,
        };
        !over && !stop.load(Ordering::Relaxed)
    };
    let report = play(&mut device, &mut wall, &limits, rate_hz, &mut *pace, more);
    // Errors of files and of the output are returned after those of the device: that its motors may still be on is more urgent.
    let recorded = csv.map_or(Ok(()), |place| trace.write(&place, rate_hz));
    let card = kept.then(|| {
        let run = scorecard::PlayedOnDevice {
            sheet: &sheet,
            settings: &settings,
            limits: &limits,
            turn,
        };
        run.card(trace.ticks(), &obstacle())
    });
    let account = Account {
        sheet: &sheet,
        settings: &settings,
        source: &source,
        caution: caution.as_deref(),
        wall: &wall,
        limits: &limits,
        priority: priority.as_ref(),
        report: &report,
        card: card.as_ref(),
    };
    // A run without an end of its own is always ended by Ctrl-C, so only one with an end counts as interrupted.
    let interrupted = stop.load(Ordering::Relaxed) && seconds.is_some();
    let told = account.tell();
    let written = match (&options.scored.out, &card) {
        (Some(folder), Some(card)) => {
            scorecard::write(&account, card, &command, folder, options.scored.force)
        }
        _ => Ok(()),
    };
    ended(&report.ending, &report.release, &sheet.name)?;
    recorded.and(told).and(written)?;
    Ok(match interrupted {
        true => ExitCode::from(interrupt::INTERRUPTED as u8),
        false => ExitCode::SUCCESS,
    })
}
