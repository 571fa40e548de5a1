//! Tests of the energy balance: work put in is stored or dissipated.

use touchstone_world::plant::{
    BareCoulomb, BareLinear, Device, FIRM, HeldCoulomb, HeldLinear, Kinematics, LIGHT, Loss,
    MEDIUM, Stepper,
};

use crate::oracle::{KNOB, Random, STICKY_KNOB};

/// Energies of a run, J: work of the torque, work of the rest point's jumps, losses. Also the error of the energy balance, relative
/// to the sum of these energies.
struct Books {
    work: f64,
    loss: Loss,
    throughput: f64,
    imbalance: f64,
    turns: u32,
    rests: u32,
}

/// Simulates a knob between walls at 0.1 and -0.1 rad, driven by torque and hand. The walls are soft enough to be stable.
fn audit<P: Stepper>(plant: &P, ticks: u32) -> Books {
    let mut random = Random(5);
    let mut state = P::State::at_rest(0.0);
    let (mut push, mut rest) = (0.0, 0.0);
    let start = plant.stored_energy_j(&state, rest);
    let mut books = Books {
        work: 0.0,
        loss: Loss::default(),
        throughput: 0.0,
        imbalance: 0.0,
        turns: 0,
        rests: 0,
    };
    let mut jumps = 0.0;
    for tick in 0..ticks {
        if tick % 50 == 0 {
            push = 0.01 * random.uniform();
            let before = plant.stored_energy_j(&state, rest);
            rest = 0.5 * random.uniform();
            let jump = plant.stored_energy_j(&state, rest) - before;
            jumps += jump;
            books.throughput += jump.abs();
        }
        let x = state.position();
        let torque = push - 0.2 * (x - x.clamp(-0.1, 0.1));
        let v = state.velocity();
        books.loss += plant.step_with_loss(&mut state, torque, rest);
        let work = torque * (state.position() - x);
        books.work += work;
        books.throughput += work.abs();
        books.turns += u32::from(v * state.velocity() < 0.0);
        books.rests += u32::from(state.velocity() == 0.0);
    }
    let stored = plant.stored_energy_j(&state, rest) - start;
    books.imbalance = (books.work + jumps - books.loss.total_j() - stored) / books.throughput;
    books
}

fn check(books: &Books, friction: bool, hand: bool) {
    assert!(
        books.imbalance.abs() < 1e-12,
        "off by {:e} of throughput",
        books.imbalance
    );
    // The simulated motion must contain the cases that the test is for.
    assert!(
        books.loss.device_j > 0.01 * books.throughput,
        "{:?} of {}",
        books.loss,
        books.throughput
    );
    assert_eq!(books.loss.hand_j > 0.01 * books.throughput, hand);
    assert!(books.turns > 100, "{} turns", books.turns);
    assert_eq!(books.rests > 100, friction, "{} ticks at rest", books.rests);
}

#[test]
fn bare_linear_books_close() {
    check(
        &audit(&BareLinear::new(&KNOB, 1e-3).unwrap(), 20_000),
        false,
        false,
    );
}

#[test]
fn bare_coulomb_books_close() {
    check(
        &audit(&BareCoulomb::new(&STICKY_KNOB, 1e-3).unwrap(), 20_000),
        true,
        false,
    );
}

#[test]
fn held_linear_books_close() {
    for hand in [LIGHT, MEDIUM, FIRM] {
        check(
            &audit(&HeldLinear::new(&KNOB, &hand, 1e-3).unwrap(), 20_000),
            false,
            true,
        );
    }
}

#[test]
fn held_coulomb_books_close() {
    for hand in [LIGHT, MEDIUM, FIRM] {
        check(
            &audit(
                &HeldCoulomb::new(&STICKY_KNOB, &hand, 1e-3).unwrap(),
                20_000,
            ),
            true,
            true,
        );
    }
}

#[test]
fn without_any_damping_energy_is_kept() {
    let device = Device {
        damping: 0.0,
        ..KNOB
    };
    let hand = touchstone_world::plant::Hand {
        damping: 0.0,
        pad_damping: 0.0,
        ..MEDIUM
    };
    let plant = HeldLinear::new(&device, &hand, 1e-3).unwrap();
    let mut state = touchstone_world::plant::State::from_array([0.1, 3.0, 0.0, -1.0]);
    let start = plant.stored_energy_j(&state, 0.0);
    for _ in 0..100_000 {
        plant.step(&mut state, 0.0, 0.0);
    }
    let end = plant.stored_energy_j(&state, 0.0);
    assert!((end - start).abs() < 1e-11 * start, "{start} to {end}");
}

#[test]
fn left_alone_stored_energy_never_rises() {
    let plant = HeldCoulomb::new(&STICKY_KNOB, &MEDIUM, 1e-3).unwrap();
    let mut state = touchstone_world::plant::State::from_array([0.3, 8.0, -0.2, -4.0]);
    let mut stored = plant.stored_energy_j(&state, 0.0);
    for tick in 0..3_000 {
        plant.step(&mut state, 0.0, 0.0);
        let now = plant.stored_energy_j(&state, 0.0);
        assert!(
            now <= stored * (1.0 + 1e-15),
            "tick {tick}: {stored} to {now}"
        );
        stored = now;
    }
    assert_eq!(state.velocity(), 0.0);
}
