//! What the checker's report says about each harness, and why a harness counts as proved.
//!
//! The checker calls a harness successful also when an assumption was impossible, when a cover was never reached and when an
//! assertion could not be reached. So its own verdict is only one of the conditions here.
//!
//! The checker's own question whether an assertion can be reached is switched off: it asks it of every one in the code too, which takes
//! a quarter of the time. Each of a property has a cover after it in its block, which is reached by way of it ([`super::shown`] reads that in
//! the sources), or is a cover as well (`assert_reached!` in `proofs/src/lib.rs`). One with neither does not count.

use std::collections::BTreeMap;

use serde_json::Value;

use super::usage::Usage;

/// The cover that stands before an assertion of a property after which no other comes.
const REACHED: &str = "assertion reached";

/// How the checker's run of one harness ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Every check holds, every cover was reached, every assertion of the property can be reached.
    Proved,
    /// An assertion does not hold; the first one, with its place.
    Refuted(String),
    /// Every check holds, but that may mean nothing; what could not be reached.
    Empty(String),
    /// No answer within the time of a harness.
    TimedOut,
    /// No answer for another reason: memory, a solver's crash, a check without a verdict.
    Unknown(String),
}

/// One harness of a run.
#[derive(Debug, Clone)]
pub struct Verdict {
    pub answer: Answer,
    /// Whether an assertion of the property itself failed, not only a check that the compiler or the checker put in.
    pub own_failed: bool,
    pub covers: (usize, usize),
    /// Duration by the clock, s.
    pub seconds: f64,
    /// The solver that ran.
    pub solver: String,
    /// Name of the file that the checker's tools worked on, by which processes are recognised.
    pub program: String,
    /// Memory and time of the tools, where they could be measured.
    pub usage: Option<Usage>,
}

impl Verdict {
    pub fn proved(&self) -> bool {
        self.answer == Answer::Proved
    }
    /// The verdict in a few words.
    pub fn words(&self) -> String {
        match &self.answer {
            Answer::Proved => "proved".into(),
            Answer::Refuted(what) => format!("refuted: {what}"),
            Answer::Empty(what) => format!("holds, but may say nothing: {what}"),
            Answer::TimedOut => "no answer in time".into(),
            Answer::Unknown(why) => format!("no answer: {why}"),
        }
    }
}

/// All harnesses of a report, by name.
pub fn read(text: &str) -> Result<BTreeMap<String, Verdict>, String> {
    let report: Value =
        serde_json::from_str(text).map_err(|why| format!("the checker's report: {why}"))?;
    let results = report["verification_results"]["results"]
        .as_array()
        .ok_or("the checker's report has no results")?;
    let of = |list: &Value, name: &str| -> Value {
        let key = if list
            .as_array()
            .is_some_and(|all| all.iter().any(|row| row["pretty_name"].is_string()))
        {
            "pretty_name"
        } else {
            "harness_id"
        };
        let rows = list.as_array().map_or(&[][..], Vec::as_slice);
        rows.iter()
            .find(|row| row[key] == name)
            .cloned()
            .unwrap_or_default()
    };
    let mut found = BTreeMap::new();
    for result in results {
        let name = result["harness_id"]
            .as_str()
            .ok_or("a result without a harness")?;
        let errors = of(&report["error_details"], name);
        let checks = result["checks"].as_array().map_or(&[][..], Vec::as_slice);
        let covers: Vec<_> = checks
            .iter()
            .filter(|check| check["category"] == "cover" && check["description"] != REACHED)
            .collect();
        let reached = covers
            .iter()
            .filter(|cover| cover["status"] == "Satisfied")
            .count();
        let metadata = of(&report["harness_metadata"], name);
        let file = metadata["goto_file"].as_str().unwrap_or_default();
        let file = file.rsplit('/').next().unwrap_or_default();
        let verdict = Verdict {
            answer: answer(result, &errors, checks),
            own_failed: checks
                .iter()
                .any(|check| own_assertion(check) && check["status"] == "Failure"),
            covers: (reached, covers.len()),
            seconds: result["duration_ms"].as_f64().unwrap_or_default() / 1e3,
            solver: of(&report["cbmc"], name)["configuration"]["solver"]
                .as_str()
                .unwrap_or("?")
                .into(),
            program: file.split('.').next().unwrap_or_default().into(),
            usage: None,
        };
        if found.insert(name.to_string(), verdict).is_some() {
            return Err(format!("two results for {name}"));
        }
    }
    Ok(found)
}

