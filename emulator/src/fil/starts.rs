//! Tests of the stored encoder alignment and of the automatic start. The firmware must use each if all its conditions hold, and
//! refuse it if one does not.

use std::f64::consts::TAU;

use touchstone_control::Si;
use touchstone_drive::Reason;
use touchstone_protocol::settings::DeviceSettings;
use touchstone_protocol::{
    DeviceCommand, Fault, FaultCode, Phase, Refusal, Reply, Request, SelfStart, StartReport,
    Telemetry, Unkept,
};
use touchstone_world::plant::MEDIUM;

use super::fault::Fault as Trouble;
use super::press::{board_named, compare};
use super::tally::Tally;
use crate::bench::{Bench, MS, Setup, number};
use crate::board::Encoder;
use crate::chip::ResetCause;
use crate::cpu::elf::Program;

/// Time within which an automatic start switches the outputs on, in processor cycles. It covers the program's start, half a second
/// at rest before the alignment check, and a quarter of a second in it. The test of a normal start shows that the time is long
/// enough.
const WOULD_BE_ON: u64 = 1_200 * MS;
/// Time within which an undisturbed automatic start arms the device, in processor cycles.
const WOULD_BE_ARMED: u64 = 4_500 * MS;
/// Time within which a shaft without a hand comes to rest, in processor cycles.
const AT_REST: u64 = 6_000 * MS;
/// Longest allowed silence of the computer in seconds, once the computer has sent a message.
const SILENCE_S: &str = "0.5";

/// Tests that a stored alignment is used and checked at the next start.
pub fn kept_alignment(program: &Program, setup: &Setup, tally: &mut Tally) {
    if !setup.board.is_large() || matches!(setup.board.encoder, Encoder::Incremental(_)) {
        return tally.check("kept alignment", is_not_kept(program, setup));
    }
    let mut bench = match kept(program, setup) {
        Ok(bench) => bench,
        Err(error) => return tally.check("kept alignment", Err(error)),
    };
    tally.check("kept alignment, used", is_used(&mut bench));
    // A slip of 24 electrical degrees pulls the rotor away by less than an eighth of an electrical turn. So only the mean over the
    // check reveals it.
    for degrees in [360.0, 24.0, 30.0, 90.0, 180.0] {
        let name = format!("kept alignment, a magnet that slipped by {degrees} electrical degrees");
        tally.check(&name, slipped(&mut bench, degrees));
    }
    tally.check(
        "kept alignment, other pole pairs",
        other_pole_pairs(&mut bench),
    );
    tally.ran(&bench);
}

/// Tests a board that starts unattended, and each reason that prevents the start.
pub fn start_by_itself(program: &Program, setup: &Setup, tally: &mut Tally) {
    // This test runs on two boards: one with the larger motor and one with the small motor. The SimpleFOC Mini's program is the
    // same as the latter's.
    if !["nucleo-g474re", "nucleo-g474re-ihm16m1"].contains(&setup.board.name) {
        return;
    }
    let asked = kept(program, setup).and_then(|mut bench| {
        bench.demand(Request::Command(DeviceCommand::Stop))?;
        bench.configure(|settings| settings.limits.host_silence_s = Si::lit(SILENCE_S))?;
        bench.demand(Request::Autostart(true))?;
        bench.demand(Request::Save)?;
        Ok(bench)
    });
    let mut bench = match asked {
        Ok(bench) => bench,
        Err(error) => return tally.check("start by itself", Err(error)),
    };
    tally.check(
        "start by itself, a press, and a cable pulled",
        starts(&mut bench),
    );
    tally.check("start by itself, stop button", stops(&mut bench));
    for (name, case) in KEPT_FROM {
        let name = format!("no start by itself: {name}");
        tally.check(&name, case(&mut bench));
    }
    tally.ran(&bench);
}

/// A test of one reason that prevents an automatic start. It prepares the reason and checks that the outputs stay off.
type Case = fn(&mut Bench) -> Result<String, String>;

