//! Tests in which the supply fails: at each change of the flash during a save, twice in a row, and in every state with the outputs
//! on or off.
//!
//! After each failure the device must start with all of the old saved settings or all of the new ones. Its outputs must stay off
//! until the computer requests them.

use touchstone_control::Si;
use touchstone_protocol::settings::DeviceSettings;
use touchstone_protocol::{DeviceCommand, Phase, Request};
use touchstone_world::plant::MEDIUM;

use super::storage::{changed, restart};
use super::tally::Tally;
use crate::bench::{Bench, MS, Setup, US};
use crate::cpu::elf::Program;
use crate::machine::Halt;

/// An upper bound of the number of flash changes (words programmed, pages erased) in one save of the settings.
const MOST_CHANGES: u64 = 400;
/// On boards other than the reference board, the tests cut the supply only at every n-th flash change (a word programmed, a page
/// erased). This constant is n. [`SAMPLED_MOMENTS`] is the same for the device's states.
const SAMPLED_CHANGES: u64 = 5;
const SAMPLED_MOMENTS: usize = 3;
/// Time in processor cycles for which the supply is absent. By its end the motor's current is zero; the knob may still be moving.
const AWAY: u64 = 200 * MS;
/// Stiffness that was saved last, N·m/rad. [`UNSAVED`] is the stiffness in use, which was not saved.
const SAVED: Si = Si::lit("1.25");
const UNSAVED: Si = Si::lit("0.75");

/// Whether all supply tests run on this board. On the other boards only a part runs, because their programs differ only in pins.
fn is_reference(setup: &Setup) -> bool {
    setup.board.name == "nucleo-g474re-ihm16m1"
}

/// Tests that cut the supply at single changes of the flash (a word programmed, a page erased) while settings are saved, and once
/// more in the save after the restart.
pub fn power_cuts(program: &Program, setup: &Setup, tally: &mut Tally) {
    let every = match is_reference(setup) {
        true => 1,
        false => SAMPLED_CHANGES,
    };
    tally.check(
        "power cuts at writes to flash",
        in_a_save(program, setup, every).map(|cuts| {
            format!(
                "{cuts} cuts, at one in {every} of a Save's changes: the old or the new settings, each time"
            )
        }),
    );
    tally.check(
        "power cut in a save, and in the save after it",
        cut_twice(program, setup)
            .map(|cuts| format!("{cuts} pairs of cuts: the old or the new settings")),
    );
}

/// Checks that the outputs go on after the command to calibrate, and that the device accepts the command to stop.
fn starts(bench: &mut Bench) -> Result<(), String> {
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    let on = bench.run_until("the outputs on", 200 * MS, |bench| bench.is_on());
    let status = bench.status()?;
    on.map_err(|error| format!("{error}: {} with {:?}", status.phase.name(), status.fault))?;
    bench
        .demand(Request::Command(DeviceCommand::Stop))
        .map(|_| ())
}

/// Checks the device after a restart: the outputs have stayed off since `since`, no fault is latched, arming is refused, and the
/// settings are one of `may_be`.
fn came_up(bench: &mut Bench, since: u64, may_be: &[&DeviceSettings]) -> Result<(), String> {
    let status = bench.status()?;
    if status.phase != Phase::Boot {
        return Err(format!("{} with {:?}", status.phase.name(), status.fault));
    }
    if bench.command(DeviceCommand::Arm)? {
        return Err("arms without a calibration".into());
    }
    bench.run(20 * MS)?;
    let changes = &bench.machine.chip().bridge.changes;
    if bench.is_on() || changes.iter().any(|(time, on)| *time > since && *on) {
        return Err("the outputs went on by themselves".into());
    }
    let settings = bench.settings()?;
    match may_be.contains(&&settings) {
        true => Ok(()),
        false => Err(format!(
            "neither the old nor the new settings: k_desired is {}",
            settings.wall.k_desired_n_m_per_rad
        )),
    }
}

