//! Tests that the steps of linear plants are exact, and that changes without a physical effect (mirroring, scaling) change nothing.

use nalgebra::{SMatrix, SVector};
use touchstone_world::plant::{
    BareCoulomb, BareLinear, Device, FIRM, Hand, HeldCoulomb, HeldLinear, Kinematics, LIGHT,
    MEDIUM, State, Stepper,
};

use crate::oracle::{KNOB, Oracle, Random, STICKY_KNOB, assert_close};

const DAMPINGS: [f64; 5] = [0.0, 1e-15, 1e-9, 3e-4, 0.05];
const INTERVALS: [f64; 4] = [1e-5, 1e-3, 2.5e-3, 0.02];

#[test]
fn bare_step_and_loss_are_what_runge_kutta_converges_to() {
    for damping in DAMPINGS {
        for h in INTERVALS {
            let device = Device { damping, ..KNOB };
            let plant = BareLinear::new(&device, h).unwrap();
            let oracle = Oracle { device, hand: None };
            for (v, u) in [(0.0, 0.01), (3.0, 0.0), (3.0, -0.02)] {
                let n = 20_000;
                let expected = oracle.runge_kutta(&[0.2, v, 0.2, v, 0.0, 0.0, 0.0], u, 0.0, h, n);
                let mut state = State::from_array([0.2, v]);
                let loss = plant.step_with_loss(&mut state, u, 9.0);
                let what = format!("b {damping}, h {h}, v {v}, u {u}");
                assert_close(state.to_array(), &expected, &[0.2, v], 2e-12, &what);
                assert!(
                    (loss.device_j - expected[4]).abs() <= 1e-11 * expected[4],
                    "{what}"
                );
                assert_eq!(loss.hand_j, 0.0);
            }
        }
    }
}

#[test]
fn held_step_and_loss_are_what_runge_kutta_converges_to() {
    for hand in [LIGHT, MEDIUM, FIRM] {
        for damping in DAMPINGS {
            for h in INTERVALS {
                let device = Device { damping, ..KNOB };
                let plant = HeldLinear::new(&device, &hand, h).unwrap();
                let oracle = Oracle {
                    device,
                    hand: Some(hand),
                };
                let mut random = Random(7);
                for _ in 0..3 {
                    let z: [f64; 4] = std::array::from_fn(|_| random.uniform());
                    let (u, r) = (0.05 * random.uniform(), random.uniform());
                    let full = [z[0], z[1], z[2], z[3], 0.0, 0.0, 0.0];
                    let expected = oracle.runge_kutta(&full, u, r, h, 10_000);
                    let mut state = State::from_array(z);
                    let loss = plant.step_with_loss(&mut state, u, r);
                    let what = format!("b {damping}, h {h}");
                    assert_close(state.to_array(), &expected, &z, 2e-12, &what);
                    assert!(
                        (loss.device_j - expected[4]).abs() <= 1e-11 * expected[4],
                        "{what}"
                    );
                    assert!(
                        (loss.hand_j - expected[6]).abs() <= 1e-11 * expected[6],
                        "{what}"
                    );
                }
            }
        }
    }
}

