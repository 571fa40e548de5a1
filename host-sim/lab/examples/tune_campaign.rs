//! Random devices, each with a law tuned for it: `cargo run --release -p touchstone-lab --example tune_campaign -- FILE.csv [DEVICES a
//! stiffness] [SEED] [LAW] [TICKS]`.
//!
//! Rows are appended to the file, a device a row; a campaign that was stopped goes on where it stopped, with the same words. At the
//! end it prints how many hold, and why the others do not.

use std::error::Error;
use std::path::Path;
use touchstone_lab::journal::Journal;
use touchstone_lab::scorecard::rivals::Rival;
use touchstone_lab::tune::campaign::{Class, Row, row};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let usage = "give FILE.csv [DEVICES, default 100] [SEED, default 1] [LAW, default spring-damper-estimated] [TICKS, default 4e6]";
    let word = |i: usize, default: &'static str| words.get(i).cloned().unwrap_or(default.into());
    let file = words.first().ok_or(usage)?;
    let devices: u64 = word(1, "100").parse()?;
    let seed: u64 = word(2, "1").parse()?;
    let rival = Rival::named(&word(3, "spring-damper-estimated"))?;
    let ticks: f64 = word(4, "4e6").parse()?;
    let path = Path::new(file);
    let (mut journal, mut done) = Journal::open::<Row>(path)?;
    println!(
        "seed {seed}, {}: {} of {} devices are done",
        rival.name,
        done.len(),
        3 * devices
    );
    // Stiffness by stiffness within a number, so that a campaign that was cut has as many of each.
    for number in 0..devices {
        for class in Class::ALL {
            if done
                .iter()
                .any(|row| (row.class, row.number) == (class, number))
            {
                continue;
            }
            let row = row(seed, class, number, rival, ticks)?;
            journal.append(None, std::slice::from_ref(&row))?;
            done.push(row);
        }
    }
    for class in Class::ALL {
        let rows: Vec<&Row> = done.iter().filter(|row| row.class == class).collect();
        let rest = rows.iter().filter(|row| row.rests).count();
        let both = rows.iter().filter(|row| row.rests && row.moves).count();
        println!(
            "{class:?}: {rest} of {} rest within 5 %, {both} also hold a moving hand within 15 % and 15°",
            rows.len()
        );
        for row in rows.iter().filter(|row| !row.rests || !row.moves) {
            println!(
                "  {}: {}{}; T sqrt(k/J) {:.3}, b T/J {:.4}, delay {:.2}; certify: {} {}",
                row.number,
                if row.rests { "" } else { "does not rest " },
                if row.moves {
                    ""
                } else {
                    "does not hold a moving hand"
                },
                row.stiffness_per_tick,
                row.damping_per_tick,
                row.delay_ticks,
                row.certificate,
                row.cause
            );
        }
    }
    Ok(())
}
