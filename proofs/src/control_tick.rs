//! A device's control tick, from the readings to the drive's command, compared with its specification. The device's parts (law,
//! limits, drive) may return any result. The code calls them with the same arguments as the specification, and calculates the same
//! from their results. Random tests run six ticks in a row with the real parts.
//!
//! ```text
//! output, memory = spec(memory, input, answers)     p11_control_tick
//! ```
//!
//! Many of the parts have proofs of their own: the counter (`device::p9_*`), the fault machine (`device::p10_*`), count to
//! penetration (`settings::p6_penetration*`), law and guard (`refines`), the torque that fades in and its current (`drive::p4_*`).

use crate::contact_phase::contact_of;
use crate::device::{any_command, any_context, any_state};
use crate::source::Source;
use crate::spec::control_tick::{self, Parts};
use crate::{cover, replaced_property};
use fixed::types::{I8F24, I16F16};
use touchstone_control::law::View;
use touchstone_control::{Controller, Energy, Fixed32, Force, Position};
use touchstone_drive::calibration::{Alignment, Calibration, Progress};
use touchstone_drive::change::ChangeConfig;
use touchstone_drive::command::{AnyDrive, Drive as _, Driven, Rotor};
use touchstone_drive::device::{Memory, torque_of};
use touchstone_drive::hardware::IHM08M1;
use touchstone_drive::supervisor::power::Power;
use touchstone_drive::supervisor::{Supervisor, Verdict, Watch};
use touchstone_drive::transform::Dq;
use touchstone_drive::{
    Amps, Angle, Celsius, Config, ControlInput, CurrentReport, Device, DriveCommand, EncoderKind,
    EncoderReading, Record, Si, TickTiming, Trip,
};
use touchstone_protocol::settings::DriveKind;
use touchstone_protocol::{DeviceSettings, Limit, Limits, Machine, Outputs, State};

#[cfg(kani)]
use crate::device_parts::{end, of_specification};
/// Number of control ticks that the comparison runs in a row: one under the model checker, six in random tests.
const TICKS: usize = if cfg!(kani) { 1 } else { 6 };
/// Does nothing in random tests. Under the model checker, the function of this name in `device_parts` marks that the specification
/// makes all further calls.
#[cfg(not(kani))]
fn of_specification() {}
#[cfg(not(kani))]
fn end() -> bool {
    true
}
/// Asserts in random tests that code and specification have the same law with the same memory. The model checker replaces the law,
/// so there is no memory to compare.
#[cfg(not(kani))]
fn same_law(device: &Device, own: &Own) {
    assert!(*device.law() == own.law, "the law remembers the same");
}
#[cfg(kani)]
fn same_law(_: &Device, _: &Own) {}

/// The device's parts as the specification calls them: the real parts in random tests, the recorded answers under the model
/// checker.
struct Own {
    config: Config,
    supervisor: Supervisor,
    law: Controller<Fixed32>,
    calibration: Option<Calibration>,
    input: ControlInput,
    /// Whether new settings wait to take effect.
    waits: bool,
    next: Config,
    found: Option<Verdict>,
}

