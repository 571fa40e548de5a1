//! Tests of the measured eccentricity: an encoder whose magnet is off the axis and tilted. The code that runs on the computer
//! computes the eccentricity from the device's telemetry during calibration. The reference is the true error of the simulated
//! encoder, which the device does not know.

#[allow(
    dead_code,
    unused_imports,
    reason = "what a magnet costs and whether it stands out is for the desktop"
)]
#[path = "../../../host-sim/lab/src/identify/eccentricity/mod.rs"]
mod identify;

use nalgebra::Complex;
use std::f64::consts::TAU;
use touchstone_control::Si;
use touchstone_protocol::{DeviceCommand, Phase, Request};
use touchstone_world::plant::train::Harmonic;

use self::identify::{
    CalibrationTick, Eccentricity, FIELD_FASTEST_TURNS_PER_S, KnownEncoder, Witness,
};
use super::cogging::COGGING;
use super::noisy::NOISE;
use super::tally::Tally;
use crate::bench::{Bench, MS, Setup, number};
use crate::cpu::elf::Program;
use crate::world::EncoderError;

/// Longest time in processor cycles for a calibration at the fastest field speed, together with the measurement of the
/// eccentricity.
const MEASURED: u64 = 60_000 * MS;
/// Allowed error of the computed eccentricity, as a fraction of the true amplitude; one encoder count is allowed in addition.
const OFF_MOST: f64 = 0.01;
/// Torque of a knob whose centre of mass is off its axis: as large as its friction.
const WEIGHT: Harmonic = Harmonic {
    amplitude: 5e-4,
    per_rev: 1.0,
    phase: 0.7,
};

/// Errors of the encoder's angle due to its magnet, at one and two periods per turn: amplitudes in degrees, and phases in rad.
#[derive(Clone, Copy)]
struct Magnet([f64; 2], [f64; 2]);

/// Magnets for the measurement by the motor's field alone: centred, typical, and far off the axis.
const MAGNETS: [Magnet; 3] = [
    Magnet([0.0, 0.0], [0.0, 0.0]),
    Magnet([0.3, 0.3], [-2.5, 0.4]),
    Magnet([2.0, 1.0], [1.0, -1.7]),
];
/// The magnet of the measurement with spins of the shaft, in which the knob's centre of mass is off its axis.
const SPUN: Magnet = Magnet([1.0, 0.3], [2.2, -0.6]);

/// Tests the measurement of the eccentricity on the reference board.
pub fn eccentricity(program: &Program, setup: &Setup, tally: &mut Tally) {
    if setup.board.name != "nucleo-g474re-ihm16m1" {
        return;
    }
    let mut bench = match prepared(program, setup) {
        Ok(bench) => bench,
        Err(error) => return tally.check("eccentricity", Err(error)),
    };
    for magnet in MAGNETS {
        let [once, twice] = magnet.0;
        let name = format!("eccentricity of {once}° once and {twice}° twice a turn, by the field");
        let found = measured(&mut bench, magnet, false).and_then(judged);
        tally.check(&name, found);
    }
    bench.machine.chip_mut().world.cogging.push(WEIGHT);
    let spun = measured(&mut bench, SPUN, true).and_then(|(found, truth)| match found.witness[0] {
        Witness::Coast => judged((found, truth)),
        Witness::Field => Err("the field was believed, which the weight turns".into()),
    });
    tally.check(
        "eccentricity with a weight out of the axis, by the coasts",
        spun,
    );
    tally.ran(&bench);
}

/// A device with an absolute encoder, whose motor has cogging torque.
fn prepared(program: &Program, setup: &Setup) -> Result<Bench, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.machine.chip_mut().world.cogging = COGGING.to_vec();
    bench.boot()?;
    let kind = setup.board.encoder.kind();
    bench.configure(|settings| {
        settings.encoder.kind = kind;
        settings.calibration.electrical_turns_per_s = Si::from_num(FIELD_FASTEST_TURNS_PER_S);
        // The calibration's current may be held for ever, because this test is not about heating.
        settings.motor.continuous_current_a = settings.calibration.current_a;
    })?;
    bench.demand(Request::Telemetry { decimation: 1 })?;
    Ok(bench)
}

