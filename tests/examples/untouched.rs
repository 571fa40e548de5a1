//! How low the guard's account falls while a hand holds, wiggles and trembles against a good wall.
//!
//! `cargo run --release -p touchstone-tests --example untouched -- 3600` plays an hour of each; the default is a minute.

use touchstone_control::Si;
use touchstone_tests::port::{Gripped, Port, SpringDamper, wiggle};

fn main() {
    let seconds: u32 = match std::env::args().nth(1).map(|text| text.parse()) {
        None => 60,
        Some(Ok(seconds)) => seconds,
        Some(Err(error)) => {
            eprintln!(
                "argument 1, the seconds of each motion: {error}; give a whole number, such as 3600"
            );
            std::process::exit(2);
        }
    };
    println!(
        "{seconds} s each; account in mJ: lowest, at the end; mean power, mW, without a cap that would hide it"
    );
    for (k, b) in [(5.0, 0.0076), (20.0, 0.016), (20.0, 0.055)] {
        for delay in [0.0, 0.5] {
            for hz in [0.0, 1.0, 4.0, 9.0, 8.0, 10.0, 12.0] {
                for (refill, count) in [(0.0005, true), (0.0, true), (0.0, false)] {
                    let mut port = Port::new(SpringDamper { k, b }, delay, true, true);
                    if let Some(guard) = &mut port.guard {
                        guard.refill = Si::from_num(refill);
                        if !count {
                            guard.count = Si::ZERO;
                        }
                    }
                    let outcome = port.play(&mut Gripped::medium(wiggle(hz)), 1000 * seconds);
                    // The same with an account so large that neither end is met.
                    if let Some(guard) = &mut port.guard {
                        guard.capacity = Si::from_num(1);
                        guard.refill = Si::ZERO;
                    }
                    let long = port.play(&mut Gripped::medium(wiggle(hz)), 20_000);
                    let short = port.play(&mut Gripped::medium(wiggle(hz)), 10_000);
                    let power = (long.last_account_j - short.last_account_j) / 10.0;
                    println!(
                        "k {k:>4} B {b:<6} delay {delay} {hz:>4} Hz  P {:.1} mW {:<12} lowest {:>6.2} end {:>6.2}  changed {:>8} ticks  drift {:>7.3} mW",
                        1e3 * refill,
                        if count { "count" } else { "no count" },
                        1e3 * outcome.lowest_account_j,
                        1e3 * outcome.last_account_j,
                        outcome.changed_ticks,
                        1e3 * power
                    );
                }
            }
        }
    }
}
