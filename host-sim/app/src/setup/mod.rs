//! `touchstone setup`: from a connected board to a tuned wall, step by step. A folder keeps the results of finished steps; after an
//! interruption, the same command resumes at the unfinished step.

mod kept;
mod knob_scene;
mod law_file;
mod sheet;

use super::config::toml_file;
use super::device::spin::{self, Measured};
use super::device::{calibrated, cogging, eccentricity, start, status_of, warn_unwatched};
use super::flash::{self, BoardName};
use super::interrupt;
use super::number;
use super::out::{self, note, path_line, say, tell};
use super::port::PortOption;
use super::progress;
use kept::{Kept, io};
use law_file::with_knob;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use touchstone_control::Si;
use touchstone_device::Client;
use touchstone_drive::wire::{checked, hardware};
use touchstone_lab::identify::eccentricity::Eccentricity;
use touchstone_lab::identify::motor::MeasuredMotor;
use touchstone_lab::scorecard::rivals::Rival;
use touchstone_lab::tune::own_firmware::{CFile, OwnFirmware};
use touchstone_lab::tune::{self, Effort, Tuned};
use touchstone_link::guard;
use touchstone_link::value;
use touchstone_link::words::{described, name_of, number_of};
use touchstone_protocol::settings::fields::field;
use touchstone_protocol::settings::kept as kept_start;
use touchstone_protocol::{DeviceCommand, DeviceSettings, Phase, Request, Unkept};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;
use touchstone_sim::scene::Scene;

/// Options of `touchstone setup`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(flatten)]
    port: PortOption,
    /// Folder of measurements and settings; an interrupted setup in this folder resumes.
    #[arg(long, value_name = "DIR", default_value = "knob")]
    out: PathBuf,
    /// Settings of this knob: pole pairs, encoder, currents, supply; as `touchstone config export` writes them.
    #[arg(long, value_name = "FILE.toml")]
    settings: Option<PathBuf>,
    /// Stiffness of the wall, N·m/rad; default: the stiffness in the settings.
    #[arg(long, value_name = "N_M_PER_RAD", allow_negative_numbers = true, value_parser = number::up_to(1e5, "N·m/rad"))]
    k_desired: Option<f64>,
    /// Writes the firmware of this board if no device answers at the port.
    #[arg(long)]
    board: Option<BoardName>,
    /// Tunes for seconds instead of minutes.
    #[arg(long)]
    quick: bool,
    /// Reads the control law's settings from this file, as `touchstone tune --out` writes it, instead of tuning.
    #[arg(long, value_name = "FILE.toml", conflicts_with = "quick")]
    law: Option<PathBuf>,
    /// Measures the knob and tunes the wall again, even if an earlier setup did.
    #[arg(long)]
    again: bool,
    /// Saves the alignment of an absolute encoder, so that the next start only checks it with a small motion.
    #[arg(long)]
    keep_alignment: bool,
    /// Also measures the motor's cogging and saves a map that compensates it: THE SHAFT TURNS SLOWLY for a minute more. Needs an
    /// absolute encoder.
    #[arg(long)]
    cogging: bool,
}

/// Runs `touchstone setup`. If board, cable or supply fail, only the results of the present step are lost.
pub fn main(options: &Options) -> Result<()> {
    stepped(options).map_err(|error| match error {
        Error::Device {
            place,
            problem,
            mut fix,
        } if !fix.contains(AGAIN) && options.out.join(BEFORE).is_file() => {
            fix += "; then ";
            fix += AGAIN;
            Error::Device {
                place,
                problem,
                fix,
            }
        }
        other => other,
    })
}

/// Text for error messages: how to resume an interrupted setup.
const AGAIN: &str = "the same command again";

fn stepped(options: &Options) -> Result<()> {
    let stop = interrupt::noted()?;
    let mut kept = Kept::open(&options.out)?;
    if options.again {
        kept.again();
    }
    tell!("1/6 board      who is there");
    let mut client = connect(options)?;
    let who = described(client.identity());
    tell!("    {who}");
    if !client.identity().board.senses_current() {
        return Err(cannot_measure(&client));
    }
    begin(&mut client, &mut kept, &options.out)?;
    // From here on this command may move the shaft.
    steps(options, &stop, &mut kept, &mut client, &who).map_err(|failure| client.left_off(failure))
}

