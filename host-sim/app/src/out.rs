//! The program's output by kind; `--quiet` and `--json` suppress some kinds.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::harmless::is_harmful;

/// A reader has gone away.
static CLOSED: AtomicBool = AtomicBool::new(false);
/// `--json`.
static JSON: AtomicBool = AtomicBool::new(false);
/// `--quiet`.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Takes `--json` and `--quiet`, once, before anything is printed.
pub fn choose(json: bool, quiet: bool) {
    JSON.store(json, Ordering::Relaxed);
    QUIET.store(quiet, Ordering::Relaxed);
}

/// Whether the result is wanted as JSON.
pub fn json() -> bool {
    JSON.load(Ordering::Relaxed)
}

/// Whether progress, notes and summaries are unwanted.
pub fn quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Whether standard output is still read; prints nothing.
pub fn is_read() -> bool {
    !CLOSED.load(Ordering::Relaxed)
}

/// Prints what is [`shown`] of a text. A reader that has had enough (`| head`) is no error, and must not keep a report from being written.
pub fn print(text: Arguments<'_>) -> Result<()> {
    put(&shown(&text.to_string()))
}

/// Prints a line over the one that was printed last; with `ends` it stays.
pub fn print_over(line: &str, ends: bool) -> Result<()> {
    put(&format!(
        "\r{}{}",
        shown(line),
        if ends { "\n" } else { "" }
    ))
}

fn put(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
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

/// Prints a result for programs, if that is wanted; otherwise what `people` prints.
pub fn result(
    value: impl FnOnce() -> serde_json::Value,
    people: impl FnOnce() -> Result<()>,
) -> Result<()> {
    match json() {
        true => print(format_args!("{}\n", json_text(&value()))),
        false => people(),
    }
}

/// JSON in lines, with each letter that a terminal would obey as JSON's own escape: the value is the same.
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

/// A text as it may come to a terminal or a log: names and texts from files, boards and services may have control characters, which a
/// terminal would obey.
pub fn shown(text: &str) -> String {
    let harmless = |letter: char| match letter {
        '\n' | '\t' => letter,
        _ if is_harmful(letter) => '\u{fffd}',
        _ => letter,
    };
    text.chars().map(harmless).collect()
}

/// `println!` without its panic, for a command's wanted output.
macro_rules! say {
    ($($text:tt)*) => { $crate::out::print(format_args!("{}\n", format_args!($($text)*)))? };
}
/// Same as [`say`], for progress and summaries, which `--json` and `--quiet` suppress.
macro_rules! tell {
    ($($text:tt)*) => { if !$crate::out::json() && !$crate::out::quiet() { $crate::out::say!($($text)*) } };
}
/// A note or a warning, on standard error.
macro_rules! note {
    ($($text:tt)*) => { if !$crate::out::quiet() { eprintln!("{}", $crate::out::shown(&format!($($text)*))) } };
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
