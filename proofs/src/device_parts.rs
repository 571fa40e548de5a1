//! Replacements of a device's parts (law, limits, drive) when the model checker runs. A part returns any result to the code, and
//! the same result to the specification, which must call with the same arguments.
//!
//! A part is called at most once in a tick. Some calls change law or supervisor, or read what may have changed in the law. Their
//! arguments include the history of the calls before them. The part itself and its coefficients are not recorded as arguments; the
//! property's random tests cover those.

use crate::contact_phase::contact_of;
use crate::controller::plain;
use crate::device::code_of;
use crate::format::Format;
use crate::source::Symbolic;
use core::sync::atomic::{AtomicI64, AtomicUsize, Ordering::Relaxed};
use fixed::types::I8F24;
use touchstone_control::law::View;
use touchstone_control::{Controller, CountScale, Fixed32, Force, Number, Position, Settings, Si};
use touchstone_drive::angle::ElectricalScale;
use touchstone_drive::calibration::{Alignment, Calibration, Progress};
use touchstone_drive::change::ChangeConfig;
use touchstone_drive::command::{AnyDrive, Driven, Rotor};
use touchstone_drive::supervisor::power::Power;
use touchstone_drive::supervisor::shaft::{Shaft, ShaftConfig};
use touchstone_drive::supervisor::{Supervisor, SupervisorConfig, Verdict, Watch};
use touchstone_drive::thermistor::Thermistor;
use touchstone_drive::transform::Dq;
use touchstone_drive::{
    Amps, Angle, Celsius, ControlInput, CurrentCommand, CurrentMode, CurrentReport, DacCode,
    DeviceSettings, DriveCommand, EncoderReading, Hardware, SettingsError,
};
use touchstone_protocol::Limits;

static SPECIFIES: AtomicUsize = AtomicUsize::new(0);
/// Record of which calls changed law or supervisor in this tick, in order: one octal digit per call.
static HISTORY: AtomicUsize = AtomicUsize::new(1);
/// 1 if the specification has called a part with other arguments than the code, or if one of them has called a part twice.
static DIFFERS: AtomicUsize = AtomicUsize::new(0);
static OF_CODE: AtomicUsize = AtomicUsize::new(0);

/// Marks that the specification makes all further calls of parts.
pub fn of_specification() {
    OF_CODE.store(HISTORY.swap(1, Relaxed), Relaxed);
    SPECIFIES.store(1, Relaxed);
}
/// Whether the specification has called the same parts as the code, with the same arguments. The order must be the same for calls
/// that change law or supervisor.
#[must_use]
pub fn end() -> bool {
    let open = [
        found::is_open(),
        calibrated::is_open(),
        sped::is_open(),
        advanced::is_open(),
        turned::is_open(),
        warm::is_open(),
        behind::is_open(),
        since::is_open(),
        pushed::is_open(),
        viewed::is_open(),
        told::is_open(),
        tripped::is_open(),
        beyond::is_open(),
        faded::is_open(),
        driven::is_open(),
    ];
    let same_history = HISTORY.load(Relaxed) == OF_CODE.load(Relaxed);
    same_history & (open == [false; 15]) & (DIFFERS.load(Relaxed) == 0)
}
fn done(what: usize) -> i64 {
    let history = (HISTORY.load(Relaxed) << 3) | what;
    HISTORY.store(history, Relaxed);
    history as i64
}
fn so_far() -> i64 {
    HISTORY.load(Relaxed) as i64
}

/// Defines the replacement of one part of a device. The two numbers are the counts of words in its arguments and in its result.
macro_rules! part {
    ($module:ident, $words:literal, $answers:literal) => {
        mod $module {
            use super::{AtomicI64, AtomicUsize, DIFFERS, Relaxed, SPECIFIES};

            static ASKED: AtomicUsize = AtomicUsize::new(0);
            static QUESTION: [AtomicI64; $words] = [const { AtomicI64::new(0) }; $words];
            static ANSWER: [AtomicI64; $answers] = [const { AtomicI64::new(0) }; $answers];

            /// The result of a replaced part: any words for the code, and the same words for the specification.
            pub fn ask(question: [i64; $words]) -> [i64; $answers] {
                let mut answer = [0; $answers];
                let (is_new, mut same) = (SPECIFIES.load(Relaxed) == 0, true);
                // States: 0 not called, 1 called by the code, 2 called by the specification too.
                if is_new {
                    same &= ASKED.swap(1, Relaxed) == 0;
                    for at in 0..$words {
                        QUESTION[at].store(question[at], Relaxed);
                    }
                    for at in 0..$answers {
                        answer[at] = kani::any();
                        ANSWER[at].store(answer[at], Relaxed);
                    }
                } else {
                    same &= ASKED.swap(2, Relaxed) == 1;
                    for at in 0..$words {
                        same &= QUESTION[at].load(Relaxed) == question[at];
                    }
                    for at in 0..$answers {
                        answer[at] = ANSWER[at].load(Relaxed);
                    }
                }
                if !same {
                    DIFFERS.store(1, Relaxed);
                }
                answer
            }
            pub fn is_open() -> bool {
                ASKED.load(Relaxed) == 1
            }
        }
    };
}
part!(found, 6, 6);
part!(calibrated, 6, 9);
part!(sped, 1, 1);
part!(advanced, 1, 1);
part!(turned, 1, 1);
part!(warm, 1, 2);
part!(behind, 1, 1);
part!(since, 2, 1);
part!(pushed, 4, 1);
part!(viewed, 1, 4);
part!(told, 2, 1);
part!(tripped, 1, 1);
part!(beyond, 2, 1);
part!(faded, 3, 1);
part!(driven, 6, 10);

