//! Output of the program, sorted into results, progress, notes and errors; `--quiet` and `--json` suppress some of these kinds.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::harmless::{is_harmful, one_line};

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

/// Whether the reader of standard output still keeps the pipe open. This check prints nothing.
pub fn is_read() -> bool {
    !CLOSED.load(Ordering::Relaxed)
}

/// Prints a text on standard output, with harmful characters replaced by [`shown`]. A reader that closes the pipe early (`| head`)
/// causes no error, so that the report is still written.
pub fn print(text: Arguments<'_>) -> Result<()> {
    put(&shown(&text.to_string()))
}

/// Prints a line in place of the last printed line on a terminal. With `ends`, the next output begins on a new line.
pub fn print_over(line: &str, ends: bool) -> Result<()> {
    put(&format!(
        "\r{}{}",
        shown(line),
        if ends { "\n" } else { "" }
    ))
}

fn put(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    put_out(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Converts the outcome of writing to standard output. A pipe that its reader closed is not an error.
pub fn put_out(written: std::io::Result<()>) -> Result<()> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::Io {
            path: "standard output".into(),
            problem: error.to_string(),
            fix: "free some space, or give another path".to_owned(),
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
        true => print(format_args!("{}\n", json_text(&value()))),
        false => people(),
    }
}

/// JSON text of a value, with indented lines. Characters that a terminal would execute are written as JSON escapes, which keeps the
/// value the same.
pub fn json_text(value: &serde_json::Value) -> String {
    let mut text = String::new();
    for letter in format!("{value:#}").chars() {
        match letter {
            '\n' => text.push(letter),
            _ if is_harmful(letter) => text.push_str(&format!("\\u{:04x}", u32::from(letter))),
            _ => text.push(letter),
        }
    }
    text
}

/// The path of an input as one line. A file name may contain line ends, and the text after one could be a command to a CI service.
pub fn path_line(path: &std::path::Path) -> String {
    one_line(&path.display().to_string())
}

/// Replaces control characters, except line ends and tabs, by U+FFFD. Texts from files, boards and services may have control
/// characters, which a terminal would execute.
pub fn shown(text: &str) -> String {
    let harmless = |letter: char| match letter {
        '\n' | '\t' => letter,
        _ if is_harmful(letter) => '\u{fffd}',
        _ => letter,
    };
    text.chars().map(harmless).collect()
}

/// Same as `println!`, without a panic on a closed pipe; for the output that is the purpose of a command.
macro_rules! say {
    ($($text:tt)*) => { $crate::out::print(format_args!("{}\n", format_args!($($text)*)))? };
}
/// Same as [`say`], for progress and summaries, which `--json` and `--quiet` suppress.
macro_rules! tell {
    ($($text:tt)*) => { if !$crate::out::json() && !$crate::out::quiet() { $crate::out::say!($($text)*) } };
}
/// Prints a note or a warning on standard error, as one line. Text after a line end in a file's name could be a command to a CI
/// service.
macro_rules! note {
    ($($text:tt)*) => { if !$crate::out::quiet() { eprintln!("{}", touchstone_sim::harmless::one_line(&format!($($text)*))) } };
}
pub(crate) use {note, say, tell};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_for_a_terminal_is_the_same_value() {
        let value = serde_json::json!({ "name": "a\u{1b}[31m\u{7f}\u{9b}\u{202e}\u{2028}\nß" });
        let text = json_text(&value);
        assert!(
            !text
                .chars()
                .any(|letter| letter != '\n' && is_harmful(letter)),
            "{text:?}"
        );
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&text).unwrap(),
            value
        );
        assert_eq!(shown("a\u{9b}b\tc\n"), "a\u{fffd}b\tc\n");
    }
}
