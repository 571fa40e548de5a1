//! `cargo xtask bench [EXAMPLE [TICKS MORE_TICKS]] [-- ARGS]`: instructions per tick of an example of `host-sim`.
//!
//! The example is called as `EXAMPLE TICKS ARGS…` twice under valgrind's callgrind, with few and with more ticks; the
//! difference of the instruction counts over the difference of the ticks is free of start-up, and, unlike a wall clock,
//! the same on a busy machine.

use std::path::Path;

use crate::outcome::Outcome;
use crate::{setup, shell};

/// What to count.
#[derive(Debug, PartialEq, Eq)]
struct Plan {
    example: String,
    ticks: [u64; 2],
    args: Vec<String>,
}

impl Plan {
    /// Without words: what a tick of the simulator costs.
    fn parse(words: &[String]) -> Option<Plan> {
        let end = words.iter().position(|word| word == "--");
        let (own, args) = match end {
            Some(at) => (&words[..at], words[at + 1..].to_vec()),
            None => (words, Vec::new()),
        };
        let (example, ticks) = match own {
            [] => ("tick_cost", [10_000, 110_000]),
            [example] => (example.as_str(), [10_000, 110_000]),
            [example, few, more] => (example.as_str(), [few.parse().ok()?, more.parse().ok()?]),
            _ => return None,
        };
        (ticks[0] < ticks[1]).then(|| Plan {
            example: example.into(),
            ticks,
            args,
        })
    }
}

/// Instructions in all, from callgrind's output file.
fn instructions(file: &str) -> Option<u64> {
    let value = |key| {
        file.lines()
            .find_map(|line: &str| line.strip_prefix(key)?.trim().parse().ok())
    };
    value("totals:").or_else(|| value("summary:"))
}

/// `(Ir(n2) - Ir(n1)) / (n2 - n1)`.
fn per_tick(ticks: [u64; 2], counted: [u64; 2]) -> f64 {
    (counted[1] as f64 - counted[0] as f64) / (ticks[1] - ticks[0]) as f64
}

pub fn run(words: &[String]) -> Outcome {
    let Some(plan) = Plan::parse(words) else {
        let usage =
            "cargo xtask bench [EXAMPLE [TICKS MORE_TICKS]] [-- ARGS], TICKS below MORE_TICKS";
        return Outcome::Usage(usage.into());
    };
    let source = format!("host-sim/examples/{}.rs", plan.example);
    if !shell::root().join(&source).is_file() {
        let reason = format!("there is no {source}");
        // Asked for by name, a missing example is a mistake; as a step of the tests it is something not there yet.
        return if words.is_empty() {
            Outcome::NotRun(reason)
        } else {
            Outcome::Failed(reason)
        };
    }
    if let Some(missing) = setup::missing_valgrind() {
        return missing;
    }
    match count(&plan) {
        Ok(cost) => {
            let words = [&[plan.example.clone()][..], &plan.args].concat().join(" ");
            println!("{words}: {cost:.1} instructions per tick");
            Outcome::Ok(format!("{cost:.1} instructions per tick"))
        }
        Err(failed) => failed,
    }
}

fn count(plan: &Plan) -> Result<f64, Outcome> {
    let mut build = shell::cargo_locked("build");
    build.args(["--release", "--package", "touchstone", "--example"]);
    let built = shell::run(build.arg(&plan.example));
    if built.is_failure() {
        return Err(built);
    }
    let folder = shell::target("bench");
    std::fs::create_dir_all(&folder)
        .map_err(|error| Outcome::Failed(format!("{}: {error}", folder.display())))?;
    let binary = shell::target("release/examples").join(&plan.example);
    let mut counted = [0; 2];
    for (count, ticks) in counted.iter_mut().zip(plan.ticks) {
        let out = folder.join(format!("{}-{ticks}.callgrind", plan.example));
        *count = callgrind(&binary, ticks, &plan.args, &out)?;
    }
    Ok(per_tick(plan.ticks, counted))
}

fn callgrind(binary: &Path, ticks: u64, args: &[String], out: &Path) -> Result<u64, Outcome> {
    // An old count must not stand in for one that failed.
    let _ = std::fs::remove_file(out);
    let mut command = shell::program("valgrind");
    command
        .args(["--quiet", "--tool=callgrind"])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(binary)
        .arg(ticks.to_string())
        .args(args);
    let ran = shell::run(&mut command);
    if ran.is_failure() {
        return Err(ran);
    }
    std::fs::read_to_string(out)
        .ok()
        .and_then(|text| instructions(&text))
        .ok_or_else(|| Outcome::Failed(format!("no totals in {}", out.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(words: &str) -> Option<Plan> {
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        Plan::parse(&words)
    }

    #[test]
    fn words_become_a_plan() {
        assert_eq!(plan("").unwrap().example, "tick_cost");
        let full = plan("knob 100 300 -- enhanced-sfa --logged").unwrap();
        assert_eq!(full.example, "knob");
        assert_eq!(full.ticks, [100, 300]);
        assert_eq!(full.args, ["enhanced-sfa", "--logged"]);
        for wrong in ["knob 100", "knob 300 100", "knob 100 100", "knob a b"] {
            assert_eq!(plan(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn totals_are_read_and_differenced() {
        let file = |count| {
            format!(
                "# callgrind format\nevents: Ir\nsummary: {count}\nfn=(1) main\n5 100\ntotals: {count}\n"
            )
        };
        let counted = [1_000_500, 2_000_500].map(|count| instructions(&file(count)).unwrap());
        assert_eq!(per_tick([1_000, 11_000], counted), 100.0);
        assert_eq!(instructions("events: Ir\nsummary: 12\n"), Some(12));
        assert_eq!(instructions("events: Ir\n"), None);
    }
}
