use super::*;
use crate::encoder::{EncoderKind, EncoderReading};
use crate::hardware::IHM08M1;
use crate::timing::TickTiming;

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