const KEPT_FROM: [(&str, Case); 9] = [
    ("reset by the pin", |bench| {
        reset(bench, ResetCause::Pin, SelfStart::NoPowerOn)
    }),
    ("reset by the watchdog", |bench| {
        let why = reset(bench, ResetCause::Watchdog, SelfStart::NoPowerOn)?;
        match bench.fault()?.and_then(|fault| fault.known()) {
            Some(FaultCode::Watchdog) => Ok(why),
            other => Err(format!("{other:?} instead of Watchdog")),
        }
    }),
    ("a desktop speaks first", |bench| {
        power_on(bench);
        bench.boot()?;
        stays_off(bench, WOULD_BE_ON, SelfStart::DesktopSpoke)
    }),
    ("the stop button is pressed", |bench| {
        power_on(bench);
        bench.run(200 * MS)?;
        let stop = Trouble::StopPressed(0);
        stop.inject(bench)?;
        bench.run(100 * MS)?;
        stop.remove(bench);
        stays_off(bench, WOULD_BE_ON, SelfStart::StopPressed)
    }),
    ("a supply that is too low, until it comes", |bench| {
        let volts = bench.machine.chip().board.supply_v;
        bench.machine.chip_mut().world.bridge.bus_v = 7.0;
        power_on(bench);
        let off = is_off_for(bench, WOULD_BE_ON);
        bench.machine.chip_mut().world.bridge.bus_v = volts;
        off?;
        bench.run_until("the outputs on", WOULD_BE_ON, |bench| bench.is_on())?;
        Ok("off, and on when it had come".into())
    }),
    ("a driver that reports an error until its supply comes", |bench| {
        bench.machine.chip_mut().world.bridge.bus_v = 7.0;
        power_on(bench);
        let error = Trouble::Break(0);
        error.inject(bench)?;
        let off = is_off_for(bench, WOULD_BE_ON);
        // The supply is as it should be, too.
        error.remove(bench);
        off?;
        bench.run_until("the outputs on", WOULD_BE_ON, |bench| bench.is_on())?;
        Ok("off, and on when it had come".into())
    }),
    ("a shaft that turns", |bench| {
        power_on(bench);
        bench.machine.chip_mut().world.force(1.0);
        let off = is_off_for(bench, WOULD_BE_ON);
        bench.release();
        off.map(|()| "off".into())
    }),
    ("a magnet that slipped", |bench| {
        bench.machine.chip_mut().world.slip(TAU / 4.0);
        power_on(bench);
        let tried = tries_once(bench);
        bench.machine.chip_mut().world.slip(-TAU / 4.0);
        tried
    }),
    ("other pole pairs", |bench| {
        power_on(bench);
        bench.boot()?;
        bench.configure(|settings| settings.motor.pole_pairs = 11)?;
        bench.demand(Request::Save)?;
        power_on(bench);
        stays_off(bench, WOULD_BE_ON, SelfStart::NoAlignment)
    }),
];

/// A device with an absolute encoder, whose alignment is stored in flash.
fn kept(program: &Program, setup: &Setup) -> Result<Bench, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    let kind = setup.board.encoder.kind();
    bench.configure(|settings| {
        settings.encoder.kind = kind;
        settings.calibration.electrical_turns_per_s = setup.board.field_turns_per_s;
        settings.wall.surface_rad = Si::lit("0.3");
        // The calibration's current may be held for ever, because this test is not about heating.
        settings.motor.continuous_current_a = settings.calibration.current_a;
    })?;
    bench.calibrate()?;
    bench.demand(Request::KeepAlignment)?;
    bench.demand(Request::Command(DeviceCommand::Stop))?;
    bench.demand(Request::Save)?;
    Ok(bench)
}

/// Switches the power off, and on again when the shaft is at rest.
pub fn power_on(bench: &mut Bench) {
    bench.release();
    let until = bench.now() + AT_REST;
    let mut before = f64::NAN;
    while bench.now() < until {
        let here = bench.machine.chip().world.angle_rad();
        if (here - before).abs() < 1e-5 || bench.run(50 * MS).is_err() {
            break;
        }
        before = here;
    }
    bench.machine.power_on(ResetCause::PowerOn);
    bench.halted = None;
    // Ends a frame that the link may have begun before the power cut.
    bench.send(&[0]);
}

fn report(bench: &mut Bench) -> Result<StartReport, String> {
    match bench.demand(Request::Start)? {
        Reply::Start(report) => Ok(report),
        other => Err(format!("not what is kept: {other:?}")),
    }
}

/// Checks that the device refuses to store the alignment of an incremental encoder. A board without memory for an alignment answers
/// that it does not know the request.
fn is_not_kept(program: &Program, setup: &Setup) -> Result<String, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    let said = bench.ask(Request::KeepAlignment)?;
    match said {
        Err(Refusal::NotUnderstood | Refusal::Unkept(Unkept::Incremental)) => {
            Ok(format!("refused: {said:?}"))
        }
        other => Err(format!("{other:?}")),
    }
}

