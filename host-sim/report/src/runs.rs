//! The part of the page below the tables: for each requested stiffness the figures of all laws side by side, then each run.

use std::fmt::Write;

use super::ReportInput;
use super::anchor::{row_id, run_id};
use super::figure::Range;
use super::figures::Kind;
use super::label;
use super::matrix::Matrix;
use super::measures::facts;
use super::origin::Origin;
use super::quantity::{plain, with_unit};
use super::summary::{badge, command};
use super::svg::{self, Size, escape, typeset};
use super::try_cell;
use super::view::{Ranges, View};
use touchstone_sim::run::record::{Run, Verdict};

/// Size of figures side by side, one column per law, pixels.
const SMALL: Size = Size {
    width: 250,
    height: 190,
};
/// Size of the figures of one run, three in a row, pixels.
const MEDIUM: Size = Size {
    width: 380,
    height: 230,
};
/// Size of the figures in a report of a single run, two in a row, pixels.
const LARGE: Size = Size {
    width: 480,
    height: 270,
};

/// The section of a report with a single run; it is not folded.
pub fn alone(input: &ReportInput, origin: &Origin) -> String {
    let mut page = String::from("<section class=\"alone\">\n");
    if let Some(run) = input.runs.first() {
        let view = View::new(run, input.k_critical);
        let _ = write!(
            page,
            "<article id=\"{}\">\n<header><h2>{}, k<sub>de</sub> {}</h2>{}{}</header>\n",
            run_id(0),
            label::run_name(&run.summary),
            plain(run.summary.k_desired),
            badge(run.summary.verdict),
            links(origin, 0)
        );
        body(&mut page, run, view.as_ref(), (input, origin), 0, LARGE);
        page.push_str("</article>\n");
    }
    page + "</section>\n"
}

/// The section of one requested stiffness, folded; empty if none of its runs has a recorded trace.
pub fn row(
    input: &ReportInput,
    origin: &Origin,
    matrix: &Matrix,
    number: usize,
    row: usize,
) -> String {
    let views: Vec<(usize, View)> = matrix
        .row(row)
        .filter_map(|index| {
            View::new(&input.runs[index], input.k_critical).map(|view| (index, view))
        })
        .collect();
    let mut page = String::new();
    if views.is_empty() {
        return page;
    }
    let k = matrix.stiffnesses[row];
    let distinction = if matrix.distinction.is_empty() {
        String::new()
    } else {
        format!(" · {}", matrix.distinction)
    };
    let badges: Vec<String> = views
        .iter()
        .map(|(_, view)| {
            let s = &view.run.summary;
            format!("{} {}", label::run_name(s), badge(s.verdict))
        })
        .collect();
    let _ = writeln!(
        page,
        "<details class=\"row\" id=\"{}\"><summary><h2>k<sub>de</sub> = {} N·m/rad{}</h2> <span class=\"note\">{}</span></summary>",
        row_id(number, row),
        plain(k),
        escape(&distinction),
        badges.join(" · ")
    );
    let _ = writeln!(page, "<p>{}</p>", typeset(&found(&views)));
    for (_, note) in input.row_notes.iter().filter(|(of, _)| *of == k) {
        let _ = writeln!(page, "<p class=\"note\">{}</p>", escape(note));
    }
    if views.len() > 1 {
        side_by_side(&mut page, &views);
    }
    for (index, view) in &views {
        let s = &view.run.summary;
        let _ = writeln!(
            page,
            "<details class=\"run\" id=\"{}\"{}><summary><h3>{}, k<sub>de</sub> {}</h3> {}</summary><p class=\"files\">{}</p>",
            run_id(*index),
            if views.len() == 1 { " open" } else { "" },
            label::run_name(s),
            plain(s.k_desired),
            badge(s.verdict),
            links(origin, *index)
        );
        body(
            &mut page,
            view.run,
            Some(view),
            (input, origin),
            *index,
            MEDIUM,
        );
        page.push_str("</details>\n");
    }
    page.push_str("</details>\n");
    page
}

/// Describes the results at one requested stiffness in sentences.
fn found(views: &[(usize, View)]) -> String {
    let mut text = String::new();
    let mut verdicts: Vec<Verdict> = views.iter().map(|(_, v)| v.run.summary.verdict).collect();
    verdicts.sort();
    verdicts.dedup();
    for verdict in verdicts {
        let runs = views
            .iter()
            .map(|(_, view)| &view.run.summary)
            .filter(|s| s.verdict == verdict);
        let names: Vec<String> = runs
            .map(|s| match s.k_displayed {
                Some(k) => format!(
                    "{} shows {}",
                    label::run_name(s),
                    with_unit(k, "N·m/rad", 3)
                ),
                None => match s.limit_cycle_peak_to_peak {
                    Some(a) => {
                        format!("{} moves by {}", label::run_name(s), with_unit(a, "rad", 3))
                    }
                    None => label::run_name(s).to_owned(),
                },
            })
            .collect();
        let mut word = label::verdict(verdict).to_owned();
        word[..1].make_ascii_uppercase();
        let _ = write!(text, "{word}: {}. ", names.join(", "));
    }
    text.trim_end().to_owned()
}

