//! `touchstone scorecard`: what a hand feels of a wall, law by law.

use super::interrupt;
use super::out::{self, say, tell};
use super::progress;
use super::report_options::program;
use super::wall_options::WallOptions;
use std::path::PathBuf;
use touchstone_lab::report::{self, pages};
use touchstone_lab::scorecard::{
    self, Entry, page,
    rivals::{RIVALS, Rival},
};
use touchstone_lab::tune::{self, Effort};
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// Options of `scorecard`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene or path of a TOML file with a scene or only its device.
    #[arg(default_value = "thesis-knob")]
    scene: String,
    #[command(flatten)]
    wall: WallOptions,
    /// Laws to compare, default: all.
    #[arg(long = "law", value_name = "NAME", num_args = 1.., value_parser = clap::builder::PossibleValuesParser::new(RIVALS.map(|rival| rival.name)))]
    laws: Vec<String>,
    /// Tunes every law for this device first, as `touchstone tune` does.
    #[arg(long)]
    tuned: bool,
    /// With --tuned: looks for seconds instead of minutes.
    #[arg(long, requires = "tuned")]
    quick: bool,
    /// With --tuned: seed of the search.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Writes a page, results.json and, with --tuned, the settings of every law to this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replaces what another command left in the folder.
    #[arg(long)]
    force: bool,
}

/// Runs it.
pub fn main(options: &Options) -> Result<()> {
    let scene = options.wall.load(&options.scene)?;
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
            intro: "What a hand feels of a wall under several laws, on the device as it is and as it may also be.",
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
    Ok(())
}

/// A law, and the settings that were found for it.
type Tuned = (String, String);

/// The laws with their settings; those of tuned ones as files.
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
        let asked = tune::Options {
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
