//! Tests that new settings take effect from the next calibration on, and never if they were refused.

use touchstone_drive::hardware::IHM08M1;
use touchstone_drive::{Device, DeviceSettings, Si};
use touchstone_protocol::{Command, FaultCode, State};
use touchstone_tests::knob::{Honest, Knob};
use touchstone_world::motor::{Drive, GIMBAL};

#[test]
fn refused_settings_do_not_calibrate_until_there_are_others() {
    let mut knob = Knob::new(&DeviceSettings::default(), GIMBAL, 0.0, Honest);
    knob.device.report_fault(FaultCode::SettingsInvalid, 0);
    knob.tick();
    assert_eq!(knob.fault(), Some(FaultCode::SettingsInvalid));
    knob.ask(Command::Stop);
    knob.tick();
    assert_eq!(knob.device.state(), State::Stopped);
    knob.ask(Command::Calibrate);
    knob.tick();
    assert_eq!(
        (knob.fault(), knob.acting),
        (Some(FaultCode::SettingsInvalid), Drive::Off)
    );
    knob.ask(Command::Stop);
    knob.tick();
    assert!(knob.device.may_configure());
    knob.device
        .configure(&DeviceSettings::default(), &IHM08M1)
        .unwrap();
    assert_eq!(knob.calibrate(), State::Ready);
}

#[test]
fn a_supply_that_only_the_new_limits_allow_calibrates_with_them_at_the_first_try() {
    let mut low = DeviceSettings::default();
    low.limits.bus_min_v = Si::lit("25");
    low.limits.bus_max_v = Si::lit("30");
    // The simulated supply has 24 V.
    let mut knob = Knob::new(&low, GIMBAL, 0.0, Honest);
    knob.calibrate();
    assert_eq!(knob.fault(), Some(FaultCode::UnderVoltage));
    knob.device
        .configure(&DeviceSettings::default(), &IHM08M1)
        .unwrap();
    knob.ask(Command::Stop);
    knob.tick();
    assert_eq!(knob.calibrate(), State::Ready);
    // The other way: the limits that come refuse what the present ones allow.
    knob.device.configure(&low, &IHM08M1).unwrap();
    knob.ask(Command::Stop);
    knob.tick();
    knob.calibrate();
    assert_eq!(
        (knob.fault(), knob.acting),
        (Some(FaultCode::UnderVoltage), Drive::Off)
    );
}

#[test]
fn settings_count_from_the_next_calibration_on() {
    let mut knob = Knob::new(&DeviceSettings::default(), GIMBAL, 0.0, Honest);
    assert_eq!(knob.calibrate(), State::Ready);
    let mut others = DeviceSettings::default();
    others.motor.current_bandwidth_hz = Si::lit("300");
    knob.device.configure(&others, &IHM08M1).unwrap();
    assert_eq!(
        knob.device.current_config(),
        Device::new(&DeviceSettings::default(), &IHM08M1)
            .unwrap()
            .current_config()
    );
    knob.ask(Command::Stop);
    knob.tick();
    knob.ask(Command::Calibrate);
    knob.tick();
    assert!(knob.output.unwrap().reconfigure);
    assert_eq!(
        knob.device.current_config(),
        Device::new(&others, &IHM08M1).unwrap().current_config()
    );
    while knob.device.state() == State::Calibrating {
        knob.tick();
        assert!(!knob.output.unwrap().reconfigure);
    }
    assert_eq!(knob.device.state(), State::Ready);
    let mut wrong = DeviceSettings::default();
    wrong.motor.pole_pairs = 0;
    assert!(knob.device.configure(&wrong, &IHM08M1).is_err());
}
