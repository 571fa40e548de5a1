//! Tests of the friction models at the shaft of a drive train, also with friction that depends on the direction. References are
//! closed-form solutions, and Runge–Kutta steps that share no code with the train.

use super::train::{KNOB, LOSSLESS, T, bare, made, smooth, torque};
use touchstone_world::plant::train::{Current, Friction, Links, LuGre, Shaft, Sliding, TrainState};
use touchstone_world::plant::{
    BareCoulomb, Biased, Coulomb, Device, HeldCoulomb, Kinematics, MEDIUM, State, Stepper,
};

fn sliding(kinetic: f64, breakaway: f64, stribeck: Option<f64>) -> Shaft {
    Shaft {
        friction: Friction::Dry {
            directions: [Sliding { kinetic, breakaway }; 2],
            stribeck,
        },
        ..smooth()
    }
}

#[test]
fn dry_friction_in_a_train_converges_to_the_closed_form() {
    let friction = Some(Coulomb {
        kinetic: 2e-3,
        breakaway: 3e-3,
    });
    let sticky = Device { friction, ..KNOB };
    let off = |substeps: u32| {
        let train = made::<2, 6>(&bare(KNOB), &sliding(2e-3, 3e-3, None), substeps);
        let plant = BareCoulomb::new(&sticky, T).unwrap();
        let mut states = (TrainState::at_rest(0.0), State::at_rest(0.0));
        (0..1000).fold(0.0_f64, |worst, tick| {
            let u = 0.008 * (0.05 * f64::from(tick)).sin();
            train.step(&mut states.0, u, 0.0);
            plant.step(&mut states.1, u, 0.0);
            worst.max((states.0.position() - states.1.position()).abs())
        })
    };
    // A scene with these values gets 32 substeps.
    let [coarse, fine] = [32, 256].map(off);
    println!("{coarse:e} {fine:e}");
    // One count of an encoder with 40,000 counts per turn is 1.6e-4 rad.
    assert!(
        fine < coarse / 6.0 && coarse < 1.6e-4,
        "{coarse:e} {fine:e}"
    );
}

#[test]
fn what_friction_holds_does_not_move_by_a_bit() {
    let hand = Some(MEDIUM);
    let links = Links {
        hand,
        current: Some(Current {
            bandwidth_hz: 600.0,
            back_emf: 0.0,
        }),
        ..bare(KNOB)
    };
    let train = made::<5, 9>(&links, &sliding(2e-3, 3e-3, Some(0.1)), 32);
    let mut state = TrainState::at_rest(0.3);
    for tick in 0..10_000 {
        // A torque that changes with every tick, up to 0.9 times the break-away torque.
        train.step(&mut state, 2.7e-3 * f64::from(tick % 7) / 6.0, 0.3);
        assert_eq!((state.position(), state.velocity()), (0.3, 0.0), "{tick}");
    }
    train.step(&mut state, 4e-3, 0.3);
    train.step(&mut state, 4e-3, 0.3);
    assert!(state.velocity() > 0.0);
}