/// The steps from the knob's settings to the tuned board.
fn steps(
    options: &Options,
    stop: &AtomicBool,
    kept: &mut Kept,
    client: &mut Client,
    who: &str,
) -> Result<()> {
    tell!("2/6 settings   of the knob");
    let before = options.out.join(BEFORE);
    let settings = settings(client, options, &before)?;
    tell!(
        "    {} pole pairs, {} with {} counts, up to {} A",
        settings.motor.pole_pairs,
        value::shown(&settings, named("encoder.kind")?),
        settings.encoder.counts_per_rev,
        settings.motor.current_limit_a,
    );

    let pole_pairs = settings.motor.pole_pairs.into();
    let (motor, encoder) = match kept.measured() {
        Some(motor) => {
            tell!("3/6 motor      measured before (--again measures again)");
            (motor, kept.encoder())
        }
        None => {
            tell!(
                "3/6 motor      HANDS OFF: THE SHAFT TURNS, THEN SPINS BOTH WAYS, for half a minute"
            );
            let Measured { motor, encoder } = spin::measure(client, &settings, stop)?;
            if let Err(why) = &encoder {
                note!("note: the encoder's eccentricity was not found: {why}");
            }
            let encoder = encoder.ok();
            let as_json = encoder.map(|it| eccentricity::as_json(&it, pole_pairs));
            kept.keep_measured(&motor, as_json)?;
            (motor, encoder)
        }
    };
    for line in sheet::lines(&motor) {
        tell!("    {line}");
    }
    if let Some(encoder) = &encoder {
        let constant = motor.torque_constant_n_m_per_a.value;
        let field = eccentricity::field_n_m_per_rad(&settings, constant);
        for line in eccentricity::lines(encoder, pole_pairs, field) {
            tell!("    {line}");
        }
        if let Some(warning) = eccentricity::warning(encoder, pole_pairs) {
            note!("{warning}");
        }
    }

    let board = client.identity().board;
    let scene_file = options.out.join("knob.toml");
    // The wall is tuned without the encoder's angle error, which no settings of a control law can correct.
    let told: f64 = settings.law.position_error_rad.to_num();
    let position_error_rad = encoder
        .as_ref()
        .map_or(0.0, Eccentricity::position_error_rad);
    let position_error_rad = position_error_rad.max(told);
    let text = knob_scene::text(&motor, position_error_rad, &settings, hardware(board), who);
    let with_encoder = text.clone() + &knob_scene::encoder_text(encoder.as_ref());
    write(&scene_file, &with_encoder)?;
    tell!("4/6 scene      {}", scene_file.display());

    let law_file = options.out.join("law.toml");
    if let Some(given) = &options.law {
        tell!("5/6 wall       as given: {}", path_line(given));
        let law = touchstone_sim::input::text(given, touchstone_sim::input::MOST_OF_SETTINGS)
            .map_err(|error| io(given, &error))?;
        toml_file::read(&law, given, &settings)?;
        kept.forget_tuned()?;
        write(&law_file, &law)?;
        // Those of an earlier search would be of another law.
        for name in [RUST, C] {
            let _ = std::fs::remove_file(options.out.join(name));
        }
    } else if kept.is_tuned_for(&text, options.quick) && law_file.is_file() {
        tell!("5/6 wall       tuned before: {}", law_file.display());
    } else {
        tell!("5/6 wall       looking for settings of the law");
        let law = tuned(&Scene::parse(&text, &scene_file)?, options, stop)?;
        kept.forget_tuned()?;
        write(&law_file, &tune::settings::toml(&law))?;
        write_code(&law, &options.out)?;
        kept.keep_tuned_for(&text, options.quick)?;
    }

    tell!("6/6 board      gets the settings, saves them and calibrates: THE SHAFT TURNS");
    let all = with_knob(settings, &motor, position_error_rad, &law_file, client)?;
    take(client, &all)?;
    warn_unwatched(&all);
    if options.keep_alignment {
        tell!("    stores the alignment and checks it: the shaft moves a little");
        start::keep(client)?;
    }
    let cogging = match options.cogging {
        true => Some(uncogged(client, &all, stop)?),
        false => None,
    };
    let page = sheet::write(
        &motor,
        encoder.as_ref(),
        cogging.as_ref(),
        &with_encoder,
        &all,
        who,
        &options.out.join(REPORT),
    )?;
    out::result(
        || {
            serde_json::json!({
                "device": kept.device(),
                "measured": kept::as_json(&motor),
                "encoder": encoder.map(|it| eccentricity::as_json(&it, pole_pairs)),
                "cogging": cogging.as_ref().map(cogging::Tried::json),
                "scene": scene_file.display().to_string(),
                "settings": law_file.display().to_string(),
                "page": page.display().to_string(),
                "state": "ready",
            })
        },
        || {
            say!("ready; the wall is at {} rad", all.wall.surface_rad);
            say!("promise    {}", guard::promise(&all, board));
            say!(
                "           {}",
                guard::by_torque_constant(constant_error(&motor))
            );
            say!("page       {}", page.display());
            say!("feel it    touchstone device arm");
            if may_keep(client, &all).is_ok() && !options.keep_alignment {
                say!(
                    "store it   touchstone device alignment keep: the next start then needs only a small motion"
                );
            }
            say!(
                "simulate   touchstone run {} --settings {}",
                scene_file.display(),
                law_file.display()
            );
            Ok(())
        },
    )
}

