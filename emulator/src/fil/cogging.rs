//! Tests of the map that compensates a motor's cogging torque. The map is measured over the serial line as `touchstone device
//! cogging measure` does, computed by the code that runs on the computer, stored in flash and applied. The reference is the true
//! cogging of the simulated motor, which the device does not know.

#[path = "../../../host-sim/lab/src/identify/cogging.rs"]
mod identify;

use nalgebra::Complex;
use touchstone_control::Si;
use touchstone_drive::cogging::SHARE;
use touchstone_protocol::settings::cogging::CURRENT_BITS;
use touchstone_protocol::{
    CoggingMap, CoggingReport, DeviceCommand, DeviceSettings, MeasuringPart, Phase, Reply, Request,
    Sweep, Unkept,
};
use touchstone_world::motor::MotorParameters;
use touchstone_world::plant::train::Harmonic;

use self::identify::{KnownKnob, MeasuredCogging, SweepTick, Swept};
use super::press::board_named;
use super::slow_turn::{Felt, slow_turn};
use super::starts::power_on;
use super::tally::Tally;
use crate::bench::{Bench, MS, Setup, number};
use crate::cpu::elf::Program;

/// Longest time in processor cycles for a calibration and a cogging sweep. The calibration turns the field by four electrical turns
/// per second; the sweep is two and a quarter turns each way at a quarter of a turn per second.
const SWEPT: u64 = 40_000 * MS;
/// Shaft speed in rad/s at which a wrong or refused cogging map is tested.
const SLOW: f64 = 2.0;
/// Shaft speeds in rad/s at which the ripple is measured with and without the cogging map.
const SPEEDS: [f64; 4] = [SLOW, -SLOW, 5.0, 10.0];
/// Largest fraction of the cogging torque that may remain with the cogging map, at each speed in [`SPEEDS`].
const LEFT_MOST: [f64; 4] = [0.3, 0.3, 0.4, 0.6];
/// Largest relative deviation of the measured ripple from the cogging torque while no cogging map is applied.
const ALL: f64 = 0.01;
/// Largest fraction of the shaft's ripple that may remain in a sweep with the cogging map. `touchstone device cogging` accepts up
/// to 0.7.
const RIPPLE_LEFT_MOST: f64 = 0.5;

const fn part(amplitude: f64, per_rev: f64, phase: f64) -> Harmonic {
    Harmonic {
        amplitude,
        per_rev,
        phase,
    }
}

/// Cogging torque of a motor with 12 slots and 14 poles, 0.77 mN·m rms in total. The components have 84 periods per turn (the least
/// common multiple of slots and poles), 168, and 12 and 14 due to unequal slots and magnets. For comparison, the wall may push with
/// 45 mN·m.
pub(super) const COGGING: [Harmonic; 4] = [
    part(1e-3, 84.0, 0.4),
    part(2e-4, 168.0, 2.0),
    part(3e-4, 12.0, -1.0),
    part(2.5e-4, 14.0, 3.0),
];

/// Largest error of a cogging map at each number of periods per turn: relative error of the amplitude, and error of the phase in
/// degrees.
type Off = [(f64, f64); COGGING.len()];
/// Largest errors of the measured cogging map if the configured inertia is a third above the knob's. At 168 periods per turn, 42 Hz
/// in the sweep, nearly all of the measured torque is due to the inertia, so the largest error is allowed there.
const OFF_MOST: Off = [(0.15, 3.0), (0.4, 20.0), (0.05, 3.0), (0.05, 3.0)];
/// Largest errors of the measured cogging map if the configured inertia is that of the knob.
const OFF_MOST_KNOWN: Off = [(0.05, 3.0), (0.15, 20.0), (0.05, 3.0), (0.05, 3.0)];
/// Largest torque of the cogging map at numbers of periods per turn at which the motor has no cogging, N·m rms.
const STRANGE_MOST_N_M: f64 = 1e-4;