#[test]
fn held_step_is_the_matrix_exponential_in_absolute_angles() {
    // The states [x, v, x_h, v_h, u, r], with the matrix exponential by nalgebra's Padé approximant.
    let (d, p) = (KNOB, MEDIUM);
    let (j, j_h) = (d.inertia, p.inertia);
    let (k_p, b_p) = (p.pad_stiffness, p.pad_damping);
    let (k_h, b_h) = (p.stiffness, p.damping);
    let mut a = SMatrix::<f64, 6, 6>::zeros();
    (a[(0, 1)], a[(2, 3)]) = (1.0, 1.0);
    (a[(1, 0)], a[(1, 1)], a[(1, 2)], a[(1, 3)]) =
        (-k_p / j, -(b_p + d.damping) / j, k_p / j, b_p / j);
    a[(1, 4)] = 1.0 / j;
    (a[(3, 0)], a[(3, 1)], a[(3, 2)], a[(3, 3)]) =
        (k_p / j_h, b_p / j_h, -(k_p + k_h) / j_h, -(b_p + b_h) / j_h);
    a[(3, 5)] = k_h / j_h;
    for h in [1e-4, 1e-3, 0.1] {
        let plant = HeldLinear::new(&KNOB, &MEDIUM, h).unwrap();
        let z = [0.1, -2.0, 0.12, 1.0];
        let (u, r) = (-0.03, 0.3);
        let expected = (a * h).exp() * SVector::from([z[0], z[1], z[2], z[3], u, r]);
        let mut state = State::from_array(z);
        plant.step(&mut state, u, r);
        assert_close(
            state.to_array(),
            expected.as_slice(),
            &z,
            1e-12,
            &format!("h {h}"),
        );
    }
}

#[test]
fn two_part_steps_make_one_whole() {
    let device = KNOB;
    for (first, second) in [(5e-4, 5e-4), (1e-4, 9e-4), (1e-9, 1e-3 - 1e-9)] {
        let whole = HeldLinear::new(&device, &MEDIUM, first + second).unwrap();
        let parts = [first, second].map(|h| HeldLinear::new(&device, &MEDIUM, h).unwrap());
        let bare_whole = BareLinear::new(&device, first + second).unwrap();
        let bare_parts = [first, second].map(|h| BareLinear::new(&device, h).unwrap());

        let mut once = State::from_array([0.1, -2.0, 0.12, 1.0]);
        let (mut twice, mut bare_once, mut bare_twice) = (
            once,
            State::from_array([0.1, -2.0]),
            State::from_array([0.1, -2.0]),
        );
        let mut losses = [0.0; 4];
        for _ in 0..50 {
            losses[0] += whole.step_with_loss(&mut once, -0.03, 0.3).total_j();
            losses[1] += bare_whole
                .step_with_loss(&mut bare_once, -0.03, 0.3)
                .total_j();
            for part in 0..2 {
                losses[2] += parts[part].step_with_loss(&mut twice, -0.03, 0.3).total_j();
                losses[3] += bare_parts[part]
                    .step_with_loss(&mut bare_twice, -0.03, 0.3)
                    .total_j();
            }
        }
        assert_close(
            twice.to_array(),
            &once.to_array(),
            &[0.1, 2.0, 0.1, 1.0],
            2e-14,
            "held",
        );
        assert_close(
            bare_twice.to_array(),
            &bare_once.to_array(),
            &[0.1, 2.0],
            2e-14,
            "bare",
        );
        assert!((losses[0] - losses[2]).abs() < 1e-13 * losses[0]);
        assert!((losses[1] - losses[3]).abs() < 1e-13 * losses[1]);
    }
}

#[test]
fn without_damping_the_bare_device_falls_on_a_parabola() {
    let device = Device {
        damping: 0.0,
        ..KNOB
    };
    let (h, v, u) = (1e-3, 1.5, -0.013);
    let a = u / device.inertia;
    let fall = |b: f64| {
        let plant = BareLinear::new(
            &Device {
                damping: b,
                ..device
            },
            h,
        )
        .unwrap();
        let mut state = State::from_array([0.0, v]);
        plant.step(&mut state, u, 0.0);
        state
    };
    let still = fall(0.0);
    assert!((still.position() - (v * h + a * h * h / 2.0)).abs() < 4e-16 * v * h);
    assert!((still.velocity() - (v + a * h)).abs() < 4e-16 * v);
    // To first order in b, the parabola gives dv = -(b/J)(v h + a h²/2). A closed form that divides by b loses this change.
    for b in [1e-6, 1e-8, 1e-10] {
        let change = fall(b).velocity() - still.velocity();
        let expected = -b / device.inertia * (v * h + a * h * h / 2.0);
        assert!(
            (change - expected).abs() < 1e-4 * expected.abs() + 4e-16,
            "b {b:e}: {change:e}, {expected:e}"
        );
    }
    assert_eq!(fall(1e-300), still);
}

