//! Tests of Coulomb friction: a device at rest stays at rest, and every stop and start comes at the right time.

use touchstone_world::plant::{
    BareCoulomb, BareLinear, Coulomb, Device, FIRM, Hand, HeldCoulomb, HeldLinear, Kinematics,
    LIGHT, MEDIUM, State, Stepper,
};

use crate::oracle::{FRICTION, Full, KNOB, Oracle, Random, STICKY_KNOB, assert_close};

fn with_friction(kinetic: f64, breakaway: f64) -> Device {
    Device {
        friction: Some(Coulomb { kinetic, breakaway }),
        ..KNOB
    }
}

#[test]
fn below_break_away_nothing_moves_at_all() {
    let torque = 0.9 * FRICTION.breakaway;
    let bare = BareCoulomb::new(&STICKY_KNOB, 1e-3).unwrap();
    let mut state = State::from_array([0.123, 0.0]);
    for _ in 0..10_000 {
        bare.step(&mut state, torque, 0.0);
    }
    assert_eq!(state, State::from_array([0.123, 0.0]));

    // The hand moves all the time, but pad and held torque together never reach the break-away torque.
    let held = HeldCoulomb::new(&STICKY_KNOB, &MEDIUM, 1e-3).unwrap();
    let mut state = State::<4>::at_rest(0.123);
    let mut swing = 0.0_f64;
    for tick in 0..10_000 {
        let rest = 0.123 + 0.01 * (0.01 * f64::from(tick)).sin();
        held.step(&mut state, torque, rest);
        assert_eq!((state.position(), state.velocity()), (0.123, 0.0));
        swing = swing.max((state.hand_position() - 0.123).abs());
    }
    assert!(swing > 5e-4, "the hand did not move: {swing}");
}

#[test]
fn break_away_is_at_the_static_level_and_not_at_it() {
    let bare = BareCoulomb::new(&STICKY_KNOB, 1e-3).unwrap();
    let held = HeldCoulomb::new(&STICKY_KNOB, &MEDIUM, 1e-3).unwrap();
    for sign in [1.0, -1.0] {
        for at_rest in [0.0, -0.0] {
            let level = sign * FRICTION.breakaway;
            let mut state = State::from_array([0.5, at_rest]);
            bare.step(&mut state, level, 0.0);
            assert_eq!(state, State::from_array([0.5, 0.0]));
            bare.step(&mut state, sign * FRICTION.breakaway.next_up(), 0.0);
            assert!(sign * state.velocity() > 0.0);

            let mut state = State::from_array([0.5, at_rest, 0.5, 0.0]);
            held.step(&mut state, level, 0.5);
            assert_eq!(state, State::from_array([0.5, 0.0, 0.5, 0.0]));
            held.step(&mut state, sign * FRICTION.breakaway.next_up(), 0.5);
            assert!(sign * state.velocity() > 0.0);
        }
    }
}

#[test]
fn a_torque_of_exactly_the_kinetic_level_lets_the_device_coast() {
    // Only the damper acts: the velocity decays and never changes its sign.
    let bare = BareCoulomb::new(&STICKY_KNOB, 1e-3).unwrap();
    let free = BareLinear::new(&KNOB, 1e-3).unwrap();
    let (mut state, mut expected) = (State::from_array([0.0, 2.0]), State::from_array([0.0, 2.0]));
    for _ in 0..1_000 {
        bare.step(&mut state, FRICTION.kinetic, 0.0);
        free.step(&mut expected, 0.0, 0.0);
    }
    assert_eq!(state, expected);
    assert!(state.velocity() > 0.0);
}

#[test]
fn zero_friction_is_no_friction() {
    let zero = with_friction(0.0, 0.0);
    let bare = (
        BareCoulomb::new(&zero, 1e-3).unwrap(),
        BareLinear::new(&KNOB, 1e-3).unwrap(),
    );
    let held = (
        HeldCoulomb::new(&zero, &MEDIUM, 1e-3).unwrap(),
        HeldLinear::new(&KNOB, &MEDIUM, 1e-3).unwrap(),
    );
    let mut random = Random(23);
    let mut turns = [0, 0];
    for _ in 0..20_000 {
        let z: [f64; 4] =
            std::array::from_fn(|i| if i % 2 == 0 { 0.1 } else { 0.5 } * random.uniform());
        let (u, r) = (0.01 * random.uniform(), 0.1 * random.uniform());

        let (mut a, mut b) = (
            State::from_array([z[0], z[1]]),
            State::from_array([z[0], z[1]]),
        );
        bare.0.step(&mut a, u, r);
        bare.1.step(&mut b, u, r);
        if z[1] * b.velocity() > 0.0 {
            assert_eq!(a, b, "to the bit where nothing turns");
        } else {
            turns[0] += 1;
            for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
                assert!((a - b).abs() < 2e-15, "{a} {b}");
            }
        }

        let (mut a, mut b) = (State::from_array(z), State::from_array(z));
        held.0.step(&mut a, u, r);
        held.1.step(&mut b, u, r);
        if z[1] * b.velocity() < 0.0 {
            turns[1] += 1;
        }
        for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
            assert!((a - b).abs() < 2e-15, "{a} {b}");
        }
    }
    assert!(turns[0] > 1_000 && turns[1] > 1_000, "{turns:?}");
}