/// Tests on the reference board that the cogging map is measured, applied, stored and, where it does not fit, refused.
pub fn cogging(program: &Program, setup: &Setup, tally: &mut Tally) {
    if setup.board.name != "nucleo-g474re-ihm16m1" {
        return;
    }
    let mut bench = match prepared(program, setup) {
        Ok(bench) => bench,
        Err(error) => return tally.check("cogging", Err(error)),
    };
    if let Err(error) = rows(&mut bench, setup, tally) {
        tally.check("cogging", Err(error));
    }
    tally.ran(&bench);
}

/// Runs the tests and adds their results to the tally. The first failure ends the remaining tests.
fn rows(bench: &mut Bench, setup: &Setup, tally: &mut Tally) -> Result<(), String> {
    let motor = setup.parts.motor;
    let bare = swept(bench, Sweep::Bare)?;
    let (swept_bare, found) = bare.map()?;
    let off = beside(&found, &motor, &OFF_MOST);
    tally.check("cogging, the map beside the motor's", off);
    let known = Told {
        known: KnownKnob {
            inertia_kg_m2: setup.parts.knob.inertia,
            ..bare.known
        },
        ..bare
    };
    let off = beside(&known.map()?.1, &motor, &OFF_MOST_KNOWN);
    tally.check("cogging, the same with the knob's own inertia", off);

    let map = found.map;
    let without = turns(bench)?;
    bench.demand(Request::KeepCogging(map.clone()))?;
    let with = turns(bench)?;
    tally.check("cogging, what is felt with the map", felt(&without, &with));
    bench.demand(Request::KeepCogging(half_a_period_off(&map)))?;
    let wrong = slow_turn(bench, SLOW)?.left();
    tally.check(
        "cogging, what is felt with a map half a period off",
        match wrong > 1.5 {
            true => Ok(format!("{wrong:.2} of the cogging")),
            false => Err(format!("only {wrong:.2} of the cogging")),
        },
    );

    bench.demand(Request::KeepCogging(map.clone()))?;
    bench.demand(Request::Command(DeviceCommand::Stop))?;
    let (after, _) = swept(bench, Sweep::Compensated)?.swept()?;
    let left = after.ripple_rad(&map) / swept_bare.ripple_rad(&map);
    tally.check(
        "cogging, the shaft's ripple in a sweep with the map",
        match left < RIPPLE_LEFT_MOST {
            true => Ok(format!("{left:.2} of what it is without")),
            false => Err(format!("{left:.2} of what it is without")),
        },
    );
    bench.demand(Request::Command(DeviceCommand::Stop))?;
    bench.demand(Request::Save)?;

    let reversed = refused(bench, Unkept::OtherEncoder, |settings| {
        settings.encoder.reversed = true;
    });
    tally.check(
        "cogging, not played with the encoder counted the other way",
        reversed,
    );
    bench.machine.chip_mut().world.mount(MotorParameters {
        pole_pairs: 11,
        // The torque constant stays the same.
        flux_linkage_wb: motor.flux_linkage_wb * f64::from(motor.pole_pairs) / 11.0,
        ..motor
    });
    let other = refused(bench, Unkept::OtherPolePairs, |settings| {
        settings.encoder.reversed = false;
        settings.motor.pole_pairs = 11;
    });
    tally.check("cogging, not played with another motor's pole pairs", other);
    bench.machine.chip_mut().world.mount(motor);
    tally.check(
        "cogging, the map after the power was off",
        kept(bench, &map),
    );
    Ok(())
}

/// A device with an absolute encoder, whose motor has cogging torque.
fn prepared(program: &Program, setup: &Setup) -> Result<Bench, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.machine.chip_mut().world.cogging = COGGING.to_vec();
    bench.boot()?;
    let kind = setup.board.encoder.kind();
    bench.configure(|settings| {
        settings.encoder.kind = kind;
        settings.calibration.electrical_turns_per_s = setup.board.field_turns_per_s;
        // The wall is far away.
        settings.wall.surface_rad = Si::lit("90");
        // The calibration's current may be held for ever, because this test is not about heating.
        settings.motor.continuous_current_a = settings.calibration.current_a;
    })?;
    bench.demand(Request::Telemetry { decimation: 1 })?;
    Ok(bench)
}

