//! `cargo xtask test [--quick]`: every step of the table in order, each to its end, then a summary.

use std::fmt::Write;
use std::time::{Duration, Instant};

use crate::outcome::Outcome;
use crate::step::{InTest, Quick, Step};

/// One finished step.
struct Done {
    name: &'static str,
    outcome: Outcome,
    took: Duration,
}

pub fn run(all: &[Step], args: &[String]) -> Outcome {
    let mut steps: Vec<(&Step, Vec<String>)> = all
        .iter()
        .filter_map(|step| step.in_test.args().map(|args| (step, args)))
        .collect();
    let is_quick = match args {
        [] => false,
        [option] if option == "--quick" => true,
        _ => {
            let names: Vec<_> = steps.iter().map(|(step, _)| step.name).collect();
            return Outcome::Usage(format!(
                "cargo xtask test [--quick]; single steps are commands: {}",
                names.join(", ")
            ));
        }
    };
    if is_quick {
        steps.retain(|(step, _)| step.quick != Quick::LeftOut);
    }
    let start = Instant::now();
    let mut done = Vec::new();
    for (index, (step, whole)) in steps.iter().enumerate() {
        println!("\n==> [{}/{}] {}", index + 1, steps.len(), step.name);
        let args = match step.quick {
            Quick::Part(option, _) if is_quick => vec![option.to_owned()],
            _ => whole.clone(),
        };
        let begun = Instant::now();
        let outcome = (step.run)(&args);
        let took = begun.elapsed();
        println!("<== {} {}: {outcome}", step.name, seconds(took));
        done.push(Done {
            name: step.name,
            outcome,
            took,
        });
    }
    println!("\n{}", table(&done));
    if is_quick {
        println!("left out by --quick:\n{}", left_out(all));
    }
    verdict(&done, start.elapsed())
}

/// What `--quick` leaves out of the steps, a line each.
pub fn left_out(all: &[Step]) -> String {
    let mut text = String::new();
    for step in all.iter().filter(|step| step.in_test != InTest::No) {
        if let Some(what) = step.quick.left_out() {
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

    /// Nothing is left out without a word.
    #[test]
    fn what_is_quick_names_what_it_leaves_out() {
        let step = |name, quick| Step {
            name,
            about: "",
            in_test: InTest::Whole,
            quick,
            run: |args| Outcome::Ok(args.join(" ")),
        };
        let steps = [
            step("whole", Quick::Whole),
            step("part", Quick::Part("--quick", "the slow half")),
            step("none", Quick::LeftOut),
        ];
        assert_eq!(
            left_out(&steps),
            "  part       the slow half\n  none       all of it\n"
        );
        assert_eq!(run(&steps, &["--quick".into()]).word(), "ok");
        assert_eq!(run(&steps, &["--quik".into()]).word(), "usage");
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
