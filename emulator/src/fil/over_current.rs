//! Tests of the over-current protection by the chip's comparators, on boards where they protect the bridge. The tests short a wire
//! of the motor and check the current at which the break switches the outputs off.
//!
//! That current follows from what the program has written (DAC code, comparator inputs and polarity) and from the shunts; see
//! [`crate::chip::comparators`]. The required current is stated in this module.

use touchstone_protocol::{DeviceCommand, FaultCode, Phase, Request};

use super::tally::Tally;
use crate::bench::{Bench, MS, Setup, US};
use crate::cpu::elf::Program;
use crate::world::{Short, Touched};

/// Current out of the motor, in amperes, at which the hardware switches off without the processor
/// (docs/faults/08-hardware-break.md).
const SWITCHES_OFF_A: f64 = 30.0;
/// Current per DAC code in amperes: 3.3 V / 4,096 over 4/7 of the shunt's 3 mV/A. The comparators' threshold is a whole number of
/// codes.
const STEP_A: f64 = 3.3 / 4_096.0 / (0.003 * 4.0 / 7.0);
/// Inductance of a short circuit at the motor in henry: that of its leads. At 24 V the current rises by 6 A/us, so the comparators
/// act before the next sample.
const LEADS_H: f64 = 4e-6;
/// Resistance of supply, wires and transistor in the short, Ω.
const WAY_OHM: f64 = 0.05;
/// Longest time between two evaluations of the short circuit, in microseconds. The emulator evaluates it once per instruction, and
/// the longest instruction, a division, takes 12 cycles.
const LOOK_US: f64 = 12.0 / 170.0;
/// Duration in microseconds for which a comparator must stay active before the break acts: eight samples, one per 32 cycles
/// (docs/faults/08-hardware-break.md).
const FILTER_US: f64 = 8.0 * 32.0 / 170.0;
/// Longest time for the current loop to switch off, in processor cycles: one PWM period until the next sample, and a part of a
/// period until it acts.
const SOFTWARE: u64 = 100 * US;
/// Time for which the outputs must stay off after a break, in processor cycles.
const WATCHED: u64 = 30 * MS;

/// Comparator of each phase, counted from 0: COMP1, COMP2, COMP4.
const COMPARATORS: [usize; 3] = [0, 1, 3];

/// Tests all short circuits, on a board whose shunts are connected to comparators.
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

/// Brings the device into the armed state, without a short circuit.
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
        // The test calibrates every few seconds, so the settings allow the calibration's current for ever.
        settings.motor.continuous_current_a = settings.calibration.current_a;
    })?;
    // The answer is ignored: if a break is active, the device refuses the calibration, and `no_break` below reports the break.
    let _ = bench.command(DeviceCommand::Calibrate)?;
    while no_break(bench)? == Phase::Calibrating {
        bench.run(20 * MS)?;
    }
    bench.demand(Request::Command(DeviceCommand::Arm))?;
    bench.wait_for(Phase::Armed, 100 * MS)?;
    bench.run(250 * MS)
}

/// The device's phase. Errors: the device has latched a fault, although the test has made no short circuit.
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

/// What happened in a short circuit.
struct Found {
    /// The comparator that acted, and the current in its shunt at that moment, A. `None` where no comparator acted.
    seen: Option<(usize, f64)>,
    /// Time in microseconds until the outputs were off, counted from the moment at which a comparator acted, or from the short
    /// circuit where none did.
    off_us: f64,
    /// Largest current in the short circuit, A.
    largest_a: f64,
    code: Option<FaultCode>,
}

/// Short-circuits a motor phase of the armed device until the outputs are off, and returns what happened.
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

/// Checks that a current out of the motor through a lower transistor trips the phase's comparator without delay, at the required
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

/// Checks that a current just below the comparators' threshold does not trip them, and that the current loop switches off instead.
fn just_below(bench: &mut Bench) -> Result<String, String> {
    let bus_v = bench.machine.chip().board.supply_v;
    let amps = SWITCHES_OFF_A - STEP_A;
    // The resistance of the short circuit limits its current to `amps`. The current reaches this value within a microsecond.
    let found = short(bench, 1, Touched::Supply, bus_v / amps, 1e-7)?;
    match (found.seen, found.code) {
        (None, Some(FaultCode::OverCurrent)) if found.largest_a > 0.99 * amps => Ok(format!(
            "{:.2} A: no comparator, and the current loop after {:.0} us",
            found.largest_a, found.off_us
        )),
        (seen, code) => Err(format!("{seen:?} and {code:?} at {:.2} A", found.largest_a)),
    }
}

/// Checks that no comparator acts on a current into the motor, and that the current loop switches off after its next sample. Such a
/// current bypasses the shunt in the upper transistor, and flows the other way in the lower one.
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
