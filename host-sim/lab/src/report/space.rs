//! The page of the comparison in three degrees of freedom: claims, a table, and the figures of every run, folded.

use std::fmt::Write;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use touchstone_sim::error::Result;

use super::html::table;
use super::staging::{Staging, io_error};
use super::svg::{self, Size, escape};
use super::write::Written;
use super::{FileOptions, ProgramVersion, previous};
use crate::scorecard::measure::Measure;
use crate::thesis::claims::Claim;
use crate::thesis::space::held_out::{HeldOut, HeldOutCell};
use crate::thesis::space::held_out_cause::HeldOutCause;
use crate::thesis::space::tuned::DirectionCard;
use crate::thesis::space::tuned_wall::TunedWall;
use crate::thesis::space::{Mechanism, Phase, RATE_HZ, Record, figures};

const SIZE: Size = Size {
    width: 460,
    height: 280,
};
const PAGE: &str = "index.html";
const RESULTS: &str = "results.json";

/// What the page is made of.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// The command line that makes it again.
    pub command: &'a str,
    /// The program that ran.
    pub program: ProgramVersion,
    /// What is written over what.
    pub files: FileOptions,
    /// What was played on.
    pub mechanism: Mechanism,
    /// The tuned law where its setting was not chosen.
    pub held_out: Option<&'a HeldOut>,
    /// The runs.
    pub runs: &'a [Record],
    /// What was claimed, and how it fared.
    pub claims: &'a [Claim],
    /// The tuned law's scorecards, a direction each.
    pub cards: &'a [DirectionCard],
}

