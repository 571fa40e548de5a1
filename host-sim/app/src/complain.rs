//! Error messages for people: one line with place, problem and remedy, cut to a length that a person can read.

use clap::error::{ContextKind, ContextValue, Error as UsageError, ErrorKind};
use std::error::Error as _;
use touchstone_sim::harmless::is_harmful;

/// Longest word that is printed uncut, in characters: room for a path, but not for a long text that was pasted by mistake.
const WORD_MAX: usize = 200;
/// Longest error message, in characters; longer ones are cut.
const LINE_MAX: usize = 1500;

/// Makes an error's text fit for a person: replaces control characters by `?`, and cuts long words and long texts.
pub fn line(text: &str) -> String {
    let mut short = String::new();
    for (index, word) in text.split([' ', '\n', '\r', '\t']).enumerate() {
        if index > 0 {
            short.push(' ');
        }
        push_cut(&mut short, word, WORD_MAX);
        if short.len() > LINE_MAX {
            break;
        }
    }
    let mut cut = String::new();
    push_cut(&mut cut, &short, LINE_MAX);
    cut.chars()
        .map(|letter| if is_harmful(letter) { '?' } else { letter })
        .collect()
}

/// Appends a text to `out`. Of a text that is longer than `most`, only the beginning and the end are appended.
fn push_cut(out: &mut String, text: &str, most: usize) {
    let letters = text.chars().count();
    if letters <= most {
        out.push_str(text);
        return;
    }
    out.extend(text.chars().take(most / 4));
    out.push_str(&format!("…({letters} characters)…"));
    out.extend(text.chars().skip(letters - most / 8));
}

/// A mistake on the command line as one line of text; `commands` are the names of the program's commands. `None` for help and
/// version, which are no mistakes.
pub fn usage(error: &UsageError, commands: &[&str]) -> Option<String> {
    let text = |kind| error.get(kind).map(ToString::to_string);
    let many = |kind| match error.get(kind) {
        Some(ContextValue::Strings(words)) => words.join(", "),
        Some(other) => other.to_string(),
        None => String::new(),
    };
    // Of `--steps <STEPS>`, only `--steps` is named.
    let option = |kind| {
        text(kind).map(|name| match name.split_once(' ') {
            Some((option, _)) if option.starts_with('-') => option.to_owned(),
            _ => name,
        })
    };
    let place = option(ContextKind::InvalidArg).unwrap_or_else(|| "command line".to_owned());
    let value = text(ContextKind::InvalidValue).unwrap_or_default();
    let help = || "see the command's --help".to_owned();
    let meant = |kind: ContextKind| {
        let near = many(kind);
        match near.is_empty() {
            true => help(),
            false => format!("did you mean {near}?"),
        }
    };
    let (place, problem, fix) = match error.kind() {
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayVersion
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => return None,
        ErrorKind::InvalidValue if value.is_empty() => (place, "has no value".to_owned(), help()),
        ErrorKind::InvalidValue => {
            let words = many(ContextKind::ValidValue);
            let words: Vec<&str> = words.split(", ").filter(|word| !word.is_empty()).collect();
            // A number gets no suggestion: similar digits do not mean a similar intention.
            let is_number = value.parse::<f64>().is_ok();
            let near = touchstone_sim::scene::nearest(&value, &words).filter(|_| !is_number);
            let fix = match near {
                Some(near) => format!("did you mean {near}?"),
                None if words.is_empty() => help(),
                None => format!("give {}", touchstone_sim::scene::list(&words)),
            };
            (place, format!("unknown value \"{value}\""), fix)
        }
        ErrorKind::ValueValidation => {
            let cause = error.source().map_or_else(String::new, ToString::to_string);
            match cause.split_once("; ") {
                Some((problem, fix)) => (place, problem.to_owned(), fix.to_owned()),
                None => (place, format!("\"{value}\": {cause}"), help()),
            }
        }
        ErrorKind::UnknownArgument => (
            place,
            "unknown option or word".to_owned(),
            meant(ContextKind::SuggestedArg),
        ),
        ErrorKind::InvalidSubcommand => {
            let given = text(ContextKind::InvalidSubcommand).unwrap_or_default();
            let fix = match touchstone_sim::scene::nearest(&given, commands) {
                _ if touchstone_sim::scene::is_shipped(&given) => {
                    format!("it is a scene: touchstone run {given}")
                }
                Some(near) => format!("did you mean {near}?"),
                None => meant(ContextKind::SuggestedSubcommand),
            };
            (given, "unknown command".to_owned(), fix)
        }
        ErrorKind::MissingRequiredArgument => (
            "command line".to_owned(),
            format!("{} is missing", many(ContextKind::InvalidArg)),
            "give it, or leave out the option that needs it; see the command's --help".to_owned(),
        ),
        ErrorKind::MissingSubcommand => (
            "command line".to_owned(),
            "a command is missing".to_owned(),
            format!("give one of {}", many(ContextKind::ValidSubcommand)),
        ),
        ErrorKind::ArgumentConflict => {
            let prior = many(ContextKind::PriorArg);
            let problem = match prior.is_empty() || prior.starts_with(&place) {
                true => "was given twice".to_owned(),
                false => format!("cannot be used together with {prior}"),
            };
            (place, problem, "leave one of them out".to_owned())
        }
        _ => {
            let all = error.to_string();
            let first = all.lines().next().unwrap_or_default();
            let first = first.strip_prefix("error: ").unwrap_or(first);
            (place, first.to_owned(), help())
        }
    };
    Some(line(&format!("{place}: {problem}; {fix}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_values_are_cut_and_paths_are_not() {
        let path = format!("/{}", "a/".repeat(90));
        assert_eq!(line(&format!("{path}: no")), format!("{path}: no"));
        let long = line(&format!("--law: unknown value {}", "9".repeat(5_000_000)));
        assert!(
            long.len() < 300 && long.contains("5000000 characters"),
            "{long}"
        );
        let words = line(&"word ".repeat(100_000));
        assert!(words.len() < LINE_MAX, "{}", words.len());
        assert_eq!(line("a\nb\u{1b}[31m"), "a b?[31m");
    }
}
