//! Options of every command that writes a report.

use super::number;
use touchstone_lab::report::{FileOptions, PARQUET, ProgramVersion};

/// Options on the files of a report's folder.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct ReportOptions {
    /// Writes traces as Parquet alone, a tenth of the size; needs a program with that feature.
    #[arg(long, value_parser = parquet_alone)]
    no_csv: bool,
    /// Writes each Nth tick into traces; the figures show all.
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true, value_parser = number::within(1_u32, u32::MAX, "of ticks"))]
    every: u32,
    /// Replaces what another command left in the folder.
    #[arg(long)]
    force: bool,
}

impl ReportOptions {
    /// Files for the report.
    pub fn files(&self) -> FileOptions {
        FileOptions {
            no_csv: self.no_csv,
            every: self.every as usize,
            force: self.force,
        }
    }
}

/// `--no-csv` leaves nothing where there is no Parquet.
fn parquet_alone(word: &str) -> Result<bool, String> {
    match (word, PARQUET) {
        ("true", false) => Err(
            "this program was built without Parquet; build it with its feature, as in cargo run --release --features parquet".to_owned(),
        ),
        _ => Ok(word == "true"),
    }
}

/// This program, with the commit that it was built from.
pub fn program() -> ProgramVersion {
    ProgramVersion {
        version: env!("CARGO_PKG_VERSION"),
        commit: Some(env!("TOUCHSTONE_COMMIT")).filter(|commit| !commit.is_empty()),
        modified: env!("TOUCHSTONE_MODIFIED") == "true",
        ..ProgramVersion::default()
    }
}

/// Name, version and commit of this program.
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
