//! Tests of the motor against an independent integration of its equations, and against known properties of motors.

use std::f64::consts::TAU;
use touchstone_world::motor::{
    Bridge, Drive, GIMBAL, KNOB, MotorParameters, Rig, Shunt, Windings, Wires, as5047p_frame,
    count, mt6701_frame,
};
use touchstone_world::plant::{BareLinear, HeldLinear, Kinematics, MEDIUM, Stepper};

const PERIOD_S: f64 = 50e-6;
const TOP: u16 = 4_250;

fn amplitude_invariant([a, b, c]: [f64; 3], theta: f64) -> (f64, f64) {
    let third = TAU / 3.0;
    let d = 2.0 / 3.0 * (a * theta.cos() + b * (theta - third).cos() + c * (theta + third).cos());
    let q = -2.0 / 3.0 * (a * theta.sin() + b * (theta - third).sin() + c * (theta + third).sin());
    (d, q)
}

/// Rates of the currents `(i_d, i_q)` in the rotor's frame by the textbook equations, A/s. Their form differs from that of the
/// tested model.
fn slope(
    m: &MotorParameters,
    (d, q): (f64, f64),
    (v_d, v_q): (f64, f64),
    omega: f64,
) -> (f64, f64) {
    (
        (v_d - m.resistance_ohm * d + omega * m.inductance_h * q) / m.inductance_h,
        (v_q - m.resistance_ohm * q - omega * (m.inductance_h * d + m.flux_linkage_wb))
            / m.inductance_h,
    )
}

