//! Report page of the comparison in three degrees of freedom: a picture, tables, claims, and the folded figures of every run.

mod picture;
mod results;
pub mod schema;

use std::fmt::Write;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use touchstone_sim::error::Result;
use touchstone_sim::run::verdict::Verdict;

use crate::scorecard::measure::Measure;
use crate::thesis::claims::Claim;
use crate::thesis::space::held_out::HeldOut;
use crate::thesis::space::held_out_cause::HeldOutCause;
use crate::thesis::space::tuned::DirectionCard;
use crate::thesis::space::tuned_wall::TunedWall;
use crate::thesis::space::{Mechanism, Object, Phase, RATE_HZ, Record, figures};
pub use results::{numbers, results};
use touchstone_report::html::table;
use touchstone_report::staging::{Staging, io_error};
use touchstone_report::svg::{self, Size, escape};
use touchstone_report::write::Written;
use touchstone_report::{FileOptions, ProgramVersion, label, previous};

const SIZE: Size = Size {
    width: 460,
    height: 280,
};
const PAGE: &str = "index.html";
const RESULTS: &str = "results.json";
/// Names of the files in the report's folder.
pub(super) const FILES: [&str; 2] = [RESULTS, PAGE];

/// Contents of the report page in three degrees of freedom.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// Command line that repeats the report.
    pub command: &'a str,
    /// Version of the program.
    pub program: ProgramVersion,
    /// Which files to write, and whether they may replace others.
    pub files: FileOptions,
    /// Mechanism of the simulated device.
    pub mechanism: Mechanism,
    /// Results of the tuned law on walls that were not used to choose its settings.
    pub held_out: Option<&'a HeldOut>,
    /// The runs with their records.
    pub runs: &'a [Record],
    /// The thesis' claims, with whether the runs confirm them.
    pub claims: &'a [Claim],
    /// Scorecards of the tuned law, one per direction.
    pub cards: &'a [DirectionCard],
}

/// Table rows on walls that were not used to choose a setting: measure, worst value, median, number of walls beyond the limit, and
/// the wall with the worst value.
fn held_out_rows(found: &HeldOut) -> Vec<[String; 5]> {
    let rows = found.worst().into_iter().map(|it| {
        let (heading, factor) = match it.measure {
            // In three axes the ripple is that of a force, not of a torque.
            Measure::RippleRmsNM => ("ripple mN", 1e3),
            _ => it.measure.heading(),
        };
        let shown = |value: Option<f64>| {
            value.map_or("lost".to_owned(), |value| format!("{:.3}", factor * value))
        };
        [
            heading.to_owned(),
            shown(it.value),
            shown(it.median),
            it.beyond.to_string(),
            it.wall,
        ]
    });
    rows.collect()
}

/// Formats the results on walls that were not used to choose a setting as text.
#[must_use]
pub fn held_out_text(found: &HeldOut) -> String {
    let mut text = format!(
        "The tuned law on {} walls of seed {} that its setting was not chosen on: {} with a figure beyond its limit: {}; settled {} after the ramp at worst\n",
        found.cells.len(),
        found.seed,
        found.failed(),
        found.causes(),
        found
            .settle_s()
            .map_or("never".to_owned(), |s| format!("{s:.3} s"))
    );
    let head = ["figure", "worst", "median", "beyond", "wall of the worst"].map(str::to_owned);
    for [figure, worst, median, beyond, wall] in std::iter::once(head).chain(held_out_rows(found)) {
        let _ = writeln!(
            text,
            "  {figure:14} {worst:>9} {median:>9} {beyond:>7}  {wall}"
        );
    }
    for cell in found.cells.iter().filter(|cell| !cell.fails().is_empty()) {
        let fails = cell.fails();
        let names: Vec<_> = fails.iter().map(|(it, _)| it.heading().0).collect();
        let _ = writeln!(
            text,
            "  beyond: {}: {} at up to {:.2} N, for {}",
            cell.drawn.text(),
            names.join(", "),
            cell.longest_n,
            cell.cause.map_or("", HeldOutCause::text)
        );
    }
    text
}

/// Writes the page and `results.json` into a folder. On an error no new file is left.
///
/// # Errors
/// The errors of [`touchstone_report::write::write`].
pub fn write(input: &Input, folder: &Path) -> Result<Written> {
    let names = FILES.map(str::to_owned);
    let stale = previous::stale(folder, input.command, input.files.force, &names)?;
    let files: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
    let page = page(input);
    let results = format!("{:#}\n", results(input));
    let bytes = (page.len() + results.len()) as u64;
    let publish = || -> io::Result<()> {
        let staging = Staging::new(folder)?;
        fs::write(staging.path.join(RESULTS), results)?;
        fs::write(staging.path.join(PAGE), page)?;
        staging.publish(&files, &stale)
    };
    publish().map_err(|error| io_error(folder, &error))?;
    Ok(Written {
        page: folder.join(PAGE),
        files,
        bytes,
    })
}