fn answer(result: &Value, errors: &Value, checks: &[Value]) -> Answer {
    let place = |check: &Value| {
        let text = |value: &Value| value.as_str().unwrap_or("?").replace('\n', " ");
        let location = &check["location"];
        format!(
            "{} ({}:{})",
            text(&check["description"]),
            text(&location["file"]),
            text(&location["line"])
        )
    };
    match errors["exit_status"].as_str() {
        Some("timeout") => return Answer::TimedOut,
        Some("properties_failed") | None => {}
        Some(other) => return Answer::Unknown(other.into()),
    }
    let status = |check: &Value| check["status"].as_str().unwrap_or_default().to_string();
    // A loop that was cut short says nothing about the code: neither proof nor refutation.
    if let Some(cut) = checks
        .iter()
        .find(|check| status(check) == "Failure" && check["category"] == "unwind")
    {
        return Answer::Unknown(format!(
            "a loop was not followed to its end: {}",
            place(cut)
        ));
    }
    if let Some(failed) = checks.iter().find(|check| status(check) == "Failure") {
        return match failed["category"].as_str() {
            Some("unsupported_construct") => Answer::Unknown(place(failed)),
            _ => Answer::Refuted(place(failed)),
        };
    }
    if result["status"] != "Success" {
        return Answer::Unknown("not successful, and no check failed".into());
    }
    let is_cover = |check: &&Value| check["category"] == "cover";
    let is_reached = |check: &&Value| is_cover(check) && check["description"] == REACHED;
    for check in checks {
        match (status(check).as_str(), is_cover(&check)) {
            ("Success", false) | ("Satisfied", true) => {}
            (_, true) => return Answer::Empty(format!("cover not reached: {}", place(check))),
            (other, false) => return Answer::Unknown(format!("{other}: {}", place(check))),
        }
    }
    if checks
        .iter()
        .filter(is_cover)
        .all(|check| is_reached(&check))
    {
        return Answer::Empty("no cover".into());
    }
    // Several in one macro may have one place; then it has as many covers.
    let line = |check: &Value| {
        let line = &check["location"]["line"];
        line.as_u64()
            .or(line.as_str().and_then(|it| it.parse().ok()))
    };
    for check in checks.iter().filter(|check| own_assertion(check)) {
        let after =
            |other: &Value| other["function"] == check["function"] && line(other) >= line(check);
        let own = |other: &&Value| is_reached(other) && line(other) == line(check);
        let shows = |other: &&Value| is_cover(other) && !own(other) && after(other);
        if checks.iter().any(|other| shows(&other)) {
            continue;
        }
        let here = |other: &&Value| {
            other["location"] == check["location"] && other["function"] == check["function"]
        };
        let own = |other: &&Value| own_assertion(other);
        let assertions = checks.iter().filter(here).filter(own).count();
        if checks.iter().filter(here).filter(is_reached).count() < assertions {
            return Answer::Empty(format!("not asked whether it is reached: {}", place(check)));
        }
    }
    match checks.iter().any(own_assertion) {
        true => Answer::Proved,
        false => Answer::Empty("no assertion".into()),
    }
}

/// An `assert!` in a property's body, not a check that the compiler or the checker put in.
fn own_assertion(check: &Value) -> bool {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_string();
    check["category"] == "assertion"
        && text(&check["location"]["file"]).contains("proofs/src/")
        && text(&check["description"]).starts_with("assertion failed")
}
