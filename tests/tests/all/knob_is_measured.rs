//! Tests that a calibration with measurement finds the properties of motor and knob, whatever the settings were before. Resistance,
//! inductance, flux and inertia are found to within 5 %, damping and friction to within 20 % (the default motor's friction to
//! within 5 %).

use nalgebra::Complex;
use touchstone_drive::measurement::FAST_FIELD;
use touchstone_drive::{DeviceSettings, Reason};
use touchstone_lab::identify::motor::{KnownMotor, MeasuredMotor, MotorTick, NotMeasured, motor};
use touchstone_protocol::{Command, FaultCode, MeasuringPart, State, Telemetry};
use touchstone_tests::knob::{Honest, Knob, PERIOD_S, Tamper};
use touchstone_world::motor::{GIMBAL, MotorParameters};
use touchstone_world::plant::{BareCoulomb, Coulomb, Device};

/// The simulated knob of the DLR thesis, with some dry friction.
const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: Some(Coulomb {
        kinetic: 1e-3,
        breakaway: 1e-3,
    }),
};

fn asked() -> DeviceSettings {
    let mut settings = DeviceSettings::default();
    settings.calibration.measures = true;
    settings
}

fn known(settings: &DeviceSettings) -> KnownMotor {
    KnownMotor {
        rate_hz: f64::from(settings.timing.rate_hz),
        counts_per_rev: f64::from(settings.encoder.counts_per_rev),
        pole_pairs: f64::from(settings.motor.pole_pairs),
        fast_field_hz: f64::from(FAST_FIELD) / 2_f64.powi(32) / PERIOD_S,
    }
}

/// Converts a telemetry record to the form in which the desktop program evaluates a measurement; `None` outside of a measurement.
fn told(telemetry: &Telemetry) -> Option<MotorTick> {
    let milli = |value: i32| 1e-3 * f64::from(value);
    telemetry.measuring.map(|it| MotorTick {
        tick: telemetry.tick,
        part: it.part,
        count: telemetry.count,
        current_a: Complex::new(milli(it.current_d_ma), milli(telemetry.current_q_ma)),
        voltage_v: Complex::new(milli(it.voltage_d_mv), milli(it.voltage_q_mv)),
    })
}

/// Simulates a calibration; returns its telemetry, and the knob in its final state.
fn calibrated<T: Tamper>(
    settings: &DeviceSettings,
    truth: MotorParameters,
    knob: Device,
    tamper: T,
) -> (Vec<MotorTick>, Knob<T, BareCoulomb>) {
    let plant = BareCoulomb::new(&knob, PERIOD_S / 2.0).unwrap();
    let mut knob = Knob::with_plant(settings, truth, plant, 0.3, tamper);
    // A dead time of 0.5 us in a PWM period of 50 us.
    knob.rig.bridge.dead_share = 0.01;
    knob.ask(Command::Calibrate);
    let mut ticks = vec![];
    knob.tick();
    while knob.device.state() == State::Calibrating {
        knob.tick();
        ticks.extend(told(&knob.telemetry()));
    }
    (ticks, knob)
}

fn measured(truth: MotorParameters, knob: Device) -> MeasuredMotor {
    let settings = asked();
    let (ticks, knob) = calibrated(&settings, truth, knob, Honest);
    assert_eq!(knob.device.state(), State::Ready);
    motor(&ticks, &known(&settings)).unwrap()
}

/// Errors of the measured properties. Those of resistance, inductance, flux and inertia are relative to the true values. Those of
/// damping and friction are multiples of the allowed error, 20 % (for damping at least 2e-6 N·m·s/rad).
fn errors(found: &MeasuredMotor, truth: &MotorParameters, knob: &Device) -> [f64; 6] {
    let part = |found: f64, truth: f64| found / truth - 1.0;
    let allowed = |found: f64, truth: f64, floor: f64| (found - truth) / (0.2 * truth).max(floor);
    let it = &found.mechanics;
    let friction = knob.friction.unwrap().kinetic;
    [
        part(found.resistance_ohm.value, truth.resistance_ohm),
        part(found.inductance_h.value, truth.inductance_h),
        part(found.flux_linkage_wb.value, truth.flux_linkage_wb),
        part(it.inertia_kg_m2.value, knob.inertia),
        allowed(it.damping_n_m_s_per_rad.value, knob.damping, 2e-6),
        allowed(it.friction_n_m.value, friction, 0.0),
    ]
}

