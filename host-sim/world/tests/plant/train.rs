//! The drive train against closed forms, against the plants without a train, and against Runge–Kutta steps that share no code with
//! it.

use std::f64::consts::TAU;
use touchstone_world::plant::train::{
    Current, DriveTrain, Friction, Harmonic, Links, LuGre, Shaft, Sliding, TrainState, Transmission,
};
use touchstone_world::plant::{
    BareCoulomb, BareLinear, Biased, Coulomb, Device, HeldCoulomb, HeldLinear, Kinematics, MEDIUM,
    State, Stepper,
};

const T: f64 = 1e-3;
const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: None,
};
const LOSSLESS: Device = Device {
    damping: 0.0,
    ..KNOB
};

fn bare(device: Device) -> Links {
    Links {
        device,
        current: None,
        transmission: None,
        hand: None,
    }
}

fn smooth() -> Shaft {
    Shaft::default()
}

fn made<const N: usize, const K: usize>(
    links: &Links,
    shaft: &Shaft,
    substeps: u32,
) -> DriveTrain<N, K> {
    DriveTrain::new(links, shaft, T, substeps).unwrap()
}

/// A torque that changes every tick, N·m.
fn torque(tick: i32) -> f64 {
    0.02 * (0.37 * f64::from(tick)).sin() + 0.01 * (1.9 * f64::from(tick)).cos()
}

#[test]
fn a_train_of_nothing_is_the_plant_without_one() {
    let (train, plant) = (
        made::<2, 6>(&bare(KNOB), &smooth(), 9),
        BareLinear::new(&KNOB, T).unwrap(),
    );
    let held = Links {
        hand: Some(MEDIUM),
        ..bare(KNOB)
    };
    let (held_train, held_plant) = (
        made::<4, 8>(&held, &smooth(), 9),
        HeldLinear::new(&KNOB, &MEDIUM, T).unwrap(),
    );
    let mut states = (TrainState::at_rest(0.3), State::at_rest(0.3));
    let mut held_states = (TrainState::at_rest(0.3), State::at_rest(0.3));
    for tick in 0..400 {
        let u = torque(tick);
        let port = train.step_with_port(&mut states.0, u, 0.0);
        let loss = plant.step_with_loss(&mut states.1, u, 0.0);
        assert!((port.loss.device_j - loss.device_j).abs() < 1e-15);
        let port = held_train.step_with_port(&mut held_states.0, u, 0.31);
        let loss = held_plant.step_with_loss(&mut held_states.1, u, 0.31);
        assert!((port.loss.hand_j - loss.hand_j).abs() < 1e-15);
    }
    let far = |a: &[f64], b: &[f64]| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    assert!(far(&states.0.to_array(), &states.1.to_array()) < 1e-12);
    assert!(far(&held_states.0.to_array(), &held_states.1.to_array()) < 1e-12);
    // Turned by a thousand turns, the motion is the same but for the rounding of its angles.
    let mut near = TrainState::<4>::at_rest(0.3);
    let mut turned = TrainState::<4>::at_rest(0.3 + 1024.0);
    for tick in 0..400 {
        held_train.step(&mut near, torque(tick), 0.31);
        held_train.step(&mut turned, torque(tick), 0.31 + 1024.0);
    }
    assert!((turned.position() - 1024.0 - near.position()).abs() < 1e-9);
}

#[test]
fn a_torque_behind_a_current_loop_rises_as_one_pole_does() {
    let current = Current {
        bandwidth_hz: 600.0,
        back_emf: 0.0,
    };
    let links = Links {
        current: Some(current),
        ..bare(LOSSLESS)
    };
    let train = made::<3, 7>(&links, &smooth(), 1);
    let mut state = TrainState::at_rest(0.0);
    let (u, omega) = (0.1, current.rate());
    let mut impulse = 0.0;
    for tick in 1..=20 {
        let port = train.step_with_port(&mut state, u, 0.0);
        impulse += port.force * T;
        let t = f64::from(tick) * T;
        let [_, v, tau] = state.to_array();
        assert!((tau - u * (1.0 - (-omega * t).exp())).abs() < 1e-15);
        let expected = u / 1e-4 * (t - (1.0 - (-omega * t).exp()) / omega);
        assert!((v / expected - 1.0).abs() < 1e-13, "{v} {expected}");
        // The mean torque is what the momentum came from.
        assert!((impulse - 1e-4 * v).abs() < 1e-16);
    }
}

