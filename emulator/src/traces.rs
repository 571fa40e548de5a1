//! Signals of a first power-up on the emulated board, as an oscilloscope, a current probe and `touchstone monitor`
//! show them. They are written as tables; `cargo xtask traces` draws the pictures of the build guide from them.

use std::fmt::Write as _;
use std::path::Path;

use touchstone_control::Si;
use touchstone_protocol::{DeviceCommand, MeasuringPart, Phase, Request};
use touchstone_world::plant::MEDIUM;

use crate::bench::{Bench, MS, Setup, US};
use crate::board::Source;
use crate::cpu::elf::Program;
use crate::peripheral::CORE_HZ;

/// A signal to record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trace {
    /// The pins of the power bridge while the device is armed but renders no force, and the sampling times of the converters.
    Pwm,
    /// The phase currents at the beginning of the first current push of a calibration.
    Step,
    /// The shaft's angle and the current of one phase during a calibration.
    Calibration,
    /// A hand's press on the wall and its release, from the board's telemetry.
    Press,
}

impl Trace {
    /// Returns the signal of this name; `None` for an unknown name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "pwm" => Some(Self::Pwm),
            "step" => Some(Self::Step),
            "calibration" => Some(Self::Calibration),
            "press" => Some(Self::Press),
            _ => None,
        }
    }
}

/// Time between two readings of the pins, in processor cycles. [`LOOKS`] is the number of readings, which cover 110 µs.
const LOOK: u64 = 5;
const LOOKS: u64 = 110 * US / LOOK;
/// Time between two samples of a current probe, in processor cycles. [`SHAFT`] is that between two samples of the shaft's angle.
const PROBE: u64 = 25 * US;
const SHAFT: u64 = 2 * MS;
/// Time recorded before a current step, in processor cycles. [`AFTER`] is the time recorded after the step.
const BEFORE: u64 = MS;
const AFTER: u64 = 4 * MS;
/// A current push counts as begun when the amplitude of the phase currents reaches this fraction (0 to 1) of the push's current.
const BEGUN: f64 = 0.1;
/// Longest time from an event until the telemetry shows it, in processor cycles.
const TOLD: u64 = 10 * MS;
/// Waiting time after arming until the torque has faded in, in processor cycles.
const FADED_IN: u64 = 300 * MS;
/// Times in seconds: the hand presses in for `PRESS_S`, holds for `HOLD_S`, and then lets go.
const PRESS_S: f64 = 0.8;
const HOLD_S: f64 = 0.6;
const AFTERWARDS: u64 = 300 * MS;

/// Records the signal and writes it as a table; returns a summary.
///
/// # Errors
/// The step that failed.
pub fn write(
    program: &Program,
    setup: &Setup,
    trace: Trace,
    file: &Path,
) -> Result<String, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    let kind = setup.board.encoder.kind();
    bench.configure(|settings| {
        settings.encoder.kind = kind;
        settings.calibration.electrical_turns_per_s = setup.board.field_turns_per_s;
        settings.calibration.measures = trace == Trace::Step;
        settings.wall.k_desired_n_m_per_rad = setup.board.walls[0];
        settings.wall.surface_rad = Si::lit("0.1");
    })?;
    let text = match trace {
        Trace::Pwm => pwm(&mut bench),
        Trace::Step => step(&mut bench),
        Trace::Calibration => calibration(&mut bench),
        Trace::Press => press(&mut bench),
    }?;
    let written = std::fs::write(file, &text);
    written.map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(format!(
        "{} rows in {}",
        text.lines().count() - 1,
        file.display()
    ))
}

fn seconds(cycles: u64) -> f64 {
    cycles as f64 / CORE_HZ as f64
}

fn name(source: Source) -> String {
    match source {
        Source::Current(phase) => format!("current {}", ['U', 'V', 'W'][phase.min(2)]),
        Source::Bus => "bus".into(),
        Source::Temperature => "temperature".into(),
    }
}

/// Records the levels of the bridge's pins for 110 µs, which is just over two PWM periods, from the bottom of the timer's counter
/// on.
fn pwm(bench: &mut Bench) -> Result<String, String> {
    bench.arm()?;
    bench.run(FADED_IN)?;
    let bridge = |bench: &Bench| {
        let now = bench.now();
        bench.machine.chip().bridge.since_bottom(now)
    };
    let mut before = 0;
    while bridge(bench) >= before {
        before = bridge(bench);
        bench.run(LOOK)?;
    }
    let begin = bench.now() - bridge(bench);
    let mut text = String::from("time_s,upper_u,lower_u,upper_v,lower_v,upper_w,lower_w,samples\n");
    let mut seen: Vec<(Source, u64)> = Vec::new();
    for _ in 0..LOOKS {
        let (now, chip) = (bench.now(), bench.machine.chip());
        let _ = write!(text, "{:.8}", seconds(now - begin));
        for pins in chip.bridge.pins(now) {
            let (upper, lower) = pins.ok_or("a phase is not driven")?;
            let _ = write!(text, ",{},{}", u8::from(upper), u8::from(lower));
        }
        // A sample is written to the first row after its time.
        let samples = chip.samplings().into_iter().flatten();
        let new: Vec<_> = samples
            .filter(|(_, at)| (begin..=now).contains(at))
            .filter(|sample| !seen.contains(sample))
            .collect();
        let words: Vec<String> = new.iter().map(|(source, _)| name(*source)).collect();
        let _ = writeln!(text, ",{}", words.join("+"));
        seen.extend(new);
        bench.run(LOOK)?;
    }
    Ok(text)
}