impl Parts for Own {
    fn inspect(&mut self, watch: Watch) -> Verdict {
        let found = self
            .supervisor
            .inspect(&self.config.supervisor, &self.input, watch);
        self.found = Some(found);
        found
    }
    fn aligns(&self) -> bool {
        matches!(self.config.drive, AnyDrive::ThreePhase(_))
    }
    fn calibrate(&mut self, tick: u32, count: i64) -> Progress {
        let fresh = Calibration::new(self.config.calibration);
        let mut running = self.calibration.unwrap_or(fresh);
        let progress = running.tick(tick, count, &self.input.current);
        // The checker uses recorded answers instead of this calibration, which then has no memory.
        if cfg!(not(kani)) {
            self.calibration = Some(running);
        }
        progress
    }
    fn calibration_over(&mut self) {
        self.calibration = None;
    }
    fn changes_wait(&self) -> bool {
        self.waits
    }
    fn changes_over(&mut self) -> bool {
        let waited = core::mem::take(&mut self.waits);
        if waited {
            // Under the checker, code and specification have the same settings.
            if cfg!(not(kani)) {
                self.config = self.next;
            }
            self.supervisor.restart();
        }
        waited
    }
    fn speed(&mut self) -> i32 {
        self.supervisor
            .shaft()
            .speed(self.config.supervisor.shaft())
            .to_bits()
    }
    fn advance(&mut self) -> i32 {
        self.supervisor
            .shaft()
            .advance(self.config.supervisor.shaft())
    }
    fn angle(&mut self, count: i64) -> u16 {
        self.config.electrical.angle(count).0
    }
    fn temperature(&mut self) -> Option<Celsius> {
        Power::temperature(&self.config.thermistor, &self.input.current)
    }
    fn penetration(&mut self, count: i64) -> i32 {
        self.config.scale.penetration::<Fixed32>(count).0.to_bits()
    }
    fn measures_change(&self) -> bool {
        self.config.change.is_some()
    }
    fn since_change(&mut self, until: i32, from: i32) -> i32 {
        let change = self.config.change.expect("asked where it is measured");
        change
            .since_change(position(until), position(from))
            .0
            .to_bits()
    }
    fn resume(&mut self) {
        self.law.resume(&self.config.law);
    }
    fn law(&mut self, e: i32, at_change: Option<i32>) -> i32 {
        self.law
            .tick_with_change(position(e), at_change.map(position))
            .0
            .to_bits()
    }
    fn view(&mut self) -> View<Fixed32> {
        self.law.view()
    }
    fn commanded(&mut self, force: i32) {
        self.law.commanded(Force(I8F24::from_bits(force)));
    }
    fn switched_off(&mut self) {
        self.law.switched_off();
    }
    fn is_tripped(&mut self) -> bool {
        self.law.tripped()
    }
    fn is_beyond_reach(&mut self, e: i32) -> bool {
        self.law.is_beyond_reach(position(e))
    }
    fn force_limit(&self) -> i32 {
        self.config.force_limit.to_bits()
    }
    fn fade_step(&self) -> u32 {
        self.config.fade_step
    }
    fn torque(&mut self, force: i32, share: Option<u32>) -> i32 {
        torque_of(Force(I8F24::from_bits(force)), share).0.to_bits()
    }
    fn drive(&mut self, torque: i32, rotor: &Rotor) -> Driven {
        self.config
            .drive
            .command(Force(I8F24::from_bits(torque)), rotor)
    }
}

fn position(bits: i32) -> Position<Fixed32> {
    Position(I8F24::from_bits(bits))
}
fn any_position<S: Source>(s: &mut S) -> Position<Fixed32> {
    position(s.i32())
}
/// A value that is sometimes `None` in random tests. Under the model checker it is always `None`, to save a case.
fn some_sampled<S: Source, T>(s: &mut S, any: impl FnOnce(&mut S) -> T) -> Option<T> {
    if cfg!(kani) { None } else { some(s, any) }
}
fn some<S: Source, T>(s: &mut S, any: impl FnOnce(&mut S) -> T) -> Option<T> {
    s.bool().then(|| any(s))
}