#[test]
fn windings_at_a_voltage_brake_as_their_back_emf_says() {
    // Far slower than R/L, the damping of the windings' own voltage adds to the knob's: v = u/(b + D).
    let links = Links {
        current: Some(Current {
            bandwidth_hz: 6.0 / (TAU * 3e-3),
            back_emf: 0.25 * 0.25 / 6.0,
        }),
        ..bare(KNOB)
    };
    let train = made::<3, 7>(&links, &smooth(), 1);
    let mut state = TrainState::at_rest(0.0);
    for _ in 0..20_000 {
        train.step(&mut state, 0.05, 0.0);
    }
    let expected = 0.05 / (4e-4 + 0.25 * 0.25 / 6.0);
    assert!((state.velocity() / expected - 1.0).abs() < 1e-12);
}

/// Largest difference of the shaft's angle to the plant without a train.
fn off_the_rigid(links: &Links) -> f64 {
    let plant = BareLinear::new(&KNOB, T).unwrap();
    let mut rigid = State::at_rest(0.0);
    let mut run = |step: &mut dyn FnMut(f64) -> f64| {
        (0..200).fold(0.0_f64, |most, tick| {
            plant.step(&mut rigid, torque(tick), 0.0);
            most.max((step(torque(tick)) - rigid.position()).abs())
        })
    };
    if links.current.is_some() {
        let train = made::<3, 7>(links, &smooth(), 1);
        let mut state = TrainState::at_rest(0.0);
        run(&mut |u| {
            train.step(&mut state, u, 0.0);
            state.position()
        })
    } else {
        let train = made::<4, 8>(links, &smooth(), 1);
        let mut state = TrainState::at_rest(0.0);
        run(&mut |u| {
            train.step(&mut state, u, 0.0);
            state.position()
        })
    }
}

#[test]
fn poles_and_compliances_converge_to_their_absence() {
    let current = |bandwidth_hz| Links {
        current: Some(Current {
            bandwidth_hz,
            back_emf: 0.0,
        }),
        ..bare(KNOB)
    };
    let transmission = |stiffness: f64| Links {
        transmission: Some(Transmission {
            stiffness,
            // A tenth of critical.
            damping: 0.1 * 2.0 * (stiffness * 2.1e-5).sqrt(),
            knob_inertia: 3e-5,
            gap: 0.0,
        }),
        ..bare(KNOB)
    };
    // First order in the time constant, and in the compliance.
    for hz in [1e4, 1e5, 1e6] {
        let ratio = off_the_rigid(&current(hz)) / off_the_rigid(&current(10.0 * hz));
        assert!((ratio - 10.0).abs() < 0.5, "{hz}: {ratio}");
    }
    for stiffness in [1e3, 1e4, 1e5] {
        let (soft, stiff) = (
            off_the_rigid(&transmission(stiffness)),
            off_the_rigid(&transmission(10.0 * stiffness)),
        );
        assert!(stiff < 0.2 * soft, "{stiffness}: {soft:e} {stiff:e}");
    }
    assert!(off_the_rigid(&transmission(1e8)) < 1e-8);
}

#[test]
fn two_inertias_on_a_spring_swing_at_their_frequency() {
    let links = Links {
        transmission: Some(Transmission {
            stiffness: 20.0,
            damping: 0.0,
            knob_inertia: 3e-5,
            gap: 0.0,
        }),
        ..bare(LOSSLESS)
    };
    let train = made::<4, 8>(&links, &smooth(), 1);
    let omega = (20.0 * (1.0 / 7e-5 + 1.0 / 3e-5_f64)).sqrt();
    let (a, m, k) = (0.01, 7e-5, 3e-5);
    let mut state = TrainState::from_array([a * k / (m + k), 0.0, -a * m / (m + k), 0.0]);
    for tick in 1..=500 {
        train.step(&mut state, 0.0, 0.0);
        let [x, _, x_k, _] = state.to_array();
        let expected = a * (omega * f64::from(tick) * T).cos();
        assert!(
            (x - x_k - expected).abs() < 1e-13 * f64::from(tick),
            "{tick}"
        );
    }
}

/// Worst of `|work - stored - lost|` of all ticks, over the energy that has gone through so far.
fn audit<const N: usize, const K: usize>(links: &Links, shaft: &Shaft, substeps: u32) -> f64 {
    let train = made::<N, K>(links, shaft, substeps);
    let rest = 0.3;
    let mut state = TrainState::<N>::at_rest(rest);
    let mut through = 0.0_f64;
    (0..2000).fold(0.0_f64, |worst, tick| {
        let before = train.stored_energy_j(&state, rest);
        let kinetic = |state: &TrainState<N>| {
            0.5 * links.device.inertia * state.velocity() * state.velocity()
        };
        let moving = kinetic(&state);
        let port = train.step_with_port(&mut state, 3.0 * torque(tick), rest);
        let gained = train.stored_energy_j(&state, rest) - before;
        if links.hand.is_none() {
            let told = kinetic(&state) - moving + port.stored_j;
            assert!((told - gained).abs() <= 1e-12 * (gained.abs() + 1e-6));
        }
        through += port.work_j.abs() + port.loss.total_j();
        worst.max((port.work_j - gained - port.loss.total_j()).abs() / through)
    })
}

