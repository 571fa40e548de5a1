//! Certificates against runs: `cargo run --release -p touchstone-lab --example certify_campaign -- FILE.csv [RUNS] [SEED]`.
//!
//! Rows are appended to the file; a campaign that was stopped goes on where it stopped, with the same seed. At the end it prints
//! what was said beside what happened.

use rayon::prelude::*;
use std::error::Error;
use std::io::Write;
use std::path::Path;
use touchstone_lab::certify::campaign::{Tally, row};

/// Rows between two writes.
const CHUNK: u64 = 48;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let usage = "give FILE.csv [RUNS, default 2000] [SEED, default 1]";
    let file = words.next().ok_or(usage)?;
    let runs: u64 = words.next().map_or(Ok(2000), |word| word.parse())?;
    let seed: u64 = words.next().map_or(Ok(1), |word| word.parse())?;
    let path = Path::new(&file);
    let mut done = 0;
    if path.exists() {
        done = csv::Reader::from_path(path)?.records().count() as u64;
    }
    println!("seed {seed}: {done} of {runs} runs are done");
    while done < runs {
        let chunk: Vec<_> = (done..runs.min(done + CHUNK))
            .into_par_iter()
            .map(|index| row(seed, index))
            .collect::<Result<_, _>>()?;
        let mut writer = csv::WriterBuilder::new()
            .has_headers(done == 0)
            .from_writer(Vec::new());
        for row in &chunk {
            writer.serialize(row)?;
        }
        let text = writer.into_inner()?;
        // One write a chunk: a chunk is there or it is not.
        std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(path)?
            .write_all(&text)?;
        done += chunk.len() as u64;
        eprint!("\r{done}/{runs}");
    }
    let mut tally = Tally::default();
    for record in csv::Reader::from_path(path)?.deserialize() {
        tally.add(&record?);
    }
    println!("\n{tally}");
    Ok(())
}
