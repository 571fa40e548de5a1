//! Tests every fault that the firmware's supervisor detects, on a knob whose motor is on. The outputs are off in the tick that
//! detects the fault, the fault's code and value are latched, and only stop and calibration lead back to the armed state.

use touchstone_drive::encoder::Frames;
use touchstone_drive::{
    ControlInput, CurrentSample, DeviceSettings, EncoderReading, Si, TickTiming,
};
use touchstone_protocol::{Command, FaultCode, Outputs, State};
use touchstone_tests::knob::{Knob, Tamper};
use touchstone_world::motor::{Drive, GIMBAL};

/// Falsifies one input of the firmware from control tick `from` up to `until`.
struct Inject {
    from: u32,
    until: u32,
    what: What,
}

enum What {
    Sample(fn(&mut CurrentSample)),
    Input(fn(&mut ControlInput, u32)),
    Hang,
    Bus(f64),
}

impl Tamper for Inject {
    fn sample(&mut self, tick: u32, sample: &mut CurrentSample) {
        if let What::Sample(change) = self.what
            && (self.from..self.until).contains(&tick)
        {
            change(sample);
        }
    }

    fn input(&mut self, tick: u32, input: &mut ControlInput) -> bool {
        if !(self.from..self.until).contains(&tick) {
            return true;
        }
        if let What::Input(change) = self.what {
            change(input, tick - self.from);
        }
        !matches!(self.what, What::Hang)
    }

    fn bus_v(&mut self, tick: u32) -> f64 {
        match self.what {
            What::Bus(volts) if (self.from..self.until).contains(&tick) => volts,
            _ => 24.0,
        }
    }
}

fn settings() -> DeviceSettings {
    let mut settings = DeviceSettings::default();
    settings.encoder.bad_readings = 3;
    settings.wall.surface_rad = Si::lit("0.2");
    settings
}

/// A knob with its motor on that is pressed against the wall. The fault `what` begins at the next control tick.
fn armed(what: What) -> Knob<Inject> {
    let inject = Inject {
        from: u32::MAX,
        until: u32::MAX,
        what,
    };
    let mut knob = Knob::new(&settings(), GIMBAL, 0.0, inject).armed();
    for _ in 0..600 {
        knob.rest_rad = 3.0;
        knob.tick();
    }
    assert!(knob.record.force.0 > 0.02, "in the wall: {:?}", knob.record);
    knob.tamper.from = knob.record.tick + 1;
    knob
}

/// Checks that no command switches the motor on until the device was stopped and calibrated.
fn stays_off(knob: &mut Knob<Inject>, code: FaultCode) {
    for command in [
        Command::Arm,
        Command::Disarm,
        Command::Calibrate,
        Command::Arm,
    ] {
        knob.ask(command);
        knob.tick();
        assert_eq!(knob.output.unwrap().accepted, Some(false));
        assert_eq!(knob.fault(), Some(code), "after {command:?}");
        for _ in 0..3 {
            assert_eq!(knob.acting, Drive::Off);
            knob.period();
        }
    }
    // The cause is removed: a stop leaves the fault, an arm command does not arm.
    knob.tamper.until = 0;
    knob.ask(Command::Stop);
    knob.tick();
    assert_eq!(knob.device.state(), State::Stopped);
    assert!(knob.output.unwrap().clear_latches);
    knob.ask(Command::Arm);
    knob.tick();
    assert_eq!(knob.device.state(), State::Stopped);
    assert_eq!(knob.acting, Drive::Off);
    // Meanwhile the knob swings out; after that it works as a new one.
    for _ in 0..200 {
        knob.rest_rad = knob.rig.now().angle_rad;
        knob.tick();
    }
    assert_eq!(knob.calibrate(), State::Ready, "{:?}", knob.device.fault());
    knob.ask(Command::Arm);
    knob.tick();
    assert_eq!(knob.device.state(), State::Armed);
}

