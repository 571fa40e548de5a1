//! `cargo xtask test [--quick | --full]`: runs the steps of a gate (test run of one extent) in the order of the table, then prints
//! a summary.

use std::fmt::Write;
use std::time::{Duration, Instant};

use crate::ahead;
use crate::outcome::Outcome;
use crate::step::{Gate, Step};

/// A step that was run, with its outcome and running time.
struct Done {
    name: &'static str,
    outcome: Outcome,
    took: Duration,
}

/// Options of `cargo xtask test`, with the gate (test run of one extent) that each selects.
const GATES: [(&[&str], Gate); 3] = [
    (&[], Gate::Test),
    (&["--quick"], Gate::Quick),
    (&["--full"], Gate::Full),
];

pub fn run(all: &[Step], args: &[String]) -> Outcome {
    let Some((_, gate)) = GATES.iter().find(|(words, _)| args == *words) else {
        let tested = all.iter().filter(|step| step.gates.is_tested());
        let names: Vec<_> = tested.map(|step| step.name).collect();
        return Outcome::Usage(format!(
            "cargo xtask test [--quick | --full]; single steps are commands: {}",
            names.join(", ")
        ));
    };
    let steps: Vec<(&Step, Vec<String>)> = all
        .iter()
        .filter_map(|step| step.gates.of(*gate).args().map(|args| (step, args)))
        .collect();
    let start = Instant::now();
    let (mut done, mut ahead) = (Vec::new(), None);
    for (index, (step, args)) in steps.iter().enumerate() {
        println!("\n==> [{}/{}] {}", index + 1, steps.len(), step.name);
        let begun = Instant::now();
        let outcome = (step.run)(args);
        let took = begun.elapsed();
        println!("<== {} {}: {outcome}", step.name, seconds(took));
        done.push(Done {
            name: step.name,
            outcome,
            took,
        });
        // After the step that looks for what compiling needs. A quick run needs nothing of it, a night is long enough.
        if step.name == "setup" && *gate == Gate::Test {
            ahead = Some(ahead::start());
        }
    }
    // Every step has ended, so only compiling that no step waited for can still run.
    let _ = ahead.map(std::thread::JoinHandle::join);
    println!("\n{}", table(&done));
    let rest = left_out(all, *gate);
    if !rest.is_empty() {
        println!("left out ({}):\n{rest}", whole(*gate));
    }
    verdict(&done, start.elapsed())
}

/// Sentence that names the commands for what a gate (test run of one extent) leaves out.
fn whole(gate: Gate) -> &'static str {
    match gate {
        Gate::Quick => "`cargo xtask test` runs more, `cargo xtask test --full` nearly all",
        Gate::Test => "`cargo xtask test --full` runs nearly all of it",
        Gate::Full => "each step's own command runs it",
    }
}

/// List of what a gate (test run) leaves out, one line per step.
pub fn left_out(all: &[Step], gate: Gate) -> String {
    let mut text = String::new();
    for step in all.iter().filter(|step| step.gates.is_tested()) {
        if let Some(what) = step.gates.of(gate).left_out() {
            let _ = writeln!(text, "  {:<11}{what}", step.name);
        }
    }
    text
}

fn seconds(took: Duration) -> String {
    format!("{:.1} s", took.as_secs_f64())
}

fn table(done: &[Done]) -> String {
    let mut text = format!("{:<12}{:<9}{:>10}\n", "step", "result", "time");
    for step in done {
        let _ = writeln!(
            text,
            "{:<12}{:<9}{:>10}  {}",
            step.name,
            step.outcome.word(),
            seconds(step.took),
            step.outcome.reason()
        );
    }
    text
}

fn verdict(done: &[Done], took: Duration) -> Outcome {
    let names = |wanted: fn(&Outcome) -> bool| {
        let names: Vec<_> = done
            .iter()
            .filter(|step| wanted(&step.outcome))
            .map(|step| step.name)
            .collect();
        names.join(", ")
    };
    let failed = names(Outcome::is_failure);
    if !failed.is_empty() {
        return Outcome::Failed(failed);
    }
    let not_run = names(|outcome| matches!(outcome, Outcome::NotRun(_)));
    let rest = if not_run.is_empty() {
        String::new()
    } else {
        format!("; not run: {not_run}")
    };
    Outcome::Ok(format!("in {}{rest}", seconds(took)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::{Gates, Share};

    fn done(outcomes: &[Outcome]) -> Vec<Done> {
        let names = ["first", "second", "third"];
        names
            .into_iter()
            .zip(outcomes)
            .map(|(name, outcome)| Done {
                name,
                outcome: outcome.clone(),
                took: Duration::from_millis(1250),
            })
            .collect()
    }

    /// Checks that the list of what a gate (test run) leaves out names each left-out part.
    #[test]
    fn a_gate_names_what_it_leaves_out() {
        let step = |name, gates| Step {
            name,
            about: "",
            gates,
            run: |args| Outcome::Ok(args.join(" ")),
        };
        let steps = [
            step("whole", Gates::ALL),
            step("part", Gates::part(&["--some"], "the slow half")),
            step("night", Gates::FULL_ONLY),
            step("never", Gates::NONE),
        ];
        let of_test = "  part       the slow half\n  night      all of it\n";
        assert_eq!(left_out(&steps, Gate::Test), of_test);
        assert_eq!(left_out(&steps, Gate::Quick), of_test);
        assert_eq!(left_out(&steps, Gate::Full), "");
        for (words, _) in GATES {
            let words: Vec<_> = words.iter().map(|word| (*word).to_owned()).collect();
            assert_eq!(run(&steps, &words).word(), "ok");
        }
        assert_eq!(run(&steps, &["--quik".into()]).word(), "usage");
        assert_eq!(
            run(&steps, &["--quick".into(), "--full".into()]).word(),
            "usage"
        );
    }

    /// Checks that `cargo xtask test --full` runs every step of the shorter test runs, and that each step of which a part is run
    /// has arguments.
    #[test]
    fn the_full_gate_has_every_step_of_the_others() {
        for step in crate::STEPS {
            let gates = step.gates;
            let runs = |gate| gates.of(gate) != Share::LeftOut;
            assert!(runs(Gate::Full) || !runs(Gate::Test), "{}", step.name);
            assert!(runs(Gate::Test) || !runs(Gate::Quick), "{}", step.name);
            for gate in [Gate::Quick, Gate::Test, Gate::Full] {
                if let Share::Part(args, what) = gates.of(gate) {
                    assert!(!args.is_empty() && !what.is_empty(), "{}", step.name);
                }
            }
        }
    }

    #[test]
    fn one_failure_fails_the_run_and_is_named() {
        let steps = done(&[
            Outcome::Ok("12 tests".into()),
            Outcome::Failed("broke".into()),
            Outcome::NotRun("no valgrind".into()),
        ]);
        assert_eq!(
            verdict(&steps, Duration::ZERO),
            Outcome::Failed("second".into())
        );
        let table = table(&steps);
        assert_eq!(table.lines().count(), 4);
        assert!(table.contains("FAILED        1.2 s  broke"), "{table}");
        assert!(
            table.contains("not run       1.2 s  no valgrind"),
            "{table}"
        );
    }

    #[test]
    fn what_was_not_run_is_named_and_does_not_fail_the_run() {
        let steps = done(&[Outcome::Ok(String::new()), Outcome::NotRun("why".into())]);
        assert_eq!(
            verdict(&steps, Duration::from_secs(2)),
            Outcome::Ok("in 2.0 s; not run: second".into())
        );
    }
}
