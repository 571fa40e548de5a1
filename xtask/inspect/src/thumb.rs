//! Checks for `cargo xtask thumb`: compares the digests (hashes of results) that this machine and the emulated microcontroller
//! printed. Examines the code that a control period (tick) can reach in the microcontroller's program.

use crate::answer::Answer;
use crate::budgets::{ENHANCED, SPACE};
use crate::cortex::{ProgramCode, is_panic, is_soft_float};
use crate::vectors::Report;

/// Compares the lines that this machine (`desktop`) and the microcontroller printed, and checks the cost of a control period and
/// the code that it can reach.
pub fn inspect(
    program: &ProgramCode,
    desktop: &str,
    microcontroller: &str,
) -> Result<Answer, String> {
    let mut report = Report::default();
    desktop.lines().for_each(|line| report.desktop(line));
    microcontroller
        .lines()
        .for_each(|line| report.microcontroller(line));
    println!("\n{}", report.table());
    let mut wrong = report.differences();
    wrong.extend(examine(program));
    let mut costs = Vec::new();
    for (what, rows, most) in [
        ("enhanced tick", "enhanced", ENHANCED),
        ("tick of three axes", "space", SPACE),
    ] {
        costs.push(
            budget(what, report.worst_of(rows), most).unwrap_or_else(|over| {
                wrong.push(over.clone());
                over
            }),
        );
    }
    let cost = costs.join("; ");
    println!("{cost}");
    for what in &wrong {
        println!("WRONG: {what}");
    }
    Ok(match wrong.len() {
        0 => Answer::Right(format!("{} digests equal; {cost}", report.equal())),
        count => Answer::Wrong(format!("{count} wrong, the first: {}", wrong[0])),
    })
}

/// Returns a sentence on the cost of the most expensive control period, in instructions.
///
/// # Errors
/// The cost exceeds the budget, or was not counted.
fn budget(what: &str, worst: u64, most: u64) -> Result<String, String> {
    match worst {
        0 => Err(format!("no {what} was counted")),
        worst if worst > most => Err(format!(
            "{what} at most {worst} instructions, OVER the budget of {most}"
        )),
        worst => Ok(format!(
            "{what} at most {worst} instructions, within the budget of {most}"
        )),
    }
}

/// Prints the size of the code that each kind of control period can reach. Returns the panics, float operations and calls to an
/// unknown target in that code.
fn examine(program: &ProgramCode) -> Vec<String> {
    let mut wrong = Vec::new();
    println!(
        "{:<42}{:>8}{:>14}",
        "code, with all that it calls", "bytes", "instructions"
    );
    for (function, what) in [
        ("enhanced_fixed32", "enhanced law, 32 bits"),
        ("tick_fixed32", "all laws, 32 bits"),
        ("tick_fixed16", "all laws, 16 bits"),
        ("tick_space", "three axes, 32 bits"),
        (
            "penetration_fixed32",
            "encoder count to penetration, 32 bits",
        ),
    ] {
        let Some(reach) = program.reach(function) else {
            wrong.push(format!("{function} is not in the program"));
            continue;
        };
        println!("{what:<42}{:>8}{:>14}", reach.bytes, reach.instructions);
        let named = |is_bad: fn(&str) -> bool| reach.functions.iter().filter(move |n| is_bad(n));
        wrong.extend(named(is_panic).map(|name| format!("{what}: a panic, {name}")));
        wrong.extend(named(is_soft_float).map(|name| format!("{what}: a float, {name}")));
        wrong.extend(
            reach
                .float_unit
                .iter()
                .map(|place| format!("{what}: the float unit, {place}")),
        );
        wrong.extend(
            reach
                .unknown
                .iter()
                .map(|place| format!("{what}: a call to where? {place}")),
        );
    }
    let anywhere: Vec<_> = program.names().filter(|name| is_soft_float(name)).collect();
    let panics = program.names().filter(|name| is_panic(name)).count();
    println!(
        "in the whole program: {} soft-float functions, {panics} of panics (its printing's)",
        anywhere.len()
    );
    wrong.extend(
        anywhere
            .iter()
            .map(|name| format!("in the program: a float, {name}")),
    );
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the verdict on a cost: at the budget, above the budget, and if no cost was counted.
    #[test]
    fn a_budget_can_be_broken() {
        assert!(budget("tick", 700, 700).is_ok());
        assert!(
            budget("tick", 701, 700).is_err_and(|over| over.contains("OVER the budget of 700"))
        );
        assert!(budget("tick", 0, 700).is_err());
    }
}