/// The computed eccentricity, and the true one as seen from the calibrated zero.
type Found = (Eccentricity, [Complex<f64>; 2]);

/// Sends the requests of `touchstone device eccentricity`: takes the device from stopped to ready and back, and returns the result.
fn measured(bench: &mut Bench, magnet: Magnet, spins: bool) -> Result<Found, String> {
    let error = |index: usize| EncoderError {
        amplitude_rad: magnet.0[index].to_radians(),
        per_rev: (index + 1) as f64,
        phase_rad: magnet.1[index],
    };
    let errors = [error(0), error(1)];
    let sensors = &mut bench.machine.chip_mut().world.sensors;
    sensors.encoder_error = errors.to_vec();
    // With noise the device detects no rest, and each brake and coast phase of a measurement lasts its longest time.
    sensors.noise = (!spins).then_some(NOISE);
    bench.configure(|settings| settings.calibration.measures = spins)?;
    let from = bench.link.telemetry.len();
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    bench.wait_for(Phase::Ready, MEASURED)?;
    let settings = bench.settings()?;
    let known = KnownEncoder {
        rate_hz: settings.timing.rate_hz.into(),
        counts_per_rev: settings.encoder.counts_per_rev.into(),
        pole_pairs: settings.motor.pole_pairs.into(),
        field_turns_per_s: number(settings.calibration.electrical_turns_per_s),
    };
    let told = bench.link.telemetry[from..].iter();
    let told = told.filter(|record| record.phase == Phase::Calibrating);
    let ticks: Vec<CalibrationTick> = told
        .map(|record| CalibrationTick {
            tick: record.tick,
            part: record.measuring.map(|it| it.part),
            count: record.count,
        })
        .collect();
    // The field no longer holds the shaft, so the shaft moves until it comes to rest.
    bench.run(500 * MS)?;
    let since = bench.link.telemetry.last().ok_or("no telemetry")?.count;
    let turned = TAU * f64::from(since) / known.counts_per_rev;
    let world = &bench.machine.chip().world;
    let zero = world.sensors.with_error(world.angle_rad()) - turned;
    let truth =
        errors.map(|it| Complex::from_polar(it.amplitude_rad, it.phase_rad + it.per_rev * zero));
    bench.demand(Request::Command(DeviceCommand::Stop))?;
    let found = Eccentricity::new(&ticks, &known).map_err(|why| why.to_string())?;
    Ok((found, truth))
}

/// Compares the computed errors at one and two periods per turn with the true ones. Each deviation must be below twice the stated
/// uncertainty, or half a count if that is more. It must also be below one count plus [`OFF_MOST`] of the true amplitude.
fn judged((found, truth): Found) -> Result<String, String> {
    let mut words = Vec::new();
    let mut is_right = true;
    for (it, truth) in found.harmonics.iter().zip(truth) {
        let off = (Complex::from_polar(it.amplitude_rad, it.phase_rad) - truth).norm();
        is_right &= off < found.count_rad + OFF_MOST * truth.norm();
        is_right &= off < (2.0 * it.uncertainty_rad).max(0.5 * found.count_rad);
        words.push(format!(
            "{:.4}° and {:.4}° off, said to be known within {:.4}°",
            it.amplitude_rad.to_degrees(),
            off.to_degrees(),
            it.uncertainty_rad.to_degrees()
        ));
    }
    if let Some(apart) = found.apart_rad {
        words.push(format!(
            "field and coasts apart by {:.3}° and {:.3}°",
            apart[0].to_degrees(),
            apart[1].to_degrees()
        ));
    }
    let words = words.join("; ");
    if is_right { Ok(words) } else { Err(words) }
}
