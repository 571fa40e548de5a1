//! Tests which reset reasons of the microcontroller the firmware reports as faults, and with which value.

use touchstone_drive::{DeviceSettings, ResetFlags, ResetReason};
use touchstone_protocol::FaultCode;
use touchstone_tests::knob::{Honest, Knob};
use touchstone_world::motor::{Drive, GIMBAL};

#[test]
fn what_the_start_tells() {
    let cases = [
        (
            ResetFlags {
                independent_watchdog: true,
                pin: true,
                ..ResetFlags::default()
            },
            Some((FaultCode::Watchdog, 0)),
        ),
        (
            ResetFlags {
                window_watchdog: true,
                pin: true,
                ..ResetFlags::default()
            },
            Some((FaultCode::Watchdog, 1)),
        ),
        (
            ResetFlags {
                brown_out: true,
                pin: true,
                memory_kept: true,
                ..ResetFlags::default()
            },
            Some((FaultCode::BrownOut, 0)),
        ),
        (
            ResetFlags {
                software: true,
                pin: true,
                panic: Some(123),
                ..ResetFlags::default()
            },
            Some((FaultCode::Panic, 123)),
        ),
        (
            ResetFlags {
                brown_out: true,
                pin: true,
                ..ResetFlags::default()
            },
            None,
        ),
        (
            ResetFlags {
                software: true,
                pin: true,
                memory_kept: true,
                ..ResetFlags::default()
            },
            None,
        ),
        (
            ResetFlags {
                pin: true,
                memory_kept: true,
                ..ResetFlags::default()
            },
            None,
        ),
        (
            ResetFlags {
                brown_out: true,
                pin: true,
                panic: Some(5),
                ..ResetFlags::default()
            },
            None,
        ),
    ];
    for (flags, expected) in cases {
        let mut knob = Knob::new(&DeviceSettings::default(), GIMBAL, 0.0, Honest);
        knob.device.started(ResetReason::of(&flags));
        knob.tick();
        let fault = knob
            .device
            .fault()
            .map(|context| (context.code, context.value));
        assert_eq!(fault, expected, "{flags:?}");
        assert_eq!(knob.acting, Drive::Off);
    }
}
