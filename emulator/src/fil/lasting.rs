//! Tests that take longer than a single fault injection: a cable is pulled, a hand leans on the wall.

use touchstone_control::Si;
use touchstone_drive::wire::hardware;
use touchstone_protocol::{DeviceCommand, FaultCode, Limit, Limits, Phase, Request};
use touchstone_world::plant::Hand;

use super::press::board_named;
use super::tally::Tally;
use crate::bench::{Bench, MS, Setup, US, number};
use crate::cpu::elf::Program;

/// Longest allowed silence of the computer in seconds, as configured in these tests. [`SILENCE_US`] is the time limit for switching
/// off, in microseconds: it adds one control period for the last message and one for the reaction.
const SILENCE_S: &str = "0.5";
const SILENCE_US: u64 = 500_000 + 2 * 1_050;

/// Configured thermal time constant of the motor in seconds, short so that the motor warms up within seconds.
const HEATING_TIME_S: f64 = 1.0;

/// Pulls the cable to the computer (its messages stop) in each state in which the outputs are on, and checks that the device
/// switches them off within [`SILENCE_US`], with the fault `HostSilent`.
pub fn cable_pulled(program: &Program, setup: &Setup, tally: &mut Tally) {
    for state in [Phase::Calibrating, Phase::Armed] {
        let name = format!("cable pulled, {}", state.name());
        let off = pulled(program, setup, state);
        if off.is_ok() {
            tally.latched.insert(FaultCode::HostSilent);
        }
        tally.check(
            &name,
            off.map(|us| format!("off after {us} us of {SILENCE_US}, HostSilent")),
        );
    }
}

fn prepared(program: &Program, setup: &Setup, silence: &str) -> Result<Bench, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    let (kind, silence) = (setup.board.encoder.kind(), Si::from_str(silence));
    let silence = silence.map_err(|error| error.to_string())?;
    bench.configure(|settings| {
        settings.encoder.kind = kind;
        settings.calibration.electrical_turns_per_s = Si::lit("4");
        settings.wall.surface_rad = Si::lit("0.3");
        settings.limits.host_silence_s = silence;
        settings.motor.heating_time_s = Si::from_num(HEATING_TIME_S);
        // The calibration's current may be held for ever: `weak_motor` tests a calibration that heats the motor.
        settings.motor.continuous_current_a = settings.calibration.current_a;
    })?;
    Ok(bench)
}

fn pulled(program: &Program, setup: &Setup, state: Phase) -> Result<u64, String> {
    let mut bench = prepared(program, setup, SILENCE_S)?;
    match state {
        Phase::Calibrating => {
            bench.demand(Request::Command(DeviceCommand::Calibrate))?;
            bench.run_until("the outputs on", 400 * MS, |bench| bench.is_on())?;
        }
        _ => bench.arm()?,
    }
    // After this request the desktop stays silent.
    bench.status()?;
    let begin = bench.now();
    bench.run(450 * MS)?;
    if !bench.is_on() {
        return Err("off before its time".into());
    }
    bench.run(250 * MS)?;
    let changes = &bench.machine.chip().bridge.changes;
    let off = changes.iter().find(|(time, on)| *time > begin && !on);
    let us = match off {
        Some((time, _)) if !bench.is_on() => (time - begin) / US,
        _ => return Err("the outputs stay on".into()),
    };
    if us > SILENCE_US {
        return Err(format!("off after {us} us, later than {SILENCE_US}"));
    }
    match bench.fault()?.and_then(|fault| fault.known()) {
        Some(FaultCode::HostSilent) => Ok(us),
        other => Err(format!("{other:?} instead of HostSilent")),
    }
}

/// A reference model of the winding temperature: the squared current amplitude through a first-order low-pass with the time
/// constant [`HEATING_TIME_S`], from the simulated phase currents every 100 us.
#[derive(Default)]
struct Windings {
    mean: f64,
    hottest: f64,
    /// Largest squared current amplitude so far, A².
    most: f64,
}

impl Windings {
    fn warm(&mut self, bench: &Bench) {
        let world = &bench.machine.chip().world;
        let squares: f64 = (0..3).map(|phase| world.current_a(phase).powi(2)).sum();
        // The squared amplitude of three balanced currents is two thirds of the sum of their squares.
        let square = 2.0 / 3.0 * squares;
        self.mean += 1e-4 / HEATING_TIME_S * (square - self.mean);
        self.hottest = self.hottest.max(self.mean);
        self.most = self.most.max(square);
    }
}

