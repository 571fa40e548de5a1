//! Carries out fault injections, one after the other on the same device. Each injection first brings the device back to a working
//! state.

use touchstone_control::Si;
use touchstone_protocol::{DeviceCommand, FaultCode, Phase, Request};
use touchstone_world::plant::MEDIUM;

use super::fault::Fault;
use super::list::{Expect, Injection, When};
use crate::bench::{Bench, MS, Setup, US};
use crate::cpu::elf::Program;

/// Result of one fault injection.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Time in µs from the injection until the outputs were off; `None` if they were off already or stayed on.
    pub off_us: Option<f64>,
    /// Fault code that the device latched; `None` if the device latched none.
    pub code: Option<FaultCode>,
    /// Description of what deviates from the expected result; `None` if nothing does.
    pub wrong: Option<String>,
}

/// A device under test, on which injections run one after the other.
pub struct Campaign {
    bench: Bench,
    fresh: bool,
}

/// Time in cycles for which the device is watched after its outputs are off.
const WATCHED: u64 = 30 * MS;

/// Value of the fault `CalibrationFailed` if the shaft did not follow the field evenly (docs/faults/10-calibration-failed.md).
const UNEVEN: i32 = 4;

/// Angle within which a shaft must stay for a tenth of a second to count as resting, rad: a thousandth of a turn.
const RESTS_RAD: f64 = 6e-3;

impl Campaign {
    /// Boots a device with an encoder, and configures the encoder and a fast calibration.
    ///
    /// # Errors
    /// The program does not start.
    pub fn new(program: &Program, setup: &Setup) -> Result<Self, String> {
        let mut bench = Bench::new(program, setup)?;
        bench.boot()?;
        let kind = setup.board.encoder.kind();
        bench.configure(|settings| {
            settings.encoder.kind = kind;
            settings.calibration.electrical_turns_per_s = setup.board.field_turns_per_s;
            settings.wall.surface_rad = Si::lit("0.3");
            // This test calibrates every few seconds, while a user calibrates once. So the settings allow the calibration's current
            // for ever.
            settings.motor.continuous_current_a = settings.calibration.current_a;
        })?;
        bench.demand(Request::Save)?;
        Ok(Self { bench, fresh: true })
    }

    /// The test bench with the emulated device.
    pub fn bench(&mut self) -> &mut Bench {
        &mut self.bench
    }

    /// Carries out one injection.
    pub fn inject(&mut self, injection: &Injection) -> Outcome {
        let mut outcome = Outcome {
            off_us: None,
            code: None,
            wrong: None,
        };
        let result = self
            .prepare(injection.when)
            .map_err(|error| format!("before: {error}"))
            .and_then(|()| self.carry_out(injection, &mut outcome));
        if let Err(wrong) = result {
            outcome.wrong.get_or_insert(wrong);
        }
        self.mend(injection);
        if injection.again && outcome.wrong.is_none() {
            let again = self.prepare(When::Free);
            outcome.wrong = again.err().map(|error| format!("afterwards: {error}"));
        }
        outcome
    }

    /// Removes the injected faults, as far as that is possible from outside the chip.
    fn mend(&mut self, injection: &Injection) {
        for fault in [Some(injection.fault), injection.then]
            .into_iter()
            .flatten()
        {
            fault.remove(&mut self.bench);
        }
    }

    /// Brings the device into a state by commands alone, whatever its state was before.
    fn prepare(&mut self, when: When) -> Result<(), String> {
        let bench = &mut self.bench;
        bench.release();
        let phase = bench.status()?.phase;
        if phase != Phase::Stopped && !(self.fresh && phase == Phase::Boot) {
            bench.demand(Request::Command(DeviceCommand::Stop))?;
        }
        self.fresh = false;
        if when == When::Starting {
            return Ok(());
        }
        rest(bench)?;
        if when == When::Measuring {
            bench.demand(Request::Command(DeviceCommand::Calibrate))?;
            return bench.run(10 * MS);
        }
        if when == When::Calibrating {
            bench.demand(Request::Command(DeviceCommand::Calibrate))?;
            // The outputs are switched on after the measurement of the current offsets. 200 ms later the calibration's field turns.
            bench.run_until("the outputs on", 3_000 * MS, |bench| bench.is_on())?;
            return bench.run(200 * MS);
        }
        calibrate(bench)?;
        if when == When::Ready {
            return Ok(());
        }
        bench.demand(Request::Command(DeviceCommand::Arm))?;
        bench.wait_for(Phase::Armed, 100 * MS)?;
        bench.run(250 * MS)?;
        if when == When::Pressed {
            let torque = bench.machine.chip().board.press_n_m;
            bench.press(&MEDIUM, torque, 0.4, 100.0)?;
            bench.run(500 * MS)?;
            if bench
                .link
                .telemetry
                .last()
                .is_none_or(|record| record.force_n_m == 0)
            {
                return Err("the hand does not press".into());
            }
        }
        Ok(())
    }