#[test]
fn a_tick_without_event_is_the_linear_tick_to_the_bit() {
    let held = HeldCoulomb::new(&STICKY_KNOB, &MEDIUM, 1e-3).unwrap();
    let linear = HeldLinear::new(&KNOB, &MEDIUM, 1e-3).unwrap();
    let mut state = State::from_array([0.0, 5.0, 0.01, 4.0]);
    let mut expected = state;
    for _ in 0..20 {
        held.step(&mut state, 1e-3, 0.2);
        linear.step(&mut expected, 1e-3 - FRICTION.kinetic, 0.2);
        assert_eq!(state, expected);
    }
    assert!(state.velocity() > 0.0);
}

fn full(z: [f64; 4]) -> Full {
    [z[0], z[1], z[2], z[3], 0.0, 0.0, 0.0]
}

/// Compares one tick of the plant, from each of many states, with a reference of fine steps that locate every stop and start.
/// Returns how many ticks had how many stops and starts.
fn compare_ticks(
    device: Device,
    hand: Option<Hand>,
    h: f64,
    ticks: u32,
    tolerance: f64,
) -> [u32; 5] {
    let oracle = Oracle { device, hand };
    let friction = device.friction.unwrap();
    let bare = BareCoulomb::new(&device, h).unwrap();
    let held = hand.map(|hand| HeldCoulomb::new(&device, &hand, h).unwrap());
    let linear = hand.map(|hand| HeldLinear::new(&device, &hand, h).unwrap());
    let mut random = Random(99);
    let mut seen = [0; 5];
    // The reference steps are so fine that only rounding errors remain, in long intervals too.
    let substeps = 400.max((1e5 * h) as u32);
    // Velocities that a tick's net torque can undo, so that about half the ticks have events.
    let turn = friction.breakaway * h / device.inertia;
    for tick in 0..ticks {
        let mut z = full(std::array::from_fn(|_| random.uniform()));
        z[0] *= 0.2;
        z[1] = if tick % 4 == 0 { 0.0 } else { turn * z[1] };
        z[2] = z[0] + 0.02 * z[2];
        z[3] *= 0.5;
        if hand.is_none() {
            (z[2], z[3]) = (z[0], z[1]);
        }
        let (u, r) = (
            2.0 * friction.breakaway * random.uniform(),
            z[0] + 0.1 * random.uniform(),
        );
        let (expected, events) = oracle.with_events(&z, u, r, h, substeps);
        seen[(events as usize).min(4)] += 1;

        let (state, loss) = if let Some(held) = &held {
            let mut state = State::from_array([z[0], z[1], z[2], z[3]]);
            let loss = held.step_with_loss(&mut state, u, r);
            if events == 0 && z[1] != 0.0 {
                // The equality holds even if the plant had to search the interval to find that there is no stop.
                let mut expected = State::from_array([z[0], z[1], z[2], z[3]]);
                let w = u - friction.kinetic.copysign(z[1]);
                linear.as_ref().unwrap().step(&mut expected, w, r);
                assert_eq!(state, expected, "tick {tick}");
            }
            (state.to_array(), loss)
        } else {
            let mut state = State::from_array([z[0], z[1]]);
            let loss = bare.step_with_loss(&mut state, u, r);
            let [x, v] = state.to_array();
            ([x, v, x, v], loss)
        };
        let scales = [0.2, turn, 0.2, 0.5];
        for i in 0..if hand.is_some() { 4 } else { 2 } {
            let error = (state[i] - expected[i]).abs() / scales[i];
            assert!(
                error < tolerance,
                "tick {tick}, {events} events: {state:?} {expected:?}"
            );
        }
        let device_j = expected[4] + friction.kinetic * expected[5];
        let scale = device_j + expected[6] + friction.breakaway * turn * h;
        assert!(
            (loss.device_j - device_j).abs() < tolerance * scale,
            "tick {tick}: {loss:?} {device_j:e}"
        );
        assert!(
            (loss.hand_j - expected[6]).abs() < tolerance * scale,
            "tick {tick}: {loss:?}"
        );
    }
    seen
}

