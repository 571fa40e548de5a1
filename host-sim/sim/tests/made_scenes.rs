//! Scenes made from the schema by a seed: every field at both ends of its range, at 0 and in between, with every
//! environment. An accepted scene runs to its end in a bounded time; a refused one gives one line.

use std::panic::catch_unwind;
use std::time::{Duration, Instant};
use touchstone_sim::run;
use touchstone_sim::run::train::Train;
use touchstone_sim::scene::schema::{FIELDS, Field, Kind, Range};
use touchstone_sim::scene::{Preset, Scene};

/// Longest time of a substep: twenty times what one takes with most effects, as the sine of a huge angle is slow and
/// machines are busy.
const SLOWEST_SUBSTEP: Duration = Duration::from_micros(20);
/// The same for a hand with friction: a stiff pad takes up to 4,096 power series in a tick.
const SLOWEST_EVENTS: Duration = Duration::from_millis(8);
/// Time to wait in addition.
const PATIENCE: Duration = Duration::from_secs(2);
/// A scene may ask for days in steps of microseconds, and gets them. The campaign has no time for them.
const MOST_STEPS: f64 = 2e6;

/// SplitMix64 (Steele, Lea and Flood, 2014).
struct Seeded(u64);

impl Seeded {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % most as u64) as usize
    }

    fn of<'a>(&mut self, words: &[&'a str]) -> &'a str {
        words[self.below(words.len())]
    }

    fn number(&mut self, numbers: &[f64]) -> String {
        // `1e300` for what `Display` would write in 301 digits.
        format!("{:e}", numbers[self.below(numbers.len())])
    }
}

/// Names as people have them, and some that are hostile.
const TEXTS: [&str; 6] = [
    "\"\"",
    "\"a \\\"quoted\\\" name\"",
    "\"two\\nlines\"",
    "\"\\u001b[31mred\"",
    "\"../x; rm -rf ~\"",
    "\"ü 力\"",
];

/// A value for a field: mostly one that it takes.
fn value(field: &Field, seeded: &mut Seeded) -> String {
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
        Kind::Number(range) => match range {
            Range::Any | Range::NotZero => seeded.number(&wide),
            Range::Positive | Range::NotNegative => {
                let number = wide[seeded.below(wide.len())];
                format!("{:e}", number.abs())
            }
            Range::AtLeast(least) => seeded.number(&[least, 2.0 * least, least + 1.0, 1e3, 1e300]),
            Range::UpTo(most) => seeded.number(&[most, 0.5 * most, 1e-3 * most, 1e-9 * most, TINY]),
            Range::Within(least, most) => seeded.number(&[
                least,
                most,
                0.0,
                0.5 * (least + most),
                least + 1e-3 * (most - least),
            ]),
            Range::Exactly(least, most) => seeded.of(&[least, most, "0"]).to_owned(),
        },
    }
}

/// Random changes of a scene.
fn made(seeded: &mut Seeded) -> (&'static str, Vec<String>) {
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

enum Ended {
    Run,
    Refused,
    TooLong,
}

/// Makes and runs a scene.
fn tried(base: &str, sets: &[String]) -> Ended {
    let one_line = |error: touchstone_sim::error::Error| {
        let text = error.to_string();
        // A name of the file may hold anything; what prints it makes it visible.
        assert!(
            !text.contains('\n') && text.chars().count() < 1200,
            "{base} {sets:?}: {text}"
        );
        Ended::Refused
    };
    let begun = Instant::now();
    let scene = Scene::load(base).unwrap();
    let scene = match scene
        .with_preset(Preset::Thesis)
        .and_then(|scene| scene.with_overrides(sets))
    {
        Ok(scene) => scene,
        Err(error) => return one_line(error),
    };
    let printed = scene.to_toml();
    assert!(
        Scene::parse(&printed, std::path::Path::new("again.toml")).is_ok(),
        "{base} {sets:?} is not read again: {printed}"
    );
    // A stiff plant gets more of them unasked, up to a limit, and `plan` says so.
    let asked = scene.plant.as_ref().map_or(1, |plant| plant.substeps);
    let substeps = Train::of(&scene).map_or(asked, |train| train.substeps);
    let steps = scene.timing.ticks() as f64 * f64::from(substeps);
    if steps > MOST_STEPS {
        return Ended::TooLong;
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
    let took = begun.elapsed();
    let has_events = scene.operator.hand().is_some() && scene.device.friction.is_some();
    let events = SLOWEST_EVENTS.mul_f64(f64::from(u8::from(has_events)));
    let ticks = scene.timing.ticks() as f64;
    let limit = PATIENCE + SLOWEST_SUBSTEP.mul_f64(steps) + events.mul_f64(ticks);
    assert!(
        took < limit,
        "{base} {sets:?} took {took:?} for {steps} steps"
    );
    ended
}

fn campaign(number: usize, seed: u64) {
    let mut seeded = Seeded(seed);
    let [mut runs, mut refused, mut too_long] = [0; 3];
    let mut wrong = Vec::new();
    for _ in 0..number {
        let (base, sets) = made(&mut seeded);
        match catch_unwind(|| tried(base, &sets)) {
            Ok(Ended::Run) => runs += 1,
            Ok(Ended::Refused) => refused += 1,
            Ok(Ended::TooLong) => too_long += 1,
            Err(_) => wrong.push(format!("{base} {sets:?}")),
        }
    }
    println!("{runs} run, {refused} refused, {too_long} too long to try");
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    // Both are tried, or the generator is worth nothing.
    assert!(runs > number / 10 && refused > number / 10 && too_long < number / 10);
}

/// Two findings of the campaign: a step of the plant without an end, and panics where a plant diverges.
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
        // Whether it runs or is refused: neither panics, and neither takes long.
        tried(base, &sets);
    }
}

#[test]
fn made_scenes_run_or_are_refused_in_a_line() {
    campaign(500, 51);
}

/// `cargo test --release -p touchstone-sim --test made_scenes -- --ignored --nocapture`
#[test]
#[ignore = "more than half an hour; how many have run is not shown"]
fn a_hundred_thousand_scenes() {
    campaign(100_000, 52);
}
