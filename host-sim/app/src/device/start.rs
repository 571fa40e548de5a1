//! `touchstone device alignment` and `autostart`: the alignment of motor and encoder that a board stores, and whether it starts
//! unattended.

use super::{calibrated, status_of};
use crate::out::{self, say, tell};
use clap::{Subcommand, ValueEnum};
use touchstone_control::Si;
use touchstone_device::Client;
use touchstone_protocol::{
    Board, DeviceCommand, DeviceSettings, Phase, Reply, Request, StartReport, Unkept,
};
use touchstone_sim::error::{Error, Result};

const SILENCE: &str = "limits.host_silence_s";

/// The actions on the stored alignment of motor and encoder.
#[derive(Debug, Clone, Copy, Subcommand)]
pub enum AlignmentAction {
    /// Stores the alignment that the calibration measured, saves it with the settings, and checks it at once: THE SHAFT MOVES A
    /// LITTLE.
    Keep,
    /// Deletes the stored alignment and saves the settings without it: each calibration then measures the alignment again.
    Forget,
}

/// Whether a board starts unattended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// The board checks the stored alignment and arms when power comes on: the shaft moves with no person present.
    On,
    /// The board waits for a command from a computer, as shipped.
    Off,
}

/// The device's report on stored alignment and automatic start; `None` from a board that supports neither.
pub fn report(client: &mut Client) -> Result<Option<StartReport>> {
    if !client.identity().board.is_large() {
        return Ok(None);
    }
    match client.ask(&Request::Start)? {
        Reply::Start(report) => Ok(Some(report)),
        other => Err(client.odd(&other)),
    }
}

/// Same as [`report`], but returns an error for a board that has no such report.
fn demanded(client: &mut Client) -> Result<StartReport> {
    let board = client.identity().board;
    report(client)?.ok_or_else(|| {
        let why = if board.has_bus() {
            "has too little flash for it"
        } else {
            "has no connector for an absolute encoder"
        };
        let problem = format!("{} cannot store an alignment: it {why}", board.name());
        let fix = "calibrate at each start: touchstone device calibrate; or use a NUCLEO-G474RE";
        Error::device(client.place(), problem, fix)
    })
}

/// The two lines of text on the start that `status` and `doctor` print: stored alignment, and automatic start.
pub fn lines(report: Option<&StartReport>, settings: &DeviceSettings, board: Board) -> [String; 2] {
    let Some(report) = report else {
        return [
            "cannot be stored on this board".into(),
            "not on this board".into(),
        ];
    };
    let alignment = match (report.kept.usable(settings, board), report.was_checked) {
        (Ok(_), true) => "stored; the last calibration checked it".into(),
        (Ok(_), false) => "stored; the next calibration checks it".into(),
        (Err(Unkept::None | Unkept::Incremental | Unkept::NothingToAlign), _) => {
            "not stored; each calibration measures it".into()
        }
        (Err(why), _) => format!(
            "stored but NOT USED: {}; calibrate, then: touchstone device alignment keep",
            why.words()
        ),
    };
    let autostart = match report.kept.autostart {
        true => format!("on; at this start: {}", report.self_start.words()),
        false => "off".into(),
    };
    [alignment, autostart]
}

/// The report on stored alignment and automatic start as JSON.
pub fn json(
    report: Option<&StartReport>,
    settings: &DeviceSettings,
    board: Board,
) -> serde_json::Value {
    let Some(report) = report else {
        return serde_json::Value::Null;
    };
    let usable = report.kept.usable(settings, board);
    serde_json::json!({
        "alignment_is_kept": report.kept.alignment.is_some(),
        "alignment_is_usable": usable.is_ok(),
        "not_usable_because": usable.err().map(Unkept::words),
        "was_checked": report.was_checked,
        "autostart": report.kept.autostart,
        "self_start": report.self_start.words(),
    })
}

/// Shows the state of the stored alignment and of the automatic start.
fn shown(client: &mut Client) -> Result<()> {
    let board = client.identity().board;
    let (report, settings) = (demanded(client)?, client.settings()?);
    let of_both = lines(Some(&report), &settings, board);
    out::result(
        || json(Some(&report), &settings, board),
        || {
            say!("alignment  {}", of_both[0]);
            say!("autostart  {}", of_both[1]);
            Ok(())
        },
    )
}

