//! Generates scene files (descriptions of a simulation): every field at both ends of its range, at 0 and in between, with every
//! environment of walls and detents. Checks that an accepted scene runs to its end in a bounded time, and that a refused one gets a
//! one-line message.

use super::choices::Choices;
use std::time::Instant;
use touchstone_sim::run;
use touchstone_sim::run::plan::Plan;
use touchstone_sim::run::work::{self, Work};
use touchstone_sim::scene::schema::{FIELDS, Field, Kind, Range};
use touchstone_sim::scene::{Preset, Scene};

/// Largest processor time in s that a generated scene may take if the program did not announce it as long. It is longer in builds
/// without optimisation.
const PATIENCE_S: f64 = if cfg!(debug_assertions) { 6.0 } else { 2.0 };
/// Processor time that a simulation announced as long may take, per second of the program's own estimate.
const SHARE: f64 = PATIENCE_S / work::LONG_S;
/// Part of a scene announced as long that is simulated, in s of the program's estimate of its processor time.
pub const TRIED_S: f64 = 0.2;

fn number(seeded: &mut impl Choices, numbers: &[f64]) -> String {
    // Writes `1e300` in this form; `Display` would write 301 digits.
    format!("{:e}", numbers[seeded.below(numbers.len())])
}

/// Names of scene files: ones that users choose, and ones that could do harm.
const TEXTS: [&str; 6] = [
    "\"\"",
    "\"a \\\"quoted\\\" name\"",
    "\"two\\nlines\"",
    "\"\\u001b[31mred\"",
    "\"../x; rm -rf ~\"",
    "\"ü 力\"",
];

/// Makes a random value for a field of a scene file, mostly one that the field accepts.
fn value(field: &Field, seeded: &mut impl Choices) -> String {
    const TINY: f64 = 5e-324;
    let wide = [
        0.0,
        1.0,
        -1.0,
        0.1,
        -0.3,
        1e-9,
        1e3,
        1e6,
        -1e6,
        1e300,
        -1e300,
        TINY,
        f64::MAX,
    ];
    if seeded.below(40) == 0 {
        let odd = [
            "nan", "inf", "-0.0", "true", "\"\"", "[]", "1_0", "-1e-300", "9e999",
        ];
        return seeded.of(&odd).to_owned();
    }
    match field.kind {
        Kind::Text if field.path.ends_with(".file") => "\"none.csv\"".to_owned(),
        Kind::Text => seeded.of(&TEXTS).to_owned(),
        Kind::Flag => seeded.of(&["true", "false"]).to_owned(),
        Kind::Choice(words) => format!("{:?}", seeded.of(words)),
        Kind::Whole(least, most) => {
            let middle = least.max(1).saturating_mul(3).min(most);
            [least, most, 0, middle, least.saturating_add(1)][seeded.below(5)].to_string()
        }
        Kind::Numbers(fewest, most, low, high) => {
            let many = [fewest, most, 3, most / 2, fewest - 1, most + 1][seeded.below(6)];
            let values = [low, high, 0.0, 0.5 * high, 1e-9, 1.5 * high];
            let items: Vec<String> = (0..many).map(|_| number(seeded, &values)).collect();
            format!("[{}]", items.join(", "))
        }
        Kind::Number(range) => match range {
            Range::Any | Range::NotZero => number(seeded, &wide),
            Range::Positive | Range::NotNegative => {
                let number = wide[seeded.below(wide.len())];
                format!("{:e}", number.abs())
            }
            Range::AtLeast(least) => number(seeded, &[least, 2.0 * least, least + 1.0, 1e3, 1e300]),
            Range::UpTo(most) => {
                number(seeded, &[most, 0.5 * most, 1e-3 * most, 1e-9 * most, TINY])
            }
            Range::Within(least, most) => number(
                seeded,
                &[
                    least,
                    most,
                    0.0,
                    0.5 * (least + most),
                    least + 1e-3 * (most - least),
                ],
            ),
            Range::Exactly(least, most) => seeded.of(&[least, most, "0"]).to_owned(),
        },
    }
}

