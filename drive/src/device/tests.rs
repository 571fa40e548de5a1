use super::*;
use crate::encoder::{EncoderKind, EncoderReading};
use crate::hardware::IHM08M1;
use crate::scenery::WallAlone;
use crate::timing::TickTiming;
use touchstone_control::Si;

#[test]
fn the_present_position_becomes_zero_while_nothing_may_move() {
    let mut settings = DeviceSettings::default();
    settings.encoder.kind = EncoderKind::Incremental;
    let mut device = Device::new(&settings, &IHM08M1).unwrap();
    let count = |device: &mut Device, counter| {
        let input = ControlInput {
            encoder: EncoderReading::Counter32(counter),
            current: CurrentReport::default(),
            command: None,
            hardware_break: false,
            gate_driver_error: false,
            stop_button: false,
            host_heard: true,
            timing: TickTiming::default(),
        };
        device.tick(&input).record.count
    };
    let first = count(&mut device, 1_000);
    assert_eq!(count(&mut device, 1_007), first + 7);
    assert!(device.zero_here());
    assert_eq!(count(&mut device, 1_007), 0);
    assert_eq!(count(&mut device, 1_004), -3);
    device.machine = Machine::at(State::Armed);
    assert!(!device.zero_here());
}

#[test]
fn where_positions_end_a_pushed_shaft_is_a_fault_and_a_free_one_is_none() {
    let step = Si::lit("0.05");
    for (inside, fault) in [(true, Some((FaultCode::OverSpeed, 0))), (false, None)] {
        let mut device = Device::new(&DeviceSettings::default(), &IHM08M1).unwrap();
        let mut at = Si::lit("127");
        while at < Si::lit("127.95") {
            let place = Position::from_si(at).unwrap();
            device.record.penetration = if inside { place } else { -place };
            device.display(0, 1 << 16, Some(0), &mut WallAlone);
            // Two displacements of the guard's 60 rad/s before the format's end.
            let is_there = at > Si::lit("127.88");
            assert_eq!(
                device.record.force > Force::zero(),
                inside && !is_there,
                "{at}"
            );
            assert_eq!(device.reported, fault.filter(|_| is_there), "{at}");
            at += step;
        }
    }
}
