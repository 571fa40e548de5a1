//! `touchstone device`: sends commands to a board, shows its state and its fault, and saves the record of the second before the
//! fault. Commands for haptic devices such as the omega.3 are in [`super::haptic`].

pub mod cogging;
pub mod eccentricity;
pub mod spin;
pub mod start;

use super::haptic;
use super::out::{self, note, say, tell};
use super::port::PortOption;
use super::whole::{Named, Overwrite};
use clap::Subcommand;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use touchstone_control::Si;
use touchstone_device::Client;
use touchstone_drive::Reason;
use touchstone_link::words::{described, name_of, number_of, page};
use touchstone_protocol::{
    Counters, DeviceCommand, DeviceSettings, Fault, FaultCode, Phase, Reply, Request, ResetReason,
    RingRecord, Status,
};
use touchstone_report::csv::decimal;
use touchstone_sim::error::{Error, Result};

/// Time that a calibration takes in addition to the turns of the motor's field (sensor offsets, alignment, pauses), with a reserve.
const CALIBRATION_REST: Duration = Duration::from_secs(15);

/// Options of the command `touchstone device`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(flatten)]
    port: PortOption,
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Clone, Subcommand)]
#[expect(
    clippy::large_enum_variant,
    reason = "a run of the program has only one"
)]
enum Action {
    #[command(flatten)]
    Haptic(haptic::Action),
    #[command(flatten)]
    Board(BoardAction),
}

#[derive(Debug, Clone, Subcommand)]
enum BoardAction {
    /// Shows the board's identity, state and counters.
    Status,
    /// Measures direction, pole pairs and electrical offset: THE SHAFT MOVES. Waits for the end.
    Calibrate {
        /// Returns at once, without waiting for the end.
        #[arg(long)]
        no_wait: bool,
        /// Measures the alignment of motor and encoder again, although the board has a stored one.
        #[arg(long)]
        anew: bool,
    },
    /// Switches the outputs on: from now on the wall acts.
    Arm,
    /// Switches the outputs off, keeps the calibration.
    Disarm,
    /// Switches the outputs off and discards the calibration; clears a fault.
    Stop,
    /// Makes the present position zero. Not while armed.
    Zero,
    /// Shows whether the alignment of motor and encoder is stored for the next start; stores or deletes it. For absolute encoders.
    Alignment {
        #[command(subcommand)]
        action: Option<start::AlignmentAction>,
    },
    /// Shows whether a map of the motor's cogging torque is stored and used; measures, checks or deletes it. For absolute encoders.
    Cogging {
        #[command(subcommand)]
        action: Option<cogging::CoggingAction>,
    },
    /// Measures the error of the encoder's angle that an off-centre magnet causes.
    Eccentricity {
        #[command(subcommand)]
        action: eccentricity::EccentricityAction,
    },
    /// Shows whether the board starts unattended when power comes on, without a computer; switches that on or off, and saves it.
    Autostart {
        #[arg(value_enum)]
        switch: Option<start::Switch>,
    },
    /// Switches off and restarts the device.
    Reboot,
    /// Shows the latched fault: its meaning, and where to read on.
    Fault,
    /// Saves the record of the last second before the fault, as CSV.
    Ring {
        /// The file to write.
        #[arg(long, value_name = "CSV")]
        out: PathBuf,
        #[command(flatten)]
        overwrite: Overwrite,
    },
}

/// Runs the command `touchstone device`.
pub fn main(options: &Options) -> Result<ExitCode> {
    match &options.action {
        Action::Haptic(action) => {
            options.port.refuse()?;
            haptic::main(action)
        }
        Action::Board(action) => of_board(options, action).map(|()| ExitCode::SUCCESS),
    }
}