/// Injects a fault into a pressed knob. Asserts that the fault is latched within this many control ticks, with the outputs off from
/// the first bad tick on. Returns the fault's value.
fn within(ticks: u32, code: FaultCode, what: What) -> i32 {
    let mut knob = armed(what);
    for tick in 1..=ticks {
        knob.tick();
        assert_eq!(knob.acting, Drive::Off, "{code:?}: still on in tick {tick}");
        let output = knob.output.unwrap();
        assert_eq!(output.outputs, Outputs::Off);
        assert_eq!(output.mailbox().mode, touchstone_drive::CurrentMode::Off);
        if knob.fault().is_some() {
            assert_eq!(tick, ticks, "{code:?}: earlier than expected");
        }
    }
    assert_eq!(knob.fault(), Some(code));
    let context = knob.device.fault().unwrap();
    assert_eq!(context.tick, knob.record.tick);
    stays_off(&mut knob, code);
    context.value
}

#[test]
fn power() {
    // Above the upper limit of 30 V, and below the lower one of 18 V. The fault's value is in mV; 100 mV are allowed for the
    // conversion.
    assert!((31_400..31_600).contains(&within(1, FaultCode::OverVoltage, What::Bus(31.5))));
    assert!((14_900..15_100).contains(&within(1, FaultCode::UnderVoltage, What::Bus(15.0))));
    assert_eq!(
        within(1, FaultCode::UnderVoltage, What::Sample(|s| s.bus = 0)),
        0
    );
    let hot = within(
        1,
        FaultCode::OverTemperature,
        What::Sample(|s| s.temperature = 3_300),
    );
    assert!((930..960).contains(&hot), "{hot}");
    for code in [0, 4_095] {
        let broken = if code == 0 {
            What::Sample(|s| s.temperature = 0)
        } else {
            What::Sample(|s| s.temperature = 4_095)
        };
        assert_eq!(within(1, FaultCode::OverTemperature, broken), i32::MAX);
    }
}

#[test]
fn hardware() {
    assert_eq!(
        within(
            1,
            FaultCode::HardwareBreak,
            What::Sample(|s| s.hardware_break = true)
        ),
        0
    );
    assert_eq!(
        within(
            1,
            FaultCode::HardwareBreak,
            What::Input(|i, _| i.hardware_break = true)
        ),
        0
    );
    assert_eq!(
        within(
            1,
            FaultCode::GateDriver,
            What::Input(|i, _| i.gate_driver_error = true)
        ),
        0
    );
}

#[test]
fn currents() {
    for what in [
        What::Sample(|s| s.phase_a = 4_095),
        What::Sample(|s| s.phase_a = 0),
        What::Sample(|s| s.phase_b = 4_095),
        What::Sample(|s| s.phase_b = 0),
        // Only the third phase has an over-current: both measured phases rise together.
        What::Sample(|s| (s.phase_a, s.phase_b) = (s.phase_a + 200, s.phase_b + 200)),
    ] {
        let value = within(1, FaultCode::OverCurrent, what);
        assert!(value > 4_000, "{value} mA");
    }
}

