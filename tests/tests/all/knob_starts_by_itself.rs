//! Tests the automatic start of a board: it gives itself the start commands once if everything is in order, and no command
//! otherwise.

use touchstone_drive::autostart::{Autostart, AutostartInput, STEP_MS};
use touchstone_drive::{DeviceSettings, ResetReason, Si};
use touchstone_protocol::{Command, Context, FaultCode, SelfStart, State};
use touchstone_tests::knob::{Honest, Knob};
use touchstone_world::motor::GIMBAL;

const STEPS_A_SECOND: u32 = 1_000 / STEP_MS;

/// Inputs of the automatic start with which everything is in order.
const GOOD: AutostartInput = AutostartInput {
    state: State::Boot,
    is_supplied: true,
    count: 77,
    is_stop_pressed: false,
    desktop_spoke: false,
};

fn fault() -> State {
    State::Fault(Context {
        code: FaultCode::CalibrationFailed,
        tick: 1,
        value: 7,
    })
}

fn asked() -> Autostart {
    Autostart::new(true, ResetReason::PowerOn, true)
}

/// Runs the steps of the automatic start with the inputs `now` for at most this many seconds. Returns the first command that it
/// gives, and the number of its step.
fn until(
    autostart: &mut Autostart,
    seconds: u32,
    now: impl Fn(u32) -> AutostartInput,
) -> Option<(Command, u32)> {
    (0..seconds * STEPS_A_SECOND).find_map(|step| Some((autostart.step(&now(step))?, step)))
}

#[test]
fn it_calibrates_and_arms_and_asks_for_nothing_more() {
    let mut autostart = asked();
    assert!(!autostart.stands_in(false));
    let (command, step) = until(&mut autostart, 2, |_| GOOD).expect("a command");
    assert_eq!(command, Command::Calibrate);
    // Half a second of rest, and one step to determine where the shaft is.
    assert!((50..=51).contains(&step), "{step}");
    assert_eq!(autostart.told(), SelfStart::Checking);
    assert!(autostart.stands_in(false) && !autostart.stands_in(true));
    let in_state = |state| move |_| AutostartInput { state, ..GOOD };
    assert_eq!(
        until(&mut autostart, 30, in_state(State::Calibrating)),
        None
    );
    let (command, step) = until(&mut autostart, 2, in_state(State::Ready)).expect("a command");
    assert_eq!(command, Command::Arm);
    assert!((19..=21).contains(&step), "{step}");
    for state in [
        State::Armed,
        fault(),
        State::Stopped,
        State::Boot,
        State::Ready,
    ] {
        assert_eq!(until(&mut autostart, 30, in_state(state)), None);
    }
    assert_eq!(autostart.told(), SelfStart::Started);
}

#[test]
fn it_begins_only_when_power_comes_on_with_an_alignment_to_check() {
    use ResetReason::*;
    for (is_asked, reason, has_alignment, told) in [
        (false, PowerOn, true, SelfStart::Off),
        (true, PowerOn, false, SelfStart::NoAlignment),
        (true, BrownOut, true, SelfStart::NoPowerOn),
        (true, Pin, true, SelfStart::NoPowerOn),
        (true, Software, true, SelfStart::NoPowerOn),
        (true, IndependentWatchdog, true, SelfStart::NoPowerOn),
        (true, WindowWatchdog, true, SelfStart::NoPowerOn),
        (true, Panic(7), true, SelfStart::NoPowerOn),
        (true, OptionBytes, true, SelfStart::NoPowerOn),
        (true, LowPower, true, SelfStart::NoPowerOn),
    ] {
        let mut autostart = Autostart::new(is_asked, reason, has_alignment);
        assert_eq!(until(&mut autostart, 20, |_| GOOD), None, "{reason:?}");
        assert_eq!(autostart.told(), told);
        assert!(!autostart.stands_in(false));
    }
}

#[test]
fn each_condition_keeps_it_from_starting_and_says_so() {
    type Case = (
        &'static str,
        fn(u32) -> AutostartInput,
        Option<Command>,
        SelfStart,
    );
    let cases: [Case; 6] = [
        (
            "no supply",
            |_| AutostartInput {
                is_supplied: false,
                ..GOOD
            },
            Some(Command::Stop),
            SelfStart::NotReady,
        ),
        (
            "supply that comes and goes",
            |step| AutostartInput {
                is_supplied: step % 40 != 0,
                ..GOOD
            },
            Some(Command::Stop),
            SelfStart::NotReady,
        ),
        (
            "shaft that turns",
            |step| AutostartInput {
                count: i64::from(step),
                ..GOOD
            },
            Some(Command::Stop),
            SelfStart::NotReady,
        ),
        (
            "stop button",
            |step| AutostartInput {
                is_stop_pressed: step == 20,
                ..GOOD
            },
            Some(Command::Stop),
            SelfStart::StopPressed,
        ),
        (
            "desktop",
            |step| AutostartInput {
                desktop_spoke: step == 20,
                ..GOOD
            },
            None,
            SelfStart::DesktopSpoke,
        ),
        (
            "fault",
            |step| AutostartInput {
                state: if step == 20 { fault() } else { State::Boot },
                ..GOOD
            },
            None,
            SelfStart::Faulted,
        ),
    ];
    for (name, now, command, told) in cases {
        let mut autostart = asked();
        let last = until(&mut autostart, 20, now);
        assert_eq!(last.map(|(command, _)| command), command, "{name}");
        assert_eq!(autostart.told(), told, "{name}");
        // No further command comes.
        assert_eq!(until(&mut autostart, 20, |_| GOOD), None, "{name}");
    }
}

