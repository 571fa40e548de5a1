//! Tests single faults of a running knob: the energy that a hand gets until the device is off. Every fault is simulated once on
//! every board, with a moment, a grip and a quarter of an electrical turn that a seed chooses; `TOUCHSTONE_SEED` sets the seed.
//! `cargo xtask faults` simulates all combinations.

use rayon::prelude::*;
use touchstone_protocol::Board;
use touchstone_tests::random::Random;
use touchstone_tests::single_faults::{
    Bench, FAULTS, Fault, Grip, Moment, Row, Table, UNFOUND, run,
};

/// Number of combinations of moment, grip and quarter from which a board's faults are drawn.
const PLACES: usize = 5;

fn seed() -> u64 {
    std::env::var("TOUCHSTONE_SEED").map_or(1, |text| text.parse().expect("a seed"))
}

fn drawn(random: &mut Random, below: usize) -> usize {
    (random.bits() % below as u64) as usize
}

fn benches(places: Vec<(Board, (Moment, Grip, u8))>) -> Vec<Bench> {
    places
        .into_par_iter()
        .map(|(board, (moment, grip, quarter))| Bench::new(board, moment, grip, quarter))
        .collect()
}

fn played<'b>(cells: Vec<(&'b Bench, &'static Fault)>) -> Table<'b> {
    let rows: Vec<Row<'b>> = cells
        .into_par_iter()
        .filter(|(bench, fault)| fault.not_on(bench.board).is_none())
        .map(|(bench, fault)| run(bench, fault))
        .collect();
    Table {
        rows,
        long: Vec::new(),
    }
}

#[test]
fn a_single_fault_gives_a_hand_no_more_than_is_said() {
    let mut random = Random::new(seed());
    let all: Vec<_> = Bench::places().collect();
    let places = Board::ALL
        .iter()
        .flat_map(|board| [*board; PLACES])
        .map(|board| (board, all[drawn(&mut random, all.len())]))
        .collect();
    let benches = benches(places);
    let mut cells = Vec::new();
    for of_board in benches.chunks(PLACES) {
        for fault in FAULTS {
            cells.push((&of_board[drawn(&mut random, PLACES)], fault));
        }
    }
    let table = played(cells);
    assert!(table.rows.len() > 4 * FAULTS.len(), "{}", table.rows.len());
    let complaints = table.complaints();
    assert!(complaints.is_empty(), "{complaints:#?}");
    // In more than a quarter of the runs the board found a fault, so the sample tests the detection too.
    let found = table.rows.iter().filter(|row| row.cell.off_s.is_some());
    assert!(found.count() > table.rows.len() / 4);
}

#[test]
fn names_are_single_and_exceptions_name_faults() {
    let is_fault = |name: &str| FAULTS.iter().filter(|fault| fault.name == name).count() == 1;
    for fault in FAULTS {
        assert!(is_fault(fault.name), "{}", fault.name);
    }
    for (_, names) in UNFOUND {
        for name in *names {
            assert!(is_fault(name), "{name}");
        }
    }
    assert!(FAULTS.len() >= 40);
}
