//! `cargo xtask test`: every step of the table in order, each to its end, then a summary.

use std::fmt::Write;
use std::time::{Duration, Instant};

use crate::outcome::Outcome;
use crate::{COMMANDS, Command};

/// One finished step.
struct Done {
    name: &'static str,
    outcome: Outcome,
    took: Duration,
}

pub fn run(args: &[String]) -> Outcome {
    let steps: Vec<&Command> = COMMANDS.iter().filter(|step| step.in_test).collect();
    if !args.is_empty() {
        let names: Vec<_> = steps.iter().map(|step| step.name).collect();
        return Outcome::Usage(format!(
            "cargo xtask test takes no arguments; single steps are commands: {}",
            names.join(", ")
        ));
    }
    let start = Instant::now();
    let mut done = Vec::new();
    for (index, step) in steps.iter().enumerate() {
        println!("\n==> [{}/{}] {}", index + 1, steps.len(), step.name);
        let begun = Instant::now();
        let outcome = (step.run)(&[]);
        let took = begun.elapsed();
        println!("<== {} {}: {outcome}", step.name, seconds(took));
        done.push(Done {
            name: step.name,
            outcome,
            took,
        });
    }
    println!("\n{}", table(&done));
    verdict(&done, start.elapsed())
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