fn of_board(options: &Options, action: &BoardAction) -> Result<()> {
    let mut client = options.port.connect()?;
    let mut command = |command| client.tell(&Request::Command(command));
    match action {
        BoardAction::Status => return status(&mut client),
        BoardAction::Calibrate { no_wait, anew } => {
            if *anew && client.identity().board.is_large() {
                client.tell(&Request::ForgetAlignment)?;
            }
            client.tell(&Request::Command(DeviceCommand::Calibrate))?;
            if !no_wait {
                calibrated(&mut client)?;
            }
        }
        BoardAction::Alignment { action } => return start::alignment(&mut client, *action),
        BoardAction::Cogging { action } => return cogging::main(&mut client, *action),
        BoardAction::Eccentricity { action } => return eccentricity::main(&mut client, *action),
        BoardAction::Autostart { switch } => return start::autostart(&mut client, *switch),
        BoardAction::Arm => {
            // Requested before arming: if this request fails, the device must not be left armed.
            let settings = client.settings()?;
            client.arm()??;
            note_silence(&settings);
        }
        BoardAction::Disarm => client.stop_by(DeviceCommand::Disarm)?,
        BoardAction::Stop => client.stop_by(DeviceCommand::Stop)?,
        BoardAction::Zero => command(DeviceCommand::Zero)?,
        BoardAction::Reboot => {
            command(DeviceCommand::Reboot)?;
            return state("restarting");
        }
        BoardAction::Fault => return fault(&mut client),
        BoardAction::Ring { out, overwrite } => {
            let place = Named {
                path: out,
                option: "--out",
                replaces: overwrite.force,
            };
            place.check()?;
            return ring(&mut client, &place);
        }
    }
    state(status_of(&mut client)?.phase.name())
}

/// Warns if the host watchdog is off: an armed device then stays on when the computer hangs.
pub fn warn_unwatched(settings: &DeviceSettings) {
    if settings.limits.host_silence_s == Si::ZERO {
        note!(
            "this device stays on when the computer hangs or is disconnected. To switch it off after 2 s of silence: touchstone config set limits.host_silence_s 2"
        );
    }
}

/// Prints after which time without a request from the computer an armed device switches off, or that it never does.
fn note_silence(settings: &DeviceSettings) {
    warn_unwatched(settings);
    let silence_s = settings.limits.host_silence_s;
    if silence_s != Si::ZERO {
        note!(
            "the device switches off if no program sends a request for {silence_s} s, so keep `touchstone monitor` or `touchstone live` running. With limits.host_silence_s = 0 it stays on without a computer"
        );
    }
}

/// Prints the name of the state that the device has after a command.
fn state(name: &str) -> Result<()> {
    out::result(
        || serde_json::json!({ "state": name }),
        || {
            tell!("{name}");
            Ok(())
        },
    )
}

/// Time limit of a calibration. The motor's field turns by one electrical turn and by one more per pole pair, forward and back, at
/// the configured speed.
pub fn calibration_limit(settings: &DeviceSettings) -> Duration {
    let turns = 2.0 * (f64::from(settings.motor.pole_pairs) + 1.0);
    let turns_per_s: f64 = settings.calibration.electrical_turns_per_s.to_num();
    // The speed's range allows positive values only; any other value must not cause a panic.
    CALIBRATION_REST + Duration::try_from_secs_f64(turns / turns_per_s).unwrap_or_default()
}

/// Waits for the end of a calibration. A calibration that exceeds its time limit is stopped, and is an error.
pub fn calibrated(client: &mut Client) -> Result<()> {
    let limit = calibration_limit(&client.settings()?);
    let until = Instant::now() + limit;
    loop {
        let status = status_of(client)?;
        let (problem, fix) = match status.phase {
            Phase::Ready | Phase::Armed => return Ok(()),
            Phase::Calibrating if Instant::now() < until => {
                std::thread::sleep(Duration::from_millis(50));
                continue;
            }
            Phase::Calibrating => {
                // The shaft is driven and this command stops waiting, so the calibration is stopped.
                client.tell(&Request::Command(DeviceCommand::Stop))?;
                (
                    format!(
                        "the calibration did not end within {} s, and was stopped",
                        limit.as_secs()
                    ),
                    "find the cause in the record of `touchstone device ring`; or start a calibration without this time limit: touchstone device calibrate --no-wait",
                )
            }
            Phase::Fault if status.fault.as_ref().is_some_and(is_of_kept) => (
                "the check of the stored alignment failed: the alignment is wrong, or the shaft was held, loaded or turning".to_owned(),
                "take your hand off the knob and try again: touchstone device stop, touchstone device calibrate; or measure the alignment again with `calibrate --anew`",
            ),
            Phase::Fault => (
                format!(
                    "the calibration ended with a fault: {}",
                    status
                        .fault
                        .map_or("unknown".into(), |fault| name_of(&fault))
                ),
                "see its cause and remedy: touchstone device fault",
            ),
            Phase::Boot | Phase::Stopped => (
                "the calibration was stopped".to_owned(),
                "start it again: touchstone device calibrate",
            ),
        };
        return Err(Error::device(client.place(), problem, fix));
    }
}

