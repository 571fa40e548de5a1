//! `cargo xtask bench --ladder [--write]`: measures the cost of every effect of a scene file, alone and in pairs, in instructions
//! per control period (tick).
//!
//! One process runs all configurations, each first with few and then with more ticks. Callgrind writes its instruction count at
//! every call of the example's function `mark`. `--write` puts the counts into `host-sim/lab/src/plan/ladder.txt`, from which
//! `touchstone plan` predicts the computing cost of a scene, and as a table into `docs/effects.md`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::counted::{built, instructions, per_tick};
use crate::outcome::Outcome;
use crate::{marked, packages, shell};

/// Numbers of ticks (control periods) of the short and of the long run. Events that happen once in a hundred ticks still happen
/// often in 1000 ticks.
const TICKS: [u64; 2] = [1_000, 5_000];
/// Line of `docs/effects.md` after which the table begins.
const BEGIN: &str = "<!-- ladder: begin, written by `cargo xtask bench --ladder --write` -->\n";
const END: &str = "<!-- ladder: end -->\n";
/// Most instructions per tick that an effect may add if its amplitude in the scene is zero. It allows only for rounding.
const NOTHING: f64 = 0.01;

type Costs = BTreeMap<String, f64>;

pub fn run(words: &[String]) -> Outcome {
    let write = match words {
        [] => false,
        [word] if word == "--write" => true,
        _ => return Outcome::Usage("cargo xtask bench --ladder [--write]".into()),
    };
    if let Some(missing) = packages::missing_valgrind() {
        return missing;
    }
    climb(write).unwrap_or_else(|failed| failed)
}

fn climb(write: bool) -> Result<Outcome, Outcome> {
    let binary = built("tick_cost")?;
    let names = shell::capture(shell::program(&binary).arg("--ladder"))
        .ok_or_else(|| Outcome::Failed("tick_cost does not name its ladder".into()))?;
    let names: Vec<&str> = names.lines().collect();
    let costs = counted(&binary, &names)?;
    allocated(&binary)?;
    let table = table(&names, &costs);
    print!("{table}");
    let bare = costs["bare"];
    for (name, cost) in costs.iter().filter(|(name, _)| name.starts_with("silent:")) {
        // An effect of the simulated hand needs the hand, so its cost is compared with the cost of a hand alone.
        let costs_nothing = [bare, costs["with:hand"]]
            .iter()
            .any(|without| (cost - without).abs() <= NOTHING);
        if !costs_nothing {
            return Err(Outcome::Failed(format!(
                "{name} costs {:.1} instructions a tick",
                cost - bare
            )));
        }
    }
    if write {
        let lines: Vec<String> = names
            .iter()
            .map(|name| format!("{name} {:.1}\n", costs[*name]))
            .collect();
        put(
            &shell::root().join("host-sim/lab/src/plan/ladder.txt"),
            &lines.concat(),
        )?;
        let page = shell::root().join("docs/effects.md");
        let text = std::fs::read_to_string(&page).map_err(|error| failed(&page, &error))?;
        let replaced = marked::between(&text, BEGIN, END, &table).ok_or_else(|| {
            Outcome::Failed(format!("{}: no place for the table", page.display()))
        })?;
        put(&page, &replaced)?;
    }
    let most = costs.values().copied().fold(0.0, f64::max);
    Ok(Outcome::Ok(format!(
        "{bare:.1} to {most:.1} instructions per tick, {} configurations",
        names.len()
    )))
}

fn failed(path: &Path, error: &std::io::Error) -> Outcome {
    Outcome::Failed(format!("{}: {error}", path.display()))
}

fn put(path: &Path, text: &str) -> Result<(), Outcome> {
    std::fs::write(path, text).map_err(|error| failed(path, &error))
}

/// Measures the instructions per tick of every configuration in `names`.
fn counted(binary: &Path, names: &[&str]) -> Result<Costs, Outcome> {
    let folder = shell::target("bench/ladder");
    // Removes old counts, which must not be read if this run fails.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).map_err(|error| failed(&folder, &error))?;
    let out = folder.join("count");
    let mut command = shell::program("valgrind");
    command
        .args([
            "--quiet",
            "--tool=callgrind",
            "--dump-before=*tick_cost*mark*",
        ])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(binary)
        .arg("--ladder")
        .args(TICKS.map(|ticks| ticks.to_string()));
    if shell::capture(&mut command).is_none() {
        return Err(Outcome::Failed("the ladder failed under valgrind".into()));
    }
    // The first count covers everything before the first call of `mark`.
    let file = |number: usize| PathBuf::from(format!("{}.{number}", out.display()));
    let count = |number: usize| -> Result<u64, Outcome> {
        let path = file(number);
        let text = std::fs::read_to_string(&path).map_err(|error| failed(&path, &error))?;
        instructions(&text)
            .ok_or_else(|| Outcome::Failed(format!("no totals in {}", path.display())))
    };
    let last = 3 * names.len();
    if file(last + 1).is_file() || !file(last).is_file() {
        return Err(Outcome::Failed(format!(
            "callgrind did not write {last} counts"
        )));
    }
    names
        .iter()
        .enumerate()
        .map(|(at, name)| {
            // Each configuration calls `mark` three times; the last call ends its ticks. The code after it prepares the next
            // configuration.
            let counted = [count(3 * at + 2)?, count(3 * at + 3)?];
            Ok(((*name).to_owned(), per_tick(TICKS, counted)))
        })
        .collect()
}

