//! Shell scripts that the model checker runs in the place of its solvers. They start the solvers with options that suit these
//! proofs.
//!
//! The checker starts the first program with a solver's name in the search path, so a script earlier in the path is started
//! instead. For a solver that is not installed there is no script; harnesses (proofs) that need it end without a result.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Number of conflicts after which the script stops the solver CaDiCaL and starts the solver kissat. CaDiCaL reaches this number in
/// a second or two. The limit is not a time, so that the same solver answers on every machine.
const CONFLICTS: u32 = 10_000;
/// Number of variables below which the solver kissat runs at once, without CaDiCaL, because kissat solves such small problems as
/// fast.
///
/// The last problem of a harness (proof) depends on the solutions of its earlier problems. With CaDiCaL for the earlier ones,
/// kissat took 28 s instead of 4 s for one of two tried harnesses, and 11 s instead of 8 s for the other. These differences are
/// chance and may be the opposite for other harnesses.
const FEW_VARIABLES: u32 = 40_000;

/// Search path in which scripts come before cvc5 and kissat, if these solvers are installed.
pub fn first(target: &Path, path: OsString) -> Result<OsString, String> {
    let found = |name: &str| {
        std::env::split_paths(&path)
            .map(|folder| folder.join(name))
            .find(|file| file.is_file())
    };
    let folder = target.join("solvers");
    let mut scripts = Vec::new();
    if let Some(cvc5) = found("cvc5") {
        scripts.push(("cvc5", with_integers(&cvc5)));
    }
    if let (Some(kissat), Some(cadical)) = (found("kissat"), found("cadical")) {
        scripts.push(("kissat", with_a_first_look(&cadical, &kissat)));
    }
    if scripts.is_empty() {
        return Ok(path);
    }
    let said = |why: std::io::Error| format!("{}: {why}", folder.display());
    std::fs::create_dir_all(&folder).map_err(said)?;
    for (name, text) in scripts {
        let file = folder.join(name);
        std::fs::write(&file, text).map_err(said)?;
        let mut chmod = Command::new("chmod");
        if !chmod
            .arg("+x")
            .arg(&file)
            .status()
            .is_ok_and(|it| it.success())
        {
            return Err(format!("{}: cannot be made a program", file.display()));
        }
    }
    before(&folder, &path)
}

/// Script for the solver cvc5. It makes cvc5 translate bit vectors into integers, which multiplication and division at full width
/// need.
fn with_integers(cvc5: &Path) -> String {
    format!(
        "#!/bin/sh\nexec '{}' --solve-bv-as-int=sum \"$@\"\n",
        cvc5.display()
    )
}

/// Script that tries the solver CaDiCaL before the solver kissat.
///
/// For each harness (proof) the checker runs the solver once per cover and per assertion that must be reachable, and a last time
/// for whether any check fails. The former problems are easy; CaDiCaL solves them in a quarter of kissat's time. The last problem
/// needs kissat.
fn with_a_first_look(cadical: &Path, kissat: &Path) -> String {
    let (cadical, kissat) = (cadical.display(), kissat.display());
    format!(
        "#!/bin/sh\nfor file; do :; done\n\
         variables=$(sed -n '/^p cnf /{{s/^p cnf  *\\([0-9]*\\).*/\\1/p;q}}' \"$file\" 2>/dev/null)\n\
         if [ \"${{variables:-{FEW_VARIABLES}}}\" -lt {FEW_VARIABLES} ]; then exec '{kissat}' \"$@\"; fi\n\
         answer=$('{cadical}' -q -c {CONFLICTS} \"$@\")\ncode=$?\n\
         if [ $code = 10 ] || [ $code = 20 ]; then printf '%s\\n' \"$answer\"; exit $code; fi\n\
         exec '{kissat}' \"$@\"\n"
    )
}

/// Search path with `folder` placed before all others.
pub fn before(folder: &Path, path: &OsString) -> Result<OsString, String> {
    let all = std::iter::once(PathBuf::from(folder)).chain(std::env::split_paths(path));
    std::env::join_paths(all).map_err(|why| why.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For tests: creates a folder with shell scripts of these names and texts.
    fn programs(folder: &Path, all: &[(&str, &str)]) -> PathBuf {
        let there = folder.join("there");
        let _ = std::fs::remove_dir_all(&there);
        std::fs::create_dir_all(&there).expect("a folder");
        for (name, text) in all {
            let file = there.join(name);
            std::fs::write(&file, format!("#!/bin/sh\n{text}\n")).expect("a file");
            let made = Command::new("chmod").arg("+x").arg(&file).status();
            assert!(made.is_ok_and(|it| it.success()));
        }
        there
    }

    /// For tests: output and exit code of a shell command. Its search path has the solver scripts first, then these programs in the
    /// place of solvers.
    fn said(name: &str, all: &[(&str, &str)], command: &str) -> (String, Option<i32>) {
        let folder = crate::shell::target(name);
        let there = programs(&folder, all);
        let path = std::env::join_paths([there, "/bin".into(), "/usr/bin".into()]);
        let path = first(&folder, path.expect("a path")).expect("a path");
        let done = Command::new("sh")
            .args(["-c", command])
            .env("PATH", path)
            .output()
            .expect("sh runs");
        let text = String::from_utf8_lossy(&done.stdout).into_owned();
        (text, done.status.code())
    }

    #[test]
    fn without_solvers_the_path_is_as_it_was() {
        let folder = crate::shell::target("solvers-none");
        assert_eq!(first(&folder, "/nowhere".into()), Ok("/nowhere".into()));
    }

    #[test]
    fn the_first_cvc5_of_the_path_solves_words_as_integers() {
        let (text, _) = said("solvers-cvc5", &[("cvc5", "echo with $*")], "cvc5 x.smt2");
        assert_eq!(text, "with --solve-bv-as-int=sum x.smt2\n");
    }

    #[test]
    fn kissat_answers_what_cadical_has_no_answer_to() {
        let kissat = ("kissat", "echo s UNSATISFIABLE of $*; exit 20");
        let found = ("cadical", "echo s SATISFIABLE; echo v 1 0; exit 10");
        let unknown = ("cadical", "echo s UNKNOWN; exit 0");
        let killed = ("cadical", "echo half an ans; exit 137");
        let answer = ("s SATISFIABLE\nv 1 0\n".to_owned(), Some(10));
        let of_kissat = ("s UNSATISFIABLE of x.cnf\n".to_owned(), Some(20));
        for (name, cadical, expected) in [
            ("solvers-found", found, &answer),
            ("solvers-unknown", unknown, &of_kissat),
            ("solvers-killed", killed, &of_kissat),
        ] {
            assert_eq!(&said(name, &[kissat, cadical], "kissat x.cnf"), expected);
        }
        let alone = said("solvers-alone", &[kissat], "kissat x.cnf");
        assert_eq!(alone, of_kissat);
    }

    #[test]
    fn kissat_alone_answers_what_has_few_variables() {
        let kissat = ("kissat", "echo kissat; exit 20");
        let cadical = ("cadical", "echo cadical; exit 20");
        for (name, of, head) in [
            ("solvers-few", "kissat", "c of few\\np cnf 39999 5"),
            ("solvers-many", "cadical", "p cnf 40000 5"),
            ("solvers-no-head", "cadical", "1 2 0"),
        ] {
            let file = crate::shell::target(name).join("x.cnf");
            let command = format!(
                "printf '{head}\\n1 0\\n' > '{0}'; kissat '{0}'",
                file.display()
            );
            let expected = (format!("{of}\n"), Some(20));
            assert_eq!(said(name, &[kissat, cadical], &command), expected);
        }
    }
}