/// Whether the fault means that the stored alignment of motor and encoder failed its check.
fn is_of_kept(fault: &Fault) -> bool {
    fault.known() == Some(FaultCode::CalibrationFailed)
        && matches!(
            Reason::from_value(fault.value),
            Some(Reason::KeptWrong | Reason::KeptNotFollowed | Reason::KeptTurning)
        )
}

/// Requests the state of the device.
pub fn status_of(client: &mut Client) -> Result<Status> {
    match client.ask(&Request::Status)? {
        Reply::Status(status) => Ok(status),
        other => Err(client.odd(&other)),
    }
}

fn status(client: &mut Client) -> Result<()> {
    let status = status_of(client)?;
    let Counters {
        decode_errors,
        telemetry_dropped,
        ticks,
        tick_cycles_max,
        lateness_cycles_max,
        current_loop_cycles_max,
    } = match client.ask(&Request::Counters)? {
        Reply::Counters(counters) => counters,
        other => return Err(client.odd(&other)),
    };
    let (report, settings) = (start::report(client)?, client.settings()?);
    let identity = client.identity();
    let [alignment, autostart] = start::lines(report.as_ref(), &settings, identity.board);
    let programs = || {
        serde_json::json!({
            "board": identity.board.name(),
            "firmware_version": identity.firmware_version.to_string(),
            "build_hash": format!("{:016x}", identity.build_hash),
            "protocol_version": identity.protocol_version,
            "settings_version": identity.settings_version,
            "unique_id": number_of(identity),
            "started": started(identity.reset_reason),
            "state": status.phase.name(),
            "fault": status.fault.as_ref().map(fault_json),
            "settings_unsaved": status.unsaved,
            "start": start::json(report.as_ref(), &settings, identity.board),
            "ticks": ticks,
            "tick_cycles_max": tick_cycles_max,
            "current_loop_cycles_max": current_loop_cycles_max,
            "lateness_cycles_max": lateness_cycles_max,
            "telemetry_dropped_records": telemetry_dropped,
            "damaged_requests": decode_errors,
        })
    };
    out::result(programs, || {
        say!("device    {}", described(identity));
        say!("started   {}", started(identity.reset_reason));
        say!("state     {}", status.phase.name());
        if let Some(fault) = &status.fault {
            say!("fault     {}", name_of(fault));
        }
        let kept = if status.unsaved {
            "changed but not saved; to save: touchstone config save"
        } else {
            "as after a restart"
        };
        say!("settings  {kept}");
        say!("alignment {alignment}");
        say!("autostart {autostart}");
        say!("ticks     {ticks}");
        say!("longest   {tick_cycles_max} cycles a tick, {current_loop_cycles_max} a current loop");
        say!("latest    {lateness_cycles_max} cycles after a tick was due");
        say!("lost      {telemetry_dropped} telemetry records, {decode_errors} damaged requests");
        Ok(())
    })
}

/// A fault as JSON for programs.
fn fault_json(fault: &Fault) -> serde_json::Value {
    serde_json::json!({
        "code": fault.code,
        "name": fault.known().map(page),
        "tick": fault.tick,
        "value": fault.value,
    })
}