/// Relative error that the measured torque constant may have: two standard uncertainties.
fn constant_error(motor: &MeasuredMotor) -> f64 {
    let constant = &motor.torque_constant_n_m_per_a;
    2.0 * constant.uncertainty / constant.value
}

/// Measures the motor's cogging, saves the map that compensates it on the board, and calibrates the board again.
fn uncogged(
    client: &mut Client,
    all: &DeviceSettings,
    stop: &AtomicBool,
) -> Result<cogging::Tried> {
    tell!("    cogging: HANDS OFF, THE SHAFT TURNS SLOWLY, both ways and twice");
    client.tell(&Request::Command(DeviceCommand::Stop))?;
    let tried = cogging::measure(client, all, stop)?;
    for line in tried.lines() {
        tell!("    {line}");
    }
    client.tell(&Request::Command(DeviceCommand::Calibrate))?;
    calibrated(client)?;
    Ok(tried)
}

/// Name of the file with the board's settings before the setup. `touchstone config import` restores them from this file.
const BEFORE: &str = "before.toml";

/// Names of the files with the law's settings and the measured device for a firmware of one's own, in Rust and in C.
const RUST: &str = "law.rs";
const C: &str = "law.h";

/// Name of the folder with the page on the measured knob.
const REPORT: &str = "report";

fn write(file: &Path, text: &str) -> Result<()> {
    output::write(file, text).map_err(|error| io(file, &error))
}

/// Connects to the device. If no device answers and `--board` names the board, writes the firmware and connects again.
fn connect(options: &Options) -> Result<Client> {
    let silent = match options.port.connect() {
        Ok(client) => return Ok(client),
        Err(error) => error,
    };
    let is_bare =
        matches!(&silent, Error::Device { problem, .. } if problem.starts_with("no answer"));
    match options.board {
        Some(board) if is_bare => {
            tell!("    no answer: writing the firmware");
            flash::write(board)?;
            options.port.connect()
        }
        _ => Err(silent),
    }
}

/// Prepares the folder and the board: checks that the folder belongs to this board, or creates it, stops the board, and saves its
/// settings if the folder is new. Errors: the folder belongs to another board or cannot be created, or the wall is on.
fn begin(client: &mut Client, kept: &mut Kept, folder: &Path) -> Result<()> {
    let number = number_of(client.identity());
    match kept.device() {
        Some(other) if other != number => {
            return Err(Error::Io {
                path: folder.to_owned(),
                problem: format!("belongs to the board {other}; this one is {number}"),
                fix: "choose another folder with --out".into(),
            });
        }
        _ => {}
    }
    let status = status_of(client)?;
    match (status.phase, &status.fault) {
        (Phase::Armed, _) => {
            return Err(Error::device(
                client.place(),
                "the wall is on",
                "let go of the knob, then: touchstone device disarm",
            ));
        }
        (_, Some(fault)) => note!("note: the board was in fault {}", name_of(fault)),
        _ => {}
    }
    // The folder is created with its first file, before the board is changed. If no board answers, no empty folder is left.
    output::in_folder(
        folder,
        |error| io(folder, &error),
        || match kept.device() {
            None => kept.begin(&number),
            Some(_) => Ok(()),
        },
    )?;
    if !matches!(status.phase, Phase::Boot | Phase::Stopped) {
        client.tell(&Request::Command(DeviceCommand::Stop))?;
    }
    // An earlier setup may have been interrupted before it wrote these settings.
    let before = folder.join(BEFORE);
    if kept.is_new() && !before.is_file() {
        write(
            &before,
            &toml_file::write(&client.settings()?, client.identity()),
        )?;
    }
    Ok(())
}

/// Error for a board without current sensors. Such a board cannot measure its motor's resistance, inductance and torque constant.
fn cannot_measure(client: &Client) -> Error {
    Error::device(
        client.place(),
        "this board has no current sensors, so it cannot measure a motor",
        "set the motor's resistance, inductance and torque constant: docs/voltage-mode.md, \"By hand\"",
    )
}

