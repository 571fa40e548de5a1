//! `touchstone scorecard`: compares what a hand feels of a wall under each control law, or judges a feel.

use super::family;
use super::feel_card;
use super::interrupt;
use super::number;
use super::out::{self, say, tell};
use super::progress;
use super::report_options::program;
use super::wall_options::WallOptions;
use super::whole::Named;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use touchstone_control::Choice as _;
use touchstone_lab::scorecard::{
    self, Entry,
    cases::GRIPS,
    on_board::{deed_words, programme_csv},
    page,
    rivals::{RIVALS, Rival},
};
use touchstone_lab::tune::{self, Effort};
use touchstone_report::{self as report, pages};
use touchstone_sim::error::Result;
use touchstone_sim::scene::{Grip, Scene};

/// Options of `touchstone scorecard`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene or path of a TOML file with a scene or only its device.
    #[arg(default_value = "thesis-knob")]
    scene: String,
    #[command(flatten)]
    wall: WallOptions,
    #[command(flatten)]
    family: family::Options,
    #[command(flatten)]
    feel: feel_card::Options,
    /// Control laws to compare, default: all; with --family the scene's own.
    #[arg(long = "law", value_name = "NAME", num_args = 1.., value_parser = super::law_name::of_scorecard())]
    laws: Vec<String>,
    /// Tunes every control law for this device first, as `touchstone tune` does.
    #[arg(long)]
    tuned: bool,
    /// With --tuned: searches for seconds instead of minutes.
    #[arg(long, requires = "tuned")]
    quick: bool,
    /// Seed of the search (--tuned) or of the randomly varied devices (--family).
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Writes a page, results.json and, with --tuned, the settings of every law to this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replaces files that another command left in the folder, and an existing programme file.
    #[arg(long)]
    force: bool,
    /// Only writes the hand's motion to this file, with a row per control period for every grip: for a hand on a test stand or in
    /// the emulator. `touchstone compare --hand programme` compares a recording of this motion with the scorecard.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["laws", "tuned", "out"])]
    programme: Option<PathBuf>,
    /// With --programme: shifts the wall's surface by this fraction of an encoder count.
    #[arg(long, value_name = "SHARE", requires = "programme", allow_negative_numbers = true, value_parser = number::within(0.0, 1.0, "of a count"))]
    place: Option<f64>,
    /// With --programme: writes only the motion with this grip.
    #[arg(long, value_name = "GRIP", requires = "programme", value_parser = clap::builder::PossibleValuesParser::new(GRIPS.map(Grip::name)))]
    grip: Option<String>,
    /// With --programme: writes only these actions of the hand, such as press; may be given several times.
    #[arg(long = "deed", value_name = "DEED", requires = "programme", num_args = 1.., value_parser = deed)]
    deeds: Vec<String>,
}

/// Runs `touchstone scorecard`.
pub fn main(options: &Options) -> Result<ExitCode> {
    let scene = options.wall.load("scorecard", &options.scene)?;
    if let Some(file) = &options.programme {
        return programme(&scene, options, file).map(|()| ExitCode::SUCCESS);
    }
    if options.feel.is_asked() {
        return options.feel.main(&scene);
    }
    if options.family.is_asked() {
        return options
            .family
            .main(&scene, &laws(&scene, options)?, options.seed);
    }
    let command = super::command_line();
    if let Some(folder) = &options.out {
        report::check_folder(folder, &command, options.force)?;
        interrupt::clean_up()?;
        interrupt::sweep(folder);
    }
    let mut rivals: Vec<&'static Rival> = Vec::new();
    for name in &options.laws {
        rivals.push(Rival::named(name)?);
    }
    if rivals.is_empty() {
        rivals.extend(RIVALS.iter());
    }
    let (entries, files) = entries(&scene, &rivals, options)?;
    let bar = progress::bar(entries.len() as u64, "judging laws");
    let card = scorecard::scorecard(&scene, &entries, |_| bar.inc(1))?;
    bar.finish_and_clear();
    let value = serde_json::json!(card);
    out::result(
        || value.clone(),
        || {
            say!("{}", page::text(&card).trim_end());
            Ok(())
        },
    )?;
    if let Some(folder) = &options.out {
        let sections = page::sections(&card);
        let title = format!("Scorecard: {}", card.scene);
        let page = pages::Page {
            title: &title,
            intro: "What a hand feels of a wall under several control laws, on this device and on devices near it.",
            command: &command,
            program: program(),
            sections: &sections,
            results: ("scorecard", &value),
            files: &files,
            force: options.force,
        };
        let written = pages::write(&page, folder)?;
        tell!("page  {}", written.page.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// Control laws to compare on a set of varied devices: those from `--law`, or the scene's own.
fn laws(scene: &Scene, options: &Options) -> Result<Vec<(String, Scene)>> {
    if options.laws.is_empty() {
        return Ok(vec![(scene.law.kind.word().to_owned(), scene.clone())]);
    }
    let of = |name: &String| Ok((name.clone(), Rival::named(name)?.of(scene)));
    options.laws.iter().map(of).collect()
}

/// Parses the name of a hand's action.
fn deed(word: &str) -> std::result::Result<String, String> {
    let words = deed_words();
    match words.iter().any(|it| it == word) {
        true => Ok(word.to_owned()),
        false => Err(format!("is not one of {}", words.join(", "))),
    }
}

/// Writes the hand's motion programme, one CSV row per control period.
fn programme(scene: &Scene, options: &Options, file: &Path) -> Result<()> {
    let place = Named {
        path: file,
        option: "--programme",
        replaces: options.force,
    };
    place.check()?;
    let grip = options.grip.as_deref();
    let asked = |it: &Grip| grip.is_none_or(|grip| it.name() == grip);
    let grips: Vec<Grip> = GRIPS.into_iter().filter(asked).collect();
    let mut scene = scene.clone();
    let count_rad = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
    scene.wall.surface_rad += options.place.unwrap_or_default() * count_rad;
    let text = programme_csv(&scene, &grips, &options.deeds)?;
    place.write(&text)?;
    let ticks = text.lines().count() - 1;
    out::result(
        || serde_json::json!({"file": file.display().to_string(), "ticks": ticks}),
        || {
            tell!("{ticks} ticks in {}", file.display());
            Ok(())
        },
    )
}

/// Name of a control law, and the text of the settings file that tuning found for the law.
type Tuned = (String, String);

/// The control laws to compare, each with its scene, and the settings files of tuned control laws.
fn entries(
    scene: &Scene,
    rivals: &[&'static Rival],
    options: &Options,
) -> Result<(Vec<Entry>, Vec<Tuned>)> {
    let mut files = Vec::new();
    let mut entries = Vec::new();
    for rival in rivals {
        if !options.tuned {
            entries.push(Entry {
                rival,
                scene: rival.of(scene),
                tuned: false,
            });
            continue;
        }
        let asked = tune::TuneOptions {
            seed: options.seed,
            effort: match options.quick {
                true => Effort::Quick,
                false => Effort::Full,
            },
            ripple_n_m: None,
        };
        let bar = progress::bar(1, rival.name);
        let tuned = tune::tune(scene, rival, &asked, |done, all| {
            bar.set_length(all);
            bar.set_position(done);
        })?;
        bar.finish_and_clear();
        files.push((format!("{}.toml", rival.name), tune::settings::toml(&tuned)));
        entries.push(Entry {
            rival,
            scene: tuned.scene,
            tuned: true,
        });
    }
    Ok((entries, files))
}
