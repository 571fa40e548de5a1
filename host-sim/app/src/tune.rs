//! `touchstone tune`: searches the settings of a control law for a device.

use super::expect::NOT_MET;
use super::interrupt;
use super::number;
use super::out::{self, json, path_line, say, tell};
use super::progress;
use super::report_options::program;
use super::wall_options::WallOptions;
use super::whole::{Named, is_of_same_command};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use touchstone_lab::beside;
use touchstone_lab::identify::noise;
use touchstone_lab::scorecard::rivals::{MOST_DELAY_TICKS, Rival, delay_ticks};
use touchstone_lab::scorecard::{self, Entry, Scorecard, page};
use touchstone_lab::tune::cost::NOISE_DEG;
use touchstone_lab::tune::diagnosis::{FailureCause, of_row};
use touchstone_lab::tune::own_firmware::{self, CFile, OwnFirmware};
use touchstone_lab::tune::pareto::{self, Point};
use touchstone_lab::tune::{self, Effort, Tuned, settings};
use touchstone_report::{self as report, Block, Section, pages};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{Scene, SensorNoise};

/// Options of `touchstone tune`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene, or path of a TOML file with a scene or only its tables device, encoder, timing and wall.
    #[arg(default_value = "thesis-knob")]
    device: String,
    #[command(flatten)]
    wall: WallOptions,
    /// Control law to tune.
    #[arg(long, value_name = "NAME", default_value = "enhanced", value_parser = super::law_name::of_scorecard())]
    law: String,
    /// Seed of the search: the same seed finds the same settings.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Searches for seconds instead of minutes, with fewer devices and fewer settings.
    #[arg(long)]
    quick: bool,
    /// Largest allowed force ripple on the nominal device, N·m. Default: 0.6 times the ripple of a spring-damper on position
    /// differences that is stable at the same delays; 1.1 times if the delay is a whole control period.
    #[arg(long, value_name = "N_M", value_parser = number::up_to(100.0, "N·m"))]
    ripple: Option<f64>,
    /// Noise of the position sensor with which every limit must hold, degrees rms; default: the scene's `sensor.noise`.
    #[arg(long, value_name = "DEG", value_parser = number::within(0.0, 10.0, "degrees"))]
    noise: Option<f64>,
    /// Measures that noise from a recording of the knob at rest with the motor off, of at least 3,000 records, as `touchstone monitor
    /// --csv FILE.csv` writes it.
    #[arg(long, value_name = "FILE.csv", conflicts_with = "noise")]
    noise_from: Option<PathBuf>,
    /// Writes the settings to this file: FILE.toml for `touchstone config import` and for `--settings`, FILE.rs, FILE.c or FILE.h
    /// for a firmware of your own. Writes nothing if the settings fail a limit (exit code 3). Replaces an existing file only if it
    /// has settings of the same law and scene.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Writes a page with scorecard, Pareto table and its plot, results.json and the settings to this folder.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Replaces files of another command, and writes settings even if a device exceeds a limit.
    #[arg(long)]
    force: bool,
}

/// The language of a settings file, chosen by the file name's extension; TOML without an extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Language {
    Toml,
    Rust,
    C(CFile),
}

impl Language {
    fn of(file: &Path) -> Result<Self> {
        match file.extension().and_then(|ending| ending.to_str()) {
            None | Some("toml") => Ok(Self::Toml),
            Some("rs") => Ok(Self::Rust),
            Some("c") => Ok(Self::C(CFile::Source)),
            Some("h") => Ok(Self::C(CFile::Header)),
            _ => Err(Error::Option {
                option: format!("--out {}", path_line(file)),
                problem: "the file's ending does not say which language to write".to_owned(),
                fix: "give a file that ends in .toml, .rs (Rust), .c or .h (C)".to_owned(),
            }),
        }
    }

    fn text(self, tuned: &Tuned) -> Result<String> {
        Ok(match self {
            Self::Toml => settings::toml(tuned),
            Self::Rust => OwnFirmware::new(tuned)?.rust(),
            Self::C(file) => OwnFirmware::new(tuned)?.c(file),
        })
    }
}

impl Options {
    /// Noise of the position sensor that the user gives or recorded, rad rms; `None` without an option.
    fn noise_rad(&self, scene: &Scene) -> Result<Option<f64>> {
        let Some(file) = &self.noise_from else {
            return Ok(self.noise.map(f64::to_radians));
        };
        let encoder = beside::encoder(scene)?;
        let counts = beside::counts(file, encoder)?;
        let rms_counts = noise::rms_counts(&counts).map_err(|why| Error::Io {
            path: file.clone(),
            problem: why.to_string(),
            fix: "record the knob at rest for some seconds, with the motor off (touchstone monitor --csv FILE.csv), or give the noise (--noise DEG)"
                .to_owned(),
        })?;
        Ok(Some(rms_counts * encoder.step_rad()))
    }
}

