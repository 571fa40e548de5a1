//! Looks for the hand that gets the most energy out, with and without the energy guard, at four delays.
//!
//! `cargo run --release -p touchstone-tests --example adversary -- 1000000` spends a million evaluations with the guard, in all
//! ways, delays and laws together, and a tenth of that without. The default is 40,000.

use touchstone_tests::adversary::Way;
use touchstone_tests::port::{Port, SpringDamper};

const LAWS: [(&str, SpringDamper); 3] = [
    ("spring 5", SpringDamper { k: 5.0, b: 0.0 }),
    (
        "spring 5, damper 0.0076",
        SpringDamper { k: 5.0, b: 0.0076 },
    ),
    (
        "spring 20, damper 0.055",
        SpringDamper { k: 20.0, b: 0.055 },
    ),
];

fn main() {
    let budget: u32 = match std::env::args().nth(1).map(|text| text.parse()) {
        None => 40_000,
        Some(Ok(budget)) => budget,
        Some(Err(error)) => {
            eprintln!(
                "argument 1, the number of evaluations: {error}; give a whole number, such as 1000000"
            );
            std::process::exit(2);
        }
    };
    let each = budget / (LAWS.len() * 4 * Way::ALL.len()) as u32;
    println!(
        "the worst second found, mJ above the refill of 0.5 mW (bound: 20 mJ and 0.05 mJ for the encoder)"
    );
    println!(
        "{:<26} {:>6} {:>9} {:>10} {:>10} {:>12}",
        "law", "delay", "way", "guarded", "bare", "evaluations"
    );
    let mut worst: f64 = 0.0;
    for (name, law) in LAWS {
        for delay in [0.0, 0.1, 0.5, 1.0] {
            for way in Way::ALL {
                let guarded = Port::new(law, delay, true, true);
                let (numbers, taken) = way.worst(&guarded, each, 500, 1);
                // Longer, in case it is slow.
                let longer = way.play(&guarded, &numbers, 20_000).above_refill_j;
                let (_, bare) =
                    way.worst(&Port::new(law, delay, true, false), each / 10 + 1, 500, 1);
                let taken = taken.max(longer);
                worst = worst.max(taken);
                println!(
                    "{name:<26} {delay:>6} {:>9} {:>10.3} {:>10.1} {each:>12}",
                    format!("{way:?}"),
                    1e3 * taken,
                    1e3 * bare
                );
            }
        }
    }
    println!("worst of all with the guard: {:.3} mJ", 1e3 * worst);
}