    fn carry_out(&mut self, injection: &Injection, outcome: &mut Outcome) -> Result<(), String> {
        let bench = &mut self.bench;
        bench.run(injection.moment_us * US)?;
        let was_on = bench.is_on();
        if was_on != injection.when.is_on() {
            return Err(format!("outputs on before: {was_on}"));
        }
        let (begin, resets) = (bench.now(), bench.machine.resets.len());
        injection.fault.inject(bench)?;
        let begin = if injection.fault.waits() {
            bench.now()
        } else {
            begin
        };
        if injection.when == When::Starting {
            bench.demand(Request::Command(DeviceCommand::Calibrate))?;
            bench.run(100 * MS)?;
        }
        if let Some(time) = injection.fault.lasts() {
            bench.run(time)?;
            injection.fault.remove(bench);
        }
        match injection.expect {
            Expect::GoesOn => self.goes_on(injection),
            Expect::OffAtLast(limit, codes) => {
                self.bench.run(limit * US + WATCHED)?;
                let off = self.is_off_at_last(begin, limit, outcome)?;
                self.is_latched(off, injection, codes, outcome)
            }
            Expect::Off(limit, codes) | Expect::Reset(limit, codes) => {
                let watched = begin + limit * US + WATCHED;
                while self.bench.now() < watched
                    && (self.bench.is_on() || self.bench.now() < begin + WATCHED)
                {
                    self.bench.run(MS)?;
                }
                self.bench.run(WATCHED)?;
                if let Some(second) = injection.then {
                    second.inject(&mut self.bench)?;
                    if let Some(time) = second.lasts() {
                        self.bench.run(time)?;
                        second.remove(&mut self.bench);
                    }
                    self.bench.run(WATCHED)?;
                }
                self.is_off(begin, was_on, limit, outcome)?;
                // Where only the watchdog can end the fault, it has reset the processor within this time.
                if codes.contains(&FaultCode::Watchdog) {
                    self.bench.run(150 * MS)?;
                }
                let must_reset = matches!(injection.expect, Expect::Reset(..))
                    && !codes.contains(&FaultCode::DeadlineMiss);
                if must_reset && self.bench.machine.resets.len() == resets {
                    return Err("no reset".into());
                }
                self.is_latched(begin, injection, codes, outcome)
            }
        }
    }

    /// Checks that the outputs were switched off within the allowed time and stayed off.
    fn is_off(
        &mut self,
        begin: u64,
        was_on: bool,
        limit_us: u64,
        outcome: &mut Outcome,
    ) -> Result<(), String> {
        let changes = &self.bench.machine.chip().bridge.changes;
        let since: Vec<_> = changes.iter().filter(|(time, _)| *time >= begin).collect();
        if !was_on {
            return match since.is_empty() {
                true => Ok(()),
                false => Err("the outputs went on".into()),
            };
        }
        let Some((time, false)) = since.first() else {
            return Err("the outputs stay on".into());
        };
        let us = (time - begin) as f64 / US as f64;
        outcome.off_us = Some(us);
        if since.len() > 1 {
            return Err(format!(
                "the outputs went on again {} us later",
                (since[1].0 - time) / US
            ));
        }
        if us > limit_us as f64 {
            return Err(format!("later than {limit_us} us"));
        }
        Ok(())
    }

    /// Checks that the outputs are off at the end of the allowed time and stay off, even if they were switched on and off before.
    fn is_off_at_last(
        &mut self,
        begin: u64,
        limit_us: u64,
        outcome: &mut Outcome,
    ) -> Result<u64, String> {
        let changes = &self.bench.machine.chip().bridge.changes;
        let mut since = changes.iter().filter(|(time, _)| *time >= begin);
        let Some((time, false)) = since.next_back() else {
            return Err("the outputs stay on".into());
        };
        let us = (time - begin) as f64 / US as f64;
        outcome.off_us = Some(us);
        match us > limit_us as f64 {
            true => Err(format!("later than {limit_us} us")),
            false => Ok(*time),
        }
    }