#[test]
fn encoder() {
    let silent = |i: &mut ControlInput, _| i.encoder = EncoderReading::Silent;
    assert_eq!(within(3, FaultCode::EncoderSilent, What::Input(silent)), 3);
    let parity = |i: &mut ControlInput, _| {
        if let EncoderReading::As5047p(Frames { angle: frame, .. }) = &mut i.encoder {
            *frame ^= 0x0010;
        }
    };
    within(3, FaultCode::EncoderCheck, What::Input(parity));
    let floating =
        |i: &mut ControlInput, _| i.encoder = EncoderReading::As5047p(Frames::alone(0xFFFF));
    assert_eq!(
        within(3, FaultCode::EncoderStatus, What::Input(floating)),
        0xFFFF
    );
    // Different sorts of bad readings in a row count together; the last one gives the code.
    let mixed = |i: &mut ControlInput, n| {
        i.encoder = if n % 2 == 0 {
            EncoderReading::As5047p(Frames::alone(1))
        } else {
            EncoderReading::Silent
        };
    };
    within(3, FaultCode::EncoderCheck, What::Input(mixed));
    let jump = |i: &mut ControlInput, _| {
        if let EncoderReading::As5047p(Frames { angle: frame, .. }) = &mut i.encoder {
            *frame = touchstone_world::motor::as5047p_frame(i64::from(*frame & 0x3FFF) + 4_000);
        }
    };
    let moved = within(1, FaultCode::EncoderJump, What::Input(jump));
    assert!((3_900..4_100).contains(&moved), "{moved}");
    // 112 rad/s are 293 counts in a millisecond; a jump is 1,047 counts.
    let fast = |i: &mut ControlInput, n: u32| {
        if let EncoderReading::As5047p(Frames { angle: frame, .. }) = &mut i.encoder {
            *frame = touchstone_world::motor::as5047p_frame(
                i64::from(*frame & 0x3FFF) + 293 * (i64::from(n) + 1),
            );
        }
    };
    let speed = within(1, FaultCode::OverSpeed, What::Input(fast));
    assert!((110_000..115_000).contains(&speed), "{speed} mrad/s");
}

#[test]
fn speed_after_a_gap_is_that_of_all_its_ticks() {
    // Two bad readings while the shaft moves on at 40 rad/s or at 110 rad/s: 313 or 861 counts in three ticks.
    for (counts, expected) in [(313, None), (861, Some(FaultCode::OverSpeed))] {
        struct Gap {
            from: u32,
            counts: i64,
        }
        impl Tamper for Gap {
            fn input(&mut self, tick: u32, input: &mut ControlInput) -> bool {
                match (tick.checked_sub(self.from), &mut input.encoder) {
                    (Some(0 | 1), reading) => *reading = EncoderReading::Silent,
                    (Some(_), EncoderReading::As5047p(Frames { angle: frame, .. })) => {
                        let moved = i64::from(*frame & 0x3FFF) + self.counts;
                        *frame = touchstone_world::motor::as5047p_frame(moved);
                    }
                    _ => {}
                }
                true
            }
        }
        let gap = Gap {
            from: u32::MAX,
            counts,
        };
        let mut knob = Knob::new(&settings(), GIMBAL, 0.0, gap).armed();
        knob.tick();
        knob.tamper.from = knob.record.tick + 1;
        for _ in 0..3 {
            knob.tick();
        }
        assert_eq!(knob.fault(), expected, "{counts} counts");
        knob.period();
        knob.period();
        assert_eq!(knob.acting == Drive::Off, expected.is_some());
    }
}

#[test]
fn a_bad_reading_or_two_switch_off_and_are_forgiven() {
    for bad in 1..3 {
        let mut knob = armed(What::Input(|i, _| i.encoder = EncoderReading::Silent));
        knob.tamper.until = knob.tamper.from + bad;
        for _ in 0..bad {
            knob.tick();
            assert_eq!(knob.acting, Drive::Off, "on a guess");
            assert!(
                knob.record.limits.has(touchstone_protocol::Limit::Encoder) && !knob.record.law_ran
            );
        }
        for _ in 0..5 {
            knob.tick();
            knob.period();
            assert!(matches!(knob.acting, Drive::On(_)), "on again");
            assert!(knob.record.law_ran);
        }
        assert_eq!(knob.device.state(), State::Armed);
    }
}

