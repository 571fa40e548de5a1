//! `touchstone compare`: compares a recording of a device with its simulation.

mod board_scorecard;

use super::SceneOptions;
use super::number::{self, measured};
use super::out::{self, note, say, tell};
use super::report_options::program;
use std::path::PathBuf;
use std::process::ExitCode;
use touchstone_lab::beside::{Beside, HandWas, PARTS, WallRecording, beside, sections};
use touchstone_report as report;
use touchstone_report::{Section, pages};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::Scene;

/// Exit code if recording and simulation differ by more than the tolerance.
const APART: u8 = 3;
/// A parameter of the knob that differs from the scene's by a smaller fraction than this is not reported. An encoder's step and the
/// scatter of a fit cause as much.
const SAME: f64 = 0.1;
/// A changed parameter is named as the reason of a difference only if it reduces the rms difference between recording and
/// simulation to less than this fraction of its value.
const EXPLAINS: f64 = 0.5;

/// Options of the command `touchstone compare`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Recording that `touchstone monitor --csv` wrote, with every control period.
    recording: PathBuf,
    /// The scene file of the recorded knob, as `touchstone setup` writes it, or the name of a shipped scene.
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// What the hand did. held: it held the knob all the time, with the scene's grip; its motion is computed from the recording.
    /// released: it flicked the knob towards the wall and had let go 20 ms before the contact. programme: it followed the
    /// scorecard's programme of motions.
    #[arg(long, value_enum, default_value_t = Hand::Held)]
    hand: Hand,
    /// With --hand programme: another recording of the board, with the wall's surface at another place within an encoder count
    /// (`touchstone scorecard --programme FILE --place SHARE`). Several recordings show the scatter of the board's figures. May be
    /// given several times.
    #[arg(long, value_name = "FILE.csv")]
    also: Vec<PathBuf>,
    /// Begins at this time of the recording, s.
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number::not_negative("in s"))]
    from: f64,
    /// Ends at this time of the recording, s; without this option, at its end.
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = number::up_to(1e9, "of seconds"))]
    to: Option<f64>,
    /// Ends with exit code 3 if the rms difference of position or force exceeds this fraction of the recorded range. With --hand
    /// programme: if one of the board's figures differs from the scene's by more than this fraction and by more than the scene's
    /// own scatter.
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, value_parser = number::not_negative("a share"))]
    tolerance: Option<f64>,
    /// Folder for the page, its numbers, and the hand's motion.
    #[arg(long, value_name = "DIR", default_value = "touchstone-compare")]
    out: PathBuf,
    /// Replaces the files that another command left in the folder.
    #[arg(long)]
    force: bool,
}

/// What the hand did during the recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Hand {
    /// The hand held the knob all the time.
    Held,
    /// The hand let go of the knob before the contact with the wall.
    Released,
    /// The hand followed the scorecard's programme of motions.
    Programme,
}

/// Fields of the scene that the recording replaces, each with a description of the new value. `--set` refuses these fields.
const REPLACED: [(&str, &str); 2] = [
    ("operator.motion", "the recorded motion"),
    ("wall.surface_rad", "the device's surface"),
];

/// Runs the command `touchstone compare`.
pub fn main(options: &Options) -> Result<ExitCode> {
    options.changes.refuse_replaced("compare", &REPLACED)?;
    report::check_folder(&options.out, &crate::command_line(), options.force)?;
    let (scene, _) = options.changes.load(&options.scene)?;
    if options.hand != Hand::Programme && !options.also.is_empty() {
        return Err(Error::Option {
            option: "--also".into(),
            problem: "is of a hand that does a programme".into(),
            fix: "add --hand programme, or leave it out".into(),
        });
    }
    let hand = match options.hand {
        Hand::Held => HandWas::Holding,
        Hand::Released => HandWas::Gone,
        Hand::Programme => return board_scorecard::main(options, &scene),
    };
    let told = WallRecording::read(
        &options.recording,
        options.from,
        options.to.unwrap_or(f64::INFINITY),
    )?;
    let found = beside(&scene, &told, hand, &options.out)?;
    let result = found.to_json();
    let page = options.written(&scene, &sections(&found), &result)?;
    let holds = options.tolerance.is_none_or(|share| found.holds(share));
    out::result(
        || {
            let mut value = result.clone();
            value["holds"] = holds.into();
            value["page"] = page.display().to_string().into();
            value
        },
        || {
            print(&found)?;
            tell!("{}", page.display());
            Ok(())
        },
    )?;
    if holds {
        return Ok(ExitCode::SUCCESS);
    }
    note!(
        "apart: more than {} of what was recorded",
        options.tolerance.unwrap_or_default()
    );
    Ok(ExitCode::from(APART))
}

impl Options {
    /// Writes the HTML page of the comparison; returns its path.
    fn written(
        &self,
        scene: &Scene,
        sections: &[Section],
        result: &serde_json::Value,
    ) -> Result<PathBuf> {
        let page = pages::Page {
            title: "A recording beside its simulation",
            intro: &format!("{} and the scene {}", self.recording.display(), scene.name),
            command: &crate::command_line(),
            program: program(),
            sections,
            results: ("compare", result),
            files: &[],
            force: self.force,
        };
        Ok(pages::write(&page, &self.out)?.page)
    }
}

fn print(found: &Beside) -> Result<()> {
    if let (Some(first), Some(last)) = (found.time_s.first(), found.time_s.last()) {
        tell!("{} ticks, from {first} s to {last} s", found.time_s.len());
    }
    if found.lost_ticks > 0 {
        tell!(
            "{} ticks were lost on the way; the longest stretch without a gap is compared",
            found.lost_ticks
        );
    }
    if found.limited_ticks > 0 {
        tell!(
            "in {} control periods a limit of the device reduced the force; the simulation does not model it",
            found.limited_ticks
        );
    }
    for it in &found.differences {
        let parts = match it.parts_at_s {
            Some(at) => format!("part at {at:.3} s"),
            None => format!("never {:.0} % apart", 100.0 * PARTS),
        };
        say!(
            "{:<9} rms {} {}, {:.2} % of its span; worst {} at {:.3} s; {parts}",
            it.what,
            measured(it.rms, 3),
            it.unit,
            100.0 * it.share,
            measured(it.worst, 3),
            it.worst_at_s
        );
    }
    let as_it_is = found.differences[0].rms;
    match found.fits.first() {
        Some(best) if (best.factor - 1.0).abs() > SAME && best.rms_rad < EXPLAINS * as_it_is => {
            say!(
                "a knob with {:.2} times the scene's {} would fit better: rms {:.3e} rad",
                best.factor,
                best.field,
                best.rms_rad
            );
        }
        _ => say!("no other inertia, damping or friction explains the difference better"),
    }
    Ok(())
}