fn report(bench: &mut Bench) -> Result<CoggingReport, String> {
    match bench.demand(Request::Cogging)? {
        Reply::Cogging(report) => Ok(report),
        other => Err(format!("not what is kept: {other:?}")),
    }
}

/// Telemetry of a cogging sweep, and the knob's parameters that the computer takes as given.
struct Told {
    ticks: Vec<SweepTick>,
    known: KnownKnob,
}

impl Told {
    fn swept(&self) -> Result<(Swept, &KnownKnob), String> {
        let swept = Swept::new(&self.ticks, &self.known).map_err(|why| why.to_string())?;
        Ok((swept, &self.known))
    }

    fn map(&self) -> Result<(Swept, MeasuredCogging), String> {
        let (swept, known) = self.swept()?;
        let found = swept.map(known).map_err(|why| why.to_string())?;
        Ok((swept, found))
    }
}

/// Sends the requests of `touchstone device cogging`: brings the device from stopped through the sweep to ready. Returns the
/// telemetry.
fn swept(bench: &mut Bench, sweep: Sweep) -> Result<Told, String> {
    let from = bench.link.telemetry.len();
    bench.demand(Request::Sweep(sweep))?;
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    bench.wait_for(Phase::Ready, SWEPT)?;
    let against = report(bench)?.against.ok_or("the calibration is gone")?;
    let settings = bench.settings()?;
    let known = KnownKnob {
        rate_hz: settings.timing.rate_hz.into(),
        counts_per_rev: settings.encoder.counts_per_rev.into(),
        torque_constant_n_m_per_a: number(settings.motor.torque_constant_n_m_per_a),
        inertia_kg_m2: number(settings.law.estimator.inertia_kg_m2),
        against,
        most_a: number(settings.motor.current_limit_a) / f64::from(SHARE),
    };
    let told = bench.link.telemetry[from..].iter().filter_map(|record| {
        let part = record.measuring?.part;
        let is_swept = matches!(part, MeasuringPart::Forward | MeasuringPart::Backward);
        is_swept.then(|| SweepTick {
            tick: record.tick,
            part,
            count: record.count,
            current_a: 1e-3 * f64::from(record.current_q_ma),
        })
    });
    let ticks = told.collect();
    Ok(Told { ticks, known })
}

/// Current of a cogging map at one number `n` of periods per turn, A, as the pair in `re cos(n θ) + im sin(n θ)`.
fn at_order(map: &CoggingMap, order: f64) -> Complex<f64> {
    let ampere = f64::from(1 << CURRENT_BITS);
    let parts = map.harmonics.iter();
    parts
        .filter(|it| f64::from(it.order) == order)
        .map(|it| Complex::new(f64::from(it.cos), f64::from(it.sin)) / ampere)
        .sum()
}

/// Compares amplitudes and phases of a cogging map with the current that would compensate the simulated cogging.
///
/// Errors: the deviation is larger than `most`, or the map has too much torque at numbers of periods per turn without cogging.
fn beside(found: &MeasuredCogging, motor: &MotorParameters, most: &Off) -> Result<String, String> {
    let constant = motor.torque_constant_nm_per_a();
    let mut words = Vec::new();
    let mut is_right = true;
    for (it, (share_most, degrees_most)) in COGGING.iter().zip(most) {
        // A motor torque of `A sin(n θ + φ)` compensates the cogging `-A sin(n θ + φ)`.
        let truth = Complex::new(it.phase.sin(), it.phase.cos()) * (it.amplitude / constant);
        let ratio = at_order(&found.map, it.per_rev) / truth;
        let (share, degrees) = (ratio.norm(), ratio.arg().to_degrees());
        is_right &= (share - 1.0).abs() <= *share_most && degrees.abs() <= *degrees_most;
        words.push(format!(
            "{} periods: {share:.3} of the amplitude, {degrees:+.1}°",
            it.per_rev
        ));
    }
    let is_strange = |order: f64| COGGING.iter().all(|it| it.per_rev != order);
    let orders = found.map.harmonics.iter().map(|it| f64::from(it.order));
    let strange: f64 = orders
        .filter(|order| is_strange(*order))
        .map(|order| 0.5 * at_order(&found.map, order).norm_sqr())
        .sum();
    let strange = strange.sqrt() * constant;
    is_right &= strange <= STRANGE_MOST_N_M;
    words.push(format!("at other orders {:.3} mN·m", 1e3 * strange));
    words.push(format!("turns differ by {:.1} %", 100.0 * found.unrepeated));
    let words = words.join("; ");
    if is_right { Ok(words) } else { Err(words) }
}

