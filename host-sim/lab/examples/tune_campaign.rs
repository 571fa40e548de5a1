//! Tunes control laws for random devices: `cargo run --release -p touchstone-lab --example tune_campaign -- FILE.csv [DEVICES per
//! stiffness] [SEED] [LAWS] [TICKS] [SECOND TICKS] [AIM]`.
//!
//! LAWS are names of laws as in a scorecard, separated by commas. TICKS and SECOND TICKS limit the simulated control periods of
//! the first search, and of a second one if the first finds no suitable wall. AIM is `rest` (the default) or `all`, see
//! [`Budget::for_all_measures`]. Results are appended to the file, one row per device and law; an interrupted campaign continues
//! when started with the same arguments. At the end the program prints how many walls meet the limits under each law and under
//! the best law of each device, and why the other walls do not.

use std::error::Error;
use std::path::Path;
use touchstone_lab::journal::Journal;
use touchstone_lab::scorecard::rivals::Rival;
use touchstone_lab::tune::campaign::{Budget, Class, Row, best, row};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let usage = "give FILE.csv [DEVICES, default 100] [SEED, default 1] [LAWS, default spring-damper-estimated,enhanced] [TICKS, default 2e7] [SECOND TICKS, default 4e7] [AIM, rest or all, default rest]";
    let word = |i: usize, default: &'static str| words.get(i).cloned().unwrap_or(default.into());
    let file = words.first().ok_or(usage)?;
    let devices: u64 = word(1, "100").parse()?;
    let seed: u64 = word(2, "1").parse()?;
    let laws: Vec<&'static Rival> = word(3, "spring-damper-estimated,enhanced")
        .split(',')
        .map(Rival::named)
        .collect::<Result<_, _>>()?;
    let budget = Budget {
        first: word(4, "2e7").parse()?,
        second: word(5, "4e7").parse()?,
        for_all_measures: word(6, "rest") == "all",
    };
    let (mut journal, mut rows) = Journal::open::<Row>(Path::new(file))?;
    println!("seed {seed}: {} rows are done", rows.len());
    // All stiffnesses of one device number in turn, so that an interrupted campaign has equally many of each.
    for number in 0..devices {
        for class in Class::ALL {
            for rival in &laws {
                let is_this = |row: &Row| {
                    (row.class, row.number, row.law.as_str()) == (class, number, rival.name)
                };
                if !rows.iter().any(is_this) {
                    let row = row(seed, class, number, rival, budget)?;
                    journal.append(None, std::slice::from_ref(&row))?;
                    rows.push(row);
                }
            }
        }
    }
    let done: Vec<&Row> = rows.iter().filter(|row| row.number < devices).collect();
    for class in Class::ALL {
        println!("\n{class:?}, of {devices} devices:");
        let of_class = |row: &&&Row| row.class == class;
        for rival in &laws {
            let rows: Vec<&Row> = done
                .iter()
                .filter(of_class)
                .filter(|row| row.law == rival.name)
                .copied()
                .collect();
            print_tally(rival.name, &rows);
        }
        let better: Vec<&Row> = (0..devices)
            .filter_map(|number| {
                let laws: Vec<&Row> = done
                    .iter()
                    .filter(of_class)
                    .filter(|row| row.number == number)
                    .copied()
                    .collect();
                best(&laws)
            })
            .collect();
        print_tally("the better law of each", &better);
        for row in better.iter().filter(|row| !row.is_hard_from_the_touch()) {
            print_failure(row);
        }
    }
    Ok(())
}

fn print_tally(name: &str, rows: &[&Row]) {
    let count = |is: fn(&Row) -> bool| rows.iter().filter(|row| is(row)).count();
    println!(
        "  {name}: {} rest within 5 %, {} hold a moving hand within 15 % and 15°, {} both; {} within 10 % at rest and moving with a touch within 1.5 of the ideal wall's; called stable and not at rest: {}",
        count(|row| row.rests),
        count(|row| row.moves),
        count(|row| row.rests && row.moves),
        count(Row::is_hard_from_the_touch),
        count(Row::is_wrongly_stable),
    );
}

fn print_failure(row: &Row) {
    let fails = |what: &str, cause: Option<touchstone_lab::tune::diagnosis::FailureCause>| {
        cause.map_or(String::new(), |cause| {
            format!(" {what}: {};", cause.words())
        })
    };
    println!(
        "    {} {}:{}{} at rest off by {:.3}, moving by {:.3}, touch {:.2}; T sqrt(k/J) {:.3}, b T/J {:.4}, delay {:.2}, friction {:.1e}; certify: {} {}",
        row.number,
        row.law,
        fails("does not rest", row.rest_cause),
        fails("does not hold a moving hand", row.motion_cause),
        row.displayed_error.unwrap_or(f64::NAN),
        row.modulus_error.unwrap_or(f64::NAN),
        row.touch.unwrap_or(f64::NAN),
        row.stiffness_per_tick,
        row.damping_per_tick,
        row.delay_ticks,
        row.friction_n_m,
        row.certificate,
        row.certificate_causes
    );
}