/// Records the phase currents at the first current push of a calibration that measures the motor.
fn step(bench: &mut Bench) -> Result<String, String> {
    let push_a: f64 = bench.settings()?.calibration.current_a.to_num::<f64>() / 4.0;
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    let from = bench.link.telemetry.len();
    let mut probe: Vec<(u64, [f64; 3])> = Vec::new();
    let mut told = None;
    while told.is_none_or(|at| bench.now() < at + AFTER) {
        bench.run(PROBE)?;
        let now = bench.now();
        let world = &mut bench.machine.chip_mut().world;
        world.advance(now);
        probe.push((now, [0, 1, 2].map(|phase| world.current_a(phase))));
        let pushes = |part| part == MeasuringPart::Push;
        let records = bench.link.telemetry[from..].iter();
        if told.is_none()
            && records
                .rev()
                .take(3)
                .any(|it| it.measuring.is_some_and(|tick| pushes(tick.part)))
        {
            told = Some(now);
        }
        let last = bench.link.telemetry.last().map(|it| it.phase);
        if last == Some(Phase::Fault) || probe.len() as u64 * PROBE > 60_000 * MS {
            return Err(format!("no push: {:?}", bench.fault()?));
        }
    }
    let told = told.unwrap_or(0);
    let begins = probe
        .iter()
        .filter(|(at, _)| *at + TOLD > told)
        .find(|(_, phases)| amplitude(phases) > BEGUN * push_a);
    let begin = begins.ok_or("no current in the push")?.0;
    let mut text = String::from("time_s,current_u_a,current_v_a,current_w_a,push_a\n");
    let shown = begin.saturating_sub(BEFORE)..begin + AFTER;
    for (at, [u, v, w]) in probe.iter().filter(|(at, _)| shown.contains(at)) {
        let time = seconds(*at) - seconds(begin);
        let _ = writeln!(text, "{time:.6},{u:.5},{v:.5},{w:.5},{push_a}");
    }
    Ok(text)
}

/// Amplitude of three phase currents that are a third of a turn apart.
fn amplitude(phases: &[f64; 3]) -> f64 {
    let squares: f64 = phases.iter().map(|it| it * it).sum();
    (squares * 2.0 / 3.0).sqrt()
}

fn calibration(bench: &mut Bench) -> Result<String, String> {
    let begin = bench.now();
    let zero = bench.machine.chip().world.angle_rad();
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    let mut text = String::from("time_s,angle_deg,current_u_a\n");
    loop {
        bench.run(SHAFT)?;
        let now = bench.now();
        let world = &mut bench.machine.chip_mut().world;
        world.advance(now);
        let angle = (world.angle_rad() - zero).to_degrees();
        let (time, current) = (seconds(now - begin), world.current_a(0));
        let _ = writeln!(text, "{time:.4},{angle:.3},{current:.4}");
        match bench.link.telemetry.last().map(|it| it.phase) {
            Some(Phase::Ready) => return Ok(text),
            Some(Phase::Fault) => return Err(format!("{:?}", bench.fault()?)),
            _ if time > 20.0 => return Err("the calibration does not end".into()),
            _ => {}
        }
    }
}

/// Records a hand's press on the wall, in the columns of `touchstone monitor --csv`.
fn press(bench: &mut Bench) -> Result<String, String> {
    bench.arm()?;
    bench.run(FADED_IN)?;
    let rate_hz = f64::from(bench.settings()?.timing.rate_hz);
    let torque = bench.machine.chip().board.press_n_m;
    let from = bench.link.telemetry.len();
    bench.press(&MEDIUM, torque, PRESS_S, HOLD_S)?;
    bench.run(((PRESS_S + HOLD_S) * CORE_HZ as f64) as u64)?;
    bench.release();
    bench.run(AFTERWARDS)?;
    if bench.link.gaps(from) > 0 {
        return Err("records of telemetry are missing".into());
    }
    let records = &bench.link.telemetry[from..];
    let first = records.first().ok_or("nothing was told")?.tick;
    let mut text = String::from("time_s,penetration_rad,force_n_m,current_q_a\n");
    for record in records {
        if record.phase != Phase::Armed {
            return Err(format!("{} in the press", record.phase.name()));
        }
        let _ = writeln!(
            text,
            "{:.4},{},{},{:.3}",
            f64::from(record.tick.wrapping_sub(first)) / rate_hz,
            record.penetration_rad,
            record.force_n_m,
            f64::from(record.current_q_ma) / 1_000.0
        );
    }
    Ok(text)
}
