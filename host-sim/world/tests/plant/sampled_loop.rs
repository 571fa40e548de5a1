//! Tests the stiffness at which the sampled loop becomes unstable, against reference values.

use touchstone_world::plant::{
    BareLinear, Device, FIRM, Kinematics, LIGHT, MEDIUM, State, Stepper, closed_loop_matrix,
    critical_stiffness, spectral_radius,
};

use crate::oracle::KNOB;

const HEAVY_KNOB: Device = Device {
    inertia: 1e-4,
    damping: 5e-4,
    friction: None,
};
/// One axis of a large parallel device: 0.2 kg, 2.5 N·s/m.
const AXIS: Device = Device {
    inertia: 0.2,
    damping: 2.5,
    friction: None,
};

fn assert_within(value: f64, expected: f64, fraction: f64, what: &str) {
    assert!(
        (value / expected - 1.0).abs() <= fraction,
        "{what}: {value} is not {expected}"
    );
}

#[test]
fn critical_stiffness_is_damping_over_half_a_period_and_delay() {
    for device in [HEAVY_KNOB, AXIS] {
        for rate in [1_000.0, 10_000.0] {
            for ticks in [0.0, 0.25, 0.5, 1.0, 1.7, 3.0] {
                let (period, delay) = (1.0 / rate, ticks / rate);
                let value = critical_stiffness(&device, None, rate, delay).unwrap();
                let expected = device.damping / (period / 2.0 + delay);
                assert_within(value, expected, 0.02, &format!("{rate} Hz, {ticks} ticks"));
            }
        }
    }
}

#[test]
fn golden_values_of_knob_and_axis() {
    let knob = |rate, delay| critical_stiffness(&HEAVY_KNOB, None, rate, delay).unwrap();
    assert_within(knob(1_000.0, 0.0), 1.0008, 1e-4, "knob, 1 kHz");
    assert_within(knob(1_000.0, 1e-3), 0.334, 1e-3, "knob, one tick of delay");
    assert_within(knob(10_000.0, 0.0), 10.0, 1e-3, "knob, 10 kHz");
    let axis = |delay| critical_stiffness(&AXIS, None, 1_000.0, delay).unwrap();
    assert_within(axis(0.0), 5_010.0, 1e-3, "axis, 1 kHz");
    assert_within(axis(1e-3), 1_672.0, 1e-3, "axis, one tick of delay");
    // A device with a small inertia compared with its damping (b T / J = 0.5), for which the formula does not hold.
    let light = Device {
        inertia: 1e-6,
        ..HEAVY_KNOB
    };
    assert_within(
        critical_stiffness(&light, None, 1_000.0, 0.0).unwrap(),
        1.09,
        5e-3,
        "light knob",
    );
}

#[test]
fn without_damping_nothing_is_stable() {
    let device = Device {
        damping: 0.0,
        ..HEAVY_KNOB
    };
    assert_eq!(
        critical_stiffness(&device, None, 1_000.0, 0.0).unwrap(),
        0.0
    );
    assert!(critical_stiffness(&HEAVY_KNOB, None, 0.0, 0.0).is_err());
    assert!(critical_stiffness(&HEAVY_KNOB, None, 1_000.0, -1e-6).is_err());
}

#[test]
fn the_hand_adds_the_damping_of_its_pad_and_little_else() {
    // Rigidly attached, the hand's own damper would more than double the bare knob's damping.
    for hand in [LIGHT, MEDIUM, FIRM] {
        let value = critical_stiffness(&KNOB, Some(&hand), 1_000.0, 0.0).unwrap();
        let damping = KNOB.damping + hand.pad_damping;
        assert_within(value, 2.0 * damping / 1e-3, 0.15, "with pad");
    }
}

#[test]
fn the_boundary_separates_decay_from_growth_in_the_time_domain() {
    let plant = BareLinear::new(&HEAVY_KNOB, 1e-3).unwrap();
    let critical = critical_stiffness(&HEAVY_KNOB, None, 1_000.0, 1e-3).unwrap();
    let swing = |stiffness: f64| {
        let mut state = State::from_array([1e-3, 0.0]);
        let mut command = 0.0;
        let mut late = 0.0_f64;
        for tick in 0..80_000 {
            let next = -stiffness * state.position();
            plant.step(&mut state, command, 0.0);
            command = next;
            if tick >= 79_000 {
                late = late.max(state.position().abs());
            }
        }
        late
    };
    assert!(swing(0.98 * critical) < 1e-4, "{}", swing(0.98 * critical));
    assert!(swing(1.02 * critical) > 1e-2, "{}", swing(1.02 * critical));
}

#[test]
fn spectral_radius_agrees_with_eigenvalues() {
    let (before, after) = (
        BareLinear::new(&HEAVY_KNOB, 3e-4).unwrap(),
        BareLinear::new(&HEAVY_KNOB, 7e-4).unwrap(),
    );
    for stiffness in [0.1, 0.5, 1.0, 2.0] {
        let matrix = closed_loop_matrix(&before, &after, 1, stiffness);
        let largest = matrix
            .complex_eigenvalues()
            .iter()
            .map(|z| z.norm())
            .fold(0.0, f64::max);
        assert_within(spectral_radius(&matrix), largest, 1e-9, "spectral radius");
    }
}
