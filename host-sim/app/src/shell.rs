//! `touchstone completions` and `touchstone man`: what a shell and a reader of manuals want, made from the command line's own
//! definition.

use super::Cli;
use super::out::{print, tell};
use clap::CommandFactory;
use clap_complete::Shell;
use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};

/// Options of `completions`.
#[derive(Debug, Clone, clap::Args)]
pub struct Completions {
    /// The shell.
    shell: Shell,
}

/// Options of `man`.
#[derive(Debug, Clone, clap::Args)]
pub struct Man {
    /// Folder for the pages of all commands; without it, the page of the program goes to standard output.
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

/// Prints the completions.
pub fn completions(options: &Completions) -> Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut Cli::command(), "touchstone", &mut text);
    print(format_args!("{}", String::from_utf8_lossy(&text)))
}

/// Prints the manual's page, or writes all of them.
pub fn man(options: &Man) -> Result<()> {
    match &options.folder {
        Some(folder) => {
            std::fs::create_dir_all(folder)
                .and_then(|()| clap_mangen::generate_to(Cli::command(), folder))
                .map_err(|error| io(folder, &error))?;
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
