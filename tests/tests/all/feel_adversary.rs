//! Searches for the hand that gets the most energy out of a hostile torque profile behind the energy guard.
//!
//! `TOUCHSTONE_EVALUATIONS=100000 cargo test --profile every -p touchstone-tests feel_adversary:: -- --ignored --nocapture`

use rayon::prelude::*;
use touchstone_tests::adversary::Way;
use touchstone_tests::port::felt::{Hostile, STRENGTH_N_M};
use touchstone_tests::port::{COUNT_RAD, Port};

const DELAYS: [f64; 4] = [0.0, 0.1, 0.5, 1.0];
const CAPACITY_J: f64 = 0.02;
/// Energy of half an encoder count at each end of a time window, under the largest force.
const ENCODER_J: f64 = STRENGTH_N_M * COUNT_RAD;
/// Control periods in one evaluation. The worst hand of a search is run again for `LONGER` periods.
const TICKS: u32 = 500;
const LONGER: u32 = 5_000;
/// Evaluations of one search. More profiles find more than longer searches, because every profile is another force field.
const EACH: u32 = 250;

/// The most energy, J, that hands of all types get out of profiles of all kinds: above the refill with the guard, and in half a
/// second without a guard. `evaluations` is the number of runs with the guard.
fn searched(evaluations: u32) -> [f64; 2] {
    let of_a_round = (DELAYS.len() * Way::ALL.len()) as u32 * EACH.min(evaluations);
    let rounds = evaluations
        .div_ceil(of_a_round)
        .max(Hostile::ALL.len() as u32);
    let each = evaluations.div_ceil(rounds * (DELAYS.len() * Way::ALL.len()) as u32);
    let cells: Vec<(u32, f64, Way)> = (0..rounds)
        .flat_map(|round| DELAYS.map(|delay| (round, delay)))
        .flat_map(|(round, delay)| Way::ALL.map(|way| (round, delay, way)))
        .collect();
    let found: Vec<(Hostile, [f64; 2])> = cells
        .par_iter()
        .map(|&(round, delay, way)| {
            let kind = Hostile::ALL[round as usize % Hostile::ALL.len()];
            let profile = kind.profile(u64::from(round));
            let guarded = Port::new(profile, delay, true, true);
            let seed = u64::from(round) + 1;
            let (numbers, taken) = way.worst(&guarded, each, TICKS, seed);
            let longer = way.play(&guarded, &numbers, LONGER).above_refill_j;
            let bare = way.play(&Port::new(profile, delay, true, false), &numbers, TICKS);
            (kind, [taken.max(longer), bare.worst_window_j])
        })
        .collect();
    let mut worst = [0.0_f64; 2];
    println!(
        "{} evaluations of {TICKS} control periods, {rounds} profiles",
        each * cells.len() as u32
    );
    for kind in Hostile::ALL {
        let of = |which: usize| {
            let mine = found.iter().filter(|(own, _)| *own == kind);
            mine.map(|(_, most)| most[which]).fold(0.0, f64::max)
        };
        println!(
            "{:<8} most {:>7.3} mJ above the refill; the same hands without a guard {:>8.1} mJ",
            format!("{kind:?}"),
            1e3 * of(0),
            1e3 * of(1)
        );
        worst = [worst[0].max(of(0)), worst[1].max(of(1))];
    }
    println!(
        "worst {:.3} mJ, promised {:.3} mJ",
        1e3 * worst[0],
        1e3 * (CAPACITY_J + ENCODER_J)
    );
    worst
}

fn holds(evaluations: u32) {
    let [guarded, bare] = searched(evaluations);
    assert!(guarded <= CAPACITY_J + ENCODER_J, "{guarded} J");
    assert!(
        guarded > 0.5 * CAPACITY_J,
        "the hands are no test: {guarded} J"
    );
    assert!(
        bare > 5.0 * CAPACITY_J,
        "the profiles are no test: {bare} J"
    );
}

#[test]
fn hostile_profiles_keep_the_guard_s_promise() {
    holds(3_000);
}

#[test]
#[ignore = "minutes; `TOUCHSTONE_EVALUATIONS` gives the number"]
fn hostile_profiles_keep_the_guard_s_promise_in_a_long_search() {
    let wanted = std::env::var("TOUCHSTONE_EVALUATIONS");
    let evaluations = wanted.map_or(100_000, |text| {
        text.parse()
            .unwrap_or_else(|_| panic!("TOUCHSTONE_EVALUATIONS is `{text}`, give a number"))
    });
    holds(evaluations);
}
