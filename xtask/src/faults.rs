//! `cargo xtask faults [--write]`: simulates all single faults of a running knob on the desktop, for all boards and every moment,
//! grip and position. Compares the result with the tables in `docs/faults.md`; `--write` replaces them. `target/faults/cells.csv`
//! has the results one by one.

use crate::outcome::Outcome;
use crate::{marked, shell};

/// Line of `docs/faults.md` after which the tables begin.
const BEGIN: &str = "<!-- single faults: begin, written by `cargo xtask faults --write` -->\n";
const END: &str = "<!-- single faults: end -->\n";

pub fn run(words: &[String]) -> Outcome {
    let write = match words {
        [] => false,
        [word] if word == "--write" => true,
        _ => return Outcome::Usage("cargo xtask faults [--write]".into()),
    };
    played(write).unwrap_or_else(|failed| failed)
}

fn played(write: bool) -> Result<Outcome, Outcome> {
    let folder = shell::target("faults");
    // Optimised like the tests, which use the same crates, so that these are compiled only once.
    let mut play = shell::cargo_locked("run");
    play.args(["--profile", "test", "--package", "touchstone-tests"]);
    play.args(["--example", "single_faults", "--"]);
    shell::run(play.arg(&folder)).went_well()?;
    let read = |path: &std::path::Path| {
        std::fs::read_to_string(path)
            .map_err(|error| Outcome::Failed(format!("{}: {error}", path.display())))
    };
    let tables = read(&folder.join("page.md"))?;
    let page = shell::root().join("docs/faults.md");
    let text = read(&page)?;
    let replaced = marked::between(&text, BEGIN, END, &tables)
        .ok_or_else(|| Outcome::Failed(format!("{}: no place for the tables", page.display())))?;
    if replaced == text {
        return Ok(Outcome::Ok("docs/faults.md has these tables".into()));
    }
    if !write {
        return Err(Outcome::Failed(
            "docs/faults.md has other tables: look at target/faults/page.md, then cargo xtask faults --write".into(),
        ));
    }
    std::fs::write(&page, replaced)
        .map_err(|error| Outcome::Failed(format!("{}: {error}", page.display())))?;
    Ok(Outcome::Ok("docs/faults.md is written".into()))
}