#[test]
fn bare_ticks_agree_with_located_events() {
    for (damping, h) in [(3e-4, 1e-3), (0.0, 1e-3), (0.02, 1e-3), (3e-4, 0.02)] {
        let device = Device {
            damping,
            ..STICKY_KNOB
        };
        let seen = compare_ticks(device, None, h, 2_000, 1e-11);
        assert!(seen[1] > 100, "{seen:?}");
    }
    // Equal levels of friction at rest and in motion, where a start follows a stop at once.
    let seen = compare_ticks(with_friction(2e-3, 2e-3), None, 1e-3, 2_000, 1e-11);
    assert!(seen[1] > 100, "{seen:?}");
}

#[test]
fn held_ticks_agree_with_located_events() {
    for hand in [LIGHT, MEDIUM, FIRM] {
        let seen = compare_ticks(STICKY_KNOB, Some(hand), 1e-3, 2_000, 1e-10);
        assert!(seen[1] > 100, "{seen:?}");
        let seen = compare_ticks(with_friction(2e-3, 2e-3), Some(hand), 1e-3, 2_000, 1e-10);
        assert!(seen[1] > 100, "{seen:?}");
    }
}

#[test]
fn long_ticks_with_several_events_agree_with_located_events() {
    // On this knob the pad oscillates with a period of 40 to 100 ms.
    let mut several = 0;
    let mut many = 0;
    for hand in [LIGHT, MEDIUM, FIRM] {
        for h in [0.02, 0.06] {
            let seen = compare_ticks(STICKY_KNOB, Some(hand), h, 500, 1e-9);
            several += seen[2] + seen[3];
            many += seen[4];
        }
    }
    assert!(
        several > 200 && many > 20,
        "{several} ticks with two or three events, {many} with more"
    );
}

#[test]
fn a_velocity_that_dips_below_zero_within_a_tick_is_seen() {
    let hand = FIRM;
    let device = Device {
        inertia: 1e-4,
        ..STICKY_KNOB
    };
    let oracle = Oracle {
        device,
        hand: Some(hand),
    };
    let h = 0.01;
    let plant = HeldCoulomb::new(&device, &hand, h).unwrap();
    let linear = HeldLinear::new(&device, &hand, h).unwrap();
    let z = full([0.0, 1e-3, 0.0, 0.6]);
    let (u, r) = (1.2e-3, 0.0);
    // Under friction of one sign the velocity is positive at both ends of the interval; only a search inside shows that it dips
    // below zero.
    let mut unseen = State::from_array([z[0], z[1], z[2], z[3]]);
    linear.step(&mut unseen, u - FRICTION.kinetic, r);
    assert!(unseen.velocity() > 0.0);

    let (expected, events) = oracle.with_events(&z, u, r, h, 4_000);
    assert!(events >= 2, "{events}");
    let mut state = State::from_array([z[0], z[1], z[2], z[3]]);
    plant.step(&mut state, u, r);
    assert_close(state.to_array(), &expected, &z, 1e-10, "dip");
    assert!((state.velocity() - unseen.velocity()).abs() > 1e-3);
}

/// Inputs over half a second that make the device stick and slip: a torque back and forth, and a following hand.
fn inputs(tick: u32) -> (f64, f64) {
    let t = f64::from(tick) * 1e-3;
    (4e-3 * (40.0 * t).sin(), 0.3 * (13.0 * t).sin())
}