/// Settings for the setup: the board's earlier settings, changed by the user's settings file and stiffness.
fn settings(client: &Client, options: &Options, before: &Path) -> Result<DeviceSettings> {
    let board = client.identity().board;
    let mut settings = DeviceSettings::defaults(board);
    for file in [Some(before), options.settings.as_deref()]
        .into_iter()
        .flatten()
    {
        let text = touchstone_sim::input::text(file, touchstone_sim::input::MOST_OF_SETTINGS)
            .map_err(|error| io(file, &error))?;
        settings = toml_file::read(&text, file, &settings)?.0;
    }
    if let Some(stiffness) = options.k_desired {
        settings.wall.k_desired_n_m_per_rad = Si::saturating_from_num(stiffness);
    }
    settings.calibration.measures = false;
    refuse_invalid(&settings, client)?;
    for (is_asked, option) in [
        (options.keep_alignment, "--keep-alignment"),
        (options.cogging, "--cogging"),
    ] {
        if let (true, Err(why)) = (is_asked, may_keep(client, &settings)) {
            return Err(Error::Option {
                option: option.into(),
                problem: why.into(),
                fix: "leave it out".into(),
            });
        }
    }
    Ok(settings)
}

/// Whether the board can save an alignment and a cogging map with these settings. The error says why not.
fn may_keep(client: &Client, settings: &DeviceSettings) -> std::result::Result<(), &'static str> {
    kept_start::may_keep(settings).map_err(Unkept::words)?;
    match client.identity().board.is_large() {
        true => Ok(()),
        false => Err("this board has too little flash for the data of a motor"),
    }
}

fn refuse_invalid(settings: &DeviceSettings, client: &Client) -> Result<()> {
    checked(settings, client.identity().board).map_err(|invalid| Error::Option {
        option: invalid.path.to_owned(),
        problem: invalid.to_string(),
        fix: "give another value in a file: --settings FILE.toml".into(),
    })
}

fn named(path: &str) -> Result<&'static touchstone_protocol::settings::fields::Field> {
    field(path).ok_or_else(|| Error::Option {
        option: path.to_owned(),
        problem: "there is no such setting".into(),
        fix: "report this as a bug".into(),
    })
}

/// Writes the settings and the measured device as Rust and as C, for a firmware of one's own.
fn write_code(tuned: &Tuned, folder: &Path) -> Result<()> {
    match OwnFirmware::new(tuned) {
        Ok(code) => {
            write(&folder.join(RUST), &code.rust())?;
            write(&folder.join(C), &code.c(CFile::Header))
        }
        Err(why) => {
            note!("{RUST} and {C} are not written: {why}");
            Ok(())
        }
    }
}

/// Tuned settings of the control law for a scene.
fn tuned(scene: &Scene, options: &Options, stop: &AtomicBool) -> Result<Tuned> {
    let asked = tune::TuneOptions {
        seed: 1,
        effort: match options.quick {
            true => Effort::Quick,
            false => Effort::Full,
        },
        ripple_n_m: None,
    };
    let bar = progress::bar(1, "searching");
    let tuned = tune::tune(scene, Rival::named("enhanced")?, &asked, |done, all| {
        bar.set_length(all);
        bar.set_position(done);
        if stop.load(Ordering::Relaxed) {
            note!("interrupted: the board is off; run the same command again to continue");
            std::process::exit(interrupt::INTERRUPTED);
        }
    })?;
    bar.finish_and_clear();
    tell!(
        "    {} settings tried; the best reaches {:.2} of a limit",
        tuned.evaluations,
        tuned.worst
    );
    // Above 1, this device or a slightly varied one exceeds a limit, so that the wall is not usable.
    if tuned.worst.is_nan() || tuned.worst > 1.0 {
        return Err(Error::Option {
            option: "--k-desired".into(),
            problem: format!(
                "no settings hold a wall of {} N·m/rad on this knob and on variants of it",
                scene.wall.k_desired_n_m_per_rad
            ),
            fix: match options.quick {
                true => "choose a softer wall with --k-desired, or search longer without --quick",
                false => "choose a softer wall with --k-desired",
            }
            .into(),
        });
    }
    Ok(tuned)
}

/// Sends settings to the board, lets the board save them, and calibrates with them.
fn take(client: &mut Client, all: &DeviceSettings) -> Result<()> {
    client.tell(&Request::SetAll(all.clone()))?;
    client.tell(&Request::Save)?;
    client.tell(&Request::Command(DeviceCommand::Calibrate))?;
    calibrated(client)
}
