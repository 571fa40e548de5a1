//! `cargo xtask fil --sabotage [--only TEXT]`: shows that the checks of `cargo xtask fil` detect missing safety functions. Each
//! sabotage removes one safety function from the firmware. The check that its entry names must then fail.
//!
//! A sabotage is caught when the named check fails with the named message. A change that does not compile, a program that does not
//! boot, or another failure does not count. The same checks run first on unchanged firmware and must pass.
//!
//! A run takes several builds of the firmware per entry, and a program without a safety function may take minutes to end. So each
//! result is stored at once and not repeated for the same sources ([`crate::memo`]).

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::mpsc;
use std::time::Instant;

use crate::changes::{self, Change, Entry};
use crate::memo::Memo;
use crate::outcome::Outcome;
use crate::{emulator, firmware, shell};

const LIST: &str = "emulator/sabotage.toml";
/// The crates of the workspace that the firmware is built from.
const PARTS: [&str; 3] = ["control", "protocol", "drive"];
const MORE: [&str; 3] = ["firmware", "memory.x", "memory-g474re.x"];
const USAGE: &str = "cargo xtask fil --sabotage [--only TEXT]";
const LEAST: usize = 12;

/// A finished build: the program's path or why it could not be built, the build time in seconds, and the test to run on the
/// program.
struct Built<'s> {
    asked: &'s BuildJob<'s>,
    program: Result<PathBuf, String>,
    seconds: f64,
}

pub fn run(words: &[&str]) -> Outcome {
    let only = match words {
        [] => "",
        ["--only", text] => *text,
        _ => return Outcome::Usage(USAGE.into()),
    };
    let mut all = match changes::list(LIST) {
        Ok(all) => all,
        Err(outcome) => return outcome,
    };
    if all.len() < LEAST {
        return Outcome::Failed(format!(
            "{LIST} has {} sabotages, fewer than {LEAST}",
            all.len()
        ));
    }
    all.retain(|sabotage| sabotage.word("name").contains(only));
    if all.is_empty() {
        return Outcome::Usage(format!("no sabotage in {LIST} has `{only}` in its name"));
    }
    let emulator = match emulator::built() {
        Ok(emulator) => emulator,
        Err(outcome) => return outcome,
    };
    let folder = shell::target("fil-sabotage");
    let work = match changes::copy(&folder, &PARTS, &MORE) {
        Ok(work) => work,
        Err(why) => return Outcome::Failed(why),
    };
    let unfit: Vec<String> = all
        .iter()
        .filter_map(|one| fits(one, &work).err())
        .collect();
    if let Some(first) = unfit.first() {
        return Outcome::Failed(format!(
            "{LIST}: {} of {} do not fit the sources, the first: {first}",
            unfit.len(),
            all.len()
        ));
    }
    let memo = Memo::open(folder.join("found.tsv"), &work, Some(&emulator));
    let memo = match memo {
        Ok(memo) => memo,
        Err(why) => return Outcome::Failed(format!("{}: {why}", folder.display())),
    };
    // One program is built while the previous one is tested.
    let (send, receive) = mpsc::sync_channel(1);
    let asked = asked(&all, &memo);
    std::thread::scope(|scope| {
        // The thread owns the sending end of the channel, so the channel closes when the thread ends.
        scope.spawn(|| build_all(&asked, &folder, &work, send));
        let answers = judge_all(&emulator, &asked, memo, &receive);
        // Closes the receiving end, so that the building thread stops if the tests ended early.
        drop(receive);
        answers
    })
}

/// Checks that an entry of the list of sabotages names a known board, and that its changes fit the sources.
fn fits(one: &Entry, sources: &Path) -> Result<(), String> {
    let (name, board) = (one.word("name"), one.word("board"));
    if !firmware::BOARDS.contains(&board) {
        return Err(format!("`{name}`: there is no board `{board}`"));
    }
    one.changes.iter().try_for_each(|change: &Change| {
        let said = |why| format!("{}: {why}", change.file);
        let source = std::fs::read_to_string(sources.join(&change.file)).map_err(said)?;
        change.fits(&source)
    })
}