#[test]
fn windings_agree_with_a_fine_integration_in_the_rotors_frame() {
    for (reversed, zero) in [(false, 0.0), (true, 1.3)] {
        let motor = MotorParameters {
            reversed,
            electrical_zero_rad: zero,
            ..GIMBAL
        };
        let sign = if reversed { -7.0 } else { 7.0 };
        for speed in [0.0, 1e-5, 20.0, -150.0] {
            let mut windings = Windings::new(motor, PERIOD_S);
            let mut angle: f64 = 0.4;
            let mut fine = (0.0, 0.0);
            for period in 0..60 {
                let volts = [
                    12.0 + f64::from(period % 7),
                    9.0,
                    14.0 - f64::from(period % 3),
                ];
                let torque = windings.step(volts, angle, speed);
                // Integrates the equations by 200 steps of the fourth-order Runge-Kutta method.
                let h = PERIOD_S / 200.0;
                let omega = sign * speed;
                let mut mean = 0.0;
                for step in 0..200 {
                    let theta = |s: f64| sign * (angle + speed * h * (f64::from(step) + s)) + zero;
                    let v = |s: f64| amplitude_invariant(volts, theta(s));
                    let at = |k: (f64, f64), s: f64| (fine.0 + k.0 * s * h, fine.1 + k.1 * s * h);
                    let k1 = slope(&motor, fine, v(0.0), omega);
                    let k2 = slope(&motor, at(k1, 0.5), v(0.5), omega);
                    let k3 = slope(&motor, at(k2, 0.5), v(0.5), omega);
                    let k4 = slope(&motor, at(k3, 1.0), v(1.0), omega);
                    let before = fine.1;
                    fine.0 += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
                    fine.1 += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
                    mean += 0.5 * (before + fine.1) / 200.0;
                }
                angle += speed * PERIOD_S;
                let (d, q) = windings.dq_a(angle);
                assert!(
                    (d - fine.0).abs() < 1e-9 && (q - fine.1).abs() < 1e-9,
                    "{speed}: {d} {q} {fine:?}"
                );
                let expected = 0.25 * mean * sign.signum();
                assert!(
                    (torque - expected).abs() < 1e-7,
                    "{speed}: {torque} {expected}"
                );
                let phases = windings.currents_a();
                assert!(phases.iter().sum::<f64>().abs() < 1e-12);
                let shown = amplitude_invariant(phases, sign * angle + zero);
                assert!((shown.0 - d).abs() < 1e-9 && (shown.1 - q).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn the_current_of_an_open_bridge_ends_and_stays_ended() {
    let mut windings = Windings::new(GIMBAL, PERIOD_S);
    for _ in 0..200 {
        windings.step([16.0, 8.0, 8.0], 0.0, 0.0);
    }
    let start = windings.currents_a()[0];
    assert!(start > 0.85, "{start}");
    let mut last = start;
    let mut periods = 0;
    while windings.currents_a() != [0.0; 3] {
        windings.freewheel(24.0, 0.7, 0.0);
        assert!(windings.currents_a()[0] < last, "falls");
        last = windings.currents_a()[0];
        periods += 1;
    }
    // L/R ln(1 + R i/V) = 0.5 ms ln(1 + 5.33/16.9) = 137 µs.
    assert_eq!(periods, 3);
    assert_eq!(windings.freewheel(24.0, 0.7, 0.0), 0.0);
}

fn push(period_s: f64, seconds: f64) -> (f64, f64) {
    let plant = HeldLinear::new(&KNOB, &MEDIUM, period_s).unwrap();
    let mut rig = Rig::new(GIMBAL, Bridge::ideal(24.0, TOP), plant, 0.0);
    let mut now = rig.now();
    for _ in 0..(seconds / period_s).round() as u32 {
        now = rig.step(Drive::On([2_800, 1_500, 2_125]), 0.3);
    }
    (now.angle_rad, now.currents_a[0])
}

#[test]
fn coupling_windings_and_plant_converges_with_the_period() {
    let (fine, coarse, half) = (
        push(1e-6, 0.05),
        push(PERIOD_S, 0.05),
        push(PERIOD_S / 2.0, 0.05),
    );
    let error = (coarse.0 - fine.0).abs();
    assert!(error < 1e-4 * fine.0.abs(), "{coarse:?} {fine:?}");
    assert!(
        (half.0 - fine.0).abs() < 0.4 * error,
        "{error} {half:?} {fine:?}"
    );
    assert!((coarse.1 - fine.1).abs() < 1e-3, "{coarse:?} {fine:?}");
}

#[test]
fn a_field_that_stands_still_pulls_the_rotor_into_it() {
    for (reversed, zero, pairs) in [(false, 0.0, 7), (true, 2.0, 7), (false, -0.5, 4)] {
        let motor = MotorParameters {
            reversed,
            electrical_zero_rad: zero,
            pole_pairs: pairs,
            ..GIMBAL
        };
        let plant = BareLinear::new(&KNOB, PERIOD_S).unwrap();
        let mut rig = Rig::new(motor, Bridge::ideal(24.0, TOP), plant, 0.1);
        for _ in 0..60_000 {
            rig.step(Drive::On([3_125, 1_625, 1_625]), 0.0);
        }
        let electrical = motor.electrical_rad(rig.now().angle_rad).rem_euclid(TAU);
        assert!(electrical.min(TAU - electrical) < 1e-3, "{electrical}");
        let (d, q) = rig.dq_a();
        assert!(d > 0.9 && q.abs() < 1e-3, "{d} {q}");
    }
}

#[test]
fn dead_time_takes_voltage_from_the_current() {
    let bridge = Bridge {
        dead_share: 0.01,
        ..Bridge::ideal(24.0, TOP)
    };
    let with = bridge.voltages([2_125; 3], [1.0, -1.0, 0.0]);
    assert_eq!(with, [12.0 - 0.24, 12.0 + 0.24, 12.0]);
}

#[test]
fn currents_become_codes_and_codes_end() {
    let shunt = Shunt::bits12(0.015_553, 1_924.25);
    assert_eq!(shunt.code(0.0), 1_924);
    assert_eq!(shunt.code(0.015_553), 1_925);
    assert_eq!(shunt.code(-1_000.0), 0);
    assert_eq!(shunt.code(1_000.0), 4_095);
    // 1 A into the motor is 10 mV below ground at the shunt, -51.8 mV at the converter: 64 codes.
    let shield = Shunt::low_side(0.01, 5.18, 2_122.0);
    assert_eq!(shield.code(1.0), 2_122 - 64);
    assert_eq!(shield.code(-1.0), 2_122 + 64);
}

#[test]
fn frames_of_the_encoders() {
    assert_eq!(count(TAU / 4.0, 16_384), 4_096);
    assert_eq!(as5047p_frame(0x3FFF), 0x3FFF);
    assert_eq!(as5047p_frame(1), 0x8001);
    assert_eq!(as5047p_frame(-1), 0x3FFF);
    // x^6 of data leaves x + 1.
    assert_eq!(mt6701_frame(0, 1), 0b100_0011);
}

#[test]
fn the_same_inputs_give_the_same_bits() {
    assert_eq!(push(PERIOD_S, 0.02), push(PERIOD_S, 0.02));
    let plant = BareLinear::new(&KNOB, PERIOD_S).unwrap();
    assert_eq!(plant.interval_s(), PERIOD_S);
    let mut rig = Rig::new(GIMBAL, Bridge::ideal(24.0, TOP), plant, 0.5);
    assert_eq!(rig.state_mut().position(), 0.5);
    assert_eq!(rig.step(Drive::Off, 0.0).angle_rad, 0.5);
}

#[test]
fn an_open_phase_leaves_two_in_series_and_exchanged_wires_turn_the_other_way() {
    let held = touchstone_world::plant::Device {
        inertia: 1e9,
        ..KNOB
    };
    let stands = |wires: Wires, angle_rad: f64| {
        let plant = BareLinear::new(&held, PERIOD_S).unwrap();
        let mut rig = Rig::new(GIMBAL, Bridge::ideal(24.0, TOP), plant, angle_rad);
        rig.wires = wires;
        let mut now = rig.now();
        for _ in 0..1_000 {
            now = rig.step(Drive::On([2_800, 1_500, 2_125]), 0.0);
        }
        assert!(rig.given_j.abs() < 1e-6, "{}", rig.given_j);
        now
    };
    let volts = |leg: f64| 24.0 * leg / f64::from(TOP);
    // The phase of leg A, B or C is open: the difference of the other two drives their resistances in series.
    for (open, [from, into]) in [(0, [1, 2]), (1, [2, 0]), (2, [0, 1])] {
        let wires = Wires {
            open: Some(open),
            ..Wires::RIGHT
        };
        let now = stands(wires, 0.1);
        let legs = [2_800.0, 1_500.0, 2_125.0];
        let exact = (volts(legs[from]) - volts(legs[into])) / (2.0 * GIMBAL.resistance_ohm);
        assert!(now.currents_a[open].abs() < 1e-12, "{now:?}");
        assert!((now.currents_a[from] - exact).abs() < 1e-9, "{now:?}");
        assert!((now.currents_a[into] + exact).abs() < 1e-9, "{now:?}");
        // The torque of these currents: the flux of each phase is a cosine of its angle to the rotor.
        let theta = 0.1 * 7.0;
        let slope = |phase: usize| -(theta - TAU / 3.0 * phase as f64).sin();
        let torque = 7.0 * GIMBAL.flux_linkage_wb * exact * (slope(from) - slope(into));
        assert!((now.torque_n_m - torque).abs() < 1e-6, "{now:?} {torque}");
    }
    // Two wires are swapped and the angle has the other sign. The torque then has the other sign, and each leg has the same
    // current as before.
    let mirrored = Wires {
        order: [0, 2, 1],
        ..Wires::RIGHT
    };
    let (right, wrong) = (stands(Wires::RIGHT, 0.1), stands(mirrored, -0.1));
    assert!((right.torque_n_m + wrong.torque_n_m).abs() < 1e-12);
    for leg in 0..3 {
        assert!((right.currents_a[leg] - wrong.currents_a[leg]).abs() < 1e-12);
    }
}
