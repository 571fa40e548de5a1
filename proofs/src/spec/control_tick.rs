//! Specification of a device's control tick: which of the device's parts (drive, law, limits) the tick calls, and what it
//! calculates from their answers.
//!
//! `e` is the penetration, `f` the force, `τ` the torque, `i` the current; `share` (0 to 1) is the factor by which the torque fades
//! in; `'` marks the new value.
//!
//! ```text
//! fault     = reported, else detected, else refused settings      the first one is latched, and outputs go off
//! count'    = count - zero,  e = angle(count') - surface          from a good reading
//! f         = law(e, e - displacement since the change of force)  if armed with a good reading; else the drive is off
//! share'    = min(share + step, 1)                                0 at arming
//! τ         = -f share', or -f once the share was 1
//! (i, τ')   = drive(τ, angle, derating)
//! reported  = -τ' while fading in or if τ' /= τ                   the law's guard calculates with that force
//! tripped   : law restarted if no force acted, or if e is so near the end of positions that the guard allows none; else a fault in
//!             the next tick
//! disarmed  : where the last force acted up to now, one law tick with no force closes the energy account; then
//!             the switching off is reported to the law
//! ```
//!
//! If the device is armed but has no good reading, the drive is off and the law is not called. Its guard then counts the last force
//! up to the next reading.

use super::{Int, LOWEST, signal};
use touchstone_control::law::{Contact, View};
use touchstone_control::{Fixed32, Force, Position};
use touchstone_drive::calibration::{Alignment, Progress};
use touchstone_drive::command::{Driven, Rotor};
use touchstone_drive::device::Memory;
use touchstone_drive::supervisor::{Verdict, Watch};
use touchstone_drive::{Amps, Angle, Celsius, ControlInput, ControlOutput, DriveCommand, Record};
use touchstone_protocol::{Command, Context, FaultCode, Limit, Limits, Machine, Outputs, State};

/// The factor of the whole torque, with 32 fractional bits. It is 2^-32 less than 1, so that it fits 32 bits.
const ALL: Int = (1 << 32) - 1;

/// The parts of a device that a control tick calls. Each may give any answer.
pub trait Parts {
    /// Checks the limits. Returns the first limit that is exceeded, the shaft's position, and the fraction of the current that the
    /// temperatures allow.
    fn inspect(&mut self, watch: Watch) -> Verdict;
    /// Whether the drive has a motor whose electrical angle must be aligned with the encoder.
    fn aligns(&self) -> bool;
    /// Runs one tick of the calibration at an encoder count.
    fn calibrate(&mut self, tick: u32, count: i64) -> Progress;
    /// Ends the calibration, so that the next tick does not run it.
    fn calibration_over(&mut self);
    /// Whether new settings are waiting.
    fn changes_wait(&self) -> bool;
    /// Applies new settings that are waiting; returns whether any were waiting.
    fn changes_over(&mut self) -> bool;
    /// Shaft's speed in rad/s, with 16 fractional bits.
    fn speed(&mut self) -> i32;
    /// Electrical angle by which the rotor advances in one PWM period, in 2^-32 turns.
    fn advance(&mut self) -> i32;
    /// Electrical angle that belongs to an encoder count.
    fn angle(&mut self, count: i64) -> u16;
    /// Temperature of the power stage; `None` if it is not known.
    fn temperature(&mut self) -> Option<Celsius>;
    /// Penetration into the wall at an encoder count.
    fn penetration(&mut self, count: i64) -> i32;
    /// Whether the encoder is read a second time when the force changes.
    fn measures_change(&self) -> bool;
    /// Displacement since the force changed. Of the tick's displacement, `until` passed before the second encoder reading and
    /// `from` after it.
    fn since_change(&mut self, until: i32, from: i32) -> i32;
    /// Restarts the law, as when the outputs are switched on (arming).
    fn resume(&mut self);
    /// The law's force at the penetration `e`; `at_change` is the penetration at which the motor's force changed, if measured.
    fn law(&mut self, e: i32, at_change: Option<i32>) -> i32;
    /// The law's internal values, for telemetry.
    fn view(&mut self) -> View<Fixed32>;
    /// Reports to the law the force that was finally commanded.
    fn commanded(&mut self, force: i32);
    /// Reports to the law that the force is switched off.
    fn switched_off(&mut self);
    /// Whether the law's guard has switched the force off because of overspeed.
    fn is_tripped(&mut self) -> bool;
    /// Whether a position is so deep inside the wall, near the end of the range of positions, that the guard allows no force.
    fn is_beyond_reach(&mut self, e: i32) -> bool;
    /// Smallest force at which a tick counts as being at the force limit.
    fn force_limit(&self) -> i32;
    /// Growth per tick of the factor by which the torque fades in, in units of 2^-32.
    fn fade_step(&self) -> u32;
    /// Torque for a force; `share` is the factor by which the torque fades in, in units of 2^-32, or `None` once it has faded in.
    fn torque(&mut self, force: i32, share: Option<u32>) -> i32;
    /// Drive command for a torque, given the rotor's position.
    fn drive(&mut self, torque: i32, rotor: &Rotor) -> Driven;
}

