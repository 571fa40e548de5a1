//! Commands a device to measure its motor, and receives the telemetry of motor and encoder.

use super::calibration_limit;
use crate::interrupt;
use crate::out::note;
use crate::stream::{SIGN_OF_LIFE, SILENCE_LIMIT};
use nalgebra::Complex;
use std::fmt::Display;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use touchstone_control::Si;
use touchstone_device::Client;
use touchstone_drive::measurement::FAST_FIELD;
use touchstone_drive::{Reason, wire};
use touchstone_lab::identify::eccentricity::{
    CalibrationTick, Eccentricity, FIELD_FASTEST_TURNS_PER_S, KnownEncoder, NotSeen,
};
use touchstone_lab::identify::motor::{KnownMotor, MeasuredMotor, MotorTick, motor};
use touchstone_link::words::name_of;
use touchstone_protocol::{
    DeviceCommand, DeviceSettings, Fault, FaultCode, Phase, Reply, Request, Telemetry,
};
use touchstone_sim::error::{Error, Result};

/// Longest time that a measurement takes in addition to the calibration. The measurement has two current steps and four pushes,
/// each with coasting and braking.
const MEASUREMENT_LONGEST: Duration = Duration::from_secs(45);
/// Largest limit on the time without a request from the computer during a measurement, s. After this time, for instance after a
/// pulled cable, the device switches its motor off.
const HOST_SILENCE_S: Si = Si::ONE;

/// Result of a measurement of motor and encoder.
pub struct Measured {
    /// Measured properties of the motor and its knob.
    pub motor: MeasuredMotor,
    /// Error of the encoder's angle over one turn, or the reason why it could not be determined.
    pub encoder: std::result::Result<Eccentricity, NotSeen>,
}

/// Measures motor and encoder. Afterwards the device is stopped and has the given settings.
pub fn measure(
    client: &mut Client,
    settings: &DeviceSettings,
    stop: &AtomicBool,
) -> Result<Measured> {
    let (ticks, encoder) = heard(client, settings, stop, true)?;
    let pwm_hz = wire::hardware(client.identity().board).pwm_hz;
    let known = KnownMotor {
        rate_hz: settings.timing.rate_hz.into(),
        counts_per_rev: settings.encoder.counts_per_rev.into(),
        pole_pairs: settings.motor.pole_pairs.into(),
        fast_field_hz: f64::from(FAST_FIELD) / 2_f64.powi(32) * f64::from(pwm_hz),
    };
    let ticks: Vec<MotorTick> = ticks.into_iter().flatten().collect();
    let motor = motor(&ticks, &known).map_err(|not| not_measured(client, &not))?;
    Ok(Measured { motor, encoder })
}

/// Measures only the encoder's angle error. If the board measures no currents, only the turning field moves the motor. Afterwards
/// the device is stopped and has the given settings.
pub fn encoder(
    client: &mut Client,
    settings: &DeviceSettings,
    stop: &AtomicBool,
) -> Result<Eccentricity> {
    let spins = client.identity().board.senses_current();
    let (_, encoder) = heard(client, settings, stop, spins)?;
    encoder.map_err(|not| match spins {
        true => not_measured(client, &not),
        // Without a motor measurement, the board only checks a saved alignment and does not search for a new one.
        false => Error::device(
            client.place(),
            not.to_string(),
            "take your hand off the knob and let the shaft turn freely. If an alignment is stored, delete it: touchstone device alignment forget. Then run the same command again",
        ),
    })
}

fn not_measured(client: &Client, why: &dyn Display) -> Error {
    Error::device(
        client.place(),
        why.to_string(),
        "take your hand off the knob, see that the shaft turns freely and nothing is loose, and run the same command again",
    )
}

/// Telemetry of the motor, one entry per control period, and the encoder's angle error computed from the same motion.
type Heard = (
    Vec<Option<MotorTick>>,
    std::result::Result<Eccentricity, NotSeen>,
);

/// Runs a whole calibration and returns its telemetry. With `spins`, the device also spins the motor to measure it.
fn heard(
    client: &mut Client,
    settings: &DeviceSettings,
    stop: &AtomicBool,
    spins: bool,
) -> Result<Heard> {
    let mut asked = watched(settings);
    asked.calibration.measures = spins;
    let field = &mut asked.calibration.electrical_turns_per_s;
    *field = (*field).min(Si::saturating_from_num(FIELD_FASTEST_TURNS_PER_S));
    client.tell(&Request::SetAll(asked.clone()))?;
    client.tell(&Request::Telemetry { decimation: 1 })?;
    let calibrate = client.tell(&Request::Command(DeviceCommand::Calibrate));
    // If the cause of an earlier fault persists, the fault recurs before the shaft turns.
    calibrate.map_err(|refused| {
        let why = fault(client).unwrap_or(refused);
        client.left_off(why)
    })?;
    client.forget_telemetry();
    let limit = calibration_limit(&asked) + MEASUREMENT_LONGEST;
    let heard = match listen(client, limit, stop, told) {
        Ok(heard) => heard,
        Err(failure) => {
            // The motor must not keep turning after the command has failed.
            let failure = client.left_off(failure);
            // The first failure is returned, even if restoring the settings fails, too.
            let _ = restored(client, settings);
            return Err(failure);
        }
    };
    let stopped = restored(client, settings);
    let Some(ticks) = heard else {
        stopped?;
        note!("interrupted: the motor is off; run the same command again to continue");
        std::process::exit(interrupt::INTERRUPTED);
    };
    stopped?;
    let known = KnownEncoder {
        rate_hz: asked.timing.rate_hz.into(),
        counts_per_rev: asked.encoder.counts_per_rev.into(),
        pole_pairs: asked.motor.pole_pairs.into(),
        field_turns_per_s: asked.calibration.electrical_turns_per_s.to_num(),
    };
    let (of_encoder, of_motor): (Vec<CalibrationTick>, Vec<Option<MotorTick>>) =
        ticks.into_iter().unzip();
    Ok((of_motor, Eccentricity::new(&of_encoder, &known)))
}

