//! Compiles the theorems about sequences of control periods in `proofs/coq/` with the proof assistant Coq. Checks that they rest on
//! no assumptions, and compares their specification with the shipped code.
//!
//! Coq also exits with 0 if a proof was admitted, rests on an axiom, or proves less than intended. So `Theorems.v` lists every
//! theorem, and makes Coq print its statement and all assumptions. There must be no assumptions, and the statements must equal
//! those in `claims.txt`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::changes;
use crate::outcome::Outcome;
use crate::shell;

/// Names of the Coq files without ending, in the order of compilation: each comes after the files that it imports.
const FILES: [&str; 22] = [
    "Quotient",
    "Root",
    "Guard",
    "Port",
    "GuardLosesNothing",
    "ToldChange",
    "Shipped",
    "GuardSettings",
    "AcceptedIsValid",
    "AcceptedCovers",
    "AcceptedWindow",
    "Hand",
    "Laws",
    "LawsArePassive",
    "Mass",
    "Enhanced",
    "EnhancedIsPassive",
    "EnhancedOffset",
    "EnhancedStorage",
    "EnhancedPort",
    "Theorems",
    "Extract",
];
/// File that lists the theorems and makes Coq print their statements.
const CLAIMS: &str = "Theorems.v";
/// Committed file with the statements as Coq prints them, so that no theorem can be removed or weakened without notice.
const SAID: &str = "claims.txt";
/// Start of the Coq definition that combines all theorems, so that one command prints the assumptions of all.
const TOGETHER: &str = "Definition claims :=";
const ASKED: &str = "Print Assumptions claims.";
/// Line that Coq prints if theorems rest on no assumption.
const CLOSED: &str = "Closed under the global context";
const SOURCES: &str = "proofs/coq";
const MUTANTS: &str = "proofs/coq/mutants.toml";
const INSTALL: &str = "Coq, or OCaml's Zarith, is not installed; install with `apt-get install --no-install-recommends coq libzarith-ocaml-dev` (1 GB on disk)";
/// Number of control periods (ticks) that the shipped code and the extracted specification both compute for comparison.
const TICKS: &str = "600000";
/// Words of Coq that accept a statement without a proof; no file may contain them.
const UNPROVED: [&str; 8] = [
    "Admitted",
    "admit.",
    "Axiom",
    "Parameter",
    "Conjecture",
    "bypass_check",
    "Unset Guard Checking",
    "Unset Universe Checking",
];

/// The reason why the theorems cannot be trusted.
#[derive(Debug, PartialEq)]
struct Broken {
    /// Name of the faulty file, such as `Guard.v`.
    file: String,
    why: String,
}

pub fn is_there() -> bool {
    shell::capture(Command::new("coqc").arg("--version")).is_some() && integers().is_some()
}

/// Version of Zarith, the OCaml library for integers with which the extracted specification is compiled. `None` if the files that
/// compiling needs are missing; Coq alone needs only the files for running.
pub fn integers() -> Option<String> {
    let mut query = Command::new("ocamlfind");
    let said = shell::capture(query.args(["query", "-format", "%d %v", "zarith"]))?;
    let (folder, version) = said.trim().split_once(' ')?;
    let is_whole = Path::new(folder).join("zarith.cmxa").is_file();
    is_whole.then(|| version.to_owned())
}

/// Compiles the theorems, checks their assumptions, and compares the specification with the shipped code.
pub fn run() -> Outcome {
    if !is_there() {
        return Outcome::NotRun(INSTALL.into());
    }
    let folder = shell::target("coq");
    let begun = Instant::now();
    let claims = match fresh(&folder).and_then(|()| proved(&folder, true)) {
        Ok(claims) => claims,
        Err(Broken { file, why }) => return Outcome::Failed(format!("{SOURCES}/{file}: {why}")),
    };
    let took = begun.elapsed().as_secs_f64();
    match compared(&folder) {
        Ok(sentence) => Outcome::Ok(format!(
            "{claims} theorems over traces proved, none assumes anything ({took:.0} s); {sentence}"
        )),
        Err(why) => Outcome::Failed(format!("the specification beside the code: {why}")),
    }
}