fn started(reason: ResetReason) -> String {
    match reason {
        ResetReason::Panic(place) => {
            format!("after a panic of the firmware (place {place:#010x}): please report it")
        }
        other => format!("after: {}", other.words()),
    }
}

fn fault(client: &mut Client) -> Result<()> {
    let fault = match client.ask(&Request::Fault)? {
        Reply::Fault(fault) => fault,
        other => return Err(client.odd(&other)),
    };
    out::result(
        || serde_json::json!({ "fault": fault.as_ref().map(fault_json) }),
        || {
            let Some(fault) = &fault else {
                say!("no fault");
                return Ok(());
            };
            say!("fault  {}", name_of(fault));
            say!("tick   {}", fault.tick);
            say!("value  {}", fault.value);
            if let Some(code) = fault.known() {
                say!("page   docs/faults/{:02}-{}.md", fault.code, page(code));
            }
            say!("clear  touchstone device stop");
            Ok(())
        },
    )
}

/// Columns of the CSV file with the record of the last second before the fault.
const RING_COLUMNS: [&str; 7] = [
    "tick_low_16_bits",
    "count",
    "force_n_m",
    "current_q_a",
    "lateness_cycles",
    "limits_bits",
    "state",
];

fn ring(client: &mut Client, place: &Named<'_>) -> Result<()> {
    // All records are read before the file is begun: a lost connection then leaves no incomplete file.
    let mut records: Vec<RingRecord> = Vec::new();
    loop {
        let first = u16::try_from(records.len()).unwrap_or(u16::MAX);
        let chunk = match client.ask(&Request::Ring { first })? {
            Reply::Ring(chunk) => chunk,
            other => return Err(client.odd(&other)),
        };
        if chunk.records.is_empty() || chunk.first != first {
            break;
        }
        records.extend(&chunk.records);
        if records.len() >= usize::from(chunk.total) {
            break;
        }
    }
    let text = ring_csv(&records).map_err(|error| place.error(&error.into()))?;
    place.write(text)?;
    let out = place.path;
    out::result(
        || serde_json::json!({ "file": out.display().to_string(), "ticks": records.len() }),
        || {
            tell!("{}: {} ticks", out.display(), records.len());
            Ok(())
        },
    )
}

fn ring_csv(records: &[RingRecord]) -> csv::Result<Vec<u8>> {
    let mut file = csv::Writer::from_writer(Vec::new());
    file.write_record(RING_COLUMNS)?;
    for record in records {
        let phase = Phase::ALL.get(usize::from(record.phase));
        file.write_record([
            record.tick.to_string(),
            record.count.to_string(),
            decimal(f64::from(record.force) / 4096.0),
            decimal(f64::from(record.current_q) / 1024.0),
            (u32::from(record.lateness_64) * 64).to_string(),
            record.limits.to_string(),
            phase.map_or("unknown", |phase| phase.name()).to_owned(),
        ])?;
    }
    let text = file.into_inner().map_err(csv::IntoInnerError::into_error)?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that other programs can read the CSV file with the record before a fault.
    #[test]
    fn others_read_what_a_ring_has() {
        let nothing = RingRecord::default();
        let mut records = vec![nothing; 30_000];
        records.push(RingRecord {
            force: -1,
            current_q: 3,
            ..nothing
        });
        crate::whole::is_read_by_others("ring.csv", &ring_csv(&records).unwrap());
    }

    use touchstone_control::Si;
    use touchstone_protocol::Board;

    #[test]
    fn a_slow_calibration_of_many_pole_pairs_is_waited_for() {
        let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
        // 16 electrical turns forward and 16 back, at 4 turns per second.
        settings.motor.pole_pairs = 15;
        assert_eq!(
            calibration_limit(&settings),
            CALIBRATION_REST + Duration::from_secs(8)
        );
        settings.calibration.electrical_turns_per_s = Si::lit("0.8");
        // 40 s and `CALIBRATION_REST`; 0.8 is not exact in its fixed-point format.
        assert!((54..=55).contains(&calibration_limit(&settings).as_secs()));
    }
}