/// Calibrates with a current that the motor cannot carry for long. The device must stop with a fault when the mean square of the
/// current reaches 1.5 times the permitted one.
pub fn weak_motor(program: &Program, setup: &Setup, tally: &mut Tally) {
    let ended = ends_hot(program, setup);
    if ended.is_ok() {
        tally.latched.insert(FaultCode::MotorHot);
    }
    tally.check("a calibration that the motor does not bear", ended);
}

fn ends_hot(program: &Program, setup: &Setup) -> Result<String, String> {
    let mut bench = prepared(program, setup, "0")?;
    let bears = number(bench.settings()?.calibration.current_a) / 2.0;
    bench.configure(|settings| settings.motor.continuous_current_a = Si::from_num(bears))?;
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    bench.run_until("the outputs on", 400 * MS, |bench| bench.is_on())?;
    let mut windings = Windings::default();
    let off = bench.run_until("the outputs off", 2_000 * MS, |bench| {
        windings.warm(bench);
        !bench.is_on()
    });
    off?;
    bench.run(5 * MS)?;
    // The fault's threshold is 1.5 times the permitted mean square. The range allows for the errors of the current sensors.
    let times = windings.hottest / bears.powi(2);
    match bench.fault()?.and_then(|fault| fault.known()) {
        Some(FaultCode::MotorHot) if (1.4..1.6).contains(&times) => Ok(format!(
            "off at {times:.3} times the mean square that it bears, MotorHot"
        )),
        other => Err(format!("{other:?} at {times:.3} times what it bears")),
    }
}

/// Lets a hand lean on the wall with more torque than the motor can hold for ever. Checks that the device limits its current.
pub fn leaning_hand(program: &Program, setup: &Setup, tally: &mut Tally) {
    tally.check("a hand that leans", leans(program, setup));
}

fn leans(program: &Program, setup: &Setup) -> Result<String, String> {
    let mut bench = prepared(program, setup, "0")?;
    bench.arm()?;
    let bears = number(bench.settings()?.motor.continuous_current_a);
    // The hand is so stiff that it holds its position against any force of the wall. Its fingers grip firmly: the pad of a medium
    // grip, a linear spring, would have to be compressed by up to 4 cm.
    let hand = Hand {
        stiffness: 40.0,
        ..touchstone_world::plant::FIRM
    };
    bench.press(&hand, setup.board.lean_n_m, 0.4, 100.0)?;
    let mut windings = Windings::default();
    for _ in 0..60_000 {
        bench.run(100 * US)?;
        windings.warm(&bench);
    }
    let Windings {
        mean,
        hottest,
        most,
    } = windings;
    let status = bench.status()?;
    if status.phase != Phase::Armed {
        return Err(format!("{} with {:?}", status.phase.name(), status.fault));
    }
    if most.sqrt() < 1.5 * bears {
        return Err(format!(
            "the hand leans with no more than {:.2} A",
            most.sqrt()
        ));
    }
    let records = &bench.link.telemetry;
    let derated = |limits| Limits::from_wire(limits).has(Limit::Temperature);
    if !records.iter().any(|record| derated(record.limits)) {
        return Err("no record tells of the derating".into());
    }
    // The mean square may exceed its limit by 3 %, for the errors of the shunts and of the control tick. A coarse current sensor may
    // cause more: half a step of its converter in each of two phases is at most a step in the amplitude of the three.
    let sensors = hardware(board_named(setup.board.name)?);
    let step = number(sensors.amps_per_code).abs();
    if hottest > (1.03 * bears.powi(2)).max((bears + step).powi(2)) {
        let told = records.last().map(|record| record.current_q_ma);
        return Err(format!(
            "a mean square of {hottest:.3} A², and the motor bears {:.3}; {:.4} A in the end, the device tells {told:?} mA",
            bears * bears,
            mean.sqrt()
        ));
    }
    Ok(format!(
        "{:.2} A at most, in the end {:.2}: a mean square of {hottest:.3} A², and the motor bears {:.3}",
        most.sqrt(),
        mean.sqrt(),
        bears * bears
    ))
}