/// One program to build and test: a board, the sabotage (removed safety function; `None` for unchanged firmware), and the checks to
/// run. `is_known` means that a result is stored under `key`.
struct BuildJob<'s> {
    board: &'static str,
    sabotage: Option<&'s Entry>,
    rows: Vec<&'s str>,
    key: u64,
    is_known: bool,
}

fn asked<'s>(all: &'s [Entry], memo: &Memo) -> Vec<BuildJob<'s>> {
    let mut asked = Vec::new();
    for &board in firmware::BOARDS.iter() {
        let of_board: Vec<&Entry> = all
            .iter()
            .filter(|one| one.word("board") == board)
            .collect();
        if of_board.is_empty() {
            continue;
        }
        let with_none = std::iter::once(None).chain(of_board.iter().copied().map(Some));
        for sabotage in with_none {
            let rows: Vec<&str> = match sabotage {
                Some(sabotage) => vec![sabotage.word("only")],
                None => of_board.iter().map(|one| one.word("only")).collect(),
            };
            let key = memo.key(&(board, sabotage, &rows));
            asked.push(BuildJob {
                is_known: memo.get(key).is_some(),
                board,
                sabotage,
                rows,
                key,
            });
        }
    }
    asked
}

/// Builds the programs one after the other and sends each to the thread that tests it. A program with a stored result is not built.
fn build_all<'s>(
    all: &'s [BuildJob<'s>],
    folder: &Path,
    work: &Path,
    send: mpsc::SyncSender<Built<'s>>,
) {
    for (number, asked) in all.iter().enumerate() {
        let begun = Instant::now();
        let changes = asked.sabotage.map_or(&[][..], |one| &one.changes);
        let board = asked.board;
        let kept = folder.join(format!("{board}-{number}.elf"));
        let program = match asked.is_known {
            true => Ok(kept),
            false => changes::with(work, changes, || build(board, work, folder, &kept)),
        };
        let built = Built {
            asked,
            program,
            seconds: begun.elapsed().as_secs_f64(),
        };
        if send.send(built).is_err() {
            return;
        }
    }
}

fn build(board: &str, work: &Path, folder: &Path, kept: &Path) -> Result<PathBuf, String> {
    let (mut cargo, built) = firmware::build_copy(board, work, &folder.join("build"))
        .map_err(|outcome| outcome.to_string())?;
    let done = cargo
        .stdin(Stdio::null())
        .output()
        .map_err(|why| why.to_string())?;
    if !done.status.success() {
        let text = String::from_utf8_lossy(&done.stderr).into_owned();
        let error = text.lines().find(|line| line.starts_with("error"));
        return Err(format!(
            "does not build: {}",
            error.unwrap_or("no error named")
        ));
    }
    std::fs::copy(&built, kept).map_err(|why| format!("{}: {why}", built.display()))?;
    Ok(kept.to_path_buf())
}

