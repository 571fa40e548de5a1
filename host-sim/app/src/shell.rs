//! `touchstone completions` and `touchstone man`: shell completions and manual pages, generated from the definition of the command
//! line.

use super::Cli;
use super::out::{print, tell};
use super::whole::{Named, is_of_same_command};
use clap::CommandFactory;
use clap_complete::Shell;
use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::harmless::is_harmful;
use touchstone_sim::output;

/// This program's command line, quoted so that a shell parses it into the same arguments. Bytes that are not UTF-8 appear as
/// U+FFFD.
pub fn command_line() -> String {
    let given = std::env::args_os().skip(1);
    let words = given.map(|given| word(&given.to_string_lossy()));
    let words = std::iter::once("touchstone".to_owned()).chain(words);
    words.collect::<Vec<_>>().join(" ")
}

/// Quotes a word so that a shell reads it as one literal argument. Control characters are replaced by U+FFFD, because a terminal
/// would execute them.
pub fn word(text: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "_-.,/:=+@%".contains(letter);
    if !text.is_empty() && text.chars().all(is_plain) {
        return text.to_owned();
    }
    let shown: String = text
        .chars()
        .map(|letter| {
            if is_harmful(letter) {
                '\u{fffd}'
            } else {
                letter
            }
        })
        .collect();
    format!("'{}'", shown.replace('\'', r"'\''"))
}

/// Options of `touchstone completions`.
#[derive(Debug, Clone, clap::Args)]
pub struct Completions {
    /// Name of the shell.
    shell: Shell,
}

/// Options of `touchstone man`.
#[derive(Debug, Clone, clap::Args)]
pub struct Man {
    /// Folder for the pages of all commands; without it, the program's page is printed on standard output.
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

/// Prints the completion script for a shell.
pub fn completions(options: &Completions) -> Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut Cli::command(), "touchstone", &mut text);
    print(format_args!("{}", String::from_utf8_lossy(&text)))
}

/// Prints the program's manual page, or writes the pages of all commands to a folder.
pub fn man(options: &Man) -> Result<()> {
    match &options.folder {
        Some(folder) => {
            let mut command = Cli::command().disable_help_subcommand(true);
            command.build();
            let wrong = |error| io(folder, &error);
            output::in_folder(folder, wrong, || pages(&command, folder))?;
            tell!("{}", folder.join("touchstone.1").display());
            Ok(())
        }
        None => {
            let mut text = Vec::new();
            clap_mangen::Man::new(Cli::command())
                .render(&mut text)
                .map_err(|error| io(Path::new("standard output"), &error))?;
            print(format_args!("{}", String::from_utf8_lossy(&text)))
        }
    }
}

fn io(path: &Path, error: &std::io::Error) -> Error {
    Error::Io {
        path: path.to_owned(),
        problem: error.to_string(),
        fix: "give another folder".to_owned(),
    }
}

/// Writes the manual pages of a command's subcommands, then the command's own page. Replaces pages that this program wrote earlier.
fn pages(command: &clap::Command, folder: &Path) -> Result<()> {
    for own in command.get_subcommands().filter(|own| !own.is_hide_set()) {
        pages(own, folder)?;
    }
    let man = clap_mangen::Man::new(command.clone());
    let file = folder.join(man.get_filename());
    let mut text = Vec::new();
    man.render(&mut text).map_err(|error| io(&file, &error))?;
    let place = Named {
        path: &file,
        option: "its folder",
        replaces: is_of_same_command(&file, ".TH touchstone"),
    };
    place.write(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_stays_one_word() {
        for (text, shown) in [
            ("press-hold", "press-hold"),
            (
                "wall.k_desired_n_m_per_rad=1e-3",
                "wall.k_desired_n_m_per_rad=1e-3",
            ),
            ("", "''"),
            ("my scene.toml", "'my scene.toml'"),
            ("a;rm -rf ~", "'a;rm -rf ~'"),
            ("$(id)`id`", "'$(id)`id`'"),
            ("it's", r"'it'\''s'"),
            ("'; id; '", r"''\''; id; '\'''"),
            ("~", "'~'"),
            ("*", "'*'"),
            ("a\n\u{1b}[31m\u{3}", "'a\u{fffd}\u{fffd}[31m\u{fffd}'"),
        ] {
            assert_eq!(word(text), shown);
        }
    }

    /// Checks that a real shell parses the quoted command line into the original words.
    #[cfg(unix)]
    #[test]
    fn a_shell_takes_it_for_the_same() {
        for text in [
            "$HOME",
            "a'b\"c",
            "\\",
            "!!",
            "{a,b}",
            "x y\u{e9}",
            "-n",
            "#",
            "a&b|c>d",
        ] {
            let line = format!("printf %s {}", word(text));
            let out = std::process::Command::new("sh")
                .args(["-c", &line])
                .output();
            assert_eq!(
                String::from_utf8(out.unwrap().stdout).unwrap(),
                text,
                "{line}"
            );
        }
    }
}