/// The numbers of a run, for people and programs: names with units, and values.
#[must_use]
pub fn numbers(run: &Record) -> [(&'static str, f64); 7] {
    let hold = run.late(Phase::Hold, 0.25);
    let slide = run.late(Phase::Slide, 0.9);
    [
        (
            "displayed_at_rest_n_per_mm",
            run.displayed_n_per_mm(hold.clone()),
        ),
        ("ripple_at_rest_mm", run.ripple_mm(hold)),
        (
            "displayed_sliding_n_per_mm",
            run.displayed_n_per_mm(slide.clone()),
        ),
        ("slide_mm_per_s", run.speed_mm_per_s(slide.clone())),
        (
            "most_tangential_over_normal",
            run.most_tangential(slide.clone()),
        ),
        (
            "largest_tangential_step_over_normal",
            run.largest_jump(slide),
        ),
        ("books_off_j", run.audit_j),
    ]
}

/// `results.json`.
#[must_use]
pub fn results(input: &Input) -> serde_json::Value {
    let runs: Vec<_> = input
        .runs
        .iter()
        .map(|run| {
            let mut value = serde_json::json!({
                "object": run.cell.object.name(),
                "approach": run.cell.approach.name(),
                "k_desired_n_per_mm": run.cell.k_desired_n_per_mm,
                "stopped": run.stopped,
            });
            for (name, number) in numbers(run) {
                value[name] = number.into();
            }
            value
        })
        .collect();
    let claims: Vec<_> = input
        .claims
        .iter()
        .map(|claim| {
            serde_json::json!({
                "name": claim.name,
                "source": claim.source,
                "statement": claim.statement,
                "outcome": claim.outcome.name(),
                "measured": claim.measured,
            })
        })
        .collect();
    serde_json::json!({
        "command": input.command,
        "program": input.program.version,
        "files": [RESULTS, PAGE],
        "dof": 3,
        "mechanism": input.mechanism.word(),
        "held_out": input.held_out.map(held_out_value),
        "runs": runs,
        "claims": claims,
        "directions": directions(input.cards),
    })
}

/// Every direction, with its worst figures, and every device in it.
fn directions(cards: &[DirectionCard]) -> Vec<serde_json::Value> {
    let cells = |card: &DirectionCard| -> Vec<_> {
        let cells = card.cells.iter();
        cells
            .map(|(device, found, _)| {
                serde_json::json!({
                    "device": device,
                    "figures": found.figures,
                    "settle_from_ramp_end_s": found.settle_s,
                })
            })
            .collect()
    };
    cards
        .iter()
        .map(|card| {
            let worst = card.worst();
            serde_json::json!({
                "direction": card.at.name,
                "normal": card.at.normal,
                "worst": worst.figures,
                "settle_from_ramp_end_s": worst.settle_s,
                "devices": cells(card),
            })
        })
        .collect()
}

/// A wall with a figure beyond its limit, for programs.
fn beyond_wall(cell: &HeldOutCell) -> Option<serde_json::Value> {
    let fails = cell.fails();
    let names = || fails.iter().map(|(it, _)| it.heading().0);
    cell.cause.map(|cause| {
        serde_json::json!({
            "wall": cell.drawn.text(),
            "figures": names().collect::<Vec<_>>(),
            "longest_n": cell.longest_n,
            "cause": cause,
        })
    })
}

/// A check on walls that a setting was not chosen on, for programs.
fn held_out_value(found: &HeldOut) -> serde_json::Value {
    serde_json::json!({
        "seed": found.seed,
        "walls": found.cells.len(),
        "beyond": found.failed(),
        "beyond_at_the_motors_limit": found.failed_by(HeldOutCause::MotorsLimit),
        "beyond_walls": found.cells.iter().filter_map(beyond_wall).collect::<Vec<_>>(),
        "settle_from_ramp_end_s": found.settle_s(),
        "worst": found.worst(),
    })
}

/// The rows of such a check: figure, worst, median, how many walls are beyond, and the worst's wall.
fn held_out_rows(found: &HeldOut) -> Vec<[String; 5]> {
    let rows = found.worst().into_iter().map(|it| {
        let (heading, factor) = match it.measure {
            // A force, not a torque.
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

/// The same as text.
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

/// Writes the page and `results.json` into a folder, complete or not at all.
///
/// # Errors
/// As [`super::write::write`].
pub fn write(input: &Input, folder: &Path) -> Result<Written> {
    let names = [RESULTS, PAGE].map(str::to_owned);
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

/// What the thesis claims.
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

/// The tuned law in each direction.
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

/// The page, one file without network.
#[must_use]
pub fn page(input: &Input) -> String {
    let title = match input.mechanism {
        Mechanism::Cartesian => {
            "Stiff virtual objects on an omega.3: five approaches in three degrees of freedom"
        }
        Mechanism::Delta => {
            "Stiff virtual objects on a delta mechanism: five approaches in three degrees of freedom"
        }
    };
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n<style>\n{}</style>\n</head>\n<body>\n\
         <header>\n<h1>{title}</h1>\n<p>The thesis' comparison (§5.2), simulated on {}: each object is probed, held, slid along and let go.</p>\n</header>\n<main>\n",
        include_str!("page.css"),
        escape(input.mechanism.about())
    );
    if !input.claims.is_empty() {
        claims_section(&mut page, input.claims);
    }
    page.push_str("<section>\n<h2 id=\"runs\">Runs</h2>\n");
    table(
        &mut page,
        "At rest and sliding",
        &[
            "Object",
            "Approach",
            "k_de (N/mm)",
            "At rest (N/mm)",
            "Ripple (mm)",
            "Sliding (N/mm)",
            "Speed (mm/s)",
            "Tangential/normal",
            "Its largest step",
        ],
        input.runs.iter().map(|run| {
            let [rest, ripple, sliding, speed, tangential, step, _] = numbers(run).map(|n| n.1);
            [
                run.cell.object.name().to_owned(),
                run.cell.approach.name().to_owned(),
                format!("{}", run.cell.k_desired_n_per_mm),
                format!("{rest:.2}"),
                format!("{ripple:.4}"),
                format!("{sliding:.2}"),
                format!("{speed:.1}"),
                format!("{tangential:.4}"),
                format!("{step:.4}"),
            ]
        }),
    );
    page.push_str("</section>\n");
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
    let drawn: Vec<String> = input
        .runs
        .par_iter()
        .enumerate()
        .map(|(i, run)| figures_of(run, i))
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

fn figures_of(run: &Record, index: usize) -> String {
    let cell = &run.cell;
    let mut part = format!(
        "<details id=\"run-{index}\"><summary><h2>{}, {} N/mm, {} ({})</h2></summary>\n",
        cell.object.name(),
        cell.k_desired_n_per_mm,
        cell.approach.name(),
        figures::reference(cell.object, cell.approach)
    );
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
    part.push_str("</details>\n");
    part
}
