//! Output of the program, sorted into results, progress, notes and errors; `--quiet` and `--json` suppress some of it.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use touchstone_sim::error::{Error, Result};

/// True after the reader of standard output has closed the pipe.
static CLOSED: AtomicBool = AtomicBool::new(false);
/// Whether the option `--json` was given.
static JSON: AtomicBool = AtomicBool::new(false);
/// Whether the option `--quiet` was given.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Stores the options `--json` and `--quiet`; called once, before anything is printed.
pub fn choose(json: bool, quiet: bool) {
    JSON.store(json, Ordering::Relaxed);
    QUIET.store(quiet, Ordering::Relaxed);
}

/// Whether the option `--json` was given, so that the result is printed as JSON.
pub fn json() -> bool {
    JSON.load(Ordering::Relaxed)
}

/// Whether progress, notes and summaries are suppressed.
pub fn quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Whether the reader of standard output is still there. This check prints nothing.
pub fn is_read() -> bool {
    !CLOSED.load(Ordering::Relaxed)
}

/// Prints to standard output. A reader that closes the pipe early (`| head`) causes no error, so that the report is still written.
pub fn print(text: Arguments<'_>) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_fmt(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::Io {
            path: "standard output".into(),
            problem: error.to_string(),
            fix: "give it room, or another place".to_owned(),
        }),
        Err(_) => {
            CLOSED.store(true, Ordering::Relaxed);
            Ok(())
        }
        Ok(()) => Ok(()),
    }
}

/// Prints the result as JSON if `--json` was given; otherwise calls `people`, which prints the result as text.
pub fn result(
    value: impl FnOnce() -> serde_json::Value,
    people: impl FnOnce() -> Result<()>,
) -> Result<()> {
    match json() {
        true => print(format_args!("{:#}\n", value())),
        false => people(),
    }
}

/// Replaces control characters in a text before it is printed. Texts from files, boards and services may have such characters,
/// which a terminal would execute.
pub fn shown(text: &str) -> String {
    let harmless = |letter: char| match letter {
        '\n' | '\t' => letter,
        _ if letter.is_control() => '\u{fffd}',
        _ => letter,
    };
    text.chars().map(harmless).collect()
}

/// Same as `println!`, without a panic on a closed pipe; for the output that a command is run for.
macro_rules! say {
    ($($text:tt)*) => { $crate::out::print(format_args!("{}\n", $crate::out::shown(&format!($($text)*))))? };
}
/// Same as [`say`], for progress and summaries, which `--json` and `--quiet` suppress.
macro_rules! tell {
    ($($text:tt)*) => { if !$crate::out::json() && !$crate::out::quiet() { $crate::out::say!($($text)*) } };
}
/// Prints a note or a warning on standard error.
macro_rules! note {
    ($($text:tt)*) => { if !$crate::out::quiet() { eprintln!("{}", $crate::out::shown(&format!($($text)*))) } };
}
pub(crate) use {note, say, tell};