/// The configuration of any device settings that change how a tick runs. `None` if the settings are refused.
fn any_config<S: Source>(s: &mut S) -> Option<Config> {
    let mut settings = DeviceSettings::default();
    settings.encoder.kind = EncoderKind::Incremental;
    settings.encoder.counts_per_rev = if s.bool() { 4_096 } else { 16_384 };
    if s.bool() {
        settings.drive.kind = DriveKind::Analogue;
    }
    let mut config = Config::new(&settings, &IHM08M1).ok()?;
    config.fade_step = s.u32();
    config.force_limit = I8F24::from_bits(s.i32());
    let (before, after) = (s.i32() >> 3, s.i32() >> 3);
    config.change = some(s, |_| ChangeConfig {
        read_at: 0,
        before,
        after,
        delay_s: Si::ZERO,
        lag_s: Si::ZERO,
    });
    Some(config)
}
fn any_memory<S: Source>(s: &mut S) -> Memory {
    let last = any_position(s);
    // In random tests the displacement is mostly short, because the law's force then varies more.
    let way = |s: &mut S| {
        if s.shortcut() {
            position(s.i16().into())
        } else {
            any_position(s)
        }
    };
    Memory {
        machine: Machine::at(any_state(s)),
        alignment: any_alignment(s),
        zero: s.i64(),
        fade: if s.bool() { u32::MAX } else { s.u32() },
        reported: some(s, |s| (any_context(s).code, s.i32())),
        settings_refused: s.bool(),
        saturated: s.u16(),
        pushes: s.bool(),
        read: some(s, way),
        record: Record {
            tick: s.u32(),
            state: State::Boot,
            limits: Limits::from_wire(s.u8()),
            count: s.i64(),
            law_ran: s.bool(),
            penetration: last,
            since_change: any_position(s),
            force: Force(I8F24::from_bits(s.i32())),
            offset: any_position(s),
            energy: some(s, |s| Energy(fixed::FixedI64::from_bits(s.i64()))),
            contact: contact_of(s.u8()),
            torque: Force(I8F24::from_bits(s.i32())),
            current_command: Amps::from_bits(s.i32()),
            current: any_current(s),
            bus: I16F16::from_bits(s.i32()),
            temperature: some(s, |s| I16F16::from_bits(s.i32())),
            speed_rad_per_s: I16F16::from_bits(s.i32()),
            timing: any_timing(s),
        },
    }
}
fn any_alignment<S: Source>(s: &mut S) -> Alignment {
    Alignment {
        offset: Angle(s.u16()),
        against: s.bool(),
    }
}

/// Any input of a control tick. Supply and temperature are either fixed or arbitrary.
fn any_input<S: Source>(s: &mut S) -> ControlInput {
    let is_quiet = s.shortcut();
    ControlInput {
        encoder: if s.bool() {
            EncoderReading::Counter32(s.u32())
        } else {
            EncoderReading::Silent
        },
        current: if is_quiet {
            CurrentReport {
                current: any_current(s),
                bus: I16F16::from_bits(24 << 16),
                temperature: 0x800,
                saturated: s.u16(),
                ..CurrentReport::default()
            }
        } else {
            CurrentReport {
                periods: s.u32(),
                current: any_current(s),
                voltage: any_current(s),
                bus: I16F16::from_bits(s.i32()),
                temperature: s.u16(),
                missed: s.u16(),
                saturated: s.u16(),
                trips: s.u8(),
                trip: some_sampled(s, |s| Trip {
                    code: any_context(s).code,
                    value: s.i32(),
                }),
                offsets: None,
            }
        },
        command: some(s, any_command),
        hardware_break: !is_quiet && s.bool(),
        gate_driver_error: !is_quiet && s.bool(),
        stop_button: !is_quiet && s.bool(),
        host_heard: is_quiet || s.bool(),
        timing: if is_quiet {
            TickTiming::default()
        } else {
            any_timing(s)
        },
    }
}
fn any_current<S: Source>(s: &mut S) -> Dq {
    Dq {
        d: Amps::from_bits(s.i32()),
        q: Amps::from_bits(s.i32()),
    }
}
fn any_timing<S: Source>(s: &mut S) -> TickTiming {
    TickTiming {
        lateness: s.u32(),
        duration: s.u32(),
    }
}