    /// Checks that the fault is latched, that only the command `Stop` clears it, and that no command switches the outputs on.
    fn is_latched(
        &mut self,
        begin: u64,
        injection: &Injection,
        codes: &[FaultCode],
        outcome: &mut Outcome,
    ) -> Result<(), String> {
        let persistent_hang = matches!(injection.fault, Fault::Storm(..) | Fault::Slow(_));
        if persistent_hang {
            // The device cannot answer while this fault lasts, so the fault is removed first.
            injection.fault.remove(&mut self.bench);
            self.bench.run(200 * MS)?;
        }
        let status = self.bench.status()?;
        outcome.code = status.fault.and_then(|fault| fault.known());
        if codes.is_empty() {
            return match status.phase {
                Phase::Boot => self.does_not_rearm(begin, &[DeviceCommand::Arm]),
                other => Err(format!("{} after the reset", other.name())),
            };
        }
        if status.phase != Phase::Fault {
            return Err(format!("{} instead of fault", status.phase.name()));
        }
        match outcome.code {
            Some(code) if codes.contains(&code) => {}
            other => return Err(format!("{other:?} instead of {codes:?}")),
        }
        self.does_not_rearm(
            begin,
            &[
                DeviceCommand::Arm,
                DeviceCommand::Calibrate,
                DeviceCommand::Disarm,
            ],
        )?;
        let after = self.bench.fault()?.and_then(|fault| fault.known());
        if after != outcome.code {
            return Err(format!("{after:?} has replaced the first cause"));
        }
        // The cause of the fault is removed. The device must still not arm on its own.
        self.mend(injection);
        self.does_not_rearm(begin, &[DeviceCommand::Arm, DeviceCommand::Calibrate])?;
        if !self.bench.command(DeviceCommand::Stop)? {
            return Err("Stop was refused".into());
        }
        self.does_not_rearm(begin, &[DeviceCommand::Arm])
    }

    fn does_not_rearm(&mut self, begin: u64, commands: &[DeviceCommand]) -> Result<(), String> {
        for command in commands {
            if self.bench.command(*command)? {
                return Err(format!("{command:?} was taken"));
            }
        }
        self.bench.run(10 * MS)?;
        let changes = &self.bench.machine.chip().bridge.changes;
        match changes.iter().any(|(time, on)| *time >= begin && *on) {
            true => Err("the outputs went on again".into()),
            false => Ok(()),
        }
    }

    /// Checks that the fault does not disturb the device: it stays armed and keeps sending telemetry. After a rise in temperature
    /// it must reduce the current limit.
    fn goes_on(&mut self, injection: &Injection) -> Result<(), String> {
        let from = self.bench.link.telemetry.len();
        let before = self.bench.now();
        self.bench.run(50 * MS)?;
        self.bench
            .run_until("the line quiet", 5_000 * MS, |bench| {
                bench.machine.chip_mut().link().on_the_line() == 0
            })?;
        // The zero byte ends a frame that the noise may have begun.
        self.bench.send(&[0]);
        self.bench.run(20 * MS)?;
        let status = self.bench.status()?;
        if status.phase != Phase::Armed || !self.bench.is_on() {
            return Err(format!("{} with {:?}", status.phase.name(), status.fault));
        }
        let ticks = (self.bench.now() - before) / MS;
        let records = self.bench.link.telemetry.len() - from;
        if (records as u64) < ticks / 2 {
            return Err(format!("{records} records in {ticks} ticks"));
        }
        let is_felt = self.bench.machine.chip().board.has_thermistor();
        if let (Fault::Temperature(_), true) = (injection.fault, is_felt) {
            let records = &self.bench.link.telemetry[from + 20..];
            let limited = records.iter().filter(|record| record.limits != 0).count();
            if limited == 0 {
                return Err("no record tells of the derating".into());
            }
        }
        Ok(())
    }
}

/// Waits until the knob rests, as a person does before a calibration. A light rotor that was released at a reset swings for
/// seconds. The field may then draw it to another pole, and the calibration fails. The range of the angle over a tenth of a second
/// is judged, not single values: a knob that swings ten times a second is at the same angle after each tenth.
fn rest(bench: &mut Bench) -> Result<(), String> {
    for _ in 0..100 {
        let mut within_rad = [f64::INFINITY, f64::NEG_INFINITY];
        for _ in 0..100 {
            bench.run(MS)?;
            let angle_rad = bench.machine.chip().world.angle_rad();
            within_rad = [within_rad[0].min(angle_rad), within_rad[1].max(angle_rad)];
        }
        if within_rad[1] - within_rad[0] < RESTS_RAD {
            return Ok(());
        }
    }
    Err("the shaft does not come to rest in ten seconds".into())
}

/// Calibrates the device. If the calibration fails as uneven, calibrates once more, as a person would. Friction can hold a light
/// rotor against the field until nearly full current; the rotor then swings too far.
fn calibrate(bench: &mut Bench) -> Result<(), String> {
    let uneven = |bench: &mut Bench| {
        let fault = bench.status()?.fault;
        Ok::<_, String>(fault.is_some_and(|fault| {
            fault.code == FaultCode::CalibrationFailed.to_wire() && fault.value == UNEVEN
        }))
    };
    match bench.calibrate() {
        Err(_) if uneven(bench)? => {
            bench.demand(Request::Command(DeviceCommand::Stop))?;
            rest(bench)?;
            bench.calibrate()
        }
        done => done,
    }
}