/// Replaces `settings::validate` when the model checker runs: it accepts all settings.
pub fn accepted(_: &DeviceSettings, _: &Hardware) -> Result<(), SettingsError> {
    Ok(())
}
/// Replaces `quotient` when the model checker runs: returns a coefficient that fits every format. The replaced parts do not use it.
pub fn some_quotient(_: Si, _: Si) -> Si {
    Si::from_bits(1 << 31)
}
/// Replaces `law_settings` when the model checker runs: returns settings that have no effect, as the law is replaced as well.
pub fn law_settings(
    _: &DeviceSettings,
    _: &Hardware,
) -> Result<(Settings, Option<ChangeConfig>), SettingsError> {
    Ok((Settings::default(), None))
}
/// Replaces `Controller::new` when the model checker runs: returns a controller whose ticks are replaced.
pub fn law_made<N: Number>(
    _: &Settings,
) -> Result<Controller<N>, touchstone_control::SettingsError> {
    Ok(plain())
}

/// Replaces `Supervisor::inspect` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn inspect(
    _: &mut Supervisor,
    _: &SupervisorConfig,
    input: &ControlInput,
    watch: Watch,
) -> Verdict {
    let bits = [
        watch.watched,
        watch.may_be_on,
        watch.driven,
        watch.untold,
        watch.against,
        input.hardware_break,
        input.gate_driver_error,
        input.stop_button,
        input.host_heard,
    ];
    let mut packed = 0;
    for bit in bits {
        packed = (packed << 1) | u32::from(bit);
    }
    let (encoder, word) = match input.encoder {
        EncoderReading::Silent => (0, 0),
        EncoderReading::Counter32(word) => (1, word),
        // The harness has no other readings.
        _ => (2, 0),
    };
    let both = pair((packed << 2) | encoder, word);
    let timing = pair(input.timing.lateness, input.timing.duration);
    let [a, b, c, d] = words_of(&input.current);
    let words = found::ask([both, timing, a, b, c, d]);
    let [code, value, count, derating, ..] = words;
    Verdict {
        fault: (words[4] & 1 == 1).then_some((code_of(code as u8), value as i32)),
        count: (words[5] & 1 == 1).then_some(count),
        derating: derating as u32,
    }
}
/// Replaces `Supervisor::restart` when the model checker runs: it only records the call in the history of this tick.
pub fn restart(_: &mut Supervisor) {
    done(1);
}
/// Replaces `Shaft::speed` when the model checker runs: returns any value to the code, and the same value to the specification.
pub fn speed(_: &Shaft, _: &ShaftConfig) -> Amps {
    Amps::from_bits(sped::ask([so_far()])[0] as i32)
}
/// Replaces `Shaft::advance` when the model checker runs: returns any value to the code, and the same value to the specification.
pub fn advance(_: &Shaft, _: &ShaftConfig) -> i32 {
    advanced::ask([0])[0] as i32
}
/// Replaces `Power::temperature` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn temperature(_: &Thermistor, report: &CurrentReport) -> Option<Celsius> {
    let [is_some, bits] = warm::ask([report.temperature.into()]);
    (is_some & 1 == 1).then(|| Celsius::from_bits(bits as i32))
}
fn pair(a: u32, b: u32) -> i64 {
    (i64::from(a) << 32) | i64::from(b)
}
/// The fields of a current report that the property varies under the model checker, as integers.
fn words_of(report: &CurrentReport) -> [i64; 4] {
    let two = |dq: Dq| {
        pair(
            dq.d.to_bits().cast_unsigned(),
            dq.q.to_bits().cast_unsigned(),
        )
    };
    let counts = pair(
        (u32::from(report.missed) << 16) | u32::from(report.saturated),
        (u32::from(report.temperature) << 8) | u32::from(report.trips),
    );
    let rest = pair(report.periods, report.bus.to_bits().cast_unsigned());
    [two(report.current), two(report.voltage), counts, rest]
}
/// Replaces `Calibration::tick` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn calibrate(_: &mut Calibration, tick: u32, count: i64, report: &CurrentReport) -> Progress {
    let [a, b, c, d] = words_of(report);
    let answer = calibrated::ask([a, b, c, d, tick.into(), count]);
    let words = core::array::from_fn(|at| answer[at + 1]);
    match answer[0] & 3 {
        0 => Progress::Running(command_of(&words)),
        1 => Progress::Done(Alignment {
            offset: Angle(words[0] as u16),
            against: words[1] & 1 == 1,
        }),
        _ => Progress::Failed(code_of(words[0] as u8), words[1] as i32),
    }
}
fn command_of(words: &[i64; 8]) -> CurrentCommand {
    let [tick, mode, angle, advance, d, q, ..] = *words;
    CurrentCommand {
        tick: tick as u32,
        mode: match mode & 3 {
            0 => CurrentMode::Off,
            1 => CurrentMode::Offsets,
            _ => CurrentMode::Drive,
        },
        angle: Angle(angle as u16),
        advance: advance as i32,
        current: Dq {
            d: Amps::from_bits(d as i32),
            q: Amps::from_bits(q as i32),
        },
    }
}
/// Replaces `ElectricalScale::angle` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn angle(_: &ElectricalScale, count: i64) -> Angle {
    Angle(turned::ask([count])[0] as u16)
}
/// Replaces `CountScale::penetration` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn penetration<N: Format>(_: &CountScale, count: i64) -> Position<N> {
    position(behind::ask([count])[0])
}
fn position<N: Format>(bits: i64) -> Position<N> {
    let found = N::any_position(&mut Symbolic);
    kani::assume(N::of_signal(found.0) == i64::from(bits as i32));
    found
}
/// Replaces `ChangeConfig::since_change` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn since_change(
    _: &ChangeConfig,
    until: Position<Fixed32>,
    from: Position<Fixed32>,
) -> Position<Fixed32> {
    let question = [until, from].map(|way| i64::from(way.0.to_bits()));
    Position(I8F24::from_bits(since::ask(question)[0] as i32))
}
/// Replaces `Controller::resume` when the model checker runs: it only records the call in the history of this tick.
pub fn resume<N: Number>(_: &mut Controller<N>, _: &Controller<N>) {
    done(2);
}
/// Replaces `Controller::tick_with_change` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn law<N: Format>(
    _: &mut Controller<N>,
    e: Position<N>,
    at_change: Option<Position<N>>,
) -> Force<N> {
    let at = at_change.map_or(0, |at| N::of_signal(at.0));
    let answer = pushed::ask([done(3), N::of_signal(e.0), at_change.is_some().into(), at]);
    Force(position::<N>(answer[0]).0)
}
/// Replaces `Controller::view` when the model checker runs: returns any value to the code, and the same value to the specification.
pub fn view<N: Format>(_: &Controller<N>) -> View<N> {
    let [contact, has_energy, energy, offset] = viewed::ask([so_far()]);
    let found = N::any_energy(&mut Symbolic);
    kani::assume(N::of_energy(found.0) == energy);
    View {
        contact: contact_of(contact as u8),
        energy: (has_energy & 1 == 1).then_some(found),
        offset: position(offset),
        mass: None,
    }
}
/// Replaces `Controller::commanded` when the model checker runs: it only records the force, and the call in the history of this
/// tick.
pub fn commanded<N: Format>(_: &mut Controller<N>, force: Force<N>) {
    told::ask([done(4), N::of_signal(force.0)]);
}
/// Replaces `Controller::switched_off` when the model checker runs: it only records the call in the history of this tick.
pub fn switched_off<N: Number>(_: &mut Controller<N>) {
    done(5);
}
/// Replaces `Controller::tripped` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn is_tripped<N: Number>(_: &Controller<N>) -> bool {
    tripped::ask([so_far()])[0] & 1 == 1
}
/// Replaces `Controller::is_beyond_reach` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn is_beyond_reach<N: Format>(_: &Controller<N>, e: Position<N>) -> bool {
    beyond::ask([so_far(), N::of_signal(e.0)])[0] & 1 == 1
}
/// Replaces `torque_of` when the model checker runs: returns any value to the code, and the same value to the specification.
pub fn torque(force: Force<Fixed32>, share: Option<u32>) -> Force<Fixed32> {
    let question = [
        i64::from(force.0.to_bits()),
        share.is_some().into(),
        share.unwrap_or(0).into(),
    ];
    Force(I8F24::from_bits(faded::ask(question)[0] as i32))
}
/// Replaces `AnyDrive::command` when the model checker runs: returns any value to the code, and the same value to the
/// specification.
pub fn command(_: &AnyDrive, torque: Force<Fixed32>, rotor: &Rotor) -> Driven {
    let question = [
        torque.0.to_bits().into(),
        rotor.tick.into(),
        rotor.angle.0.into(),
        rotor.advance.into(),
        rotor.against.into(),
        rotor.derating.into(),
    ];
    let answer = driven::ask(question);
    let words: [i64; 8] = core::array::from_fn(|at| answer[at + 2]);
    Driven {
        command: match answer[0] & 3 {
            0 => DriveCommand::Off,
            1 => DriveCommand::Analogue(DacCode(words[0] as u16)),
            _ => DriveCommand::Current(command_of(&words)),
        },
        limits: Limits::from_wire(answer[1] as u8),
        torque: Force(I8F24::from_bits(words[7] as i32)),
    }
}
