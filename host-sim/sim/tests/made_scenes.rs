//! Tests with random scenes, generated from a seed and the list of scene fields. The fuzzer uses the same generator, with bytes in
//! place of a seed.

#[path = "../../../tests/made/choices.rs"]
mod choices;
#[path = "../../../tests/made/scene.rs"]
mod scene;

use choices::Seeded;
use scene::{Ended, TRIED_S, made, tried};
use std::panic::catch_unwind;
use std::time::Instant;

/// Peak memory in MB that a campaign may need.
const MEMORY_MB: f64 = 300.0;

/// Peak memory of this process in MB; 0 if the system does not report it.
fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = peak.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
    kib.map_or(0.0, |kib| kib * 1024e-6)
}

fn campaign(number: usize, seed: u64) {
    let mut seeded = Seeded(seed);
    let [mut runs, mut refused, mut long] = [0; 3];
    let mut wrong = Vec::new();
    // Longest computing time of runs without a note, and of runs that are announced as long.
    let mut slowest = [(0.0, String::new()), (0.0, String::new())];
    let begun = Instant::now();
    for at in 0..number {
        let (base, sets) = made(&mut seeded);
        match catch_unwind(|| tried(base, &sets)) {
            Ok((ended, took_s)) => {
                let slowest = &mut slowest[usize::from(matches!(ended, Ended::Long))];
                match ended {
                    Ended::Run => runs += 1,
                    Ended::Refused => refused += 1,
                    Ended::Long => long += 1,
                }
                if took_s > slowest.0 {
                    *slowest = (took_s, format!("{base} {sets:?}"));
                }
            }
            Err(_) => {
                // Printed at once, because a long campaign may be stopped before its end.
                println!("wrong: {base} {sets:?}");
                wrong.push(format!("{base} {sets:?}"));
            }
        }
        if (at + 1) % 10_000 == 0 {
            println!(
                "{} made in {:.0} s: {runs} run, {refused} refused, {long} said to be long, {} wrong; at most {:.2} s, {:.0} MB",
                at + 1,
                begun.elapsed().as_secs_f64(),
                wrong.len(),
                slowest[0].0,
                peak_mb()
            );
        }
    }
    let memory_mb = peak_mb();
    println!("{runs} run, {refused} refused, {long} said to be long; {memory_mb:.0} MB");
    assert!(memory_mb < MEMORY_MB, "{memory_mb:.0} MB");
    let [quiet, said] = slowest;
    println!("without a word at most {:.2} s: {}", quiet.0, quiet.1);
    let estimates = said.0 / TRIED_S;
    println!(
        "said to be long: at most {estimates:.2} of the estimate: {}",
        said.1
    );
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    // The generator must make both scenes that run and scenes that are refused.
    assert!(runs > number / 10 && refused > number / 10 && long < number / 10);
}

/// Tests that scenes with extreme values end. Possible faults are an endless step of the plant, and a panic when the plant
/// diverges.
#[test]
fn scenes_beyond_all_numbers_end() {
    for (base, sets) in [
        (
            "thesis-knob",
            &["device.current_loop.back_emf_n_m_s_per_rad=1.7976931348623157e308"][..],
        ),
        (
            "voltage-knob",
            &["device.transmission.damper_n_m_s_per_rad=1e300"],
        ),
        ("free-release", &["device.inertia_kg_m2=5e-324"]),
        (
            "press-hold",
            &[
                "environment.detents.centre_rad=1e6",
                "operator.reflex.muscle_stiffness_n_m_per_rad=1e300",
            ],
        ),
        (
            "press-hold",
            &[
                "environment.detents.per_rev=1",
                "device.initial_angle_rad=1.7976931348623157e308",
            ],
        ),
        (
            "low-stiffness",
            &["device.friction.bristle_stiffness_n_m_per_rad=1e300"],
        ),
    ] {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        // The scene may run or be refused, but must neither panic nor take long.
        tried(base, &sets);
    }
}

#[test]
fn made_scenes_run_or_are_refused_in_a_line() {
    campaign(500, 51);
}

/// Tests a hundred thousand random scenes: `cargo test --profile every -p touchstone-sim --test made_scenes -- --ignored
/// --nocapture`. The variables `TOUCHSTONE_MADE` and `TOUCHSTONE_SEED` give another number and seed: a million scenes can be divided
/// between processes.
#[test]
#[ignore = "some twenty minutes"]
fn a_hundred_thousand_scenes() {
    let asked = |name, otherwise| {
        let text = std::env::var(name).ok();
        text.map_or(otherwise, |text| text.parse().expect("a whole number"))
    };
    let number = asked("TOUCHSTONE_MADE", 100_000);
    campaign(number as usize, asked("TOUCHSTONE_SEED", 52));
}
