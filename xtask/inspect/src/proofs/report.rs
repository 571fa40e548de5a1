//! Reads the model checker's report: the verdict on each harness (proof), and why a harness counts as proved.
//!
//! The checker also calls a harness successful if an assumption was impossible, or if a cover or an assertion was never reached. (A
//! cover is a statement that the checker must be able to reach.) So the checker's own verdict is only one of the conditions here.
//!
//! The checker's own test whether each assertion can be reached is switched off. It would also test the assertions in the code,
//! which takes a quarter of the checker's time. Instead each assertion of a property needs a cover, in one of two ways:
//! - A cover comes after the assertion in the same block and can only be reached through it ([`super::shown`] checks this in the
//!   sources).
//! - The assertion contains a cover (`assert_reached!` in `proofs/src/lib.rs`).
//!
//! A harness with an assertion that has neither does not count as proved.

use std::collections::BTreeMap;

use serde_json::Value;

use super::usage::Usage;

/// Description of the cover (a statement that must be reachable) in `assert_reached!`, for assertions that no other cover follows.
const REACHED: &str = "assertion reached";

/// How the model checker's run of one harness (proof) ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Every check holds, every cover (statement that must be reachable) was reached, and every assertion of the property can be
    /// reached.
    Proved,
    /// A check failed; the text names the first failed check and its place.
    Refuted(String),
    /// Every check holds, but may hold only because code is unreachable; the text names what could not be reached.
    Empty(String),
    /// The model checker gave no answer within the time limit of a harness (proof).
    TimedOut,
    /// The checker gave no answer for another reason, such as too little memory, a crash of a solver, or a check without a verdict.
    Unknown(String),
}

/// The model checker's result for one harness (proof).
#[derive(Debug, Clone)]
pub struct Verdict {
    pub answer: Answer,
    /// Whether an assertion of the property itself failed, not only a check that the compiler or the model checker inserted.
    pub own_failed: bool,
    pub covers: (usize, usize),
    /// Wall-clock time that the harness (proof) took, in seconds.
    pub seconds: f64,
    /// Name of the solver that decided the harness (proof).
    pub solver: String,
    /// Name of the file on which the checker's tools worked, without endings. It shows which processes belong to the harness
    /// (proof).
    pub program: String,
    /// Memory and processor time of the checker's tools; `None` if they were not measured.
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

/// The results of all harnesses (proofs) in a report, by the harness's name. Errors: the text is not such a report, or has two
/// results for a harness.
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
    // A loop that the checker did not follow to its end gives neither a proof nor a refutation.
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
    // Several assertions in one macro may have the same place. That place must then have at least as many covers as assertions.
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

/// Whether a check in the report is an `assert!` in a property, and not a check that the compiler or the model checker inserted.
fn own_assertion(check: &Value) -> bool {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_string();
    check["category"] == "assertion"
        && text(&check["location"]["file"]).contains("proofs/src/")
        && text(&check["description"]).starts_with("assertion failed")
}
