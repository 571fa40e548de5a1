use super::*;
use crate::encoder::{EncoderKind, EncoderReading};
use crate::hardware::IHM08M1;
use crate::scenery::WallAlone;
use crate::timing::TickTiming;
use touchstone_control::Si;

/// A control input with this reading of the encoder's counter and default values for the rest.
fn quiet(counter: u32) -> ControlInput {
    ControlInput {
        encoder: EncoderReading::Counter32(counter),
        current: CurrentReport::default(),
        command: None,
        hardware_break: false,
        gate_driver_error: false,
        stop_button: false,
        host_heard: true,
        timing: TickTiming::default(),
    }
}

#[test]
fn the_present_position_becomes_zero_while_nothing_may_move() {
    let mut settings = DeviceSettings::default();
    settings.encoder.kind = EncoderKind::Incremental;
    let mut device = Device::new(&settings, &IHM08M1).unwrap();
    let count = |device: &mut Device, counter| device.tick(&quiet(counter)).record.count;
    let first = count(&mut device, 1_000);
    assert_eq!(count(&mut device, 1_007), first + 7);
    assert!(device.zero_here());
    assert_eq!(count(&mut device, 1_007), 0);
    assert_eq!(count(&mut device, 1_004), -3);
    device.memory.machine = Machine::at(State::Armed);
    assert!(!device.zero_here());
}

#[test]
fn where_positions_end_a_wall_is_off_and_says_so() {
    let step = Si::lit("0.05");
    for inside in [true, false] {
        let mut device = Device::new(&DeviceSettings::default(), &IHM08M1).unwrap();
        let steps = 20_u8;
        // The positions go beyond the end of the range, and back.
        for n in (0..steps).chain((0..steps).rev()) {
            let at = Si::lit("127") + step * Si::from_num(n);
            let place = Position::from_si(at).unwrap();
            device.memory.record.penetration = if inside { place } else { -place };
            let (_, limits) = device.display(0, 1 << 16, Some(0), &mut WallAlone);
            // The wall is off beyond 127.88 rad: the number format of positions ends at 128 rad, less the motion of two control
            // periods at the guard's 60 rad/s.
            let is_there = at > Si::lit("127.88");
            let record = device.memory.record;
            assert_eq!(record.force > Force::zero(), inside && !is_there, "{at}");
            let told = limits.has(touchstone_protocol::Limit::Reach);
            assert_eq!(told, inside && is_there, "{at}");
            assert_eq!(device.memory.reported, None, "{at}");
        }
    }
}

/// Turns a knob with 24 detents per turn back and forth at 10 Hz, with the position measured when the force changes. Returns
/// count, force, displacement since the change, and torque of every control period.
#[cfg(feature = "large")]
fn shaken(turns: i64) -> Vec<(i64, i32, i32, i32)> {
    let mut settings = DeviceSettings::default();
    settings.encoder.kind = EncoderKind::Incremental;
    settings.limits.fade_in_s = Si::ZERO;
    settings.law.guard.change = touchstone_control::ChangeOfForce::Measured;
    let environment = crate::around::tests::detents();
    let mut device = Device::new(&settings, &IHM08M1).unwrap();
    let surrounding = Surrounding::new(&settings, &IHM08M1, &environment).unwrap();
    let mut around = Around::new();
    device.surround(&mut around, &surrounding);
    let counts = i64::from(settings.encoder.counts_per_rev);
    device.memory.zero = -turns * counts;
    device.memory.record.count = turns * counts;
    device.memory.machine = Machine::at(State::Armed);
    let fresh = device.configs.now().law;
    around.armed(&mut device.law, &fresh);
    let mut input = quiet(0);
    (input.current.bus, input.current.temperature) = (crate::Volts::lit("24"), 1_300);
    let at = |tick: f64| (200.0 * (tick * 0.001 * 10.0 * core::f64::consts::TAU).sin()) as i32;
    (0..2_000_i32)
        .map(|n| {
            let tick = f64::from(n);
            input.encoder = EncoderReading::Counter32(at(tick).cast_unsigned());
            let record = device.tick_around(&input, &mut around).record;
            assert_eq!(record.state, State::Armed, "{:?}", device.fault());
            // The simulated motor's current follows the command.
            input.current.current.q = record.current_command;
            let change = at(tick + 0.4).cast_unsigned();
            device.read_change(EncoderReading::Counter32(change));
            (
                record.count - turns * counts,
                record.force.0.to_bits(),
                record.since_change.0.to_bits(),
                record.torque.0.to_bits(),
            )
        })
        .collect()
}

#[test]
#[cfg(feature = "large")]
fn a_detent_is_the_same_ten_thousand_turns_on() {
    let here = shaken(0);
    let most = here.iter().map(|(_, force, ..)| force.abs()).max();
    assert!(
        most > Some(
            Force::<Fixed32>::from_si(Si::lit("0.045"))
                .unwrap()
                .0
                .to_bits()
        ),
        "{most:?}"
    );
    assert!(here.iter().any(|(_, _, since, _)| *since != 0));
    for turns in [20, -21, 10_000, -10_000] {
        assert!(shaken(turns) == here, "{turns} turns on");
    }
}

/// Energy in the guard's account at three times, in 2^-48 J: before a control period that ends the arming, after it, and after the
/// next arming.
fn accounts_around(ending: impl Fn(&mut ControlInput, &mut Device)) -> (i64, i64, i64) {
    let mut settings = DeviceSettings::default();
    settings.encoder.kind = EncoderKind::Incremental;
    settings.law.guard.change = touchstone_control::ChangeOfForce::Estimated;
    settings.limits.fade_in_s = Si::ZERO;
    let mut device = Device::new(&settings, &IHM08M1).unwrap();
    device.memory.machine = Machine::at(State::Armed);
    device.law.resume(&device.configs.now().law.clone());
    let account = |device: &Device| device.law.guard.as_ref().unwrap().account().0.to_bits();
    let mut input = quiet(0);
    (input.current.bus, input.current.temperature) = (crate::Volts::lit("24"), 1_300);
    let surface = device.configs.now().scale;
    let mut counts = 0;
    while surface.penetration::<Fixed32>(i64::from(counts))
        < Position::from_si(Si::lit("0.03")).unwrap()
    {
        counts += 5;
        input.encoder = EncoderReading::Counter32(counts);
        device.tick(&input);
    }
    let record = device.memory.record;
    assert!(
        record.force > Force::zero(),
        "{record:?}, {:?}",
        device.fault()
    );
    assert_eq!(device.state(), State::Armed);
    let before = account(&device);
    input.encoder = EncoderReading::Counter32(counts - 40);
    ending(&mut input, &mut device);
    let output = device.tick(&input);
    assert_eq!(output.drive, DriveCommand::Off);
    assert_ne!(device.state(), State::Armed);
    let after = account(&device);
    device.memory.machine = Machine::at(State::Ready);
    input.command = Some(Command::Arm);
    (input.hardware_break, input.encoder) = (false, EncoderReading::Counter32(counts - 40));
    device.tick(&input);
    (before, after, account(&device))
}

#[test]
fn what_a_hand_gets_out_while_it_is_disarmed_is_in_the_books() {
    let (before, after, again) = accounts_around(|input, _| input.command = Some(Command::Disarm));
    assert!(0 < after && after < before, "{before} {after}");
    assert!(again >= after && again < before, "{again}");
    // The hardware may have switched the outputs off at any time in the control period.
    let (before, after, again) = accounts_around(|input, _| input.hardware_break = true);
    assert_eq!(after, 0);
    assert!(before > 0 && again < before / 10, "{again}");
}
