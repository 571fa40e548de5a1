//! Tests that a stored alignment (rotor angle relative to the encoder) is checked at the next start: used if it is right to within
//! 20 electrical degrees, and refused if it is wrong by more, for any reason.

use std::f64::consts::TAU;
use touchstone_drive::calibration::Alignment;
use touchstone_drive::{Angle, ControlInput, DeviceSettings, EncoderKind, Reason};
use touchstone_protocol::{Command, FaultCode, State};
use touchstone_tests::knob::{Honest, Knob, PERIOD_S, Tamper};
use touchstone_world::motor::{GIMBAL, MotorParameters};
use touchstone_world::plant::{BareCoulomb, Coulomb, Device};

fn settings(kind: EncoderKind) -> DeviceSettings {
    let mut settings = DeviceSettings::default();
    settings.encoder.kind = kind;
    settings
}

/// A simulated knob with dry friction and without a hand, at rest at `angle_rad`.
fn knob<T: Tamper>(
    settings: &DeviceSettings,
    motor: MotorParameters,
    friction_n_m: f64,
    angle_rad: f64,
    tamper: T,
) -> Knob<T, BareCoulomb> {
    let device = Device {
        inertia: 1e-4,
        damping: 4e-4,
        friction: Some(Coulomb {
            kinetic: friction_n_m,
            breakaway: friction_n_m,
        }),
    };
    let plant = BareCoulomb::new(&device, PERIOD_S / 2.0).expect("a knob");
    Knob::with_plant(settings, motor, plant, angle_rad, tamper)
}

/// The rotor alignment that a full calibration finds, as stored for the next start.
fn found(settings: &DeviceSettings, motor: MotorParameters) -> Alignment {
    let mut knob = knob(settings, motor, 1e-3, 0.3, Honest);
    assert_eq!(knob.calibrate(), State::Ready, "{:?}", knob.device.fault());
    assert!(!knob.device.was_checked());
    knob.device.found().expect("an absolute encoder's")
}

/// Result of the check of a stored alignment at the start.
#[derive(Debug)]
struct Checked {
    state: State,
    /// Largest angle between the shaft and its start position during the check, in mechanical degrees. `end_deg` is the angle at
    /// the end.
    most_deg: f64,
    end_deg: f64,
    time_s: f64,
}

fn checked<T: Tamper>(knob: &mut Knob<T, BareCoulomb>, kept: Alignment) -> Checked {
    let start = knob.rig.now().angle_rad;
    let degrees = |angle: f64| (angle - start).to_degrees().abs();
    knob.device.keep(Some(kept));
    knob.ask(Command::Calibrate);
    let from = knob.tick().tick;
    let mut most_deg: f64 = 0.0;
    while knob.device.state() == State::Calibrating {
        knob.tick();
        most_deg = most_deg.max(degrees(knob.rig.now().angle_rad));
    }
    Checked {
        state: knob.device.state(),
        most_deg,
        end_deg: degrees(knob.rig.now().angle_rad),
        time_s: f64::from(knob.record.tick - from) / 1_000.0,
    }
}

fn reason(state: State) -> Option<Reason> {
    match state {
        State::Fault(context) if context.code == FaultCode::CalibrationFailed => {
            Reason::from_value(context.value)
        }
        _ => None,
    }
}

/// Error of the rotor angle that the device calculates, in electrical degrees.
fn wrong_deg<T: Tamper>(knob: &Knob<T, BareCoulomb>, motor: &MotorParameters, start: f64) -> f64 {
    // Count 0 is the position at which the device was switched on.
    let truth = motor.electrical_rad(start) / TAU * 65_536.0;
    let off = (f64::from(knob.device.alignment().offset.0) - truth).rem_euclid(65_536.0);
    (if off > 32_768.0 { off - 65_536.0 } else { off }) / 65_536.0 * 360.0
}