fn broken(file: &str, why: impl ToString) -> Broken {
    Broken {
        file: file.into(),
        why: why.to_string(),
    }
}

/// Fills a folder with a new copy of the Coq sources, without build results. Errors: a Coq file is not in [`FILES`].
fn fresh(folder: &Path) -> Result<(), Broken> {
    let said = |why: std::io::Error| broken("", format!("{}: {why}", folder.display()));
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(said)?;
    }
    std::fs::create_dir_all(folder).map_err(said)?;
    let sources = shell::root().join(SOURCES);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(&sources).map_err(said)? {
        let path = entry.map_err(said)?.path();
        let name = path.file_name().unwrap_or_default().to_owned();
        std::fs::copy(&path, folder.join(&name)).map_err(said)?;
        found.extend(name.to_string_lossy().strip_suffix(".v").map(str::to_owned));
    }
    // A file that is not compiled would look like a proof.
    match found.iter().find(|file| !FILES.contains(&file.as_str())) {
        Some(file) => Err(broken(file, "is not in the list of files to compile")),
        None => Ok(()),
    }
}

/// Compiles all files; returns the number of theorems. Errors: a file does not compile, or a theorem rests on an assumption or is
/// not the committed one.
fn proved(folder: &Path, show: bool) -> Result<usize, Broken> {
    let mut claims = 0;
    for name in FILES {
        let file = format!("{name}.v");
        let text = std::fs::read_to_string(folder.join(&file)).map_err(|why| broken(&file, why))?;
        if let Some(word) = UNPROVED.iter().find(|word| text.contains(**word)) {
            return Err(broken(&file, format!("has `{word}` in it")));
        }
        let begun = Instant::now();
        let mut coqc = Command::new("coqc");
        let done = coqc
            .current_dir(folder)
            .args(["-q", "-Q", ".", "Touchstone", &file])
            .output()
            .map_err(|why| broken(&file, why))?;
        if !done.status.success() {
            return Err(broken(&file, String::from_utf8_lossy(&done.stderr).trim()));
        }
        if show {
            println!("{:>7.1} s  {SOURCES}/{file}", begun.elapsed().as_secs_f64());
        }
        if file == CLAIMS {
            let answers = String::from_utf8_lossy(&done.stdout).into_owned();
            claims = all_asked(&text).map_err(|why| broken(CLAIMS, why))?.len();
            nothing_assumed(&answers).map_err(|why| broken(CLAIMS, why))?;
            as_claimed(folder, &answers)?;
        }
    }
    Ok(claims)
}

/// The names of the theorems whose statements the file makes Coq print. Errors: the file does not print the assumptions of the same
/// theorems.
fn all_asked(text: &str) -> Result<Vec<&str>, String> {
    let said: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("Check ")?.strip_suffix('.'))
        .collect();
    let together = text
        .split_once(TOGETHER)
        .and_then(|(_, rest)| rest.split_once(ASKED))
        .ok_or_else(|| format!("`{TOGETHER}` and `{ASKED}` are not in it"))?
        .0;
    let is_not_of_a_name = |c: char| !(c.is_alphanumeric() || c == '_');
    let asked = together.split(is_not_of_a_name).filter(|it| !it.is_empty());
    if said.is_empty() || !said.iter().copied().eq(asked) {
        return Err(
            "the claims that are asked what they say are not those that are asked what they assume"
                .into(),
        );
    }
    Ok(said)
}