/// Writes the section on the thesis' claims.
fn claims_section(page: &mut String, claims: &[Claim]) {
    page.push_str(
        "<section>\n<h2 id=\"claims\">What the thesis claims, and what the simulation shows</h2>\n",
    );
    table(
        page,
        "Claims in three degrees of freedom",
        &["Claim", "Where", "Statement", "Outcome", "Measured"],
        claims.iter().map(|claim| {
            [
                claim.name.to_owned(),
                claim.source.to_owned(),
                claim.statement.to_owned(),
                claim.outcome.name().to_owned(),
                claim.measured.clone(),
            ]
        }),
    );
    page.push_str("</section>\n");
}

/// Writes the section on the tuned law, with one scorecard per direction.
fn directions_section(page: &mut String, mechanism: Mechanism, cards: &[DirectionCard]) {
    page.push_str("<section>\n<h2 id=\"directions\">The tuned law in each direction</h2>\n");
    table(
        page,
        &format!(
            "At {} N/mm and 1 kHz; in each direction the worst of all devices in three hands",
            1e-3 * TunedWall::of(mechanism, RATE_HZ).k_desired_n_per_m
        ),
        &[
            "Direction",
            "Peak (limit 1.1; 1.3 late)",
            "Settled (s)",
            "Held (%, 5)",
            "Letting go (%, 15)",
            "|F/x| (%, 10)",
            "Phase (°, 12)",
            "Ripple (N)",
            "Beyond a limit",
        ],
        cards.iter().map(|card| {
            let worst = card.worst();
            let percent = |measure| format!("{:.1}", 100.0 * worst.figures.get(measure));
            [
                card.at.name.to_owned(),
                format!("{:.3}", worst.figures.get(Measure::PeakPenetrationRatio)),
                worst
                    .settle_s
                    .map_or("never".to_owned(), |s| format!("{s:.3}")),
                percent(Measure::StiffnessErrorHeld),
                percent(Measure::StiffnessErrorRelease),
                percent(Measure::ModulusError),
                format!("{:.1}", worst.figures.get(Measure::PhaseDeg)),
                format!("{:.3}", worst.figures.get(Measure::RippleRmsNM)),
                card.fails().len().to_string(),
            ]
        }),
    );
    page.push_str("</section>\n");
}

fn title(mechanism: Mechanism, compares: bool) -> &'static str {
    match (compares, mechanism) {
        (false, Mechanism::Cartesian) => "A stiff virtual object on an omega.3",
        (false, Mechanism::Delta) => "A stiff virtual object on a delta mechanism",
        (true, Mechanism::Cartesian) => {
            "Stiff virtual objects on an omega.3: five approaches, and what ships"
        }
        (true, Mechanism::Delta) => {
            "Stiff virtual objects on a delta mechanism: five approaches, and what ships"
        }
    }
}

const ABOUT_ALL: &str = "The hand presses each object, holds, slides along it and lets go. The five approaches have the thesis' settings (§5.2). \
    \"Shipped\" is the wall of the command touchstone device run on such a device: tuned for it, on estimated states, followed by the energy guard.";
const ABOUT_ONE: &str = "The hand presses the object, holds, slides along it and lets go.";

/// Displayed stiffness in N/mm as text; the reason if the run has none.
fn displayed(run: &Record, stiffness: f64) -> String {
    match run.judged().0 {
        Verdict::Unstable | Verdict::LimitCycle => "rings".to_owned(),
        none @ (Verdict::NotJudged | Verdict::NoContact) => label::verdict(none).to_owned(),
        Verdict::Passive | Verdict::Active => format!("{stiffness:.2}"),
    }
}

/// Displayed stiffness at rest as text for a terminal: one row per law and stiffness, one column per object.
#[must_use]
pub fn runs_text(runs: &[Record]) -> String {
    let mut text = String::from(
        "Displayed stiffness at rest, N/mm (\"rings\": never at rest; \"shipped\": the tuned wall with the energy guard)\n",
    );
    let _ = write!(text, "  {:16} {:>5}", "approach", "k_de");
    for object in Object::ALL {
        let _ = write!(text, " {:>17}", object.name());
    }
    let first = runs.iter().filter(|run| run.cell.object == Object::ALL[0]);
    for row in first {
        let (approach, k) = (row.cell.approach, row.cell.k_desired_n_per_mm);
        let _ = write!(text, "\n  {:16} {k:>5}", approach.name());
        let same =
            |run: &&Record| run.cell.approach == approach && run.cell.k_desired_n_per_mm == k;
        for run in runs.iter().filter(same) {
            let shown = displayed(run, run.displayed_n_per_mm(run.late(Phase::Hold, 0.25)));
            let _ = write!(text, " {shown:>17}");
        }
    }
    text + "\n"
}