#[test]
fn an_encoder_that_stops_while_the_shaft_turns() {
    // The encoder repeats its last good frame from then on.
    struct Stuck {
        from: u32,
        frame: Option<EncoderReading>,
    }
    impl Tamper for Stuck {
        fn input(&mut self, tick: u32, input: &mut ControlInput) -> bool {
            if tick >= self.from {
                input.encoder = *self.frame.get_or_insert(input.encoder);
            }
            true
        }
    }
    // The knob is outside the wall, where nothing else would show the fault.
    let mut settings = settings();
    settings.wall.surface_rad = Si::lit("50");
    let mut knob = Knob::new(
        &settings,
        GIMBAL,
        0.0,
        Stuck {
            from: u32::MAX,
            frame: None,
        },
    )
    .armed();
    let start = knob.rig.now().angle_rad;
    let turn = |knob: &mut Knob<Stuck>, tick: u32| {
        knob.rest_rad = start + 0.03 * f64::from(tick);
        knob.tick();
    };
    let mut ticks = 0;
    while knob.record.speed_rad_per_s < 20 {
        ticks += 1;
        turn(&mut knob, ticks);
        assert_eq!(knob.fault(), None, "a good encoder");
    }
    knob.tamper.from = knob.record.tick + 1;
    let mut until = 0;
    while knob.fault().is_none() {
        until += 1;
        ticks += 1;
        turn(&mut knob, ticks);
        assert!(until <= 12, "not found");
    }
    assert_eq!(
        (knob.fault(), knob.acting),
        (Some(FaultCode::EncoderStuck), Drive::Off)
    );
}

#[test]
fn a_shaft_that_is_held_is_not_a_stuck_encoder() {
    // Pressed hard against a wall, where the reading stays the same for hundreds of ticks.
    let mut knob = armed(What::Bus(24.0));
    for tick in 0..5_000 {
        knob.rest_rad = 3.0 + f64::from(tick) * 0.0028;
        knob.tick();
        assert_eq!(knob.fault(), None);
    }
    assert!(knob.record.current.q.saturating_abs() > 1);
}

#[test]
fn deadlines() {
    let late = |i: &mut ControlInput, _| i.timing.lateness = 90_000;
    assert_eq!(
        within(1, FaultCode::DeadlineMiss, What::Input(late)),
        90_000
    );
    let long = |i: &mut ControlInput, _| i.timing.duration = 170_001;
    assert_eq!(
        within(1, FaultCode::DeadlineMiss, What::Input(long)),
        170_001
    );
    let both = |i: &mut ControlInput, _| {
        i.timing = TickTiming {
            lateness: 80_000,
            duration: 95_000,
        }
    };
    assert_eq!(
        within(1, FaultCode::DeadlineMiss, What::Input(both)),
        95_000
    );
    // The current loop itself is late: off in the third period of the tick.
    let slow = What::Sample(|s| s.late = true);
    assert_eq!(within(1, FaultCode::DeadlineMiss, slow), 3);
    // One tick is left out; the current loop reports it to the next tick.
    let mut knob = armed(What::Hang);
    knob.tamper.until = knob.tamper.from;
    // The hang lasts until a tick number that is not reached, so the test ends it.
    knob.tamper.until = u32::MAX;
    let number = knob.record.tick;
    knob.tick();
    assert_eq!(knob.record.tick, number, "left out");
    knob.tamper.until = 0;
    knob.tick();
    assert_eq!(
        (knob.fault(), knob.acting),
        (Some(FaultCode::DeadlineMiss), Drive::Off)
    );
    assert_eq!(knob.device.fault().unwrap().value, 1);
}

#[test]
fn a_control_tick_that_hangs_does_not_leave_the_current_applied() {
    let mut knob = armed(What::Hang);
    let mut periods = 0;
    while knob.acting != Drive::Off {
        knob.period();
        periods += 1;
        assert!(periods <= 60, "still on");
    }
    // Two control periods of 20 PWM periods after the last sign of life.
    assert!(periods <= 41, "{periods}");
    for _ in 0..200 {
        knob.period();
        assert_eq!(knob.acting, Drive::Off);
    }
    // The control tick runs again and detects the hang.
    knob.tamper.until = 0;
    knob.tick();
    assert_eq!(knob.fault(), Some(FaultCode::StaleCommand));
    assert_eq!(knob.acting, Drive::Off);
}