#[test]
fn a_motor_that_is_not_the_settings_is_found() {
    let mut worst = [0.0_f64; 6];
    for (index, [r, l, flux, j, b, friction]) in [
        [1.0; 6],
        [1.3, 1.3, 1.3, 1.3, 1.3, 1.3],
        [0.7, 0.7, 0.7, 0.7, 0.7, 0.7],
        [1.3, 0.7, 0.7, 1.3, 0.7, 1.3],
        [0.7, 1.3, 1.3, 0.7, 1.3, 0.7],
        [0.7, 0.7, 1.3, 1.3, 0.7, 0.7],
    ]
    .into_iter()
    .enumerate()
    {
        let truth = MotorParameters {
            resistance_ohm: r * GIMBAL.resistance_ohm,
            inductance_h: l * GIMBAL.inductance_h,
            flux_linkage_wb: flux * GIMBAL.flux_linkage_wb,
            electrical_zero_rad: index as f64,
            reversed: index % 2 == 1,
            ..GIMBAL
        };
        let mut knob = KNOB;
        knob.inertia *= j;
        knob.damping *= b;
        let torque = 1e-3 * friction;
        knob.friction = Some(Coulomb {
            kinetic: torque,
            breakaway: torque,
        });
        let errors = errors(&measured(truth, knob), &truth, &knob);
        println!("{index}: {errors:.4?}");
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error.abs());
        }
    }
    println!("worst {worst:.4?}");
    assert!(worst[..4].iter().all(|part| *part < 0.05), "{worst:.4?}");
    assert!(worst[4] < 1.0, "{worst:.4?}");
    // Errors of friction are fractions of the allowed fifth: 0.25 is 5 %.
    assert!(worst[5] < 0.25, "{worst:.4?}");
}

#[test]
fn a_small_gimbal_motor_is_found_with_the_same_settings() {
    // A GBM2804H-100T motor with published measurements: 5.29 Ω, 1.05 mH, 5.38 mWb; inertia and damping of its size.
    let truth = MotorParameters {
        resistance_ohm: 5.29,
        inductance_h: 1.05e-3,
        flux_linkage_wb: 5.38e-3,
        ..GIMBAL
    };
    let knob = Device {
        inertia: 3e-5,
        damping: 9e-6,
        friction: Some(Coulomb {
            kinetic: 1e-3,
            breakaway: 1e-3,
        }),
    };
    let errors = errors(&measured(truth, knob), &truth, &knob);
    println!("{errors:.4?}");
    assert!(
        errors[..4].iter().all(|part| part.abs() < 0.05),
        "{errors:.4?}"
    );
    assert!(
        errors[4..].iter().all(|part| part.abs() < 1.0),
        "{errors:.4?}"
    );
}

#[test]
fn without_being_asked_it_does_not_spin() {
    let mut settings = asked();
    settings.calibration.measures = false;
    let (ticks, knob) = calibrated(&settings, GIMBAL, KNOB, Honest);
    assert!(ticks.is_empty());
    assert_eq!(knob.device.state(), State::Ready);
}

#[test]
fn a_knob_that_is_held_is_refused() {
    let settings = asked();
    // Friction above the torque of 0.25 A, and below the torque of the alignment.
    let held = Device {
        friction: Some(Coulomb {
            kinetic: 0.08,
            breakaway: 0.08,
        }),
        ..KNOB
    };
    let (_, knob) = calibrated(&settings, GIMBAL, held, Honest);
    let fault = knob.device.fault().unwrap();
    assert_eq!(
        (fault.code, Reason::from_value(fault.value)),
        (FaultCode::CalibrationFailed, Some(Reason::Held))
    );
}

#[test]
fn what_is_not_whole_or_not_free_is_refused() {
    let settings = asked();
    let (ticks, _) = calibrated(&settings, GIMBAL, KNOB, Honest);
    let known = known(&settings);
    let judged = |ticks: &[MotorTick]| motor(ticks, &known).unwrap_err();

    let cut = &ticks[..ticks.len() / 3];
    assert!(matches!(judged(cut), NotMeasured::Incomplete { .. }));

    let mut gap = ticks.clone();
    gap.drain(2_000..2_020);
    assert_eq!(judged(&gap), NotMeasured::Lost { lost: 20 });
    // A few lost records are made up for.
    let mut gap = ticks.clone();
    gap.drain(2_000..2_003);
    assert!(motor(&gap, &known).is_ok());

    // A hand that brakes in one direction: the swings give two different inertias.
    let mut uneven = ticks.clone();
    let mut push = 0;
    for index in 1..uneven.len() {
        let begins = |part| ticks[index].part == part && ticks[index - 1].part != part;
        push += usize::from(begins(MeasuringPart::Push));
        if push % 2 == 0 {
            uneven[index].count =
                uneven[index - 1].count + ((ticks[index].count - ticks[index - 1].count) * 2) / 3;
        } else {
            uneven[index].count =
                uneven[index - 1].count + ticks[index].count - ticks[index - 1].count;
        }
    }
    let refused = judged(&uneven);
    assert!(
        matches!(
            refused,
            NotMeasured::Disagree { .. } | NotMeasured::Motion(_)
        ),
        "{refused}"
    );
}