/// Runs `touchstone tune`.
pub fn main(options: &Options) -> Result<ExitCode> {
    let mut scene = options.wall.load("tune", &options.device)?;
    if let Some(rms_rad) = options.noise_rad(&scene)? {
        // Zero too is a noise that is known: without any, the search assumes the usual one.
        scene.sensor.noise = Some(SensorNoise { rms_rad });
    }
    refuse_late(&scene)?;
    let rival = Rival::named(&options.law)?;
    let command = super::command_line();
    let mark = settings::title(rival, &scene);
    let language = options.out.as_deref().map(Language::of).transpose()?;
    if !matches!(language, None | Some(Language::Toml)) {
        // Refused before the search, which takes minutes.
        own_firmware::settings(&rival.to_tune(&scene))?;
    }
    let place = options.out.as_deref().map(|path| Named {
        path,
        option: "--out",
        replaces: options.force || is_of_same_command(path, &mark),
    });
    place.map_or(Ok(()), |place| place.check())?;
    if let Some(folder) = &options.report {
        report::check_folder(folder, &command, options.force)?;
        interrupt::clean_up()?;
        interrupt::sweep(folder);
    }
    let asked = tune::TuneOptions {
        seed: options.seed,
        effort: match options.quick {
            true => Effort::Quick,
            false => Effort::Full,
        },
        ripple_n_m: options.ripple,
    };
    let bar = progress::bar(1, "searching");
    let tuned = tune::tune(&scene, rival, &asked, |done, all| {
        bar.set_length(all);
        bar.set_position(done);
    })?;
    bar.set_message("what it costs");
    bar.set_length(pareto::count(&tuned, options.quick));
    bar.set_position(0);
    let points = pareto::points(&tuned, options.quick, || bar.inc(1));
    bar.finish_and_clear();
    let entry = Entry {
        rival,
        scene: tuned.scene.clone(),
        tuned: true,
    };
    let card = scorecard::with_reference(&scene, &[entry], tuned.reference, |_| ());
    let text = settings::toml(&tuned);
    let row = &card.rows[0];
    let cause = of_row(&tuned.scene, row, &tuned.reference);
    let kept = cause.is_none() || options.force;
    if let Some(place) = place.filter(|_| kept) {
        place.write(language.map_or(Ok(text.clone()), |it| it.text(&tuned))?)?;
    }
    if let Some(folder) = options.report.as_ref().filter(|_| kept) {
        written(options, folder, &command, &tuned, &card, &points, &text)?;
    }
    if json() {
        let mut value = value(&tuned, &card, &points);
        value["cause"] = serde_json::json!(cause);
        out::print(format_args!("{}\n", out::json_text(&value)))?;
    } else {
        print(options, &tuned, &card, &points)?;
        match &options.out {
            Some(file) if kept => tell!("settings  {}", file.display()),
            _ => say!("\n{}", text.trim_end()),
        }
    }
    let Some(cause) = cause else {
        return Ok(ExitCode::SUCCESS);
    };
    complain(&scene, options, &row.fails, cause);
    Ok(ExitCode::from(NOT_MET))
}

/// Prints one line of error if tuning fails: the scene, the failed limit, the cause and the remedy.
fn complain(scene: &Scene, options: &Options, fails: &[String], cause: FailureCause) {
    let worst = fails.first().map_or("no run was possible", String::as_str);
    let unwritten = options.out.is_some() || options.report.is_some();
    let mut fix = vec!["choose a softer wall"];
    if options.quick {
        fix.push("search longer without --quick");
    }
    if unwritten && !options.force {
        fix.push("to write it anyway: --force");
    }
    eprintln!(
        "error: {}: no setting was found that holds every device within every limit: {worst}; cause: {}{}; {}",
        scene.name,
        cause.words(),
        if unwritten && !options.force {
            "; nothing was written"
        } else {
            ""
        },
        fix.join(", or ")
    );
}

/// Returns an error if the scene's delay is longer than the energy guard allows: a device runs tuned settings only with the guard.
fn refuse_late(scene: &Scene) -> Result<()> {
    let ticks = delay_ticks(scene);
    if ticks <= MOST_DELAY_TICKS {
        return Ok(());
    }
    let rate_hz = f64::from(scene.timing.rate_hz) / ticks;
    Err(Error::Option {
        option: "timing.computational_delay_s".to_owned(),
        problem: format!(
            "with the guard's own delay it is {ticks:.3} control periods, and the energy guard covers at most one"
        ),
        fix: format!(
            "take a rate of {rate_hz:.0} Hz or less (--set timing.rate_hz=), or shorten the delay"
        ),
    })
}