fn is_used(bench: &mut Bench) -> Result<String, String> {
    power_on(bench);
    bench.boot()?;
    let (begun, from) = (bench.now(), bench.machine.chip().world.angle_rad());
    let mut most: f64 = 0.0;
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    bench.run_until("the outputs on", WOULD_BE_ON, |bench| bench.is_on())?;
    bench.run_until("the outputs off", WOULD_BE_ARMED, |bench| {
        most = most.max((bench.machine.chip().world.angle_rad() - from).abs());
        !bench.is_on()
    })?;
    let ms = (bench.now() - begun) / MS;
    bench.wait_for(Phase::Ready, 100 * MS)?;
    if !report(bench)?.was_checked {
        return Err("it was looked for, not checked".into());
    }
    let degrees = most.to_degrees();
    // An eighth of an electrical turn is 6.4 degrees of the shaft with seven pole pairs.
    if degrees > 8.0 {
        return Err(format!("the shaft moved by {degrees:.1} degrees"));
    }
    arms(bench)?;
    Ok(format!(
        "ready after {ms} ms, the shaft moved by {degrees:.1} degrees at most"
    ))
}

fn arms(bench: &mut Bench) -> Result<(), String> {
    bench.demand(Request::Command(DeviceCommand::Arm))?;
    bench.wait_for(Phase::Armed, 100 * MS)?;
    bench
        .demand(Request::Command(DeviceCommand::Stop))
        .map(|_| ())
}

/// The reason why a calibration failed, from the latched fault. Errors: the fault is not a failed calibration.
fn why(fault: Option<Fault>) -> Result<Reason, String> {
    let reason = fault.and_then(|fault| {
        (fault.known() == Some(FaultCode::CalibrationFailed))
            .then(|| Reason::from_value(fault.value))?
    });
    reason.ok_or_else(|| format!("{fault:?} instead of a check that failed"))
}

/// Lets the encoder's magnet slip by this many electrical degrees. After a whole electrical turn the device must work as before.
/// After any other angle it must detect the slip and not arm.
fn slipped(bench: &mut Bench, degrees: f64) -> Result<String, String> {
    bench.machine.chip_mut().world.slip(degrees.to_radians());
    let judged = judged(bench, degrees == 360.0);
    bench.machine.chip_mut().world.slip(-degrees.to_radians());
    judged
}

fn judged(bench: &mut Bench, is_harmless: bool) -> Result<String, String> {
    power_on(bench);
    bench.boot()?;
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    let mut phase = Phase::Calibrating;
    while phase == Phase::Calibrating {
        bench.run(20 * MS)?;
        phase = bench.status()?.phase;
    }
    if is_harmless {
        return match phase {
            Phase::Ready => Ok("no difference to the motor".into()),
            other => Err(format!("{} with {:?}", other.name(), bench.fault()?)),
        };
    }
    if phase != Phase::Fault {
        return Err(format!("{}: it passed", phase.name()));
    }
    let why = why(bench.fault()?)?;
    if !matches!(why, Reason::KeptWrong | Reason::KeptNotFollowed) {
        return Err(format!("{why:?}"));
    }
    if bench.command(DeviceCommand::Arm)? || bench.is_on() {
        return Err("it arms".into());
    }
    Ok(format!("{why:?}, and no arming"))
}

/// Checks that the device does not use an alignment that was measured with another number of pole pairs. The full calibration that
/// it runs instead must then report the wrong settings.
fn other_pole_pairs(bench: &mut Bench) -> Result<String, String> {
    power_on(bench);
    bench.boot()?;
    bench.configure(|settings| settings.motor.pole_pairs = 11)?;
    let settings: DeviceSettings = bench.settings()?;
    let board = board_named(bench.machine.chip().board.name)?;
    match report(bench)?.kept.usable(&settings, board) {
        Err(Unkept::OtherPolePairs) => {}
        other => return Err(format!("{other:?}")),
    }
    if let Ok(taken) = bench.ask(Request::Autostart(true))? {
        return Err(format!("it would start by itself: {taken:?}"));
    }
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    bench.wait_for(Phase::Fault, 20_000 * MS)?;
    match why(bench.fault()?)? {
        Reason::PolePairs => Ok("not used; the whole search says that they are wrong".into()),
        other => Err(format!("{other:?}")),
    }
}

/// The telemetry records from index `from` on. Errors: records are missing.
fn told(bench: &Bench, from: usize) -> Result<Vec<&Telemetry>, String> {
    match bench.link.gaps(from) {
        0 => Ok(bench.link.telemetry[from..].iter().collect()),
        gaps => Err(format!("{gaps} records of telemetry are missing")),
    }
}

/// Waits until the device has armed itself without any message from the computer.
fn armed_by_itself(bench: &mut Bench) -> Result<(), String> {
    let is_armed = |bench: &mut Bench| {
        let last = bench.link.telemetry.last();
        last.is_some_and(|record| record.phase == Phase::Armed)
    };
    bench.run_until("armed by itself", WOULD_BE_ARMED, is_armed)
}