/// Shows, stores or deletes the alignment of motor and encoder.
pub fn alignment(client: &mut Client, action: Option<AlignmentAction>) -> Result<()> {
    demanded(client)?;
    match action {
        None => return shown(client),
        Some(AlignmentAction::Keep) => keep(client)?,
        Some(AlignmentAction::Forget) => {
            saves(client)?;
            client.tell(&Request::ForgetAlignment)?;
            client.tell(&Request::Save)?;
        }
    }
    let phase = status_of(client)?.phase;
    out::result(
        || serde_json::json!({ "state": phase.name() }),
        || {
            tell!(
                "{}",
                match action {
                    Some(AlignmentAction::Keep) => "stored and saved; the check passed",
                    _ => "deleted and saved",
                }
            );
            tell!("{}", phase.name());
            Ok(())
        },
    )
}

/// Stores the alignment that the calibration measured, and runs the check that the next start will make. An alignment that fails
/// the check is deleted again.
pub fn keep(client: &mut Client) -> Result<()> {
    client.tell(&Request::KeepAlignment)?;
    client.tell(&Request::Command(DeviceCommand::Stop))?;
    client.tell(&Request::Save)?;
    client.tell(&Request::Command(DeviceCommand::Calibrate))?;
    let Err(failed) = calibrated(client) else {
        return Ok(());
    };
    let problem = match &failed {
        Error::Device { problem, .. } => problem.clone(),
        other => other.to_string(),
    };
    // Switches the board off and deletes the alignment, if the board still answers.
    client.tell(&Request::Command(DeviceCommand::Stop))?;
    client.tell(&Request::ForgetAlignment)?;
    client.tell(&Request::Save)?;
    Err(Error::device(
        client.place(),
        format!("the stored alignment failed its check and was deleted again: {problem}"),
        "take your hand off the knob, unload the shaft, or raise calibration.current_a; then: touchstone device calibrate, touchstone device alignment keep",
    ))
}

/// Sets the time without a request from the computer after which the board switches off, and returns this time, s. A board that
/// starts unattended gets 0: it never switches off for this reason. If automatic start is switched off, a value of 0 becomes the
/// default.
fn set_silence(client: &mut Client, switch: Switch) -> Result<Si> {
    let mut settings = client.settings()?;
    let set = settings.limits.host_silence_s;
    let wanted = match switch {
        Switch::On => Si::ZERO,
        Switch::Off if set == Si::ZERO => {
            let board = client.identity().board;
            DeviceSettings::defaults(board).limits.host_silence_s
        }
        Switch::Off => set,
    };
    if wanted != set {
        settings.limits.host_silence_s = wanted;
        client.tell(&Request::SetAll(settings))?;
    }
    Ok(wanted)
}

/// Checks, before a change begins, that the device can save settings in its present state.
fn saves(client: &mut Client) -> Result<()> {
    let phase = status_of(client)?.phase;
    let fix = match phase {
        Phase::Boot | Phase::Stopped | Phase::Fault => return Ok(()),
        Phase::Armed => "let go of the knob, then: touchstone device stop",
        Phase::Ready | Phase::Calibrating => "stop first: touchstone device stop",
    };
    let problem = format!("the device does not save in state `{}`", phase.name());
    Err(Error::device(client.place(), problem, fix))
}

/// Shows whether the board starts unattended, or switches that on or off.
pub fn autostart(client: &mut Client, switch: Option<Switch>) -> Result<()> {
    demanded(client)?;
    let Some(switch) = switch else {
        return shown(client);
    };
    saves(client)?;
    client.tell(&Request::Autostart(switch == Switch::On))?;
    let silence_s = set_silence(client, switch)?;
    client.tell(&Request::Save)?;
    out::result(
        || {
            serde_json::json!({
                "autostart": switch == Switch::On,
                "host_silence_s": silence_s.to_num::<f64>(),
            })
        },
        || {
            match switch {
                Switch::On => {
                    tell!(
                        "on and saved: FROM NOW ON THE SHAFT MOVES AND THE WALL ACTS AS SOON AS POWER COMES ON, without a command"
                    );
                    tell!(
                        "{SILENCE} = 0: the wall stays on without a computer, also after a computer was connected"
                    );
                    tell!("to switch this off: touchstone device autostart off");
                }
                Switch::Off => tell!(
                    "off and saved: the board waits for a computer, and switches off after {silence_s} s without a request ({SILENCE})"
                ),
            }
            Ok(())
        },
    )
}