/// Writes rows of small figures: one row per type of figure, one column per law, all on the same axes.
fn side_by_side(page: &mut String, views: &[(usize, View)]) {
    let ranges: Vec<Ranges> = views.iter().map(|(_, view)| view.ranges()).collect();
    let mut shared = ranges
        .iter()
        .copied()
        .reduce(Ranges::union)
        .expect("called with runs");
    // An unstable run exchanges hundreds of times more energy than others, which would become flat lines.
    let whole = shared.energy;
    let calm = views
        .iter()
        .zip(&ranges)
        .filter(|((_, view), _)| view.run.summary.verdict != Verdict::Unstable)
        .map(|(_, ranges)| ranges.energy)
        .reduce(Range::union);
    if let Some(calm) = calm.filter(|calm| calm.max > calm.min) {
        shared.energy = whole.within(calm.padded(1.0, 1.0));
    }
    let clipped = shared.energy != whole;
    page.push_str("<h3>Side by side, on the same axes</h3>\n");
    for kind in Kind::SIDE_BY_SIDE {
        let mut strip = String::new();
        let mut legend = String::new();
        for (index, view) in views {
            let summary = &view.run.summary;
            let figure = view.figure(kind, &shared, false);
            let this = svg::legend(&figure);
            // A law without an observer has one line less.
            if this.len() > legend.len() {
                legend = this;
            }
            let id = format!("s{index}{}", kind.key());
            let _ = writeln!(
                strip,
                "<figure><figcaption><a href=\"#{}\">{}</a>{}</figcaption>{}</figure>",
                run_id(*index),
                label::run_name(summary),
                badge(summary.verdict),
                svg::draw(&figure, SMALL, &id)
            );
        }
        let _ = writeln!(
            page,
            "<div class=\"kind\"><h4>{}</h4>{legend}{}</div>",
            kind.title(),
            if clipped && kind == Kind::Energy {
                "<span class=\"aside\">the energy of an unstable run exceeds this figure; the whole figure is below</span>"
            } else {
                ""
            }
        );
        // A strip that scrolls must be reachable by keyboard.
        let _ = write!(
            page,
            "<div class=\"strip\" role=\"group\" tabindex=\"0\" aria-label=\"{}, laws side by side\">\n{strip}</div>\n",
            kind.title()
        );
    }
}

/// Links to the files of a run.
fn links(origin: &Origin, index: usize) -> String {
    let Some(files) = origin.runs.get(index) else {
        return String::new();
    };
    let files = [
        (files.csv.as_deref(), "CSV"),
        (files.parquet.as_deref(), "Parquet"),
        (
            files.scene.as_ref().map(|scene| scene.path.as_str()),
            "scene",
        ),
    ];
    let link = |(path, name): &(Option<&str>, &str)| {
        path.map(|path| format!("<a href=\"{}\">{name}</a>", escape(path)))
    };
    let links: Vec<String> = files.iter().filter_map(link).collect();
    format!("<span class=\"files\">{}</span>", links.join(" · "))
}

/// The section of one run: its numbers, and its figures on axes of their own.
fn body(
    page: &mut String,
    run: &Run,
    view: Option<&View>,
    (input, origin): (&ReportInput, &Origin),
    index: usize,
    size: Size,
) {
    page.push_str("<dl class=\"facts\">");
    for (name, value) in facts(&run.summary) {
        let _ = write!(
            page,
            "<div><dt>{name}</dt><dd>{}</dd></div>",
            typeset(&value)
        );
    }
    page.push_str("</dl>\n");
    page.push_str(&try_cell::button(input, origin, index));
    let Some(view) = view else {
        let _ = writeln!(
            page,
            "<p class=\"muted\">No trace was kept for this run. {}</p>",
            command(origin, index)
        );
        return;
    };
    let ranges = view.ranges();
    page.push_str("<div class=\"plots\">\n");
    for kind in Kind::ALL {
        let figure = view.figure(kind, &ranges, true);
        let id = format!("r{index}{}", kind.key());
        let _ = writeln!(
            page,
            "<figure><figcaption><strong>{}</strong><span class=\"note\">{}</span></figcaption>{}{}</figure>",
            kind.title(),
            typeset(&figure.description),
            svg::draw(&figure, size, &id),
            svg::legend(&figure)
        );
    }
    page.push_str("</div>\n");
}
