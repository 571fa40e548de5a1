//! `touchstone live`: a scene under the mouse, in one file for any browser; or a board, through a page that is served.

use super::SceneOptions;
use super::board_page;
use super::browser::open;
use super::out::{note, result, tell};
use super::report_options::program_name;
use std::path::{Path, PathBuf};
use touchstone_device::Address;
use touchstone_live::page::{self, Content};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{MotionSpec, Scene};

/// Options of `live`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene (see `touchstone scenes`) or path of a scene's TOML file.
    #[arg(default_value = "thesis-knob")]
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// File to write; one that is no such page is left alone.
    #[arg(long, value_name = "PAGE.html", default_value = "touchstone-live.html")]
    out: PathBuf,
    /// Writes the page and does not open it.
    #[arg(long)]
    no_open: bool,
    /// Shows a board instead: serial port (/dev/ttyACM0, COM3) or tcp:HOST:PORT. Serves a page to this machine alone, until Ctrl-C.
    #[arg(long, value_name = "PORT", conflicts_with_all = ["scene", "out", "SceneOptions"])]
    port: Option<Address>,
}

/// Writes the page, and opens it.
pub fn main(options: &Options) -> Result<()> {
    if let Some(address) = &options.port {
        return board_page::main(address, !options.no_open);
    }
    let (scene, _) = options.changes.load(&options.scene)?;
    let scene = without_files(scene)?;
    let command = super::command_line();
    let source = source(&options.scene, &command);
    let page = page::render(&Content {
        scene: &scene.to_toml(),
        name: &scene.name,
        description: &scene.description,
        source: &source,
        program: &program_name(),
    });
    write(&options.out, &page)?;
    let path = std::path::absolute(&options.out).unwrap_or_else(|_| options.out.clone());
    result(
        || serde_json::json!({ "page": path, "bytes": page.len() }),
        || {
            tell!("page    {} ({} kB)", path.display(), page.len() / 1000);
            Ok(())
        },
    )?;
    if !options.no_open && !open(path.as_os_str()) {
        note!("note: no browser was found; open {} in one", path.display());
    }
    Ok(())
}

/// The scene's words on the command line, without the options that are this page's own.
fn source(scene: &str, command: &str) -> String {
    let mut words = command
        .split_whitespace()
        .skip_while(|word| *word != "live");
    words.next();
    let mut kept = vec![scene.to_owned()];
    while let Some(word) = words.next() {
        match word {
            "--out" => drop(words.next()),
            "--no-open" | "--json" | "--quiet" | "-q" => {}
            word if word == scene || word.starts_with("--out=") => {}
            word => kept.push(word.to_owned()),
        }
    }
    kept.join(" ")
}

/// A page cannot read a recording: whoever holds the mouse moves the hand.
fn without_files(scene: Scene) -> Result<Scene> {
    if !matches!(scene.operator.motion, MotionSpec::Recorded(_)) {
        return Ok(scene);
    }
    note!("note: the page has no recording; its hand is the mouse");
    scene.with(|scene| scene.operator.motion = MotionSpec::None)
}

fn write(path: &Path, page: &str) -> Result<()> {
    let io = |error: std::io::Error| Error::Io {
        path: path.to_owned(),
        problem: error.to_string(),
        fix: "give a file that can be written, with --out".to_owned(),
    };
    match std::fs::read(path) {
        Ok(before) if !before.starts_with(page::MARK.as_bytes()) => {
            return Err(Error::Io {
                path: path.to_owned(),
                problem: "is there, and is no page of `touchstone live`".to_owned(),
                fix: "give another file with --out, or remove it".to_owned(),
            });
        }
        _ => {}
    }
    // Whole or not at all: a page that is half there is none.
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let beside = PathBuf::from(beside);
    std::fs::write(&beside, page).map_err(io)?;
    std::fs::rename(&beside, path).map_err(io)
}