/// Saves the settings and cuts the supply at flash change number `cut`, counted from the next change. Returns whether the cut
/// happened.
fn saves_until(bench: &mut Bench, cut: u64) -> Result<bool, String> {
    let flash = &mut bench.machine.chip_mut().flash;
    flash.cut_at = Some(flash.count + cut);
    let saved = bench.demand(Request::Save);
    bench.machine.chip_mut().flash.cut_at = None;
    match (saved, bench.halted.take()) {
        // The save made all its changes before the cut.
        (Ok(_), None) => Ok(false),
        (Err(_), Some(Halt::PowerCut)) => Ok(true),
        (Err(error), _) => Err(error),
        (Ok(_), Some(halt)) => Err(format!("{halt:?}")),
    }
}

/// Saves settings that differ from the defaults and from all earlier saves, and returns them.
fn saved(bench: &mut Bench, turn: usize) -> Result<DeviceSettings, String> {
    changed(bench, SAVED + Si::lit("0.01") * turn as i64)?;
    bench.demand(Request::Save)?;
    bench.settings()
}

/// Cuts the supply at flash changes `0`, `every`, `2 every` and so on, each in a save of its own, until the save has no further
/// change. Returns the number of cuts. After each cut the device must accept and keep further settings.
fn in_a_save(program: &Program, setup: &Setup, every: u64) -> Result<usize, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    for (cuts, cut) in (0..MOST_CHANGES).step_by(every as usize).enumerate() {
        let said = |error: String| format!("cut at change {cut}: {error}");
        let old = saved(&mut bench, cuts).map_err(said)?;
        // This save has read the page that the cut before it tore, while interrupts were enabled.
        starts(&mut bench).map_err(|error| said(format!("after a save: {error}")))?;
        changed(&mut bench, UNSAVED).map_err(said)?;
        let new = bench.settings()?;
        if !saves_until(&mut bench, cut).map_err(said)? {
            return Ok(cuts);
        }
        let since = bench.now();
        restart(&mut bench).map_err(said)?;
        came_up(&mut bench, since, &[&old, &new]).map_err(said)?;
        // A torn word raises an interrupt and the system break when it is read. The device must have handled it by now.
        starts(&mut bench).map_err(said)?;
        bench.machine.guard_torn();
    }
    Err(format!("a save of more than {MOST_CHANGES} changes"))
}

/// Cuts the supply in a save of the settings, and again in the save after the restart, at several changes of the flash in each
/// save.
fn cut_twice(program: &Program, setup: &Setup) -> Result<usize, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    let mut pairs = 0;
    for first in [0, 1, 7, 30] {
        for second in [0, 2, 19] {
            let said = |error: String| format!("cuts at changes {first} and {second}: {error}");
            let old = saved(&mut bench, pairs).map_err(said)?;
            changed(&mut bench, UNSAVED).map_err(said)?;
            let new = bench.settings()?;
            for cut in [first, second] {
                if !saves_until(&mut bench, cut).map_err(said)? {
                    return Err(said("there are fewer changes".into()));
                }
                let since = bench.now();
                restart(&mut bench).map_err(said)?;
                came_up(&mut bench, since, &[&old, &new]).map_err(said)?;
                changed(&mut bench, UNSAVED).map_err(said)?;
            }
            pairs += 1;
        }
    }
    Ok(pairs)
}

/// State of the device in which a test cuts the supply.
#[derive(Debug, Clone, Copy)]
enum Moment {
    /// Started, with no request from the computer since.
    Booted,
    /// This many milliseconds after the command to calibrate.
    Calibrating(u64),
    /// Calibrated, with the outputs off.
    Ready,
    /// Armed, with no hand at the knob.
    Free,
    /// Armed while a hand presses into the wall; the cut comes this many microseconds after the start of a control period.
    Pressed(u64),
    /// Outputs switched off by the command to stop.
    Stopped,
    /// Outputs switched off by a fault.
    Fault,
}

/// All states in which the supply is cut. Five of them are in a calibration: while the current sensors' offsets are measured, while
/// the field is switched on, and while it turns.
const MOMENTS: [Moment; 12] = [
    Moment::Booted,
    Moment::Calibrating(5),
    Moment::Calibrating(60),
    Moment::Calibrating(300),
    Moment::Calibrating(900),
    Moment::Calibrating(2_000),
    Moment::Ready,
    Moment::Free,
    Moment::Pressed(3),
    Moment::Pressed(611),
    Moment::Stopped,
    Moment::Fault,
];