/// Switches the motor off and restores the given settings.
fn restored(client: &mut Client, settings: &DeviceSettings) -> Result<()> {
    client.tell(&Request::Command(DeviceCommand::Stop))?;
    client.tell(&Request::SetAll(settings.clone()))?;
    let decimation = settings.telemetry.decimation;
    client.tell(&Request::Telemetry { decimation })
}

/// Settings for a shaft that turns unattended: without a request from the computer the device switches off after 1 s, or earlier if
/// the given settings have a shorter limit.
pub fn watched(settings: &DeviceSettings) -> DeviceSettings {
    let mut asked = settings.clone();
    let limit = &mut asked.limits.host_silence_s;
    if *limit == Si::ZERO || *limit > HOST_SILENCE_S {
        *limit = HOST_SILENCE_S;
    }
    asked
}

/// Receives the telemetry of a calibration until the device is ready; returns `None` if the user interrupts.
pub fn listen<T>(
    client: &mut Client,
    limit: Duration,
    stop: &AtomicBool,
    mut told: impl FnMut(&Telemetry) -> Option<T>,
) -> Result<Option<Vec<T>>> {
    let begun = Instant::now();
    let (mut heard, mut spoken) = (begun, begun);
    let (mut ticks, mut begins) = (Vec::new(), false);
    let failed = |client: &Client, problem: String, fix: &str| {
        Err(Error::device(client.place(), problem, fix))
    };
    loop {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        if spoken.elapsed() >= SIGN_OF_LIFE {
            spoken = Instant::now();
            client.ask(&Request::Status)?;
        }
        let Some(record) = client.next_telemetry()? else {
            if heard.elapsed() > SILENCE_LIMIT {
                return failed(
                    client,
                    "no telemetry for 2 s".into(),
                    "check cable and supply, and run the same command again",
                );
            }
            continue;
        };
        heard = Instant::now();
        ticks.extend(told(&record));
        match record.phase {
            Phase::Calibrating => begins = true,
            Phase::Ready if begins => return Ok(Some(ticks)),
            Phase::Fault => return Err(fault(client)?),
            // These records were sent before the calibration began.
            Phase::Boot | Phase::Stopped | Phase::Ready if !begins => {}
            Phase::Boot | Phase::Stopped | Phase::Ready | Phase::Armed => {
                let problem = format!("the measurement ended: {}", record.phase.name());
                return failed(client, problem, "run the same command again to continue");
            }
        }
        if begun.elapsed() > limit {
            let problem = format!("the measurement did not end within {} s", limit.as_secs());
            return failed(
                client,
                problem,
                "find the cause in the record of `touchstone device ring`",
            );
        }
    }
}

/// Reads the device's fault that ended the calibration, and converts it to an error message with a remedy.
pub fn fault(client: &mut Client) -> Result<Error> {
    let fault = match client.ask(&Request::Fault)? {
        Reply::Fault(fault) => fault,
        other => return Err(client.odd(&other)),
    };
    let held = |fault: &Fault| {
        fault.known() == Some(FaultCode::CalibrationFailed)
            && Reason::from_value(fault.value) == Some(Reason::Held)
    };
    let fix = match &fault {
        Some(fault) if held(fault) => {
            "the shaft hardly moved: take your hand off the knob, or raise calibration.current_a, and run the same command again"
        }
        _ => "see the fault's page in docs/faults, then run the same command again",
    };
    let name = fault.map_or("unknown".into(), |fault| {
        format!("{}, value {}", name_of(&fault), fault.value)
    });
    let problem = format!("the measurement ended with a fault: {name}");
    Ok(Error::device(client.place(), problem, fix))
}

fn told(record: &Telemetry) -> Option<(CalibrationTick, Option<MotorTick>)> {
    let milli = |value: i32| 1e-3 * f64::from(value);
    let of_encoder = CalibrationTick {
        tick: record.tick,
        part: record.measuring.map(|it| it.part),
        count: record.count,
    };
    let of_motor = record.measuring.map(|it| MotorTick {
        tick: record.tick,
        part: it.part,
        count: record.count,
        current_a: Complex::new(milli(it.current_d_ma), milli(record.current_q_ma)),
        voltage_v: Complex::new(milli(it.voltage_d_mv), milli(it.voltage_q_mv)),
    });
    (record.phase == Phase::Calibrating).then_some((of_encoder, of_motor))
}

#[cfg(test)]
mod tests {
    use super::{HOST_SILENCE_S, watched};
    use touchstone_control::Si;
    use touchstone_protocol::{Board, DeviceSettings};

    #[test]
    fn an_unattended_shaft_is_off_within_a_second_of_silence() {
        let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
        let half = Si::ONE / 2;
        for (set, during) in [
            (Si::ZERO, HOST_SILENCE_S),
            (half, half),
            (Si::ONE, Si::ONE),
            (Si::from_num(60), HOST_SILENCE_S),
        ] {
            settings.limits.host_silence_s = set;
            assert_eq!(watched(&settings).limits.host_silence_s, during, "{set}");
        }
    }
}
