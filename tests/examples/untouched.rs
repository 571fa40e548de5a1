//! Prints how low the energy guard's account falls while a hand holds, wiggles and trembles against a stable virtual wall.
//!
//! `cargo run --release -p touchstone-tests --example untouched -- 3600` simulates an hour of each motion; the default is a minute.
//! In rows named `counts` the guard charges half an encoder count for every change of force. In rows named `free` it charges none,
//! so the energy that the encoder's quantisation gives is not in the account.

use touchstone_control::{ChangeOfForce, GuardSettings, Si};
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
        "{seconds} s of each (where it runs dry, 600); the account in mJ: lowest, at the end; what it loses in the mean, mW, before the refill"
    );
    for (k, b) in [(5.0, 0.0076), (20.0, 0.016), (20.0, 0.055)] {
        for (delay, change) in [
            (0.0, ChangeOfForce::Measured),
            (0.5, ChangeOfForce::Measured),
            (0.5, ChangeOfForce::Estimated),
        ] {
            for (refill, counted) in [(0.0005, true), (0.0005, false), (0.0, true), (0.0, false)] {
                for hz in [0.0, 1.0, 4.0, 9.0, 8.0, 10.0, 12.0] {
                    one(
                        SpringDamper { k, b },
                        delay,
                        change,
                        refill,
                        counted,
                        hz,
                        seconds,
                    );
                }
            }
        }
    }
}

fn one(
    law: SpringDamper,
    delay: f64,
    change: ChangeOfForce,
    refill_w: f64,
    counted: bool,
    hz: f64,
    seconds: u32,
) {
    // Without a refill, or with an estimated change of force, the account is known to run empty, and ten minutes show this.
    let dry = refill_w == 0.0 || change == ChangeOfForce::Estimated;
    let seconds = if dry { seconds.min(600) } else { seconds };
    let mut port = Port::new(law, delay, true, true);
    port.told = counted;
    let settings = GuardSettings {
        change,
        refill: Si::from_num(refill_w),
        ..Port::settings(delay)
    };
    let play =
        |port: &Port, seconds: u32| port.play(&mut Gripped::medium(wiggle(hz)), 1000 * seconds);
    port.guard = Some(settings);
    let outcome = play(&port, seconds);
    // With a capacity of 1 J the account is never full or empty.
    port.guard = Some(GuardSettings {
        capacity: Si::ONE,
        refill: Si::ZERO,
        ..settings
    });
    let ends = [10, 20].map(|seconds| play(&port, seconds).last_account_j);
    println!(
        "k {:>2} B {:<6} delay {delay:<3} {:<9} {:<6} P {:.1} mW {hz:>4} Hz {seconds:>5} s: lowest {:>6.2} end {:>6.2}, loses {:>6.3} mW, {:>7} ticks changed",
        law.k,
        law.b,
        format!("{change:?}"),
        if counted { "counts" } else { "free" },
        1e3 * refill_w,
        1e3 * outcome.lowest_account_j,
        1e3 * outcome.last_account_j,
        100.0 * (ends[0] - ends[1]),
        outcome.changed_ticks,
    );
}