fn starts(bench: &mut Bench) -> Result<String, String> {
    let settings = bench.settings()?;
    power_on(bench);
    let begun = bench.now();
    // Skips the telemetry from before the power cut.
    bench.run(100 * MS)?;
    let from = bench.link.telemetry.len();
    bench.run_until("the outputs on", WOULD_BE_ON - 200 * MS, |bench| {
        bench.is_on()
    })?;
    armed_by_itself(bench)?;
    let ms = (bench.now() - begun) / MS;
    bench.run(250 * MS)?;
    let torque = bench.machine.chip().board.press_n_m;
    let counts = f64::from(settings.encoder.counts_per_rev);
    let surface = number(settings.wall.surface_rad);
    let stiffness = number(settings.wall.k_desired_n_m_per_rad);
    bench.press_at(&MEDIUM, torque, 0.6, 0.8, surface, counts, stiffness)?;
    // Longer than the allowed silence of the desktop.
    bench.run(2_200 * MS)?;
    if !bench.is_on() {
        return Err("off again, with nobody there".into());
    }
    let board = board_named(bench.machine.chip().board.name)?;
    let records = told(bench, from)?;
    let armed: Vec<_> = records
        .into_iter()
        .filter(|record| record.phase == Phase::Armed)
        .collect();
    let ticks = compare(&settings, board, &armed)?;
    let force = armed
        .iter()
        .map(|record| record.force_n_m.to_num())
        .fold(0.0, f64::max);
    if force < 0.8 * torque {
        return Err(format!("{force:.3} N·m of {torque}"));
    }
    // A desktop connects, then its cable is pulled.
    let status = bench.status()?;
    let started = report(bench)?;
    if status.phase != Phase::Armed || started.self_start != SelfStart::Started {
        return Err(format!("{} and {started:?}", status.phase.name()));
    }
    let spoken = bench.now();
    bench.run_until("the outputs off", 700 * MS, |bench| !bench.is_on())?;
    let silent = (bench.now() - spoken) / MS;
    match bench.fault()?.and_then(|fault| fault.known()) {
        Some(FaultCode::HostSilent) => Ok(format!(
            "armed after {ms} ms; {ticks} ticks equal to the bit, {force:.3} N·m; off {silent} ms after a desktop's last word"
        )),
        other => Err(format!("{other:?} instead of HostSilent")),
    }
}

fn stops(bench: &mut Bench) -> Result<String, String> {
    power_on(bench);
    bench.run(100 * MS)?;
    armed_by_itself(bench)?;
    let stop = Trouble::StopPressed(0);
    stop.inject(bench)?;
    bench.run(2 * MS)?;
    let is_on = bench.is_on();
    stop.remove(bench);
    if is_on {
        return Err("the outputs stay on".into());
    }
    is_off_for(bench, WOULD_BE_ON)?;
    match bench.fault()?.and_then(|fault| fault.known()) {
        Some(FaultCode::StopButton) => Ok("off, with nobody there, and no second try".into()),
        other => Err(format!("{other:?} instead of StopButton")),
    }
}

/// Checks that the outputs stay off for `time`, in processor cycles.
fn is_off_for(bench: &mut Bench, time: u64) -> Result<(), String> {
    let begun = bench.now();
    bench.run(time)?;
    let changes = &bench.machine.chip().bridge.changes;
    match changes.iter().any(|(at, on)| *at >= begun && *on) {
        true => Err("the outputs went on".into()),
        false => Ok(()),
    }
}

/// Checks that the outputs stay off for `time`, in processor cycles, and that the device reports the reason `because`.
fn stays_off(bench: &mut Bench, time: u64, because: SelfStart) -> Result<String, String> {
    is_off_for(bench, time)?;
    match report(bench)?.self_start {
        told if told == because => Ok(told.words().into()),
        told => Err(format!("{told:?} instead of {because:?}")),
    }
}

fn reset(bench: &mut Bench, cause: ResetCause, because: SelfStart) -> Result<String, String> {
    power_on(bench);
    bench.run(100 * MS)?;
    bench.machine.reset(cause);
    stays_off(bench, WOULD_BE_ON, because)
}

/// Checks that the device tries an automatic start only once: after its alignment check has failed, the outputs stay off.
fn tries_once(bench: &mut Bench) -> Result<String, String> {
    bench.run_until("the outputs on", WOULD_BE_ON, |bench| bench.is_on())?;
    bench.run_until("the outputs off", WOULD_BE_ARMED, |bench| !bench.is_on())?;
    is_off_for(bench, 2 * WOULD_BE_ON)?;
    let why = why(bench.fault()?)?;
    match report(bench)?.self_start {
        SelfStart::Faulted => Ok(format!("one try, {why:?}")),
        other => Err(format!("{other:?}")),
    }
}
