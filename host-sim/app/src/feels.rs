//! `touchstone feels`: lists the shipped haptic effects of a knob; `touchstone feels edit` opens a page that edits one.

use super::live::{self, EditOptions};
use super::{described, listed};
use std::path::Path;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{self, nearest};

/// Options of the command `touchstone feels`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(subcommand)]
    step: Option<Step>,
}

#[derive(Debug, Clone, clap::Subcommand)]
enum Step {
    /// Writes a page with the feel in an editor, and opens it: add, change and remove its parts, and feel them under the mouse.
    Edit(EditOptions),
}

/// Runs `touchstone feels`: lists the feels, or writes the page that edits one.
pub fn main(options: &Options) -> Result<()> {
    match &options.step {
        Some(Step::Edit(edit)) => {
            is_there(&edit.scene)?;
            live::edit(edit)
        }
        None => list(),
    }
}

fn list() -> Result<()> {
    let ways = [
        "touchstone run NAME                  one run of it under a hand that turns",
        "touchstone feels edit NAME           changes it in the browser, and feels it under the mouse",
        "touchstone run NAME --print          the whole scene; keep it as a file, and change it",
        "touchstone config environment NAME   sends it to a board, or to a knob of `touchstone demo`",
    ];
    listed("feels", &described(scene::feels())?, &ways)
}

/// Returns an error if the name is neither that of a shipped feel or scene nor that of a file.
fn is_there(name: &str) -> Result<()> {
    if scene::is_shipped(name) || Path::new(name).exists() {
        return Ok(());
    }
    Err(Error::Option {
        option: format!("feels edit {name}"),
        problem: "no such feel or file".to_owned(),
        fix: match nearest(name, &scene::feels()) {
            Some(near) => format!("did you mean {near}?"),
            None => "`touchstone feels` lists the feels; or give a scene's file".to_owned(),
        },
    })
}
