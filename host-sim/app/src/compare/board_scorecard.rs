//! `touchstone compare --hand programme`: compares the scorecard of a board with that of its simulation. On the board, a program
//! moved the hand as the scorecard prescribes.

use super::{APART, Options};
use crate::out::{self, note, say, tell};
use std::process::ExitCode;
use touchstone_lab::scorecard::on_board::{BoardRecording, board_card};
use touchstone_lab::scorecard::on_board_page::{section, text};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::Scene;

/// Runs the command `touchstone compare --hand programme`.
pub fn main(options: &Options, scene: &Scene) -> Result<ExitCode> {
    if options.from > 0.0 || options.to.is_some() {
        let option = if options.from > 0.0 { "--from" } else { "--to" };
        return Err(Error::Option {
            option: option.into(),
            problem: "does not apply to a programme, which is compared action by action".into(),
            fix: "leave it out".into(),
        });
    }
    let files = std::iter::once(&options.recording).chain(&options.also);
    let recordings: Result<Vec<_>> = files.map(|file| BoardRecording::read(file)).collect();
    let card = board_card(scene, &recordings?)?;
    let result = serde_json::json!(card);
    let page = options.written(scene, &[section(&card)], &result)?;
    let beyond = options
        .tolerance
        .map_or(0, |share| card.beyond(share).count());
    out::result(
        || {
            let mut value = result.clone();
            value["holds"] = (beyond == 0).into();
            value["page"] = page.display().to_string().into();
            value
        },
        || {
            say!("{}", text(&card).trim_end());
            tell!("{}", page.display());
            Ok(())
        },
    )?;
    if beyond == 0 {
        return Ok(ExitCode::SUCCESS);
    }
    let share = options.tolerance.unwrap_or_default();
    note!("apart: {beyond} figures by more than {share} of the scene's, and more than the scatter");
    Ok(ExitCode::from(APART))
}
