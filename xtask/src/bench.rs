//! `cargo xtask bench [EXAMPLE [TICKS MORE_TICKS]] [-- ARGS]`: counts the instructions per control period (tick) of an example of
//! `host-sim/sim`. `bench --ladder [--write]` counts every simulated effect alone and in pairs ([`ladder`]).
//!
//! `EXAMPLE ARGS… TICKS` runs twice under valgrind's callgrind, with few and with more ticks. Instructions per tick are the
//! difference of the two instruction counts divided by the difference of the ticks. This removes the cost of start-up and, unlike a
//! wall clock, does not depend on the load of the machine. Without ARGS, each configuration that `EXAMPLE --list` prints is
//! counted.

use std::path::Path;

use crate::counted::{built, instructions, per_tick};
use crate::outcome::Outcome;
use crate::{ladder, packages, shell};

/// Most instructions per tick that a configuration may take. `held-guarded-f64` (simulated motor, encoder, control law and guard in
/// double precision) takes 388; the rest is a margin of 5 % for other compilers.
const LIMITS: &[(&str, f64)] = &[("held-guarded-f64", 407.0)];

/// The example program to count, its two numbers of ticks and its arguments.
#[derive(Debug, PartialEq, Eq)]
struct Plan {
    example: String,
    ticks: [u64; 2],
    args: Vec<String>,
}

impl Plan {
    /// Parses the command's arguments. Without arguments, the plan is the example `tick_cost` with 10 000 and 110 000 ticks.
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

pub fn run(words: &[String]) -> Outcome {
    if let [first, rest @ ..] = words
        && first == "--ladder"
    {
        return ladder::run(rest);
    }
    let Some(plan) = Plan::parse(words) else {
        let usage = "cargo xtask bench [EXAMPLE [TICKS MORE_TICKS]] [-- ARGS], TICKS below MORE_TICKS, or bench --ladder [--write]";
        return Outcome::Usage(usage.into());
    };
    let folder = shell::root().join("host-sim/sim/examples");
    let source = folder.join(format!("{}.rs", plan.example));
    if !source.is_file() && !folder.join(&plan.example).join("main.rs").is_file() {
        return Outcome::Failed(format!("host-sim/sim has no example `{}`", plan.example));
    }
    if let Some(missing) = packages::missing_valgrind() {
        return missing;
    }
    let counted = count_all(&plan).unwrap_or_else(|failed| failed);
    // Without arguments, as in the test runs, the pairs of effects are measured too. Effects that a scene leaves out must cost
    // nothing, and no tick may allocate memory.
    if words.is_empty() && !counted.is_failure() {
        return ladder::run(&[]);
    }
    counted
}

/// Counts the instructions of the configuration that the arguments name; without arguments, of each configuration that the example
/// lists.
fn count_all(plan: &Plan) -> Result<Outcome, Outcome> {
    let binary = built(&plan.example)?;
    let listed = shell::capture(shell::program(&binary).arg("--list")).unwrap_or_default();
    let configurations: Vec<Vec<String>> = if plan.args.is_empty() && !listed.is_empty() {
        listed.lines().map(|name| vec![name.to_owned()]).collect()
    } else {
        vec![plan.args.clone()]
    };
    let mut costs = Vec::new();
    for args in &configurations {
        let cost = count(plan, &binary, args)?;
        let words = [&[plan.example.clone()][..], args].concat().join(" ");
        println!("{words:<32}{cost:>10.1} instructions per tick");
        if let Some(limit) = beyond_limit(args, cost) {
            return Err(Outcome::Failed(format!(
                "{words}: {cost:.1} instructions per tick, more than the {limit} it may cost"
            )));
        }
        costs.push(cost);
    }
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let most = costs.iter().copied().fold(0.0, f64::max);
    Ok(Outcome::Ok(if costs.len() == 1 {
        format!("{most:.1} instructions per tick")
    } else {
        format!(
            "{least:.1} to {most:.1} instructions per tick, {} configurations",
            costs.len()
        )
    }))
}

/// Returns the limit of a configuration, in instructions per tick, if its cost exceeds that limit; otherwise `None`.
fn beyond_limit(args: &[String], cost: f64) -> Option<f64> {
    let name = args.first()?;
    LIMITS
        .iter()
        .find_map(|(limited, limit)| (limited == name && cost > *limit).then_some(*limit))
}

fn count(plan: &Plan, binary: &Path, args: &[String]) -> Result<f64, Outcome> {
    let folder = shell::target("bench");
    std::fs::create_dir_all(&folder)
        .map_err(|error| Outcome::Failed(format!("{}: {error}", folder.display())))?;
    let mut counted = [0; 2];
    for (count, ticks) in counted.iter_mut().zip(plan.ticks) {
        let out = folder.join(format!("{}.callgrind", plan.example));
        *count = callgrind(binary, ticks, args, &out)?;
    }
    Ok(per_tick(plan.ticks, counted))
}

fn callgrind(binary: &Path, ticks: u64, args: &[String], out: &Path) -> Result<u64, Outcome> {
    // Removes an old count, which must not be read if this run fails.
    let _ = std::fs::remove_file(out);
    let mut command = shell::program("valgrind");
    command
        .args(["--quiet", "--tool=callgrind"])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(binary)
        .args(args)
        .arg(ticks.to_string());
    if shell::capture(&mut command).is_none() {
        let words = [args, &[ticks.to_string()]].concat().join(" ");
        return Err(Outcome::Failed(format!(
            "`{} {words}` failed under valgrind",
            binary.display()
        )));
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
    fn a_limit_can_be_exceeded() {
        let name = |word: &str| [word.to_owned()];
        assert_eq!(beyond_limit(&name("held-guarded-f64"), 407.1), Some(407.0));
        assert_eq!(beyond_limit(&name("held-guarded-f64"), 407.0), None);
        assert_eq!(beyond_limit(&name("held-shipped"), 1e4), None);
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