/// Tests that the device is safe if its supply is cut in each state.
pub fn supply_cut(program: &Program, setup: &Setup, tally: &mut Tally) {
    let cut = || -> Result<String, String> {
        let mut bench = Bench::new(program, setup)?;
        bench.boot()?;
        let (kind, turns) = (setup.board.encoder.kind(), setup.board.field_turns_per_s);
        bench.configure(|settings| {
            settings.encoder.kind = kind;
            settings.calibration.electrical_turns_per_s = turns;
            settings.wall.surface_rad = Si::lit("0.2");
        })?;
        let every = if is_reference(setup) {
            1
        } else {
            SAMPLED_MOMENTS
        };
        let moments = MOMENTS.iter().skip(every - 1).step_by(every);
        for (turn, moment) in moments.clone().copied().enumerate() {
            let said = |error: String| format!("{moment:?}: {error}");
            let old = saved(&mut bench, turn).map_err(said)?;
            changed(&mut bench, UNSAVED).map_err(said)?;
            let conducted = come_to(&mut bench, moment).map_err(said)?;
            goes_away(&mut bench, conducted).map_err(said)?;
            let since = bench.now();
            restart(&mut bench).map_err(said)?;
            // The unsaved settings are lost.
            came_up(&mut bench, since, &[&old]).map_err(said)?;
            starts(&mut bench).map_err(said)?;
            // The next calibration needs a rotor at rest.
            bench.run(500 * MS)?;
        }
        Ok(format!(
            "in {} moments: the saved settings, the outputs off",
            MOMENTS.len()
        ))
    };
    tally.check("supply cut", cut());
}

/// Brings the device to a state. Returns whether the outputs are on in that state.
fn come_to(bench: &mut Bench, moment: Moment) -> Result<bool, String> {
    let calibrate = Request::Command(DeviceCommand::Calibrate);
    match moment {
        Moment::Booted => Ok(false),
        Moment::Calibrating(ms) => {
            bench.demand(calibrate)?;
            bench.run(ms * MS)?;
            match bench.status()?.phase {
                Phase::Calibrating => Ok(bench.is_on()),
                other => Err(format!("{} instead of calibrating", other.name())),
            }
        }
        Moment::Ready => bench.calibrate().map(|()| false),
        Moment::Free => bench.arm().map(|()| true),
        Moment::Pressed(us) => {
            bench.arm()?;
            bench.run(250 * MS)?;
            let torque = bench.machine.chip().board.press_n_m;
            bench.press(&MEDIUM, torque, 0.3, 1.0)?;
            bench.run(700 * MS + us * US)?;
            let record = bench.link.telemetry.last().ok_or("no telemetry")?;
            match record.force_n_m > 0 {
                true => Ok(true),
                false => Err("nothing pushes back".into()),
            }
        }
        Moment::Stopped => {
            bench.calibrate()?;
            bench.demand(Request::Command(DeviceCommand::Stop))?;
            Ok(false)
        }
        Moment::Fault => {
            bench.calibrate()?;
            let volts = bench.machine.chip().board.supply_v;
            bench.machine.chip_mut().world.bridge.bus_v = 2.0 * volts;
            bench.wait_for(Phase::Fault, 50 * MS)?;
            bench.machine.chip_mut().world.bridge.bus_v = volts;
            Ok(false)
        }
    }
}

/// Cuts the supply, and checks that no transistor conducts any more and that the motor's currents end.
fn goes_away(bench: &mut Bench, conducted: bool) -> Result<(), String> {
    if bench.is_on() != conducted {
        return Err(format!("the outputs were on: {}", bench.is_on()));
    }
    bench.machine.power_off();
    if bench.is_on() {
        return Err("the outputs are on without a supply".into());
    }
    bench.run(AWAY)?;
    let now = bench.now();
    let world = &mut bench.machine.chip_mut().world;
    world.advance(now);
    let largest = (0..3).map(|phase| world.current_a(phase).abs());
    let largest = largest.fold(0.0, f64::max);
    bench.release();
    match largest < 0.05 {
        true => Ok(()),
        false => Err(format!("{largest:.2} A without a supply")),
    }
}