/// Tests each program as soon as it is built, and prints a line for each.
fn judge_all(
    emulator: &Path,
    all: &[BuildJob<'_>],
    mut memo: Memo,
    receive: &mpsc::Receiver<Built<'_>>,
) -> Outcome {
    let begun = Instant::now();
    println!(
        "{:>6} {:>5}  {:<7}  sabotage, and what went wrong",
        "build", "run", ""
    );
    let entries = all.iter().filter(|one| one.sabotage.is_some()).count();
    let (mut caught, mut known) = (0, 0);
    while let Ok(built) = receive.recv() {
        let begun = Instant::now();
        let BuildJob {
            board,
            sabotage,
            rows,
            key,
            ..
        } = built.asked;
        let name = sabotage.map_or("nothing changed, all rows", |one| one.word("name"));
        let (word, reason) = match memo.get(*key) {
            Some((word, reason)) => {
                known += usize::from(sabotage.is_some());
                (word.clone(), reason.clone())
            }
            None => {
                let wrong = built
                    .program
                    .and_then(|program| wrong(emulator, board, &program, rows));
                let (word, reason) = verdict(*sabotage, &wrong);
                // A program that could not be tested is tested again in the next run.
                if wrong.is_ok()
                    && let Err(why) = memo.keep(*key, word, &reason)
                {
                    return Outcome::Failed(format!("what was found cannot be kept: {why}"));
                }
                (word.to_owned(), reason)
            }
        };
        caught += usize::from(word == "caught");
        println!(
            "{:>4.0} s {:>3.0} s  {word:<7}  {board}: {name}\n                        {reason}",
            built.seconds,
            begun.elapsed().as_secs_f64(),
        );
        if sabotage.is_none() && word != "right" {
            return Outcome::Failed(format!("{board}, nothing changed: {reason}"));
        }
    }
    let text = format!(
        "{caught} of {entries} sabotages caught by the row that they name, {known} of them known from before, in {:.0} s",
        begun.elapsed().as_secs_f64()
    );
    match caught == entries {
        true => Outcome::Ok(text),
        false => Outcome::Failed(text),
    }
}

/// Returns the result for one program as a word such as `caught`, and the reason.
fn verdict(
    sabotage: Option<&Entry>,
    wrong: &Result<Vec<String>, String>,
) -> (&'static str, String) {
    match (wrong, sabotage) {
        (Err(why), _) => ("NOT RUN", why.clone()),
        (Ok(wrong), None) => match wrong.first() {
            None => ("right", "nothing is wrong".into()),
            Some(first) => ("WRONG", first.clone()),
        },
        (Ok(wrong), Some(one)) => {
            let (only, says) = (one.word("only"), one.word("says"));
            let named = |line: &&String| line.contains(only) && line.contains(says);
            match (wrong.iter().find(named), wrong.first()) {
                (Some(line), _) => ("caught", line.clone()),
                (None, Some(other)) => ("MISSED", format!("not `{says}`: {other}")),
                (None, None) => ("MISSED", format!("`{only}` passes")),
            }
        }
    }
}

/// Runs the firmware checks whose names contain one of `rows` on a program, and returns the failures. Errors: the emulator did not
/// run to its end.
fn wrong(
    emulator: &Path,
    board: &str,
    program: &Path,
    rows: &[&str],
) -> Result<Vec<String>, String> {
    let mut call = shell::program(emulator);
    call.arg("fil").arg(format!("--{board}")).arg(program);
    for row in rows {
        call.args(["--only", row]);
    }
    let done = call
        .stdin(Stdio::null())
        .output()
        .map_err(|why| why.to_string())?;
    let lines = String::from_utf8_lossy(&done.stdout).into_owned();
    let wrong: Vec<String> = lines
        .lines()
        .filter_map(|line| line.strip_prefix("WRONG: "))
        .map(str::to_owned)
        .collect();
    match (done.status.code(), wrong.is_empty()) {
        (Some(0), true) | (Some(1), false) => Ok(wrong),
        (code, _) => {
            let said = String::from_utf8_lossy(&done.stderr).into_owned();
            let last = said.lines().last().unwrap_or("nothing").to_owned();
            Err(format!("the emulator ended with {code:?}: {last}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_named_row_and_words_are_a_catch() {
        let sabotage = Entry::with(&[
            ("name", "no limit"),
            ("only", "bus at 33 V, pressed"),
            ("says", "stay on"),
        ]);
        let word = |line: &str| verdict(Some(&sabotage), &Ok(vec![line.into()])).0;
        assert_eq!(
            word("a: bus at 33 V, pressed: the outputs stay on"),
            "caught"
        );
        assert_eq!(word("a: bus at 33 V, pressed: before: no answer"), "MISSED");
        assert_eq!(word("a: bus gone, pressed: the outputs stay on"), "MISSED");
        assert_eq!(verdict(Some(&sabotage), &Ok(Vec::new())).0, "MISSED");
        assert_eq!(verdict(Some(&sabotage), &Err("why".into())).0, "NOT RUN");
        assert_eq!(verdict(None, &Ok(Vec::new())).0, "right");
    }
}
