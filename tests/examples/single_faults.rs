//! The table of single faults on all boards, or on those named: what a hand gets until the device is off.
//!
//! `cargo run --profile test -p touchstone-tests --example single_faults -- FOLDER [BOARD...]` writes `cells.csv` (every cell) and
//! `page.md` (what the documentation shows) into the folder, and prints the faults that a board does not detect. `cargo xtask
//! faults` runs it.

use rayon::prelude::*;
use std::error::Error;
use std::path::Path;
use touchstone_protocol::Board;
use touchstone_tests::single_faults::{Bench, FAULTS, Row, Table, run};

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let folder = words.next().ok_or("give FOLDER [BOARD...]")?;
    let names: Vec<String> = words.collect();
    let is_meant = |board: &Board| names.is_empty() || names.iter().any(|it| it == board.name());
    let boards: Vec<Board> = Board::ALL.into_iter().filter(is_meant).collect();
    let places: Vec<_> = boards
        .iter()
        .flat_map(|board| Bench::places().map(|place| (*board, place)))
        .collect();
    let benches: Vec<Bench> = places
        .into_par_iter()
        .map(|(board, (moment, grip, quarter))| Bench::new(board, moment, grip, quarter))
        .collect();
    let cells: Vec<_> = benches
        .iter()
        .flat_map(|bench| FAULTS.iter().map(move |fault| (bench, fault)))
        .filter(|(bench, fault)| fault.not_on(bench.board).is_none())
        .collect();
    let rows = cells
        .into_par_iter()
        .map(|(bench, fault)| run(bench, fault))
        .collect();
    let mut table = Table {
        rows,
        long: Vec::new(),
    };
    table.long = table.unfound().par_iter().map(Row::goes_on).collect();
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("cells.csv"), table.csv())?;
    std::fs::write(folder.join("page.md"), table.page())?;
    print!("{}", table.page());
    for board in &boards {
        println!("not found by {} (cells, most mJ):", board.name());
        for (name, cells, most_j) in table.not_found(*board) {
            println!("    {name}: {cells}, {:.1}", 1e3 * most_j);
        }
    }
    let mut complaints = table.complaints();
    if names.is_empty() {
        complaints.extend(table.complaints_of_all());
    }
    for complaint in &complaints {
        eprintln!("{complaint}");
    }
    match complaints.len() {
        0 => Ok(()),
        number => Err(format!("{number} cells are not as known: mend them or name them").into()),
    }
}