/// Checks that no theorem rests on an assumption, from the text that Coq printed.
fn nothing_assumed(answers: &str) -> Result<(), String> {
    // Coq prints the assumptions after this word.
    if let Some(at) = answers.find("Axioms:") {
        let assumed = answers[at..].lines().nth(1).unwrap_or_default();
        return Err(format!("a theorem rests on more: {assumed}"));
    }
    match answers.lines().filter(|line| *line == CLOSED).count() {
        1 => Ok(()),
        count => Err(format!(
            "one question for all theorems, and {count} answers"
        )),
    }
}

/// Checks that the statements that Coq printed equal the committed ones, apart from line breaks and spaces.
fn as_claimed(folder: &Path, answers: &str) -> Result<(), Broken> {
    let claims = std::fs::read_to_string(folder.join(SAID)).map_err(|why| broken(SAID, why))?;
    let (claimed, said) = (claims.split_whitespace(), answers.split_whitespace());
    if claimed.eq(said) {
        return Ok(());
    }
    // Writes the new answers to a file, so that a person can compare and commit them.
    let now = folder.join("claims.now.txt");
    std::fs::write(&now, answers).map_err(|why| broken(SAID, why))?;
    let line = claims
        .lines()
        .zip(answers.lines())
        .find(|(claimed, said)| claimed != said)
        .map_or("the end", |(_, said)| said);
    Err(broken(
        SAID,
        format!(
            "the theorems say something else: `{}`; all of it is in {}, to compare and to commit",
            line.trim(),
            now.display()
        ),
    ))
}

/// Runs the shipped code and the specification extracted from Coq on the same control periods; returns the comparison's message.
fn compared(folder: &Path) -> Result<String, String> {
    let mut build = Command::new("ocamlfind");
    let sources = ["specified.mli", "specified.ml", "compare.ml"];
    build
        .current_dir(folder)
        .args(["ocamlopt", "-package", "zarith", "-linkpkg"]);
    let built = build.args(sources).args(["-o", "compare"]).output();
    let built = built.map_err(|why| format!("ocamlfind: {why}"))?;
    if !built.status.success() {
        return Err(String::from_utf8_lossy(&built.stderr).trim().to_owned());
    }
    let mut trace = shell::cargo_locked("run");
    // Uses the same build profile as `cargo xtask prove --every`, so that the code is compiled only once.
    trace.args(["--profile", "every", "-q", "-p", "touchstone-proofs"]);
    trace.args(["--example", "trace", "--", TICKS]);
    let (output, input) = std::io::pipe().map_err(|why| why.to_string())?;
    let mut writes = trace.stdout(input).spawn().map_err(|why| why.to_string())?;
    // `trace` holds the writing end of the pipe. Without this `drop`, the reader would not see the pipe's end when the program
    // ends.
    drop(trace);
    let reads = Command::new(folder.join("compare")).stdin(output).output();
    let reads = reads.map_err(|why| why.to_string())?;
    let said = String::from_utf8_lossy(&reads.stdout).trim().to_owned();
    let wrote = writes.wait().map_err(|why| why.to_string())?;
    if reads.status.success() && wrote.success() {
        Ok(said)
    } else {
        Err(if said.is_empty() {
            "the ticks could not be written".into()
        } else {
            said
        })
    }
}

/// Mutation test of the Coq files: makes wrong changes of specification and theorems one by one. A change is caught if the file
/// that its entry names no longer compiles, while all files before it do. A syntax error in the changed file does not count.
pub fn mutants() -> Outcome {
    if !is_there() {
        return Outcome::NotRun(INSTALL.into());
    }
    let list = match changes::list(MUTANTS) {
        Ok(list) => list,
        Err(outcome) => return outcome,
    };
    let folder: PathBuf = shell::target("coq-mutants");
    let mut caught = 0;
    for mutant in &list {
        let (change, wanted) = (&mutant.changes[0], mutant.word("harness"));
        let answer = refuted_in(&folder, change, wanted);
        let word = match &answer {
            Ok(()) => "caught".to_owned(),
            Err(why) => format!("MISSED: {why}"),
        };
        caught += usize::from(answer.is_ok());
        println!(
            "{word}  {wanted}  `{}` -> `{}`",
            change.find, change.replace
        );
    }
    let text = format!(
        "{caught} of {} wrong changes of the theorems caught",
        list.len()
    );
    if caught == list.len() && caught > 0 {
        Outcome::Ok(text)
    } else {
        Outcome::Failed(text)
    }
}

