//! Formats the results of the hard cases as a text table for a terminal.

use std::fmt::Write;

use super::{Hard, Outcome};

/// Formats the result of one case as one line of the table.
#[must_use]
pub fn line(outcome: &Outcome) -> String {
    let failing = outcome
        .findings
        .iter()
        .filter(|finding| finding.fails_because.is_some())
        .count();
    let worst = outcome
        .worst()
        .map_or("nothing must hold".to_owned(), |worst| {
            format!(
                "worst {:.2e} of {:.1e} {} ({})",
                worst.value, worst.bound, outcome.unit, worst.subject
            )
        });
    let expected = match failing {
        0 => String::new(),
        count => format!("; {count} fail as expected"),
    };
    format!(
        "{} {:<22} {:>4} {worst}{expected}",
        if outcome.passed { "ok  " } else { "FAIL" },
        outcome.name,
        outcome.findings.len()
    )
}

/// Formats the whole table, followed by the known failures and the unexpected results.
#[must_use]
pub fn render(hard: &Hard) -> String {
    let mut out = String::new();
    let _ = writeln!(
        out,
        "     {:<22} {:>4} worst of those that must hold",
        "case", ""
    );
    for outcome in &hard.cases {
        let _ = writeln!(out, "{}", line(outcome));
    }
    for outcome in &hard.cases {
        let failing = outcome
            .findings
            .iter()
            .filter(|finding| finding.fails_because.is_some());
        for finding in failing {
            let _ = writeln!(
                out,
                "expected: {}, {}: {}{}",
                outcome.name,
                finding.subject,
                finding.fails_because.as_deref().unwrap_or_default(),
                if finding.holds() { ", but it held" } else { "" }
            );
        }
    }
    for outcome in &hard.cases {
        for finding in outcome.surprises() {
            let _ = writeln!(
                out,
                "FAIL {}, {}: {:e} of {:e} {}",
                outcome.name, finding.subject, finding.value, finding.bound, outcome.unit
            );
        }
    }
    let passed = hard.cases.iter().filter(|case| case.passed).count();
    let _ = writeln!(out, "{passed} of {} cases passed", hard.cases.len());
    out
}
