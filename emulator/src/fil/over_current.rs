//! Over-current by the chip's comparators, where they protect the bridge. A motor's wire is shorted, and the current
//! at which the break comes is checked.
//!
//! That current follows from what the program has written (a DAC's code, the comparators' inputs, their polarity) and
//! from the shunts, [`crate::chip::comparators`]; the wanted one is stated here.

use touchstone_protocol::{DeviceCommand, FaultCode, Phase, Request};

use super::tally::Tally;
use crate::bench::{Bench, MS, Setup, US};
use crate::cpu::elf::Program;
use crate::world::{Short, Touched};

/// What switches off without the processor (docs/faults/08-hardware-break.md), A out of the motor.
const SWITCHES_OFF_A: f64 = 30.0;
/// A step of the DAC at a shunt's pin: 3.3 V / 4,096 over 4/7 of 3 mV/A, A. The threshold is one of its codes.
const STEP_A: f64 = 3.3 / 4_096.0 / (0.003 * 4.0 / 7.0);
/// A short at the motor: that of its leads, H. With 24 V the current rises by 6 A/us, so that it is there before the next sample.
const LEADS_H: f64 = 4e-6;
/// Supply, wires and transistor, Ω.
const WAY_OHM: f64 = 0.05;
/// From a look at the short to the next one, us: ten cycles, as a division takes them in one instruction.
const LOOK_US: f64 = 12.0 / 170.0;
/// Eight samples of every 32nd cycle in which the comparator must say the same (docs/faults/08-hardware-break.md), us.
const FILTER_US: f64 = 8.0 * 32.0 / 170.0;
/// The current loop takes a PWM period to the next sample, and a part of one to act.
const SOFTWARE: u64 = 100 * US;
/// Time during which the outputs must stay off.
const WATCHED: u64 = 30 * MS;

/// What each phase's comparator is, counted from 0: COMP1, COMP2, COMP4.
const COMPARATORS: [usize; 3] = [0, 1, 3];

/// Shorts of every kind, on a board whose shunts go to comparators.
pub fn over_current(program: &Program, setup: &Setup, tally: &mut Tally) {
    if setup.board.shunts.is_empty() {
        return;
    }
    let mut bench = match Bench::new(program, setup) {
        Ok(bench) => bench,
        Err(error) => return tally.check("over-current by the comparators", Err(error)),
    };
    let name = |what: &str| format!("over-current by the comparators, {what}");
    for (phase, letter) in ['A', 'B', 'C'].into_iter().enumerate() {
        let found = to_supply(&mut bench, phase);
        let what = format!("phase {letter} shorted to the supply");
        tally.check(&name(&what), found);
    }
    tally.check(
        &name("phase B shorted to the supply, up to a DAC's step less than it takes"),
        just_below(&mut bench),
    );
    tally.check(&name("phase A shorted to ground"), to_ground(&mut bench));
    tally.ran(&bench);
}

/// Armed, with nothing short.
fn armed(bench: &mut Bench) -> Result<(), String> {
    if bench.link.bytes == 0 {
        bench.boot()?;
    } else {
        bench.demand(Request::Command(DeviceCommand::Stop))?;
    }
    no_break(bench)?;
    let turns = bench.machine.chip().board.field_turns_per_s;
    bench.configure(|settings| {
        settings.calibration.electrical_turns_per_s = turns;
        // A person calibrates once; here it is every few seconds.
        settings.motor.continuous_current_a = settings.calibration.current_a;
    })?;
    // A break that is there already refuses it, and is asked for next.
    let _ = bench.command(DeviceCommand::Calibrate)?;
    while no_break(bench)? == Phase::Calibrating {
        bench.run(20 * MS)?;
    }
    bench.demand(Request::Command(DeviceCommand::Arm))?;
    bench.wait_for(Phase::Armed, 100 * MS)?;
    bench.run(250 * MS)
}

/// Where the device stands, with no break that comes of itself.
fn no_break(bench: &mut Bench) -> Result<Phase, String> {
    let status = bench.status()?;
    match status.fault.and_then(|fault| fault.known()) {
        Some(FaultCode::HardwareBreak) => {
            Err("the comparators pull the break with no current".into())
        }
        Some(other) => Err(format!("{other:?} with nothing short")),
        None => Ok(status.phase),
    }
}

/// Result of a short circuit.
struct Found {
    /// The comparator that saw it, and the current in its shunt then, A.
    seen: Option<(usize, f64)>,
    /// From that moment, or from the short where no comparator saw it, to the outputs off, us.
    off_us: f64,
    /// Largest current in the short, A.
    largest_a: f64,
    code: Option<FaultCode>,
}