#[test]
fn what_goes_wrong_between_check_and_arming_ends_it() {
    type Case = (
        &'static str,
        fn(u32) -> AutostartInput,
        Option<Command>,
        SelfStart,
    );
    const READY: AutostartInput = AutostartInput {
        state: State::Ready,
        ..GOOD
    };
    let cases: [Case; 6] = [
        (
            "the check fails",
            |_| AutostartInput {
                state: fault(),
                ..GOOD
            },
            None,
            SelfStart::Faulted,
        ),
        (
            "stopped by somebody",
            |_| AutostartInput {
                state: State::Stopped,
                ..GOOD
            },
            None,
            SelfStart::NotReady,
        ),
        (
            "desktop",
            |step| AutostartInput {
                desktop_spoke: step == 10,
                ..READY
            },
            None,
            SelfStart::DesktopSpoke,
        ),
        (
            "shaft that turns",
            |step| AutostartInput {
                count: i64::from(step),
                ..READY
            },
            Some(Command::Stop),
            SelfStart::NotReady,
        ),
        (
            "stop button",
            |step| AutostartInput {
                is_stop_pressed: step == 10,
                ..READY
            },
            Some(Command::Stop),
            SelfStart::StopPressed,
        ),
        (
            "no supply",
            |_| AutostartInput {
                is_supplied: false,
                ..READY
            },
            Some(Command::Stop),
            SelfStart::NotReady,
        ),
    ];
    for (name, now, command, told) in cases {
        let mut autostart = asked();
        assert!(until(&mut autostart, 2, |_| GOOD).is_some());
        let last = until(&mut autostart, 20, now);
        assert_eq!(last.map(|(command, _)| command), command, "{name}");
        assert_eq!(autostart.told(), told, "{name}");
        assert_eq!(until(&mut autostart, 20, |_| READY), None, "{name}");
    }
}

/// Checks the automatic start with a whole simulated knob and without a desktop program: the motor is switched on, and its force
/// fades in.
#[test]
fn a_knob_nobody_speaks_to_arms_and_its_force_fades_in() {
    let mut settings = DeviceSettings::default();
    settings.wall.surface_rad = Si::lit("-0.2");
    settings.wall.k_desired_n_m_per_rad = Si::ONE;
    settings.limits.fade_in_s = Si::lit("0.2");
    let mut first = Knob::new(&settings, GIMBAL, 0.3, Honest);
    assert_eq!(first.calibrate(), State::Ready);
    let mut knob = Knob::new(&settings, GIMBAL, 0.9, Honest);
    knob.device.keep(first.device.found());
    let mut autostart = asked();
    let (mut armed, mut felt) = (0, 0);
    for tick in 0..6_000_u32 {
        if tick % STEP_MS == 0 {
            let now = AutostartInput {
                state: knob.device.state(),
                is_supplied: knob.device.is_supplied(),
                count: knob.device.record().count,
                ..GOOD
            };
            if let Some(command) = autostart.step(&now) {
                knob.ask(command);
            }
        }
        // A hand that follows the knob until it is armed, and then leans on it.
        if knob.device.state() != State::Armed {
            knob.rest_rad =
                knob.rig.now().angle_rad + 3.0 * f64::from(autostart.told() == SelfStart::Started);
        }
        let record = knob.tick();
        if record.state != State::Armed {
            continue;
        }
        armed += 1;
        let force: f64 = record.force.0.to_num();
        let torque: f64 = record.torque.0.to_num();
        let share = (f64::from(armed) / 200.0).min(1.0);
        assert!(
            (torque + force * share).abs() < 1e-5,
            "{armed}: {torque} of {force}"
        );
        felt += u32::from(force > 0.05);
    }
    assert_eq!(autostart.told(), SelfStart::Started);
    assert!(knob.device.was_checked());
    assert!(armed > 1_000 && felt > 300, "{armed} {felt}");
}