#[test]
fn what_was_found_is_used_wherever_the_shaft_stands_at_the_next_start() {
    let (mut worst_deg, mut most_deg, mut longest_s, mut back_deg) =
        (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for (kind, reversed_motor, reversed_encoder, zero) in [
        (EncoderKind::As5047p, false, false, 0.7),
        (EncoderKind::As5047p, true, false, 3.2),
        (EncoderKind::Mt6701, false, true, 5.5),
        (EncoderKind::Mt6701, true, true, 2.0),
    ] {
        let motor = MotorParameters {
            electrical_zero_rad: zero,
            reversed: reversed_motor,
            ..GIMBAL
        };
        let mut settings = settings(kind);
        settings.encoder.reversed = reversed_encoder;
        let kept = found(&settings, motor);
        for start in [-2.9, -0.4, 0.3, 1.234, 7.5] {
            let mut knob = knob(&settings, motor, 1e-3, start, Honest);
            let checked = checked(&mut knob, kept);
            assert_eq!(checked.state, State::Ready, "{kind:?} {start}");
            assert!(knob.device.was_checked());
            worst_deg = worst_deg.max(wrong_deg(&knob, &motor, start).abs());
            most_deg = most_deg.max(checked.most_deg);
            back_deg = back_deg.max(checked.end_deg);
            longest_s = longest_s.max(checked.time_s);
            // The same alignment is stored again.
            assert_eq!(knob.device.found(), Some(kept), "{kind:?} {start}");
            knob.ask(Command::Arm);
            knob.tick();
            assert_eq!(knob.device.state(), State::Armed);
        }
    }
    println!(
        "wrong by {worst_deg:.2} electrical degrees at most; the shaft moved by {most_deg:.1} degrees and came back to {back_deg:.1}; {longest_s:.2} s"
    );
    assert!(worst_deg < 0.6, "{worst_deg}");
    // An eighth of an electrical turn is 6.4 degrees.
    assert!(most_deg < 7.5, "{most_deg}");
    assert!(longest_s < 3.0, "{longest_s}");
}

#[test]
fn what_is_wrong_is_refused_by_whatever_it_is_wrong() {
    let settings = settings(EncoderKind::As5047p);
    let motor = MotorParameters {
        electrical_zero_rad: 1.0,
        ..GIMBAL
    };
    let kept = found(&settings, motor);
    for (friction_n_m, starts) in [(1e-3, [0.3, 2.0]), (0.05, [0.3, -1.0])] {
        let mut most: f64 = 0.0;
        for degrees in (-180_i32..180).step_by(10) {
            for start in starts {
                let offset = Angle((f64::from(degrees) / 360.0 * 65_536.0) as i32 as u16);
                let wrong = Alignment {
                    offset: kept.offset.plus(offset),
                    ..kept
                };
                let mut knob = knob(&settings, motor, friction_n_m, start, Honest);
                let checked = checked(&mut knob, wrong);
                let why = reason(checked.state);
                let at =
                    format!("{degrees} degrees, {friction_n_m} N·m, from {start}: {checked:?}");
                match degrees.abs() {
                    0..20 => assert_eq!(checked.state, State::Ready, "{at}"),
                    // At the limit itself either result is right.
                    20 => {}
                    _ => assert_eq!(why, Some(Reason::KeptWrong), "{at}"),
                }
                most = most.max(checked.most_deg);
            }
        }
        println!(
            "{friction_n_m} N·m: the shaft moved by {most:.1} degrees at most until it was off"
        );
        assert!(most < 14.0, "{most}");
    }
}

#[test]
fn a_rotor_that_stands_exactly_against_the_field_is_found() {
    let settings = settings(EncoderKind::As5047p);
    let kept = found(&settings, GIMBAL);
    let against = Alignment {
        offset: kept.offset.plus(Angle(0x8000)),
        ..kept
    };
    // Dry friction that holds the shaft, also in the first part of the rocking, up to a friction that never releases it.
    for friction_n_m in [1e-3, 0.02, 0.1, 0.15, 0.2, 0.4] {
        let mut knob = knob(&settings, GIMBAL, friction_n_m, 0.3, Honest);
        let checked = checked(&mut knob, against);
        let why = reason(checked.state);
        assert!(
            matches!(why, Some(Reason::KeptWrong | Reason::KeptNotFollowed)),
            "{friction_n_m}: {checked:?}"
        );
        println!(
            "{friction_n_m} N·m: {why:?}, {:.1} degrees",
            checked.most_deg
        );
    }
}

#[test]
fn phases_in_another_order_and_a_shaft_that_is_held_are_refused() {
    let settings = settings(EncoderKind::As5047p);
    let kept = found(&settings, GIMBAL);
    let swapped = MotorParameters {
        reversed: true,
        ..GIMBAL
    };
    for start in [0.0, 0.3, 1.0] {
        let mut other = knob(&settings, swapped, 1e-3, start, Honest);
        let why = reason(checked(&mut other, kept).state);
        assert!(why.is_some(), "{start}");
    }
    let wrong_way = Alignment {
        against: !kept.against,
        ..kept
    };
    for start in [0.0, 0.3, 1.0] {
        let mut other = knob(&settings, GIMBAL, 1e-3, start, Honest);
        let why = reason(checked(&mut other, wrong_way).state);
        assert!(why.is_some(), "{start}");
    }
    let mut held = knob(&settings, GIMBAL, 1.0, 0.3, Honest);
    assert_eq!(
        reason(checked(&mut held, kept).state),
        Some(Reason::KeptNotFollowed)
    );
}

/// Falsifies the encoder so that it reports a shaft that turns at this speed in rad/s.
struct Turning(f64);

impl Tamper for Turning {
    fn input(&mut self, tick: u32, input: &mut ControlInput) -> bool {
        use touchstone_drive::EncoderReading;
        use touchstone_world::motor::{count, mt6701_frame};
        let angle = self.0 * f64::from(tick) / 1_000.0;
        input.encoder = EncoderReading::Mt6701(mt6701_frame(count(angle, 16_384), 0));
        true
    }
}

#[test]
fn a_shaft_that_turns_is_not_checked() {
    let settings = settings(EncoderKind::Mt6701);
    let kept = found(&settings, GIMBAL);
    let mut turning = knob(&settings, GIMBAL, 1e-3, 0.0, Turning(1.0));
    let checked = checked(&mut turning, kept);
    assert_eq!(reason(checked.state), Some(Reason::KeptTurning));
    // The bridge was never switched on.
    assert!((4.0..4.1).contains(&checked.time_s), "{checked:?}");
}

#[test]
fn what_has_no_zero_of_its_own_is_not_kept_and_a_measurement_begins_at_the_beginning() {
    let mut incremental = Knob::new(&settings(EncoderKind::Incremental), GIMBAL, 0.3, Honest);
    assert_eq!(incremental.calibrate(), State::Ready);
    assert_eq!(incremental.device.found(), None);

    let absolute = settings(EncoderKind::As5047p);
    let kept = found(&absolute, GIMBAL);
    let mut changed = knob(&absolute, GIMBAL, 1e-3, 0.3, Honest);
    assert_eq!(changed.calibrate(), State::Ready);
    assert_eq!(changed.device.found(), Some(kept));
    // New settings are waiting: the alignment was measured with the old ones.
    let mut eleven = absolute.clone();
    eleven.motor.pole_pairs = 11;
    changed
        .device
        .configure(&eleven, &touchstone_drive::hardware::IHM08M1)
        .expect("settings");
    assert_eq!(changed.device.found(), None);

    let mut measures = absolute.clone();
    measures.calibration.measures = true;
    let mut measured = knob(&measures, GIMBAL, 1e-3, 0.3, Honest);
    measured.device.keep(Some(kept));
    assert_eq!(measured.calibrate(), State::Ready);
    assert!(!measured.device.was_checked());
}
