//! Tests of the gate, which judges the model checker's report, on a recorded report. In it harnesses (proofs) end in every possible
//! way (`fixtures/every_end.rs`).

use super::*;
use report::Answer;

/// Most memory that a harness (proof) may use in these tests, in KiB.
const MEMORY_KIB: u64 = 8 << 20;

fn recorded() -> BTreeMap<String, Verdict> {
    report::read(include_str!("fixtures/every-end.json")).expect("a report")
}

fn answer(name: &str) -> Answer {
    recorded()[name].answer.clone()
}

/// The reason that the report's reader gives for rejecting a harness (proof) that the model checker called successful.
fn empty(name: &str) -> String {
    match answer(name) {
        Answer::Empty(why) => why,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn only_one_harness_of_all_is_proved() {
    let found = recorded();
    assert_eq!(found.len(), 10);
    let proved: Vec<_> = found
        .iter()
        .filter(|(_, verdict)| verdict.proved())
        .collect();
    assert_eq!(proved.len(), 1);
    let (name, verdict) = proved[0];
    assert_eq!(name, "w8::proved");
    assert_eq!(
        (verdict.covers, verdict.solver.as_str()),
        ((1, 1), "cadical")
    );
    assert!(verdict.program.contains("__R"), "{}", verdict.program);
    // Each of the other nine harnesses has one fault.
    assert_eq!(wrong(&found, MEMORY_KIB).len(), 9);
}

/// Checks that the gate rejects harnesses (proofs) that the model checker calls successful although they prove nothing.
#[test]
fn a_success_that_says_nothing_is_none() {
    assert!(empty("w8::cover_unsatisfiable").starts_with("cover not reached: larger"));
    let at = |line| format!("cover not reached: assertion reached (proofs/src/lib.rs:{line})");
    assert_eq!(empty("w8::assertion_unreachable"), at(46));
    assert_eq!(empty("w8::impossible_assumption"), at(37));
    assert!(empty("w8::assertion_not_asked").starts_with("not asked whether it is reached: "));
    assert_eq!(empty("w8::no_cover"), "no cover");
    assert_eq!(empty("w8::no_assertion"), "no assertion");
}

/// The recorded report without the checks that `dropped` selects.
fn recorded_but(dropped: impl Fn(&serde_json::Value) -> bool) -> BTreeMap<String, Verdict> {
    let mut all: serde_json::Value =
        serde_json::from_str(include_str!("fixtures/every-end.json")).expect("JSON");
    let results = all["verification_results"]["results"].as_array_mut();
    for result in results.expect("results") {
        let checks = result["checks"].as_array_mut().expect("checks");
        checks.retain(|check| !dropped(check));
    }
    report::read(&all.to_string()).expect("a report")
}

#[test]
fn a_cover_after_it_shows_an_assertion_and_one_before_it_does_not() {
    let found = recorded_but(|check| check["description"] == "assertion reached");
    assert_eq!(found["w8::proved"].answer, Answer::Proved);
    let not_asked = |name: &str| matches!(&found[name].answer, Answer::Empty(why) if why.starts_with("not asked"));
    assert!(not_asked("w8::assertion_unreachable") && not_asked("w8::assertion_not_asked"));
}

#[test]
fn a_failed_assertion_is_a_refutation_and_nothing_else_is() {
    assert!(matches!(answer("w8::refuted"), Answer::Refuted(what) if what.contains("x / 2 < x")));
    assert_eq!(answer("w8::out_of_time"), Answer::TimedOut);
    assert!(
        matches!(answer("w8::loop_cut_short"), Answer::Unknown(why) if why.contains("unwinding"))
    );
}

/// Checks that a mutant (a wrong change of the code) counts as caught only if an assertion of the named harness (proof) failed and
/// the harness ran alone.
#[test]
fn a_mutant_is_caught_by_its_own_harness_only() {
    let only = |name: &str| BTreeMap::from([(name.to_string(), recorded()[name].clone())]);
    assert_eq!(is_refuted(&only("w8::refuted"), "w8::refuted"), Ok(true));
    assert_eq!(is_refuted(&only("w8::proved"), "w8::proved"), Ok(false));
    for name in [
        "w8::out_of_time",
        "w8::loop_cut_short",
        "w8::cover_unsatisfiable",
        "w8::assertion_unreachable",
    ] {
        assert!(is_refuted(&only(name), name).is_err(), "{name}");
    }
    let mut by_a_check = only("w8::refuted");
    by_a_check.values_mut().for_each(|it| it.own_failed = false);
    assert!(is_refuted(&by_a_check, "w8::refuted").is_err());
    assert!(is_refuted(&only("w8::refuted"), "w8::proved").is_err());
    assert!(is_refuted(&recorded(), "w8::refuted").is_err());
    assert!(is_refuted(&BTreeMap::new(), "w8::refuted").is_err());
}

#[test]
fn the_lock_is_the_list_of_what_runs() {
    // No source is read in this test, so every hash is zero.
    let found = recorded();
    let nothing = Statements::of_nothing();
    let all: String = found.keys().map(|name| nothing.line(name) + "\n").collect();
    let against = |locked: &str| against_lock(&found, &BTreeSet::new(), locked, &nothing);
    assert!(against(&all).is_empty());
    let gone = against(&format!("{all}{}\n", nothing.line("w8::gone")));
    assert_eq!(
        gone,
        ["w8::gone: in proofs/harnesses.lock, but did not run"]
    );
    let new = against(&all.replace(&(nothing.line("w8::refuted") + "\n"), ""));
    assert_eq!(
        new,
        ["w8::refuted: ran, but is not in proofs/harnesses.lock (--bless adds it)"]
    );
    // A name that is only a part of another name is a different harness.
    assert_eq!(
        against(&all.replace("w8::refuted ", "w8::refute ")).len(),
        2
    );
    // A statement with another hash is another statement.
    let other = all.replace("w8::refuted 0", "w8::refuted 1");
    assert_eq!(against(&other).len(), 1);
    assert!(against(&other)[0].contains("states something else"));
}

#[test]
fn too_long_and_too_large_are_faults() {
    let with = |processor_s, memory_kib| {
        let usage = Some(Usage {
            memory_kib,
            processor_s,
        });
        let verdict = Verdict {
            usage,
            ..recorded()["w8::proved"].clone()
        };
        wrong(&BTreeMap::from([("a".to_string(), verdict)]), MEMORY_KIB).len()
    };
    assert_eq!(with(PROCESSOR_S, MEMORY_KIB), 0);
    assert_eq!(with(PROCESSOR_S + 0.5, 0), 1);
    assert_eq!(with(1.0, MEMORY_KIB + 1), 1);
    // Without a measurement the wall-clock time counts as processor time.
    let by_clock = |seconds| {
        let verdict = Verdict {
            usage: None,
            seconds,
            ..recorded()["w8::proved"].clone()
        };
        wrong(&BTreeMap::from([("a".to_string(), verdict)]), MEMORY_KIB).len()
    };
    assert_eq!(by_clock(PROCESSOR_S), 0);
    assert_eq!(by_clock(PROCESSOR_S + 0.5), 1);
}

#[test]
fn no_report_and_an_empty_one_are_not_a_pass() {
    assert!(report::read("").is_err());
    assert!(report::read("{}").is_err());
    let none = report::read(r#"{"verification_results": {"results": []}}"#).expect("a report");
    assert!(matches!(
        say(&none, wrong(&none, MEMORY_KIB)),
        super::Answer::Wrong(_)
    ));
}

/// Checks that a status which the reader of the model checker's report does not know does not count as success.
#[test]
fn an_unknown_status_is_no_answer() {
    let text = include_str!("fixtures/every-end.json").replace(
        "\"Success\",\n      \"description\"",
        "\"Guessed\",\n      \"description\"",
    );
    let found = report::read(&text).expect("a report");
    assert!(!found["w8::proved"].proved());
}
