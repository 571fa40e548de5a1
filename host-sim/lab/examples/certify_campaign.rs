//! Certificates against runs: `cargo run --release -p touchstone-lab --example certify_campaign -- FILE.csv [RUNS] [SEED]`.
//!
//! Rows are appended to the file; a campaign that was stopped goes on where it stopped, with the same seed. At the end it prints
//! what was said beside what happened, and why some were not decided.

use rayon::prelude::*;
use std::error::Error;
use std::path::Path;
use touchstone_lab::certify::campaign::{Row, Tally, row};
use touchstone_lab::resumable::Rows;

/// Rows between two writes.
const CHUNK: u64 = 48;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let usage = "give FILE.csv [RUNS, default 2000] [SEED, default 1]";
    let file = words.next().ok_or(usage)?;
    let runs: u64 = words.next().map_or(Ok(2000), |word| word.parse())?;
    let seed: u64 = words.next().map_or(Ok(1), |word| word.parse())?;
    let mut rows: Rows<Row> = Rows::open(Path::new(&file))?;
    let mut done = rows.done().len() as u64;
    println!("seed {seed}: {done} of {runs} runs are done");
    while done < runs {
        let end = runs.min(done + CHUNK);
        rows.append(
            (done..end)
                .into_par_iter()
                .map(|index| row(seed, index))
                .collect::<Result<_, _>>()?,
        )?;
        done = end;
        eprint!("\r{done}/{runs}");
    }
    let mut tally = Tally::default();
    rows.done().iter().for_each(|row| tally.add(row));
    println!("\n{tally}");
    Ok(())
}
