//! Tests of the drive train against closed-form solutions, against the plants without a drive train, and against Runge–Kutta steps
//! that share no code with it.

use std::f64::consts::TAU;
use touchstone_world::plant::train::{
    Current, DriveTrain, Harmonic, Links, Shaft, TrainState, Transmission,
};
use touchstone_world::plant::{BareLinear, Device, HeldLinear, Kinematics, MEDIUM, State, Stepper};

pub const T: f64 = 1e-3;
pub const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: None,
};
pub const LOSSLESS: Device = Device {
    damping: 0.0,
    ..KNOB
};

pub fn bare(device: Device) -> Links {
    Links {
        device,
        current: None,
        transmission: None,
        hand: None,
    }
}

pub fn smooth() -> Shaft {
    Shaft::default()
}

pub fn made<const N: usize, const K: usize>(
    links: &Links,
    shaft: &Shaft,
    substeps: u32,
) -> DriveTrain<N, K> {
    DriveTrain::new(links, shaft, T, substeps).unwrap()
}

/// A test torque that changes with every tick (control period), N·m.
pub fn torque(tick: i32) -> f64 {
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
    // After adding 1024 rad to all angles, the motion is the same except for the rounding of the angles.
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
        // The mean torque must explain the change of momentum.
        assert!((impulse - 1e-4 * v).abs() < 1e-16);
    }
}

#[test]
fn windings_at_a_voltage_brake_as_their_back_emf_says() {
    // For motion far slower than R/L, the damping D by the back-EMF adds to the knob's damping b: v = u/(b + D).
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

/// Largest difference of the shaft's angle from that of the plant without a drive train, rad.
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
            // A tenth of the critical damping.
            damping: 0.1 * 2.0 * (stiffness * 2.1e-5).sqrt(),
            knob_inertia: 3e-5,
            gap: 0.0,
        }),
        ..bare(KNOB)
    };
    // The difference is of first order in the time constant and in the compliance.
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

/// Largest error of the energy balance over all ticks, `|work - stored - lost|`, relative to the energy exchanged up to the tick.
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

/// The arithmetic–geometric mean of two numbers.
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
    // A pendulum swings from 2 rad, where a sine is far from its argument: the period is `2 pi / (omega agm(1, cos(1)))`.
    let shaft = swinging(1.0, 0.0, 0.01);
    let omega = (0.01 / 1e-4_f64).sqrt();
    let expected = TAU / (omega * agm(1.0, 1.0_f64.cos()));
    let off = |substeps: u32| {
        let train = made::<2, 6>(&bare(LOSSLESS), &shaft, substeps);
        let mut state = TrainState::at_rest(2.0);
        // The third pass through the lowest point is in the same direction as the first.
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
    // The error is of second order, down to the error of the straight line between two ticks.
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
    // The motor crosses the play alone, as if the knob were not there, and a bounce reverses the relative velocity.
    let mut state = TrainState::from_array([0.0, 1.0, 0.0, 0.0]);
    for tick in 1..=4 {
        train.step(&mut state, 0.0, 0.0);
        let [x, v, x_k, v_k] = state.to_array();
        // The play's torque is that of a substep's middle. This leaves an error of `k v h^3/(12 J)` in each substep: 9e-11 rad for
        // the motor, 2e-10 rad for the knob.
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
    // Without play the result is that of the linear train to rounding, with substeps or without.
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