/// Checks that a long run allocates memory no more often than a short run. So no tick (control period) of any configuration
/// allocates.
fn allocated(binary: &Path) -> Result<(), Outcome> {
    let count = |more: u64| -> Result<u64, Outcome> {
        let log = shell::target("bench/ladder").join(format!("heap.{more}"));
        let mut command = shell::program("valgrind");
        command
            .args(["--tool=memcheck", "--leak-check=no"])
            .arg(format!("--log-file={}", log.display()))
            .arg(binary)
            .args(["--ladder", "10", &more.to_string()]);
        if shell::capture(&mut command).is_none() {
            return Err(Outcome::Failed("the ladder failed under memcheck".into()));
        }
        let text = std::fs::read_to_string(&log).map_err(|error| failed(&log, &error))?;
        allocations(&text)
            .ok_or_else(|| Outcome::Failed(format!("no count of allocations in {}", log.display())))
    };
    let [short, long] = [count(10)?, count(500)?];
    if short == long {
        return Ok(());
    }
    Err(Outcome::Failed(format!(
        "ticks allocate: {short} allocations in a short climb, {long} in a long one"
    )))
}

/// Number of all memory allocations, from the summary in memcheck's log.
fn allocations(log: &str) -> Option<u64> {
    let (_, rest) = log.split_once("total heap usage: ")?;
    let (count, _) = rest.split_once(" allocs")?;
    count.replace(',', "").parse().ok()
}

/// Table of the instructions per tick (control period) that each effect adds alone, and of what each pair adds beyond the sum of
/// its two effects.
fn table(names: &[&str], costs: &Costs) -> String {
    let effects: Vec<&str> = names
        .iter()
        .filter_map(|name| name.strip_prefix("with:"))
        .filter(|name| !name.contains('+'))
        .collect();
    let bare = costs["bare"];
    let added = |name: &str| costs.get(&format!("with:{name}")).map(|cost| cost - bare);
    let mut text = format!("\nWithout any: {bare:.1} instructions a tick.\n\n| effect | alone |");
    for number in 1..=effects.len() {
        let _ = write!(text, " {number} |");
    }
    text.push_str("\n|---|---:|");
    text.push_str(&"---:|".repeat(effects.len()));
    text.push('\n');
    for (row, first) in effects.iter().enumerate() {
        let alone = added(first).unwrap_or(f64::NAN);
        let _ = write!(text, "| {} {first} | {alone:+.1} |", row + 1);
        for second in &effects {
            let pair =
                added(&format!("{first}+{second}")).or_else(|| added(&format!("{second}+{first}")));
            let beyond = pair
                .zip(added(second))
                .map(|(pair, other)| pair - alone - other);
            // Empty if a pair adds nothing, so that the other cells stand out; a cross if the two effects exclude each other.
            match beyond {
                _ if first == second => text.push_str("  |"),
                Some(beyond) if beyond.abs() < 0.5 => text.push_str("  |"),
                Some(beyond) => {
                    let _ = write!(text, " {beyond:+.0} |");
                }
                None => text.push_str(" x |"),
            }
        }
        text.push('\n');
    }
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_is_told_by_what_it_adds_beyond_both() {
        let costs: Costs = [
            ("bare", 50.0),
            ("with:a", 60.0),
            ("with:b", 75.0),
            ("with:a+b", 90.0),
        ]
        .map(|(name, cost)| (name.to_owned(), cost))
        .into();
        let table = table(&["bare", "with:a", "with:b", "with:a+b"], &costs);
        assert!(table.contains("Without any: 50.0 "), "{table}");
        assert!(table.contains("| 1 a | +10.0 |  | +5 |\n"), "{table}");
        assert!(table.contains("| 2 b | +25.0 | +5 |  |\n"), "{table}");
    }

    #[test]
    fn allocations_are_read_of_the_summary() {
        let log = "==1== HEAP SUMMARY:\n==1==   total heap usage: 1,234 allocs, 1,230 frees, 9 bytes allocated\n";
        assert_eq!(allocations(log), Some(1234));
        assert_eq!(allocations("==1== nothing"), None);
    }
}