#[test]
fn the_books_of_every_linear_train_close() {
    let current = Some(Current {
        bandwidth_hz: 600.0,
        back_emf: 2e-3,
    });
    let transmission = Some(Transmission {
        stiffness: 20.0,
        damping: 1e-3,
        knob_inertia: 3e-5,
        gap: 0.0,
    });
    let hand = Some(MEDIUM);
    let all = Links {
        device: KNOB,
        current,
        transmission,
        hand,
    };
    for worst in [
        audit::<3, 7>(
            &Links {
                transmission: None,
                hand: None,
                ..all
            },
            &smooth(),
            1,
        ),
        audit::<4, 8>(
            &Links {
                current: None,
                hand: None,
                ..all
            },
            &smooth(),
            1,
        ),
        audit::<5, 9>(
            &Links {
                transmission: None,
                ..all
            },
            &smooth(),
            1,
        ),
        audit::<5, 9>(&Links { hand: None, ..all }, &smooth(), 1),
        audit::<6, 10>(
            &Links {
                current: None,
                ..all
            },
            &smooth(),
            1,
        ),
        audit::<7, 11>(&all, &smooth(), 1),
    ] {
        println!("{worst:e}");
        assert!(worst < 1e-12, "{worst:e}");
    }
}

/// The arithmetic–geometric mean.
fn agm(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..40 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

fn swinging(per_rev: f64, phase: f64, amplitude: f64) -> Shaft {
    Shaft {
        harmonics: vec![Harmonic {
            amplitude,
            per_rev,
            phase,
        }],
        ..smooth()
    }
}

#[test]
fn a_weight_out_of_the_axis_swings_as_a_pendulum_does() {
    // From 2 rad, far beyond where a sine is its argument: the period is `2 pi / (omega agm(1, cos(1)))`.
    let shaft = swinging(1.0, 0.0, 0.01);
    let omega = (0.01 / 1e-4_f64).sqrt();
    let expected = TAU / (omega * agm(1.0, 1.0_f64.cos()));
    let off = |substeps: u32| {
        let train = made::<2, 6>(&bare(LOSSLESS), &shaft, substeps);
        let mut state = TrainState::at_rest(2.0);
        // The third time that it passes its lowest point, in the same direction as the first.
        let (mut passed, mut first) = (0, 0.0);
        for tick in 0.. {
            let before = state.position();
            train.step(&mut state, 0.0, 0.0);
            if before * state.position() < 0.0 {
                let t = (f64::from(tick) + before / (before - state.position())) * T;
                passed += 1;
                match passed {
                    1 => first = t,
                    3 => return (t - first) / expected - 1.0,
                    _ => {}
                }
            }
        }
        unreachable!()
    };
    // Second order, down to what a straight line between two ticks leaves.
    let (coarse, fine) = (off(1).abs(), off(8).abs());
    println!("{coarse:e} {fine:e}");
    assert!(coarse < 1e-4 && fine < 3e-7, "{coarse:e} {fine:e}");
}

#[test]
fn cogging_keeps_its_energy_to_second_order() {
    let shaft = swinging(84.0, 0.4, 2e-3);
    let worst = |substeps: u32| {
        let train = made::<2, 6>(&bare(LOSSLESS), &shaft, substeps);
        let mut state = TrainState::from_array([0.0, 3.0]);
        let start = train.stored_energy_j(&state, 0.0);
        (0..3000).fold(0.0_f64, |worst, _| {
            train.step(&mut state, 0.0, 0.0);
            worst.max((train.stored_energy_j(&state, 0.0) / start - 1.0).abs())
        })
    };
    let (coarse, fine) = (worst(8), worst(16));
    println!("{coarse:e} {fine:e}");
    assert!((coarse / fine).log2() > 1.8, "{coarse:e} {fine:e}");
    assert!(fine < 1e-3);
}

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
    // A scene gets 32.
    let [coarse, fine] = [32, 256].map(off);
    println!("{coarse:e} {fine:e}");
    // A count of 40,000 is 1.6e-4 rad.
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
        // 0.9 of the break-away torque, and a hand that swings before it settles.
        train.step(&mut state, 2.7e-3 * f64::from(tick % 7) / 6.0, 0.3);
        assert_eq!((state.position(), state.velocity()), (0.3, 0.0), "{tick}");
    }
    train.step(&mut state, 4e-3, 0.3);
    train.step(&mut state, 4e-3, 0.3);
    assert!(state.velocity() > 0.0);
}

