//! Compares stability certificates with simulated runs of random devices: `cargo run --release -p touchstone-lab --example
//! certify_campaign -- FILE.csv [RUNS] [SEED] [STATES]`.
//!
//! Results are appended to the file, one table row per run; an interrupted campaign continues when started with the same seed. At
//! the end the program prints how often each verdict of a certificate coincided with each outcome of a run, and why some
//! certificates were undecided.

use rayon::prelude::*;
use std::error::Error;
use std::path::Path;
use touchstone_control::{Choice as _, StatesKind};
use touchstone_lab::certify::campaign::{Row, Tally, row};
use touchstone_lab::journal::Journal;

/// Number of random devices that are simulated between two writes to the file.
const CHUNK: u64 = 48;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let usage = "give FILE.csv [RUNS, default 2000] [SEED, default 1] [STATES, measured or estimated, default measured]";
    let file = words.next().ok_or(usage)?;
    let runs: u64 = words.next().map_or(Ok(2000), |word| word.parse())?;
    let seed: u64 = words.next().map_or(Ok(1), |word| word.parse())?;
    let states = words.next().map_or(Ok(StatesKind::Measured), |word| {
        StatesKind::of_word(&word).ok_or(usage)
    })?;
    let (mut journal, mut rows) = Journal::open::<Row>(Path::new(&file))?;
    println!(
        "seed {seed}, {} states: {} of {runs} runs are done",
        states.word(),
        rows.len()
    );
    while (rows.len() as u64) < runs {
        let done = rows.len() as u64;
        let chunk: Vec<_> = (done..runs.min(done + CHUNK))
            .into_par_iter()
            .map(|index| row(seed, index, states))
            .collect::<Result<_, _>>()?;
        journal.append(None, &chunk)?;
        rows.extend(chunk);
        eprint!("\r{}/{runs}", rows.len());
    }
    let mut tally = Tally::default();
    rows.iter().for_each(|row| tally.add(row));
    println!("\n{tally}");
    Ok(())
}