#[test]
fn a_pad_that_transmits_nothing_leaves_the_device_alone() {
    let loose = Hand {
        pad_stiffness: 0.0,
        pad_damping: 0.0,
        ..MEDIUM
    };
    let held = HeldLinear::new(&KNOB, &loose, 1e-3).unwrap();
    let bare = BareLinear::new(&KNOB, 1e-3).unwrap();
    let (mut a, mut b) = (
        State::from_array([0.1, 2.0, 0.3, -1.0]),
        State::from_array([0.1, 2.0]),
    );
    for _ in 0..100 {
        held.step(&mut a, 0.01, 0.5);
        bare.step(&mut b, 0.01, f64::NAN);
    }
    assert_close(
        [a.position(), a.velocity()],
        &b.to_array(),
        &[0.1, 2.0],
        1e-14,
        "device",
    );
}

#[test]
fn nothing_moves_at_equilibrium_or_in_no_time() {
    let at_rest = State::<4>::at_rest(0.7);
    let mut state = at_rest;
    HeldLinear::new(&KNOB, &FIRM, 1e-3)
        .unwrap()
        .step(&mut state, 0.0, 0.7);
    assert_eq!(state, at_rest);

    let moving = State::from_array([0.1, 2.0, 0.3, -1.0]);
    let mut state = moving;
    let loss = HeldLinear::new(&KNOB, &FIRM, 0.0)
        .unwrap()
        .step_with_loss(&mut state, 1.0, 2.0);
    assert_eq!((state, loss.total_j()), (moving, 0.0));
    let loss = HeldCoulomb::new(&STICKY_KNOB, &FIRM, 0.0)
        .unwrap()
        .step_with_loss(&mut state, 1.0, 2.0);
    assert_eq!((state, loss.total_j()), (moving, 0.0));
    let mut state = State::from_array([0.1, 2.0]);
    BareLinear::new(&KNOB, 0.0)
        .unwrap()
        .step(&mut state, 1.0, 0.0);
    BareCoulomb::new(&STICKY_KNOB, 0.0)
        .unwrap()
        .step(&mut state, 1.0, 0.0);
    assert_eq!(state, State::from_array([0.1, 2.0]));
}

/// Simulates a plant with a torque that reverses the motion often and a wandering rest point. `mirror` and `scale` are factors on
/// the inputs.
fn run<P: Stepper>(plant: &P, mirror: f64, scale: f64, mut each: impl FnMut(usize, P::State)) {
    let mut random = Random(11);
    let mut state = P::State::at_rest(0.0);
    let (mut torque, mut rest) = (0.0, 0.0);
    for tick in 0..20_000 {
        if tick % 16 == 0 {
            torque = 8e-3 * random.uniform();
            rest = 0.2 * random.uniform();
        }
        plant.step(&mut state, mirror * scale * torque, mirror * scale * rest);
        each(tick, state);
    }
}

fn entries<S: Kinematics>(state: S) -> [f64; 4] {
    [
        state.position(),
        state.velocity(),
        state.hand_position(),
        state.hand_velocity(),
    ]
}

fn trace<P: Stepper>(plant: &P, mirror: f64, scale: f64) -> Vec<[f64; 4]> {
    let mut trace = Vec::new();
    run(plant, mirror, scale, |_, state| trace.push(entries(state)));
    trace
}

/// Checks that two runs are equal bit for bit after scaling by `factor`. The sign of a zero may differ, because mirroring a sum
/// keeps it (`1 - 1` is `+0` in both runs).
fn assert_scaled(trace: &[[f64; 4]], expected: &[[f64; 4]], factor: f64) {
    for (tick, (a, b)) in trace.iter().zip(expected).enumerate() {
        assert_eq!(*a, b.map(|entry| factor * entry), "tick {tick}");
    }
}