fn value(tuned: &Tuned, card: &Scorecard, points: &[Point]) -> serde_json::Value {
    let settings: serde_json::Map<String, serde_json::Value> = tuned
        .parameters
        .iter()
        .map(|(path, value)| ((*path).to_owned(), (*value).into()))
        .collect();
    serde_json::json!({
        "law": tuned.rival.name,
        "seed": tuned.seed,
        "evaluations": tuned.evaluations,
        "settings": settings,
        "noise_deg": noise_deg(tuned),
        "scorecard": card,
        "pareto": points,
    })
}

/// Noise of the position sensor for which the law was tuned, degrees rms; `None` if none was given.
fn noise_deg(tuned: &Tuned) -> Option<f64> {
    let noise = tuned.scene.sensor.noise.as_ref();
    noise.map(|noise| noise.rms_rad.to_degrees())
}

/// The noise for which the law was tuned, in words.
fn noise_words(options: &Options, tuned: &Tuned) -> String {
    let noise = match noise_deg(tuned) {
        None if tuned.scene.encoder.is_none() => "not given".to_owned(),
        None => format!("not given; the search also tried {NOISE_DEG}° rms"),
        Some(0.0) if options.noise_from.is_some() => "less than the encoder resolves".to_owned(),
        Some(0.0) => "none".to_owned(),
        Some(noise_deg) => format!("{noise_deg:.6}° rms"),
    };
    let file = options.noise_from.as_deref().map(path_line);
    let measured = file.map_or_else(String::new, |file| format!(", measured in {file}"));
    format!("noise of the position sensor: {noise}{measured}")
}

fn print(options: &Options, tuned: &Tuned, card: &Scorecard, points: &[Point]) -> Result<()> {
    say!("{}", page::text(card).trim_end());
    say!("");
    say!("{}", page::devices(card).trim_end());
    say!("");
    say!(
        "{} settings were tried (seed {})",
        tuned.evaluations,
        tuned.seed
    );
    say!("{}", noise_words(options, tuned));
    for (path, value) in &tuned.parameters {
        say!("  {path} = {value}");
    }
    say!("");
    if points.is_empty() {
        say!("no other setting nearby holds every device, so there is no choice to show");
        return Ok(());
    }
    say!(
        "alternatives: settings that hold every device; none is better than another in stiffness, ripple and delay together"
    );
    for row in table(points).iter().map(|row| row.join("  ")) {
        say!("  {row}");
    }
    Ok(())
}

const COLUMNS: [&str; 4] = [
    "k_de N·m/rad",
    "ripple mN·m",
    "delay margin ticks",
    "estimator Hz",
];

fn table(points: &[Point]) -> Vec<Vec<String>> {
    let mut rows = vec![COLUMNS.map(str::to_owned).to_vec()];
    rows.extend(points.iter().filter(|point| point.best).map(|point| {
        vec![
            format!("{:>12.3}", point.k_desired),
            format!("{:>11.3}", 1e3 * point.ripple_rms_n_m),
            format!("{:>18.2}", point.delay_margin_ticks),
            point
                .bandwidth_hz
                .map_or_else(|| format!("{:>12}", "–"), |hz| format!("{hz:>12.1}")),
        ]
    }));
    rows
}

fn written(
    options: &Options,
    folder: &Path,
    command: &str,
    tuned: &Tuned,
    card: &Scorecard,
    points: &[Point],
    text: &str,
) -> Result<()> {
    let picture = report::standalone("Ripple, stiffness and delay", &[pareto::figure(points)]);
    let mut sections = page::sections(card);
    let mut rows = table(points);
    let header = rows.remove(0);
    sections.push(Section {
        title: "What it costs".to_owned(),
        body: vec![
            Block::Figure(picture.clone()),
            Block::Table {
                caption: "Settings that hold every device. None is better than another in stiffness, ripple and delay together.".to_owned(),
                header,
                rows,
            },
        ],
        folded: false,
    });
    let value = value(tuned, card, points);
    let files = [
        ("settings.toml".to_owned(), text.to_owned()),
        ("pareto.svg".to_owned(), picture),
    ];
    let title = format!("Tuned: {} for {}", tuned.rival.name, card.scene);
    let page = pages::Page {
        title: &title,
        intro: "Settings for a device, judged by what a hand feels of them.",
        command,
        program: program(),
        sections: &sections,
        results: ("tuned", &value),
        files: &files,
        force: options.force,
    };
    let written = pages::write(&page, folder)?;
    tell!("page  {}", written.page.display());
    Ok(())
}
