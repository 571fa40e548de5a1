//! Tests that the calibration finds direction, pole pairs and electrical offset of the simulated motor, and refuses implausible
//! results.

use std::f64::consts::TAU;
use touchstone_drive::encoder::Frames;
use touchstone_drive::{
    ControlInput, CurrentSample, DeviceSettings, EncoderKind, EncoderReading, Reason,
};
use touchstone_protocol::{Command, FaultCode, State};
use touchstone_tests::knob::{Honest, Knob, Tamper};
use touchstone_world::motor::{GIMBAL, MotorParameters};

fn settings(kind: EncoderKind, pole_pairs: u8) -> DeviceSettings {
    let mut settings = DeviceSettings::default();
    settings.encoder.kind = kind;
    settings.motor.pole_pairs = pole_pairs;
    settings
}

/// Error of the rotor alignment that the calibration has found, in electrical degrees.
fn error_deg<T: Tamper>(
    knob: &Knob<T>,
    motor: &MotorParameters,
    start_rad: f64,
    reversed: bool,
) -> f64 {
    let found = knob.device.alignment();
    // Count 0 of the unwrapped encoder is the position at which the device was switched on.
    let _ = reversed;
    let truth = motor.electrical_rad(start_rad) / TAU * 65_536.0;
    let difference = (f64::from(found.offset.0) - truth).rem_euclid(65_536.0);
    let short = if difference > 32_768.0 {
        difference - 65_536.0
    } else {
        difference
    };
    short / 65_536.0 * 360.0
}

#[test]
fn every_direction_offset_and_number_of_pole_pairs_is_found() {
    let mut worst: f64 = 0.0;
    for (kind, pairs) in [
        (EncoderKind::As5047p, 7),
        (EncoderKind::Mt6701, 4),
        (EncoderKind::Incremental, 11),
    ] {
        for (index, zero) in [0.0, 0.7, 2.0, 3.0, 3.2, 5.5].into_iter().enumerate() {
            let reversed_motor = index % 2 == 1;
            let reversed_encoder = index % 3 == 2;
            let motor = MotorParameters {
                pole_pairs: u32::from(pairs),
                flux_linkage_wb: 0.25 / 1.5 / f64::from(pairs),
                electrical_zero_rad: zero,
                reversed: reversed_motor,
                ..GIMBAL
            };
            let mut settings = settings(kind, pairs);
            settings.encoder.reversed = reversed_encoder;
            let start = 0.1 * f64::from(index as u8) - 0.2;
            let mut knob = Knob::new(&settings, motor, start, Honest);
            assert_eq!(
                knob.calibrate(),
                State::Ready,
                "{kind:?} {zero}: {:?}",
                knob.device.fault()
            );
            let found = knob.device.alignment();
            assert_eq!(
                found.against,
                reversed_motor != reversed_encoder,
                "{kind:?} {zero}"
            );
            worst = worst.max(error_deg(&knob, &motor, start, reversed_encoder).abs());
        }
    }
    println!("worst error: {worst} electrical degrees");
    assert!(worst < 0.5, "{worst} electrical degrees");
}

fn fails<T: Tamper>(
    settings: &DeviceSettings,
    motor: MotorParameters,
    tamper: T,
) -> (FaultCode, i32) {
    let mut knob = Knob::new(settings, motor, 0.0, tamper);
    let state = knob.calibrate();
    let fault = knob.device.fault();
    assert!(matches!(state, State::Fault(_)), "{state:?}");
    let fault = fault.expect("a fault");
    (fault.code, fault.value)
}

fn reason(settings: &DeviceSettings, motor: MotorParameters) -> Option<Reason> {
    let (code, value) = fails(settings, motor, Honest);
    assert_eq!(code, FaultCode::CalibrationFailed);
    Reason::from_value(value)
}

#[test]
fn wrong_pole_pairs_are_a_mismatch() {
    for wrong in [6, 8, 14] {
        let settings = settings(EncoderKind::As5047p, wrong);
        assert_eq!(
            reason(&settings, GIMBAL),
            Some(Reason::PolePairs),
            "{wrong}"
        );
    }
    let mut counts = settings(EncoderKind::Incremental, 7);
    counts.encoder.counts_per_rev = 16_384;
    assert!(Knob::new(&counts, GIMBAL, 0.0, Honest).calibrate() == State::Ready);
}

/// Falsifies the encoder so that it always reads the same count.
struct Frozen;
impl Tamper for Frozen {
    fn input(&mut self, _tick: u32, input: &mut ControlInput) -> bool {
        input.encoder = EncoderReading::As5047p(Frames::alone(0x8001));
        true
    }
}

#[test]
fn an_encoder_that_does_not_move_is_stuck() {
    assert_eq!(
        fails(&DeviceSettings::default(), GIMBAL, Frozen).0,
        FaultCode::EncoderStuck
    );
}

/// Falsifies the current sensors as if the motor phases were not connected: they measure no current.
struct Open;
impl Tamper for Open {
    fn sample(&mut self, _tick: u32, sample: &mut CurrentSample) {
        sample.phase_a = 2_128;
        sample.phase_b = 2_100;
    }
    fn bus_v(&mut self, _tick: u32) -> f64 {
        // The supply is so low that the true current stays harmless while the loop measures no current and applies its largest
        // voltage.
        18.5
    }
}

#[test]
fn a_current_that_does_not_come_is_noticed() {
    let (code, value) = fails(&DeviceSettings::default(), GIMBAL, Open);
    assert_eq!(
        (code, Reason::from_value(value)),
        (FaultCode::CalibrationFailed, Some(Reason::NoCurrent))
    );
}

/// Falsifies a current sensor: a wrong offset in converter codes, and noise in converter codes.
struct Offset(u16, u16);
impl Tamper for Offset {
    fn sample(&mut self, tick: u32, sample: &mut CurrentSample) {
        sample.phase_b = sample
            .phase_b
            .saturating_add(self.0)
            .saturating_add(if tick.is_multiple_of(2) { self.1 } else { 0 });
    }
}

#[test]
fn current_sensors_are_believed_near_their_schematic_only() {
    let settings = DeviceSettings::default();
    assert_eq!(
        fails(&settings, GIMBAL, Offset(300, 0)),
        (FaultCode::CurrentSensor, 2_400)
    );
    assert_eq!(
        fails(&settings, GIMBAL, Offset(0, 70)),
        (FaultCode::CurrentSensor, 70)
    );
}

#[test]
fn a_shaft_that_is_held_fast_is_noticed() {
    // Against the spring of a hand that stays in place, 0.02 N·m are not enough for a turn.
    let weak = MotorParameters {
        flux_linkage_wb: GIMBAL.flux_linkage_wb / 12.0,
        ..GIMBAL
    };
    let mut knob = Knob::new(&DeviceSettings::default(), weak, 0.0, Honest);
    knob.ask(Command::Calibrate);
    knob.tick();
    while knob.device.state() == State::Calibrating {
        knob.tick();
    }
    let fault = knob.device.fault().expect("a fault");
    assert_eq!(
        (fault.code, Reason::from_value(fault.value)),
        (FaultCode::CalibrationFailed, Some(Reason::Uneven))
    );
}