#[test]
fn mirrored_runs_are_mirror_images_to_the_bit() {
    let bare = BareLinear::new(&KNOB, 1e-3).unwrap();
    assert_scaled(&trace(&bare, -1.0, 1.0), &trace(&bare, 1.0, 1.0), -1.0);
    let held = HeldLinear::new(&KNOB, &MEDIUM, 1e-3).unwrap();
    assert_scaled(&trace(&held, -1.0, 1.0), &trace(&held, 1.0, 1.0), -1.0);
    let bare = BareCoulomb::new(&STICKY_KNOB, 1e-3).unwrap();
    assert_scaled(&trace(&bare, -1.0, 1.0), &trace(&bare, 1.0, 1.0), -1.0);
    let held = HeldCoulomb::new(&STICKY_KNOB, &MEDIUM, 1e-3).unwrap();
    let there = trace(&held, 1.0, 1.0);
    assert_scaled(&trace(&held, -1.0, 1.0), &there, -1.0);
    // The simulated motion must contain sticking and changes of direction, so that mirroring tests them.
    let stuck = there.iter().filter(|z| z[1] == 0.0).count();
    let turned = there.windows(2).filter(|z| z[0][1] * z[1][1] < 0.0).count();
    assert!(stuck > 100 && turned > 100, "{stuck} {turned}");
}

#[test]
fn linear_runs_scale_by_powers_of_two_to_the_bit() {
    let bare = BareLinear::new(&KNOB, 1e-3).unwrap();
    assert_scaled(&trace(&bare, 1.0, 1024.0), &trace(&bare, 1.0, 1.0), 1024.0);
    let held = HeldLinear::new(&KNOB, &MEDIUM, 1e-3).unwrap();
    assert_scaled(&trace(&held, 1.0, 1024.0), &trace(&held, 1.0, 1.0), 1024.0);
}

#[test]
fn asking_for_the_loss_changes_no_bit() {
    fn check<P: Stepper>(plant: &P)
    where
        P::State: PartialEq + std::fmt::Debug,
    {
        let mut random = Random(3);
        let mut state = P::State::at_rest(0.1);
        let mut with_loss = state;
        for tick in 0..20_000 {
            let (torque, rest) = (6e-3 * random.uniform(), 0.3 * random.uniform());
            plant.step(&mut state, torque, rest);
            let loss = plant.step_with_loss(&mut with_loss, torque, rest);
            assert_eq!(state, with_loss, "tick {tick}");
            assert!(
                loss.device_j >= 0.0 && loss.hand_j >= 0.0,
                "tick {tick}: {loss:?}"
            );
        }
    }
    check(&BareLinear::new(&KNOB, 1e-3).unwrap());
    check(&HeldLinear::new(&KNOB, &LIGHT, 1e-3).unwrap());
    check(&BareCoulomb::new(&STICKY_KNOB, 1e-3).unwrap());
    check(&HeldCoulomb::new(&STICKY_KNOB, &LIGHT, 1e-3).unwrap());
}

#[test]
fn angles_far_from_zero_are_as_good_as_near() {
    // The angles are exact in binary, so that the offset of 4096 rad rounds none of them.
    let held = HeldLinear::new(&KNOB, &MEDIUM, 1e-3).unwrap();
    let mut near = State::from_array([0.125, 1.0, 0.25, -2.0]);
    let mut far = State::from_array([4096.125, 1.0, 4096.25, -2.0]);
    let losses = (
        held.step_with_loss(&mut near, 0.01, 0.5),
        held.step_with_loss(&mut far, 0.01, 4096.5),
    );
    assert_eq!(losses.0, losses.1);
    assert_eq!(near.velocity(), far.velocity());
    assert_eq!(near.hand_velocity(), far.hand_velocity());
}