replaced_property! {
    [(touchstone_drive::settings::validate, crate::device_parts::accepted)
    (touchstone_control::quotient::quotient, crate::device_parts::some_quotient)
    (touchstone_drive::change::law_settings, crate::device_parts::law_settings)
    (touchstone_control::Controller::new, crate::device_parts::law_made)
    (touchstone_drive::supervisor::Supervisor::inspect, crate::device_parts::inspect)
    (touchstone_drive::supervisor::Supervisor::restart, crate::device_parts::restart)
    (touchstone_drive::supervisor::shaft::Shaft::speed, crate::device_parts::speed)
    (touchstone_drive::supervisor::shaft::Shaft::advance, crate::device_parts::advance)
    (touchstone_drive::supervisor::power::Power::temperature, crate::device_parts::temperature)
    (touchstone_drive::calibration::Calibration::tick, crate::device_parts::calibrate)
    (touchstone_drive::angle::ElectricalScale::angle, crate::device_parts::angle)
    (touchstone_control::CountScale::penetration, crate::device_parts::penetration)
    (touchstone_drive::change::ChangeConfig::since_change, crate::device_parts::since_change)
    (touchstone_control::Controller::resume, crate::device_parts::resume)
    (touchstone_control::Controller::tick_with_change, crate::device_parts::law)
    (touchstone_control::Controller::view, crate::device_parts::view)
    (touchstone_control::Controller::commanded, crate::device_parts::commanded)
    (touchstone_control::Controller::switched_off, crate::device_parts::switched_off)
    (touchstone_control::Controller::tripped, crate::device_parts::is_tripped)
    (touchstone_control::Controller::is_beyond_reach, crate::device_parts::is_beyond_reach)
    (touchstone_drive::device::torque_of, crate::device_parts::torque)
    (<touchstone_drive::command::AnyDrive as touchstone_drive::command::Drive>::command, crate::device_parts::command)]
    /// P11 (refinement): a control tick equals its specification, from the reading to the drive's command, with the whole memory.
    /// Code and specification call the device's parts with the same arguments, for any results of the parts. Calls that change law
    /// or supervisor are in the same order.
    equation "output, memory = spec(memory, input, answers); on => armed or calibrating, no fault, a good reading"
    over "memory, input and command, settings that wait; three phases or analogue, steps of fading in, force limits; without a measurement; under the checker one tick, whatever the parts answer, by samples six of the parts as they are"
    by minisat fn p11_control_tick(s) {
        let Some(config) = any_config(s) else {
            return;
        };
        // The checker's formula would be too large with two configurations. Random tests check which one a tick uses.
        let next = if cfg!(kani) { config } else { any_config(s).unwrap_or(config) };
        let mut device = Device::of(config, any_memory(s));
        let waits = s.bool();
        if waits {
            device.prepare(next);
        }
        let mut own = Own {
            config,
            supervisor: Supervisor::new(),
            law: config.law,
            calibration: None,
            input: any_input(s),
            waits,
            next,
            found: None,
        };
        for tick in 0..TICKS {
            let memory = *device.memory();
            let input = if tick == 0 { own.input } else { any_input(s) };
            let before = memory.machine.state();
            let found = device.tick(&input);
            of_specification();
            own.input = input;
            let (remembered, specified) = control_tick::tick(&memory, &input, &mut own);
            assert!(end());
            assert!(found == specified);
            assert!(*device.memory() == remembered);
            same_law(&device, &own);
            let after = device.state();
            let is_off = found.outputs == Outputs::Off;
            let calibrates = before == State::Calibrating && after == before;
            let is_fine = own.found.is_some_and(|found| found.count.is_some() & found.fault.is_none());
            assert!(is_off || after == State::Armed || calibrates);
            assert!(is_off || is_fine && memory.reported.is_none());
            let fades = found.record.limits.has(Limit::FadeIn);
            let torque = found.record.torque != Force::zero();
            let analogue = matches!(found.drive, DriveCommand::Analogue(_));
            let moved = found.record.since_change != Position::zero();
            let tripped = device.memory().reported.is_some();
            let (was_ready, was_armed) = (before == State::Ready, before == State::Armed);
            cover!(s, found.reconfigure, "other settings");
            cover!(s, was_ready & fades & torque, "begins to fade in");
            cover!(s, !fades & torque & analogue, "all of it, by an amplifier");
            cover!(s, was_armed & moved & (after != before), "left, measured");
            cover!(s, was_armed & tripped & (after == before), "tripped under a force");
        }
    }
}
