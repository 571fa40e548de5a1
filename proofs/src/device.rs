//! Properties of the encoder's counter (P9) and of the device's fault machine (P10).

use crate::source::Source;
use crate::{assume, cover, property};
use touchstone_protocol::{
    Command, Context, Event, FaultCode, Machine, Outputs, State, Unwrap16, Unwrap32,
};

property! {
    /// P9 (counters): the count made from a 16-bit counter follows the true count exactly, also where the counter wraps, if the
    /// displacement in a tick is less than half of the counter's range.
    equation "count' = count + moved"
    over "count of 64 bits, displacement of 16 bits"
    fn p9_unwrap16(s) {
        let (before, moved) = (s.i64(), s.i16());
        assume!(s, before.checked_add(i64::from(moved)).is_some(), "case; the other is p9_ends32");
        let now = before + i64::from(moved);
        // The timer counts modulo 2^16.
        let mut count = Unwrap16::new(before as u16, before);
        assert!(count.update(now as u16) == now && count.count() == now);
        assert!(count == Unwrap16::new(now as u16, now));
        cover!(s, (now as u16) < (before as u16) && moved > 0, "wraps upward");
        cover!(s, (now as u16) > (before as u16) && moved < 0, "wraps downward");
        cover!(s, moved == i16::MIN, "half the range");
    }
}
property! {
    /// P9 (counters): the count made from a 32-bit counter follows the true count exactly, also where the counter wraps, if the
    /// displacement in a tick is less than half of the counter's range.
    equation "count' = count + moved"
    over "count of 64 bits, displacement of 32 bits"
    fn p9_unwrap32(s) {
        let (before, moved) = (s.i64(), s.i32());
        assume!(s, before.checked_add(i64::from(moved)).is_some(), "case; the other is p9_ends32");
        let now = before + i64::from(moved);
        let mut count = Unwrap32::new(before as u32, before);
        assert!(count.update(now as u32) == now && count.count() == now);
        assert!(count == Unwrap32::new(now as u32, now));
        cover!(s, (now as u32) < (before as u32) && moved > 0, "wraps upward");
        cover!(s, (now as u32) > (before as u32) && moved < 0, "wraps downward");
    }
}
property! {
    /// P9 (counters): a count at the end of the 64-bit range stays there, without panic.
    equation "count' = min(max(count + moved, lowest), highest)"
    over "count, last and new reading"
    fn p9_ends32(s) {
        let (last, reading) = (s.u32(), s.u32());
        // Anywhere in the range, or near its end.
        let count = if s.shortcut() { i64::MAX - i64::from(s.u16()) } else { s.i64() };
        let mut unwrap = Unwrap32::new(last, count);
        let moved = i128::from(reading.wrapping_sub(last).cast_signed());
        let now = unwrap.update(reading);
        assert!(i128::from(now) == (i128::from(count) + moved).clamp(i128::from(i64::MIN), i128::from(i64::MAX)));
        cover!(s, now == i64::MAX && moved > 0 && count < i64::MAX, "reaches the end");
    }
}

property! {
    /// P10 (fault machine): a fault's number on the serial link identifies the fault, and other numbers are rejected. A new fault
    /// machine is in its first state.
    equation "from_wire(to_wire(code)) = code; new: Boot, off"
    over "byte"
    fn p10_wire(s) {
        let byte = s.u8();
        let code = FaultCode::from_wire(byte);
        assert!(code.is_some() == (1..=27).contains(&byte));
        assert!(code.is_none_or(|code| code.to_wire() == byte));
        let machine = Machine::new();
        assert!(machine.state() == State::Boot && machine.outputs() == Outputs::Off);
        assert!(machine.fault().is_none());
        cover!(s, code == Some(FaultCode::Runaway), "the last");
        cover!(s, byte == 0, "none");
    }
}

/// The fault code that a byte stands for, to make any fault from an arbitrary byte.
pub(crate) fn code_of(byte: u8) -> FaultCode {
    FaultCode::ALL[usize::from(byte) % FaultCode::ALL.len()]
}
fn any_code<S: Source>(s: &mut S) -> FaultCode {
    code_of(s.u8())
}
pub(crate) fn any_context<S: Source>(s: &mut S) -> Context {
    Context {
        code: any_code(s),
        tick: s.u32(),
        value: s.i32(),
    }
}
pub(crate) fn any_state<S: Source>(s: &mut S) -> State {
    match s.u8() % 6 {
        0 => State::Boot,
        1 => State::Calibrating,
        2 => State::Ready,
        3 => State::Armed,
        4 => State::Fault(any_context(s)),
        _ => State::Stopped,
    }
}
pub(crate) fn any_command<S: Source>(s: &mut S) -> Command {
    match s.u8() % 4 {
        0 => Command::Calibrate,
        1 => Command::Arm,
        2 => Command::Disarm,
        _ => Command::Stop,
    }
}
fn any_event<S: Source>(s: &mut S) -> Event {
    match s.u8() % 4 {
        0 => Event::Tick,
        1 => Event::Fault(any_context(s)),
        2 => Event::Calibrated,
        _ => Event::Command(any_command(s)),
    }
}