/// The cogging map with all signs reversed: it adds to the cogging instead of compensating it.
fn half_a_period_off(map: &CoggingMap) -> CoggingMap {
    let mut map = map.clone();
    for part in &mut map.harmonics {
        (part.cos, part.sin) = (-part.cos, -part.sin);
    }
    map
}

fn turns(bench: &mut Bench) -> Result<Vec<Felt>, String> {
    let turns = SPEEDS.iter().map(|speed| slow_turn(bench, *speed));
    turns.collect()
}

/// Checks that the full cogging torque remains without a cogging map, and a small part of it with one.
fn felt(without: &[Felt], with: &[Felt]) -> Result<String, String> {
    let mut words = Vec::new();
    let mut is_right = true;
    for (((speed, most), without), with) in SPEEDS.iter().zip(LEFT_MOST).zip(without).zip(with) {
        is_right &= (without.left() - 1.0).abs() < ALL && with.left() < most;
        words.push(format!(
            "{speed} rad/s {:.3} mN·m without it and {:.3} with it",
            1e3 * without.ripple_n_m,
            1e3 * with.ripple_n_m
        ));
    }
    let words = words.join("; ");
    if is_right { Ok(words) } else { Err(words) }
}

/// Checks that after a change of the settings the device reports that the cogging map does not fit them, and that the full cogging
/// torque remains.
fn refused(
    bench: &mut Bench,
    because: Unkept,
    change: impl FnOnce(&mut DeviceSettings),
) -> Result<String, String> {
    bench.demand(Request::Command(DeviceCommand::Stop))?;
    bench.configure(change)?;
    let (settings, board) = (
        bench.settings()?,
        board_named(bench.machine.chip().board.name)?,
    );
    let kept = report(bench)?.kept.ok_or("no map is kept")?;
    match kept.usable(&settings, board) {
        Err(why) if why == because => {}
        other => return Err(format!("{other:?} instead of {because:?}")),
    }
    bench.calibrate()?;
    let left = slow_turn(bench, SLOW)?.left();
    match (left - 1.0).abs() < ALL {
        true => Ok(format!("{left:.3} of the cogging is felt")),
        false => Err(format!(
            "{left:.3} of the cogging is felt: something is played"
        )),
    }
}

/// Switches the power off and on. Checks that the saved cogging map is then present, fits the settings and compensates the cogging.
fn kept(bench: &mut Bench, map: &CoggingMap) -> Result<String, String> {
    power_on(bench);
    // The device computes the map before it answers requests: twelve harmonics take 15 ms.
    bench.run(100 * MS)?;
    bench.boot()?;
    let (settings, board) = (
        bench.settings()?,
        board_named(bench.machine.chip().board.name)?,
    );
    let kept = report(bench)?.kept.ok_or("no map is kept")?;
    match kept.usable(&settings, board) {
        Ok(kept) if kept == map => {}
        other => return Err(format!("{other:?} instead of what was saved")),
    }
    bench.calibrate()?;
    let left = slow_turn(bench, SLOW)?.left();
    match left < LEFT_MOST[0] {
        true => Ok(format!("as it was saved; {left:.2} of the cogging is felt")),
        false => Err(format!("{left:.2} of the cogging is felt")),
    }
}