/// A short of an armed device, until it is latched.
fn short(
    bench: &mut Bench,
    phase: usize,
    touched: Touched,
    ohm: f64,
    henry: f64,
) -> Result<Found, String> {
    armed(bench)?;
    let begin = bench.now();
    let chip = bench.machine.chip_mut();
    chip.comparators.risen.clear();
    chip.world.short = Some(Short::new(phase, touched, ohm, henry, begin));
    let mut largest_a: f64 = 0.0;
    while bench.now() < begin + SOFTWARE {
        bench.run(US)?;
        let current_a = bench.machine.chip().world.leg_a(phase);
        largest_a = largest_a.max(current_a.abs());
    }
    bench.run(WATCHED)?;
    let chip = bench.machine.chip_mut();
    chip.world.short = None;
    let changes = chip.bridge.changes.iter().filter(|(at, _)| *at >= begin);
    let changes: Vec<_> = changes.copied().collect();
    let risen = chip.comparators.risen.first().copied();
    let [(off, false)] = changes[..] else {
        return Err(format!("on and off: {changes:?}"));
    };
    let from = risen.map_or(begin, |(at, ..)| at);
    Ok(Found {
        seen: risen.map(|(_, comparator, amps)| (comparator, amps)),
        off_us: (off as f64 - from as f64) / US as f64,
        largest_a,
        code: bench.fault()?.and_then(|fault| fault.known()),
    })
}

/// A current out of the motor through a lower transistor trips its phase's comparator, at once and at the promised
/// current.
fn to_supply(bench: &mut Bench, phase: usize) -> Result<String, String> {
    let found = short(bench, phase, Touched::Supply, WAY_OHM, LEADS_H)?;
    let bus_v = bench.machine.chip().board.supply_v;
    let slope = bus_v / LEADS_H * 1e-6;
    let Some((comparator, amps)) = found.seen else {
        return Err(format!(
            "no comparator saw {:.1} A; {:?}",
            found.largest_a, found.code
        ));
    };
    if comparator != COMPARATORS[phase] {
        return Err(format!("COMP{} saw it", comparator + 1));
    }
    let late = amps - SWITCHES_OFF_A;
    if !(-STEP_A..=STEP_A + slope * LOOK_US).contains(&late) {
        return Err(format!("it comes at {amps:.2} A"));
    }
    let filtered = FILTER_US..=FILTER_US + LOOK_US;
    match (found.off_us, found.code) {
        (us, Some(FaultCode::HardwareBreak)) if filtered.contains(&us) => Ok(format!(
            "COMP{} at {amps:.2} A out of the motor, the outputs off {us:.2} us later, at {:.1} A",
            comparator + 1,
            amps + slope * us
        )),
        (us, code) => Err(format!("off {us:.2} us later with {code:?}")),
    }
}

/// A current that ends just below the comparators' threshold does not trip them; the current loop acts on it.
fn just_below(bench: &mut Bench) -> Result<String, String> {
    let bus_v = bench.machine.chip().board.supply_v;
    let amps = SWITCHES_OFF_A - STEP_A;
    // The resistance ends it there; within a microsecond it is.
    let found = short(bench, 1, Touched::Supply, bus_v / amps, 1e-7)?;
    match (found.seen, found.code) {
        (None, Some(FaultCode::OverCurrent)) if found.largest_a > 0.99 * amps => Ok(format!(
            "{:.2} A: no comparator, and the current loop after {:.0} us",
            found.largest_a, found.off_us
        )),
        (seen, code) => Err(format!("{seen:?} and {code:?} at {:.2} A", found.largest_a)),
    }
}

/// A current into the motor comes through the upper transistor past the shunts, and through the lower one the other way: no comparator may
/// see it, and the current loop's next sample does.
fn to_ground(bench: &mut Bench) -> Result<String, String> {
    let found = short(bench, 0, Touched::Ground, WAY_OHM, LEADS_H)?;
    match (found.seen, found.code) {
        (None, Some(FaultCode::OverCurrent)) if found.off_us * (US as f64) <= SOFTWARE as f64 => {
            Ok(format!(
                "no comparator sees what is drawn through the upper transistor; the current loop switches off after {:.0} us, at {:.0} A",
                found.off_us, found.largest_a
            ))
        }
        (seen, code) => Err(format!(
            "{seen:?} and {code:?} after {:.0} us",
            found.off_us
        )),
    }
}