/// Runge–Kutta steps of a bare shaft with a friction of its own state.
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
    // Far below break-away a knob at rest stands where the bristles carry it.
    let mut state = TrainState::at_rest(0.0);
    for _ in 0..2000 {
        train.step(&mut state, 2e-5, 0.0);
    }
    assert!((state.bristle_rad() - 2e-6).abs() < 1e-14);
    // In steady motion: u = g(v) + b v.
    let (u, mut state) = (5e-3, TrainState::at_rest(0.0));
    for _ in 0..10_000 {
        train.step(&mut state, u, 0.0);
    }
    let v = state.velocity();
    let g = 1e-3 + 0.5e-3 * (-(v / 0.1) * (v / 0.1)).exp();
    assert!((g + 4e-4 * v - u).abs() < 1e-12);
    // Bristles a million times as stiff are bounded all the same.
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
fn play_transmits_nothing_and_then_as_a_spring() {
    let transmission = Transmission {
        stiffness: 20.0,
        damping: 0.0,
        knob_inertia: 3e-5,
        gap: 0.01,
    };
    let links = Links {
        transmission: Some(transmission),
        ..bare(LOSSLESS)
    };
    let train = made::<4, 8>(&links, &smooth(), 64);
    // The motor crosses the play alone, as if the knob were not there, and a bounce turns the relative velocity round.
    let mut state = TrainState::from_array([0.0, 1.0, 0.0, 0.0]);
    for tick in 1..=4 {
        train.step(&mut state, 0.0, 0.0);
        let [x, v, x_k, v_k] = state.to_array();
        // Taken off at the middle of a substep, the spring leaves `k v h^3/(12 J)` of each: 9e-11 and 2e-10 rad.
        assert!((x - f64::from(tick) * T).abs() < 6e-8 && (v - 1.0).abs() < 1e-5);
        assert!(x_k.abs() < 6e-8 && v_k.abs() < 1e-5);
    }
    let energy = |state: &TrainState<4>| train.stored_energy_j(state, 0.0);
    let start = energy(&state);
    let mut worst = 0.0_f64;
    for _ in 0..8 {
        train.step(&mut state, 0.0, 0.0);
        worst = worst.max((energy(&state) / start - 1.0).abs());
    }
    let [_, v, _, v_k] = state.to_array();
    println!("after the bounce {v} {v_k}, energy off by {worst:e}");
    assert!((v_k - v - 1.0).abs() < 2e-3 && worst < 2e-3);
    assert!((7e-5 * v + 3e-5 * v_k - 7e-5).abs() < 1e-15, "momentum");
    // Without play it is the linear train to rounding, substeps or not.
    let tight = Links {
        transmission: Some(Transmission {
            gap: 1e-300,
            ..transmission
        }),
        ..links
    };
    let linear = Links {
        transmission: Some(Transmission {
            gap: 0.0,
            ..transmission
        }),
        ..links
    };
    let (tight, linear) = (
        made::<4, 8>(&tight, &smooth(), 64),
        made::<4, 8>(&linear, &smooth(), 1),
    );
    let mut states = (state, state);
    for _ in 0..100 {
        tight.step(&mut states.0, 0.0, 0.0);
        linear.step(&mut states.1, 0.0, 0.0);
    }
    assert!((states.0.position() - states.1.position()).abs() < 1e-12);
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
    // Without a bias it is the plant inside, bit for bit; with more than the friction there is none.
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

#[test]
fn what_no_train_can_be_is_refused_by_name() {
    let field = |links: &Links| {
        DriveTrain::<4, 8>::new(links, &smooth(), T, 1)
            .unwrap_err()
            .field
    };
    let with = |stiffness, knob_inertia| Links {
        transmission: Some(Transmission {
            stiffness,
            damping: 0.0,
            knob_inertia,
            gap: 0.0,
        }),
        ..bare(KNOB)
    };
    assert_eq!(field(&with(0.0, 3e-5)), "transmission.stiffness");
    assert_eq!(field(&with(20.0, 1e-4)), "transmission.knob_inertia");
    assert_eq!(field(&bare(KNOB)), "states");
}
