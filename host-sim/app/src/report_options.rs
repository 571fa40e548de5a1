//! Options of every command that writes a report.

use super::number;
use touchstone_report::{FileOptions, PARQUET, ProgramVersion};

/// Options for the files in a report's folder.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct ReportOptions {
    /// Writes traces as Parquet only, a tenth of the size of CSV; needs a program built with Parquet.
    #[arg(long, value_parser = parquet_alone)]
    no_csv: bool,
    /// Writes only every Nth control period to traces; the figures show all of them.
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true, value_parser = number::within(1_u32, u32::MAX, "of ticks"))]
    every: u32,
    /// Replaces files that another command left in the folder.
    #[arg(long)]
    force: bool,
}

impl ReportOptions {
    /// Converts these options to the settings of the report writer.
    pub fn files(&self) -> FileOptions {
        FileOptions {
            no_csv: self.no_csv,
            every: self.every as usize,
            force: self.force,
        }
    }
}

/// Parses `--no-csv`. Error: the program was built without Parquet, so that no traces would be written.
fn parquet_alone(word: &str) -> Result<bool, String> {
    match (word, PARQUET) {
        ("true", false) => Err(
            "this program was built without Parquet; build it with its feature, as in cargo run --release --features parquet".to_owned(),
        ),
        _ => Ok(word == "true"),
    }
}

/// Version of this program, the Git commit that it was built from, and whether the sources were modified.
pub fn program() -> ProgramVersion {
    ProgramVersion {
        version: env!("CARGO_PKG_VERSION"),
        commit: Some(env!("TOUCHSTONE_COMMIT")).filter(|commit| !commit.is_empty()),
        modified: env!("TOUCHSTONE_MODIFIED") == "true",
        ..ProgramVersion::default()
    }
}

/// Text with name, version and commit of this program.
pub fn program_name() -> String {
    let program = program();
    let commit = program.commit.map(|commit| format!(", commit {commit}"));
    let changed = if program.modified {
        " with changes"
    } else {
        ""
    };
    format!(
        "Touchstone {}{}{changed}",
        program.version,
        commit.unwrap_or_default()
    )
}