/// Writes the table of the runs' measures.
fn runs_section(page: &mut String, runs: &[Record]) {
    page.push_str("<section>\n<h2 id=\"runs\">Runs</h2>\n<dl class=\"words\">");
    let mut verdicts: Vec<_> = runs.iter().map(|run| run.judged().0).collect();
    verdicts.sort();
    verdicts.dedup();
    for verdict in verdicts {
        let words = label::verdict_words(verdict);
        let _ = write!(
            page,
            "<div><dt>{}</dt><dd>{}</dd></div>",
            words.name, words.meaning
        );
    }
    page.push_str("</dl>\n");
    table(
        page,
        "At rest and sliding",
        &[
            "Object",
            "Approach",
            "desired stiffness k_de (N/mm)",
            "Verdict",
            "At rest (N/mm)",
            "Ripple (mm)",
            "Sliding (N/mm)",
            "Speed (mm/s)",
            "Tangential/normal",
            "Its largest step",
        ],
        runs.iter().map(|run| {
            let [rest, ripple, sliding, speed, tangential, step, ..] = numbers(run).map(|n| n.1);
            let (verdict, why) = run.judged();
            let why = why.map_or(String::new(), |why| format!(": {why}"));
            [
                run.cell.touched(),
                run.cell.approach.name().to_owned(),
                format!("{}", run.cell.k_desired_n_per_mm),
                format!("{}{why}", label::verdict(verdict)),
                displayed(run, rest),
                format!("{ripple:.4}"),
                displayed(run, sliding),
                format!("{speed:.1}"),
                format!("{tangential:.4}"),
                format!("{step:.4}"),
            ]
        }),
    );
    page.push_str("</section>\n");
}

/// The page as one file that needs no network. The picture comes first; the figures of a single run are not folded.
#[must_use]
pub fn page(input: &Input) -> String {
    let compares = input.runs.len() > 1;
    let title = title(input.mechanism, compares);
    let about = if compares { ABOUT_ALL } else { ABOUT_ONE };
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n<style>\n{}</style>\n</head>\n<body>\n\
         <header>\n<h1>{title}</h1>\n<p>Simulated on {}. {}</p>\n</header>\n<main>\n",
        touchstone_report::PAGE_STYLE,
        escape(input.mechanism.about()),
        escape(about)
    );
    page.push_str(&picture::section(input.runs));
    if let ([run], false) = (input.runs, compares) {
        page.push_str(&figures_of(run, 0, true));
    }
    runs_section(&mut page, input.runs);
    if !input.claims.is_empty() {
        claims_section(&mut page, input.claims);
    }
    if !input.cards.is_empty() {
        directions_section(&mut page, input.mechanism, input.cards);
    }
    if let Some(found) = input.held_out {
        page.push_str(
            "<section>\n<h2 id=\"held-out\">The tuned law where its setting was not chosen</h2>\n",
        );
        table(
            &mut page,
            &format!(
                "{} walls, hands and devices of seed {}; ripple has no limit",
                found.cells.len(),
                found.seed
            ),
            &[
                "Figure",
                "Worst",
                "Median",
                "Walls beyond its limit",
                "Wall of the worst",
            ],
            held_out_rows(found),
        );
        page.push_str("</section>\n");
    }
    let further = if compares { input.runs } else { &[] };
    let drawn: Vec<String> = further
        .par_iter()
        .enumerate()
        .map(|(i, run)| figures_of(run, i, false))
        .collect();
    drawn.iter().for_each(|part| page.push_str(part));
    let _ = write!(
        page,
        "</main>\n<footer>\n<p>This report again:</p>\n<pre>{}</pre>\n<p>All numbers: <a href=\"results.json\">results.json</a>.</p>\n<p>Touchstone {}</p>\n</footer>\n</body>\n</html>\n",
        escape(input.command),
        input.program.version
    );
    page
}

fn figures_of(run: &Record, index: usize, open: bool) -> String {
    let cell = &run.cell;
    let open = if open { " open" } else { "" };
    let mut part = format!(
        "<details id=\"run-{index}\"{open}><summary><h2>{}, {} N/mm, {} ({})</h2></summary>\n",
        cell.touched(),
        cell.k_desired_n_per_mm,
        cell.approach.name(),
        figures::reference(cell.object, cell.approach)
    );
    part.push_str("<div class=\"plots\">\n");
    for (number, figure) in figures::of(run).iter().enumerate() {
        let _ = writeln!(
            part,
            "<figure class=\"plot\">{}{}<figcaption>{}. {}</figcaption></figure>",
            svg::draw(figure, SIZE, &format!("r{index}-{number}")),
            svg::legend(figure),
            escape(&figure.title),
            escape(&figure.description)
        );
    }
    part.push_str("</div>\n</details>\n");
    part
}
