//! Tests with random recordings, generated from a seed. The fuzzer uses the same generator, with bytes in place of a seed.

#[path = "../../../tests/made/choices.rs"]
mod choices;
#[path = "../../../tests/made/recording.rs"]
mod recording;

use choices::Seeded;
use recording::{is_read, made};

fn campaign(number: usize, seed: u64) {
    let mut seeded = Seeded(seed);
    let read = (0..number).filter(|_| is_read(&made(&mut seeded))).count();
    println!("{read} of {number} were read");
    // The generator must make both recordings that are read and recordings that are refused.
    assert!(
        read > number / 20 && read < number - number / 20,
        "{read} of {number} were read"
    );
}

#[test]
fn a_hundred_thousand_recordings_are_read_or_refused_in_a_line() {
    campaign(100_000, 51);
}

/// Tests a million random recordings. Takes a minute: `cargo test -p touchstone-sim --test made_recordings -- --ignored`.
#[test]
#[ignore = "a minute"]
fn a_million_recordings() {
    campaign(1_000_000, 52);
}