property! {
    /// P10 (fault machine): the outputs may be on in the states `Armed` and `Calibrating` only, and never in the tick of a fault.
    equation "outputs = on  =>  state in {Armed, Calibrating} and no fault"
    over "state, fault, command, end of calibration"
    fn p10_outputs(s) {
        let mut machine = Machine::at(any_state(s));
        let fault = if s.bool() { Some(any_context(s)) } else { None };
        let command = if s.bool() { Some(any_command(s)) } else { None };
        let outputs = machine.tick(fault, s.bool(), command);
        assert!(outputs == machine.outputs());
        if outputs == Outputs::On {
            assert!(machine.state() == State::Armed || machine.state() == State::Calibrating);
            assert_reached!(fault.is_none());
        }
        cover!(s, outputs == Outputs::On && machine.state() == State::Armed, "armed");
        cover!(s, outputs == Outputs::On && machine.state() == State::Calibrating, "calibrating");
        cover!(s, fault.is_some() && command == Some(Command::Stop), "stop in the tick of a fault");
    }
}
property! {
    /// P10 (fault machine): a fault in any state is kept with its context, and a later fault does not replace it. Only the command
    /// to stop ends it, and the state is then `Stopped`.
    equation "state = Fault(c)  =>  state' in {Fault(c), Stopped}"
    over "state and event, with any context"
    fn p10_fault_is_latched(s) {
        let before = any_state(s);
        let event = any_event(s);
        let mut machine = Machine::at(before);
        let _ = machine.handle(event);
        if let State::Fault(first) = before {
            assert!(machine.state() == before || (machine.state() == State::Stopped && event == Event::Command(Command::Stop)));
            assert_reached!(machine.fault() == Some(first) || machine.state() == State::Stopped);
        } else if let Event::Fault(context) = event {
            assert_reached!(machine.state() == State::Fault(context));
        }
        cover!(s, matches!(before, State::Fault(_)) && machine.state() == State::Stopped, "left");
        cover!(s, before == State::Armed && machine.fault().is_some(), "from armed");
    }
}
property! {
    /// P10 (fault machine): `Armed` is entered only from `Ready` by command, `Ready` only from `Calibrating` or `Armed`, and
    /// `Calibrating` only from `Boot` or `Stopped` by command. So every path from `Fault` to `Armed` leads through `Stopped`,
    /// `Calibrating` and `Ready`, and takes three commands.
    equation "state' = Armed /= state  =>  state = Ready and event = Arm, ..."
    over "state and event, with any context"
    fn p10_ways(s) {
        let before = any_state(s);
        let event = any_event(s);
        let mut machine = Machine::at(before);
        let changed = machine.handle(event);
        let after = machine.state();
        assert!(changed == (after != before));
        // `&` instead of `&&`: the compiler would split the check in two, one of them unreachable.
        cover!(s, changed & (after == State::Armed), "armed");
        cover!(s, changed & (after == State::Calibrating) & (before == State::Stopped), "again");
        if changed {
            match after {
                State::Armed => assert_reached!(before == State::Ready && event == Event::Command(Command::Arm)),
                State::Ready => assert_reached!(
                    (before == State::Calibrating && event == Event::Calibrated)
                        || (before == State::Armed && event == Event::Command(Command::Disarm))
                ),
                State::Calibrating => assert_reached!(
                    (before == State::Boot || before == State::Stopped)
                        && event == Event::Command(Command::Calibrate)
                ),
                State::Boot => unreachable!("nothing leads to Boot"),
                State::Stopped => assert_reached!(event == Event::Command(Command::Stop)),
                State::Fault(_) => assert_reached!(matches!(event, Event::Fault(_))),
            }
        }
    }
}
property! {
    /// P10 (fault machine): whatever happens in three ticks after a fault, the device is not armed at their end.
    equation "Fault  =>  after 1, 2, 3 ticks: not Armed"
    over "context, and fault, command, end of calibration in each tick"
    fn p10_no_short_way(s) {
        let mut machine = Machine::at(State::Fault(any_context(s)));
        let mut ticks = 0_u8;
        while ticks < 3 {
            let fault = if s.bool() { Some(any_context(s)) } else { None };
            let command = if s.bool() { Some(any_command(s)) } else { None };
            let _ = machine.tick(fault, s.bool(), command);
            assert_reached!(machine.state() != State::Armed);
            ticks += 1;
        }
        cover!(s, machine.state() == State::Ready, "on its way");
    }
}