fn refuted_in(folder: &Path, change: &changes::Change, wanted: &str) -> Result<(), String> {
    fresh(folder).map_err(|it| it.why)?;
    let name = Path::new(&change.file).file_name().unwrap_or_default();
    let path = folder.join(name);
    let text = std::fs::read_to_string(&path).map_err(|why| why.to_string())?;
    if text.matches(&change.find).count() != 1 {
        return Err(format!("{} does not have it once", change.file));
    }
    std::fs::write(&path, text.replace(&change.find, &change.replace))
        .map_err(|why| why.to_string())?;
    match proved(folder, false) {
        Ok(_) => Err("everything is still proved".into()),
        Err(Broken { file, why }) if file == wanted => {
            let no_sentence = ["Syntax error", "was not found in the current environment"];
            match no_sentence.iter().find(|word| why.contains(**word)) {
                Some(word) => Err(format!("{word} in {file}")),
                None => Ok(()),
            }
        }
        Err(Broken { file, why }) => Err(format!("{file} broke: {why}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axiom_is_no_proof() {
        let closed = "it\n     : Prop\nClosed under the global context\n";
        assert_eq!(nothing_assumed(closed), Ok(()));
        assert!(nothing_assumed("it\n     : Prop\n").is_err());
        assert!(nothing_assumed(&closed.repeat(2)).is_err());
        let axioms = format!("{closed}Axioms:\nclassic : forall P : Prop, P \\/ ~ P\n");
        assert!(nothing_assumed(&axioms).unwrap_err().contains("classic"));
    }

    #[test]
    fn a_claim_that_is_not_asked_is_seen() {
        let of = |asked: &str| format!("Check a.\nCheck b.\n{TOGETHER}\n  ({asked}).\n\n{ASKED}\n");
        assert_eq!(all_asked(&of("a,\n   b")), Ok(vec!["a", "b"]));
        for asked in ["a", "a, c", "a, b, c", ""] {
            assert!(all_asked(&of(asked)).is_err(), "{asked}");
        }
        assert!(all_asked("Check a.\n").is_err());
    }

    #[test]
    fn a_claim_that_says_less_is_seen() {
        let folder = shell::target("coq-claims-test");
        std::fs::create_dir_all(&folder).expect("writable");
        std::fs::write(folder.join(SAID), "it\n : a -> b\nClosed\n").expect("writable");
        assert_eq!(as_claimed(&folder, "it : a\n   -> b\nClosed\n"), Ok(()));
        for other in ["it : c -> a -> b\nClosed\n", "it : a -> b\n", ""] {
            let why = as_claimed(&folder, other).unwrap_err();
            assert_eq!(why.file, SAID);
        }
    }

    /// Checks that Coq prints statement and assumptions of each theorem, and that the committed file has each statement.
    #[test]
    fn every_claim_is_in_the_committed_answers() {
        let read = |file| {
            let path = shell::root().join(SOURCES).join(file);
            std::fs::read_to_string(path).expect("readable")
        };
        let (theorems, said) = (read(CLAIMS), read(SAID));
        let claims = all_asked(&theorems).expect("each is asked for both");
        for claim in claims {
            assert!(said.lines().any(|line| line == claim), "{claim}");
        }
    }

    #[test]
    fn the_sources_are_all_in_the_list_and_admit_nothing() {
        let folder = shell::target("coq-test");
        fresh(&folder).expect("every file is compiled");
        for name in FILES {
            let text = std::fs::read_to_string(folder.join(format!("{name}.v"))).expect("readable");
            assert!(UNPROVED.iter().all(|word| !text.contains(word)), "{name}");
        }
    }
}