#[test]
fn set_valued_implicit_euler_converges_to_these_runs() {
    for hand in [None, Some(MEDIUM)] {
        let oracle = Oracle {
            device: STICKY_KNOB,
            hand,
        };
        let exact: Vec<f64> = match hand {
            None => {
                let plant = BareCoulomb::new(&STICKY_KNOB, 1e-3).unwrap();
                let mut state = State::<2>::at_rest(0.0);
                (0..500).map(|tick| go(&plant, &mut state, tick)).collect()
            }
            Some(hand) => {
                let plant = HeldCoulomb::new(&STICKY_KNOB, &hand, 1e-3).unwrap();
                let mut state = State::<4>::at_rest(0.0);
                (0..500).map(|tick| go(&plant, &mut state, tick)).collect()
            }
        };
        let travel = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let stuck = exact.windows(2).filter(|x| x[0] == x[1]).count();
        assert!(travel > 0.05 && stuck > 10, "{travel} {stuck}");
        let error = |n: u32| {
            let mut z = [0.0; 7];
            exact.iter().zip(0..).fold(0.0_f64, |most, (x, tick)| {
                let (u, r) = inputs(tick);
                z = oracle.implicit_euler(&z, u, r, 1e-3, n);
                most.max((z[0] - x).abs())
            })
        };
        let errors = [10, 100, 1_000].map(error);
        // The method is of first order: a tenth of the step gives about a tenth of the error.
        assert!(
            errors[1] < 0.2 * errors[0] && errors[2] < 0.2 * errors[1],
            "{errors:?}"
        );
        assert!(errors[2] < 1e-3 * travel, "{errors:?}");
    }
}

fn go<P: Stepper>(plant: &P, state: &mut P::State, tick: u32) -> f64 {
    let (u, r) = inputs(tick);
    plant.step(state, u, r);
    state.position()
}

#[test]
fn a_storm_of_events_ends_at_rest_and_makes_no_energy() {
    // In ticks of one second a pad with hardly any damping swings so long that there are more stops and starts than the plant
    // follows.
    let device = Device {
        inertia: 1e-4,
        damping: 0.0,
        ..with_friction(5e-5, 6e-5)
    };
    let hand = Hand {
        damping: 1e-7,
        pad_damping: 1e-7,
        ..FIRM
    };
    let plant = HeldCoulomb::new(&device, &hand, 1.0).unwrap();
    let oracle = Oracle {
        device,
        hand: Some(hand),
    };
    let mut storms = 0;
    for start in 1..20 {
        let z = [0.0, 0.0, 0.01 * f64::from(start), 0.0];
        let (_, events) = oracle.with_events(&full(z), 0.0, 0.0, 1.0, 20_000);
        let mut state = State::from_array(z);
        let before = plant.stored_energy_j(&state, 0.0);
        let loss = plant.step_with_loss(&mut state, 0.0, 0.0);
        let after = plant.stored_energy_j(&state, 0.0);
        assert!(
            (before - after - loss.total_j()).abs() < 1e-13 * before,
            "{before} {after} {loss:?}"
        );
        assert!(loss.device_j > 0.0 && loss.hand_j > 0.0);
        if events > 12 {
            storms += 1;
            assert_eq!(state.velocity(), 0.0, "{events} events");
        }
    }
    assert!(storms > 5, "{storms}");
}

#[test]
fn random_plants_agree_with_located_events() {
    let mut random = Random(31);
    let mut decades = |low: f64, high: f64| low * (high / low).powf(0.5 * (random.uniform() + 1.0));
    let mut events = 0;
    for _ in 0..200 {
        let kinetic = decades(1e-4, 1e-2);
        let device = Device {
            inertia: decades(1e-6, 1e-3),
            damping: decades(1e-6, 1e-2),
            friction: Some(Coulomb {
                kinetic,
                breakaway: kinetic * decades(1.0, 2.0),
            }),
        };
        let hand = Hand {
            inertia: decades(1e-5, 1e-3),
            damping: decades(1e-5, 1e-2),
            stiffness: decades(1e-3, 1.0),
            pad_damping: decades(1e-6, 1e-2),
            pad_stiffness: decades(1e-2, 3.0),
        };
        let seen = compare_ticks(device, Some(hand), 1e-3, 30, 1e-7);
        events += seen[1] + seen[2] + seen[3] + seen[4];
    }
    assert!(events > 1_000, "{events}");
}

#[test]
fn constructors_refuse_what_they_cannot_step() {
    assert_eq!(BareCoulomb::new(&KNOB, 1e-3).unwrap_err().field, "friction");
    assert_eq!(
        HeldCoulomb::new(&KNOB, &MEDIUM, 1e-3).unwrap_err().field,
        "friction"
    );
    assert_eq!(
        HeldCoulomb::new(&STICKY_KNOB, &MEDIUM, 1e3)
            .unwrap_err()
            .field,
        "interval_s"
    );
    assert_eq!(
        BareLinear::new(&KNOB, -1e-3).unwrap_err().field,
        "interval_s"
    );
    let hand = Hand {
        pad_stiffness: -1.0,
        ..MEDIUM
    };
    assert_eq!(
        HeldLinear::new(&KNOB, &hand, 1e-3).unwrap_err().field,
        "hand.pad_stiffness"
    );
}