/// The difference `a - b` of two positions, limited to the range of positions.
fn difference(a: i32, b: i32) -> i32 {
    signal(Int::from(a) - Int::from(b)) as i32
}
fn position(bits: i32) -> Position<Fixed32> {
    Position(fixed::FixedI32::from_bits(bits))
}
fn force(bits: i32) -> Force<Fixed32> {
    Force(fixed::FixedI32::from_bits(bits))
}

/// State of the device after a tick without a fault.
#[must_use]
pub fn next(state: State, calibrated: bool, command: Option<Command>) -> State {
    match (state, command) {
        (_, Some(Command::Stop)) => State::Stopped,
        (State::Boot | State::Stopped, Some(Command::Calibrate)) => State::Calibrating,
        (State::Calibrating, _) if calibrated => State::Ready,
        (State::Ready, Some(Command::Arm)) => State::Armed,
        (State::Armed, Some(Command::Disarm)) => State::Ready,
        _ => state,
    }
}

/// One control tick: returns the new memory and the output.
pub fn tick(
    found: &Memory,
    input: &ControlInput,
    parts: &mut impl Parts,
) -> (Memory, ControlOutput) {
    let before = found.machine.state();
    let number = (u64::from(found.record.tick) + 1) as u32;
    let armed = before == State::Armed;
    let watched = armed
        || before == State::Calibrating
        || before == State::Ready
        || input.command == Some(Command::Calibrate) && !parts.changes_wait();
    let drove = armed && found.record.law_ran;
    let verdict = parts.inspect(Watch {
        watched,
        may_be_on: armed || before == State::Calibrating,
        driven: drove,
        untold: parts.measures_change() && found.read.is_none(),
        against: found.alignment.against,
    });

    let mut fault = match (found.reported, verdict.fault) {
        (Some(first), _) | (None, Some(first)) => Some(first),
        (None, None) if found.settings_refused && watched => Some((FaultCode::SettingsInvalid, 0)),
        (None, None) => None,
    };
    let mut progress = None;
    if let (State::Calibrating, None, Some(count)) = (before, fault, verdict.count) {
        let now = match parts.aligns() {
            true => parts.calibrate(number, count),
            false => Progress::Done(Alignment::default()),
        };
        if let Progress::Failed(code, value) = now {
            fault = Some((code, value));
        }
        progress = Some(now);
    }
    let calibrated = matches!(progress, Some(Progress::Done(_)));
    let after = match (before, fault) {
        (State::Fault(_), Some(_)) => before,
        (_, Some((code, value))) => State::Fault(Context {
            code,
            tick: number,
            value,
        }),
        (_, None) => next(before, calibrated, input.command),
    };

    let mut new = *found;
    new.machine = Machine::at(after);
    new.reported = None;
    new.read = None;
    let entered = |state: State| before != after && after == state;
    if let (true, Some(Progress::Done(alignment)), Some(count)) =
        (entered(State::Ready), progress, verdict.count)
    {
        new.alignment = alignment;
        new.zero = count;
    }
    if entered(State::Armed) {
        parts.resume();
        new.fade = 0;
        new.pushes = false;
    }
    if before != after {
        parts.calibration_over();
    }
    let reconfigure = entered(State::Calibrating) && parts.changes_over();

    let last = found.record.penetration.0.to_bits();
    let mut count = found.record.count;
    let mut penetration = last;
    if let Some(turned) = verdict.count {
        count = (Int::from(turned) - Int::from(new.zero)).clamp(i64::MIN.into(), i64::MAX.into())
            as i64;
        penetration = parts.penetration(count);
    }
    let speed = parts.speed();
    new.record = Record {
        tick: number,
        state: after,
        limits: Limits::NONE,
        count,
        law_ran: false,
        penetration: position(penetration),
        since_change: position(0),
        force: force(0),
        offset: position(0),
        energy: None,
        contact: Contact::Free,
        torque: force(0),
        current_command: Amps::ZERO,
        current: input.current.current,
        bus: input.current.bus,
        temperature: parts.temperature(),
        speed_rad_per_s: Amps::from_bits(speed),
        timing: input.timing,
    };

    let shows = after == State::Armed && verdict.count.is_some();
    // The last tick's force acted up to this reading.
    let acted = drove && fault.is_none() && verdict.count.is_some();
    let leaves = armed && after != State::Armed;
    let mut at_change = None;
    if shows || leaves && acted {
        if let (true, Some(read)) = (parts.measures_change(), found.read) {
            let until = read.0.to_bits();
            let moved = difference(penetration, last);
            let since = parts.since_change(until, difference(moved, until));
            new.record.since_change = position(since);
        }
        let since = new.record.since_change.0.to_bits();
        at_change = parts
            .measures_change()
            .then_some(difference(penetration, since));
    }
    if leaves && acted {
        parts.law(penetration, at_change);
        parts.commanded(0);
    }
    if leaves {
        parts.switched_off();
    }

    let drive = if let (true, Some(turned)) = (shows, verdict.count) {
        let shown = parts.law(penetration, at_change);
        let view = parts.view();
        let fades = Int::from(new.fade) < ALL;
        new.fade = (Int::from(new.fade) + Int::from(parts.fade_step())).min(ALL) as u32;
        let torque = parts.torque(shown, fades.then_some(new.fade));
        let against = new.alignment.against;
        let turns = |angle: Int| if against { -angle } else { angle };
        let angle = Int::from(new.alignment.offset.0) + turns(parts.angle(turned).into());
        let advance = turns(parts.advance().into()).min(i32::MAX.into());
        let rotor = Rotor {
            tick: number,
            angle: Angle(angle.rem_euclid(1 << 16) as u16),
            advance: advance as i32,
            against,
            derating: verdict.derating,
            ..Rotor::default()
        };
        let driven = parts.drive(torque, &rotor);
        let left = driven.torque.0.to_bits();
        if fades || left != torque {
            parts.commanded(signal(-Int::from(left)) as i32);
        }
        let pushed = new.pushes;
        new.pushes = shown != 0;
        let mut beyond = false;
        if parts.is_tripped() {
            beyond = parts.is_beyond_reach(penetration);
            if beyond {
                parts.switched_off();
                parts.resume();
            } else if pushed || view.contact != Contact::Free {
                let milli = (Int::from(speed) * 1_000).div_euclid(1 << 16);
                new.reported = Some((FaultCode::OverSpeed, signal(milli) as i32));
            } else {
                parts.resume();
            }
        }
        let size = Int::from(shown).abs().min(-LOWEST - 1);
        new.record = Record {
            law_ran: true,
            force: force(shown),
            torque: driven.torque,
            offset: view.offset,
            energy: view.energy,
            contact: view.contact,
            limits: driven
                .limits
                .with(Limit::FadeIn, fades)
                .with(Limit::Reach, beyond)
                .with(Limit::Force, size >= Int::from(parts.force_limit())),
            ..new.record
        };
        driven.command
    } else if let (State::Calibrating, Some(Progress::Running(command))) = (after, progress) {
        DriveCommand::Current(command)
    } else {
        DriveCommand::Off
    };

    new.saturated = input.current.saturated;
    let limits = new.record.limits;
    new.record.limits = limits
        .with(Limit::Voltage, found.saturated != input.current.saturated)
        .with(Limit::Encoder, watched && verdict.count.is_none());
    if let DriveCommand::Current(command) = drive {
        new.record.current_command = command.current.q;
    }
    let is_off = drive == DriveCommand::Off;
    let output = ControlOutput {
        outputs: if is_off { Outputs::Off } else { Outputs::On },
        drive,
        clear_latches: matches!(before, State::Fault(_)) && after == State::Stopped,
        reconfigure,
        accepted: input
            .command
            .map(|command| fault.is_none() && next(before, false, Some(command)) != before),
        record: new.record,
    };
    (new, output)
}