/// Makes a random scene (description of a simulation): returns the shipped scene file to start from, and the changes `field=value`.
pub fn made(seeded: &mut impl Choices) -> (&'static str, Vec<String>) {
    let base = seeded.of(&[
        "thesis-knob",
        "tap",
        "press-hold",
        "press-wiggle-release",
        "low-stiffness",
        "free-release",
        "gimbal-knob",
        "voltage-knob",
    ]);
    let environment: Vec<&Field> = FIELDS
        .iter()
        .filter(|field| field.path.starts_with("environment."))
        .collect();
    let mut sets = Vec::new();
    for _ in 0..seeded.below(4) {
        let field = environment[seeded.below(environment.len())];
        sets.push(format!("{}={}", field.path, value(field, seeded)));
    }
    for _ in 0..1 + seeded.below(5) {
        let field = &FIELDS[seeded.below(FIELDS.len())];
        sets.push(format!("{}={}", field.path, value(field, seeded)));
    }
    (base, sets)
}

/// Result of trying a generated scene file.
pub enum Ended {
    /// The simulation ran to its end.
    Run,
    /// The program refused the scene file with a one-line message.
    Refused,
    /// The program announced the simulation as long, and only a part of it was run.
    Long,
}

/// Processor time of this thread in s, which other programs do not affect. If the system does not report it, returns the time
/// since `begun`.
fn processor_s(begun: Instant) -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat");
    let ns = told
        .ok()
        .and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    ns.map_or_else(|| begun.elapsed().as_secs_f64(), |ns| 1e-9 * ns)
}

/// Reads and simulates a generated scene file. Returns the result and the processor time in s.
pub fn tried(base: &str, sets: &[String]) -> (Ended, f64) {
    let one_line = |error: touchstone_sim::error::Error| {
        let text = error.to_string();
        // A file's name may contain anything; the program that prints it escapes it.
        assert!(
            !text.contains('\n') && text.chars().count() < 1200,
            "{base} {sets:?}: {text}"
        );
        Ended::Refused
    };
    let begun = Instant::now();
    let from_s = processor_s(begun);
    let within = |ended, most_s: f64| {
        let took_s = processor_s(begun) - from_s;
        assert!(
            took_s < most_s,
            "{base} {sets:?} took {took_s} s of at most {most_s}"
        );
        (ended, took_s)
    };
    let scene = Scene::load(base).unwrap();
    let scene = match scene
        .with_preset(Preset::Thesis)
        .and_then(|scene| scene.with_overrides(sets))
    {
        Ok(scene) => scene,
        Err(error) => return within(one_line(error), PATIENCE_S),
    };
    let printed = scene.to_toml();
    assert!(
        Scene::parse(&printed, std::path::Path::new("again.toml")).is_ok(),
        "{base} {sets:?} is not read again: {printed}"
    );
    let work = Work::of(&scene);
    if let (Ok(()), Some(note)) = (work.check(&scene), work.note()) {
        assert!(!note.contains('\n') && note.contains("may take"), "{note}");
        let ended = match Plan::of(&scene) {
            Err(error) => one_line(error),
            Ok(mut plan) => {
                let part = TRIED_S / work.seconds;
                let ticks = 0..(part * work.ticks as f64).ceil() as u64;
                let period_s = scene.timing.period_s();
                plan.mechanics
                    .advance(plan.control.as_mut(), &plan.motion, ticks, period_s, None);
                Ended::Long
            }
        };
        return within(ended, PATIENCE_S + SHARE * TRIED_S);
    }
    let warned = run::warnings(&scene).err();
    let ended = match run::run(&scene, false) {
        Ok(run) => {
            assert!(warned.is_none(), "{base} {sets:?}: {warned:?}");
            assert_eq!(run.summary.ticks, scene.timing.ticks());
            Ended::Run
        }
        Err(error) => one_line(error),
    };
    within(ended, PATIENCE_S)
}