/// Simulates a bare shaft by Runge–Kutta steps, with a friction model that has a state of its own.
fn by_runge_kutta(
    start: [f64; 3],
    duration_s: f64,
    steps: u32,
    rate: impl Fn([f64; 3]) -> [f64; 3],
) -> [f64; 3] {
    let h = duration_s / f64::from(steps);
    let along = |z: [f64; 3], k: [f64; 3], h: f64| std::array::from_fn(|i| z[i] + h * k[i]);
    let mut z = start;
    for _ in 0..steps {
        let a = rate(z);
        let b = rate(along(z, a, 0.5 * h));
        let c = rate(along(z, b, 0.5 * h));
        let d = rate(along(z, c, h));
        z = std::array::from_fn(|i| z[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
    }
    z
}

#[test]
fn stribeck_friction_in_motion_is_that_of_another_method() {
    let (j, b, u) = (1e-4, 4e-4, 2.5e-3);
    let level = |v: f64| 1e-3 + 1e-3 * (-(v / 0.1) * (v / 0.1)).exp();
    let expected = by_runge_kutta([0.0, 0.05, 0.0], 0.1, 100_000, |[_, v, _]| {
        [v, (u - b * v - level(v)) / j, 0.0]
    });
    let off = |substeps| {
        let train = made::<2, 6>(&bare(KNOB), &sliding(1e-3, 2e-3, Some(0.1)), substeps);
        let mut state = TrainState::from_array([0.0, 0.05]);
        for _ in 0..100 {
            train.step(&mut state, u, 0.0);
        }
        (state.position() - expected[0]).abs()
    };
    let (coarse, fine) = (off(4), off(8));
    println!("{coarse:e} {fine:e}");
    assert!(
        (coarse / fine).log2() > 1.8 && fine < 1e-6,
        "{coarse:e} {fine:e}"
    );
}

const BRISTLES: LuGre = LuGre {
    stiffness: 10.0,
    damping: 0.03,
    directions: [Sliding {
        kinetic: 1e-3,
        breakaway: 1.5e-3,
    }; 2],
    stribeck: Some(0.1),
};

fn bristly(lugre: LuGre) -> Shaft {
    Shaft {
        friction: Friction::Bristles(lugre),
        ..smooth()
    }
}

#[test]
fn bristles_move_as_their_equation_says() {
    let (j, b) = (1e-4, 4e-4);
    let g = |v: f64| 1e-3 + 0.5e-3 * (-(v / 0.1) * (v / 0.1)).exp();
    let u = |t: f64| 3e-3 * (40.0 * t).sin();
    let off = |substeps: u32| {
        let train = made::<2, 6>(&bare(KNOB), &bristly(BRISTLES), substeps);
        let mut state = TrainState::at_rest(0.0);
        let mut z = [0.0; 3];
        (0..200).fold(0.0_f64, |worst, tick| {
            let held = u(f64::from(tick) * T);
            train.step(&mut state, held, 0.0);
            z = by_runge_kutta(z, T, 200, |[_, v, bristle]| {
                let flow = v - 10.0 * v.abs() * bristle / g(v);
                [v, (held - b * v - 10.0 * bristle - 0.03 * flow) / j, flow]
            });
            worst.max((state.position() - z[0]).abs())
        })
    };
    let (coarse, fine) = (off(8), off(32));
    println!("{coarse:e} {fine:e}");
    assert!(fine < coarse / 10.0 && fine < 2e-6, "{coarse:e} {fine:e}");
}

#[test]
fn bristles_give_as_a_spring_and_slide_as_their_curve() {
    let train = made::<2, 6>(&bare(KNOB), &bristly(BRISTLES), 16);
    // Far below the break-away torque, a knob at rest is held by the deflection of the bristles.
    let mut state = TrainState::at_rest(0.0);
    for _ in 0..2000 {
        train.step(&mut state, 2e-5, 0.0);
    }
    assert!((state.bristle_rad() - 2e-6).abs() < 1e-14);
    // In steady motion at velocity v, the torque is u = g(v) + b v, with friction level g and damping b.
    let (u, mut state) = (5e-3, TrainState::at_rest(0.0));
    for _ in 0..10_000 {
        train.step(&mut state, u, 0.0);
    }
    let v = state.velocity();
    let g = 1e-3 + 0.5e-3 * (-(v / 0.1) * (v / 0.1)).exp();
    assert!((g + 4e-4 * v - u).abs() < 1e-12);
    // The motion also stays bounded with bristles a million times as stiff.
    let stiff = LuGre {
        stiffness: 1e7,
        ..BRISTLES
    };
    let train = made::<2, 6>(&bare(KNOB), &bristly(stiff), 4);
    let mut state = TrainState::from_array([0.0, 5.0]);
    for _ in 0..1000 {
        train.step(&mut state, 0.0, 0.0);
        assert!(state.velocity().abs() <= 5.0);
    }
}

#[test]
fn friction_that_differs_by_direction_stops_and_holds_as_each_direction_says() {
    let (kinetic, breakaway, bias, j) = (2e-3, 3e-3, 5e-4, 1e-4);
    let device = Device {
        friction: Some(Coulomb { kinetic, breakaway }),
        ..LOSSLESS
    };
    let plant = Biased::new(BareCoulomb::new(&device, T).unwrap(), kinetic, bias).unwrap();
    for (v, level) in [(0.5, kinetic + bias), (-0.5, kinetic - bias)] {
        let mut state = State::from_array([0.0, v]);
        let lost: f64 = (0..60)
            .map(|_| plant.step_with_loss(&mut state, 0.0, 0.0).device_j)
            .sum();
        let travel = 0.5 * j * v * v / level;
        assert_eq!(state.velocity(), 0.0);
        assert!((state.position().abs() / travel - 1.0).abs() < 1e-13);
        assert!((lost / (0.5 * j * v * v) - 1.0).abs() < 1e-13);
    }
    for (u, moves) in [
        (3.499e-3, false),
        (3.501e-3, true),
        (-2.499e-3, false),
        (-2.501e-3, true),
    ] {
        let mut state = State::at_rest(0.2);
        plant.step(&mut state, u, 0.0);
        assert_eq!(state.position() != 0.2, moves, "{u}");
    }
    // Without a bias the result is that of the wrapped plant, bit for bit. A bias above the friction is refused.
    let inner = || {
        HeldCoulomb::new(
            &Device {
                damping: 4e-4,
                ..device
            },
            &MEDIUM,
            T,
        )
        .unwrap()
    };
    let (none, plain) = (Biased::new(inner(), kinetic, 0.0).unwrap(), inner());
    let mut states = (State::at_rest(0.0), State::at_rest(0.0));
    for tick in 0..500 {
        none.step(&mut states.0, torque(tick), 0.1);
        plain.step(&mut states.1, torque(tick), 0.1);
    }
    assert_eq!(states.0, states.1);
    assert!(Biased::new(inner(), kinetic, 2.1e-3).is_err());
}
