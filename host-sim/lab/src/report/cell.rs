//! The part of the page below the verdicts: for each stiffness the laws side by side, then each run by itself.

use std::fmt::Write;

use super::figures::{Kind, legend};
use super::label;
use super::matrix::Matrix;
use super::quantity::{grouped, plain, significant, with_unit};
use super::svg::{Range, Size, escape};
use super::view::{Ranges, View};
use super::{ReportInput, TraceFiles};
use touchstone_sim::run::record::{Run, Summary, Verdict};

/// Plots side by side, one law each.
const SMALL: Size = Size {
    width: 250,
    height: 190,
};
/// Plots of one run in a row of four.
const MEDIUM: Size = Size {
    width: 330,
    height: 220,
};
/// Plots of the only run of a report, two by two.
const LARGE: Size = Size {
    width: 420,
    height: 260,
};

/// Identifier of a row of a matrix.
pub fn row_id(matrix: usize, row: usize) -> String {
    format!("m{matrix}-k{row}")
}

/// Identifier of a run's plots.
pub fn run_id(index: usize) -> String {
    format!("run-{index}")
}

/// CSS class of a verdict.
pub fn verdict_class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passive => "passive",
        Verdict::Active => "active",
        Verdict::LimitCycle => "limit-cycle",
        Verdict::Unstable => "unstable",
        Verdict::NoContact => "no-contact",
    }
}

/// A verdict as sign and word: colour is never the only difference.
pub fn verdict_words(verdict: Verdict) -> String {
    let sign = match verdict {
        Verdict::Passive => "✓",
        Verdict::Active => "△",
        Verdict::LimitCycle => "≈",
        Verdict::Unstable => "✕",
        Verdict::NoContact => "–",
    };
    format!(
        "<i aria-hidden=\"true\">{sign}</i> {}",
        label::verdict(verdict)
    )
}

/// A verdict as a small coloured label.
pub fn badge(verdict: Verdict) -> String {
    format!(
        "<span class=\"badge {}\">{}</span>",
        verdict_class(verdict),
        verdict_words(verdict)
    )
}

/// Everything about one stiffness.
pub fn row(
    input: &ReportInput,
    files: &[Option<TraceFiles>],
    matrix: &Matrix,
    number: usize,
    row: usize,
) -> String {
    let mut page = String::new();
    let k = matrix.stiffnesses[row];
    let alone = input.runs.len() == 1;
    let _ = writeln!(
        page,
        "<section{}>",
        if alone { " class=\"alone\"" } else { "" }
    );
    let distinction = if matrix.distinction.is_empty() {
        String::new()
    } else {
        format!(" · {}", matrix.distinction)
    };
    let _ = writeln!(
        page,
        "<h2 id=\"{}\">k<sub>de</sub> = {} N·m/rad{}</h2>",
        row_id(number, row),
        plain(k),
        escape(&distinction)
    );
    for (_, note) in input.row_notes.iter().filter(|(of, _)| *of == k) {
        let _ = writeln!(page, "<p>{}</p>", escape(note));
    }
    let views: Vec<(usize, View)> = matrix
        .row(row)
        .filter_map(|index| {
            View::new(&input.runs[index], input.k_critical).map(|view| (index, view))
        })
        .collect();
    if views.len() > 1 {
        side_by_side(&mut page, &views);
    }
    for index in matrix.row(row) {
        let view = views
            .iter()
            .find(|(of, _)| *of == index)
            .map(|(_, view)| view);
        let files = files.get(index).and_then(Option::as_ref);
        article(
            &mut page,
            &input.runs[index],
            view,
            index,
            files,
            if alone { LARGE } else { MEDIUM },
        );
    }
    page.push_str("</section>\n");
    page
}

/// Rows of small plots, one row for each kind, one column for each law, all on the same axes.
fn side_by_side(page: &mut String, views: &[(usize, View)]) {
    let ranges: Vec<Ranges> = views.iter().map(|(_, view)| view.ranges()).collect();
    let mut shared = ranges
        .iter()
        .copied()
        .reduce(Ranges::union)
        .expect("called with runs");
    // An unstable run gives away hundreds of times what the others exchange, and would make flat lines of them.
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
    for kind in Kind::ALL {
        let mut strip = String::new();
        for (index, view) in views {
            let summary = &view.run.summary;
            let _ = write!(
                strip,
                "<figure><figcaption><a href=\"#{}\">{}</a>{}</figcaption>",
                run_id(*index),
                label::law(summary.law),
                badge(summary.verdict)
            );
            let id = format!("s{index}{}", kind.key());
            view.draw(&mut strip, kind, SMALL, &shared, false, &id);
            strip.push_str("</figure>\n");
        }
        let _ = writeln!(
            page,
            "<div class=\"kind\"><h4>{}</h4>{}{}</div>",
            kind.title(),
            write_legend(kind, &strip),
            if clipped && kind == Kind::Energy {
                "<span class=\"aside\">the energy of an unstable run leaves the plot; whole below</span>"
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

/// One run: its numbers and its plots on its own axes.
fn article(
    page: &mut String,
    run: &Run,
    view: Option<&View>,
    index: usize,
    files: Option<&TraceFiles>,
    size: Size,
) {
    let s = &run.summary;
    let _ = write!(
        page,
        "<article id=\"{}\">\n<header><h3>{}, k<sub>de</sub> {}</h3>{}",
        run_id(index),
        label::law(s.law),
        plain(s.k_desired),
        badge(s.verdict)
    );
    if let Some(files) = files {
        let _ = write!(
            page,
            "<span class=\"files\"><a href=\"{}\">CSV</a> · <a href=\"{}\">Parquet</a></span>",
            escape(&files.csv),
            escape(&files.parquet)
        );
    }
    page.push_str("</header>\n<dl class=\"facts\">");
    for (name, value) in facts(s) {
        let _ = write!(
            page,
            "<div><dt>{name}</dt><dd>{}</dd></div>",
            typeset(&value)
        );
    }
    page.push_str("</dl>\n");
    if let Some(view) = view {
        let ranges = view.ranges();
        page.push_str("<div class=\"plots\">\n");
        for kind in Kind::ALL {
            let mut plot = String::new();
            view.draw(
                &mut plot,
                kind,
                size,
                &ranges,
                true,
                &format!("r{index}{}", kind.key()),
            );
            let legend = write_legend(kind, &plot);
            let title = kind.title();
            let _ = writeln!(
                page,
                "<figure><figcaption><strong>{title}</strong></figcaption>{plot}{legend}</figure>"
            );
        }
        page.push_str("</div>\n");
    } else {
        page.push_str("<p class=\"muted\">No trace was kept for this run.</p>\n");
    }
    page.push_str("</article>\n");
}

/// What a run came to, in words and rounded numbers; `results.json` has all digits.
pub fn facts(s: &Summary) -> Vec<(&'static str, String)> {
    let mut facts = Vec::new();
    let k = |k: f64| {
        format!(
            "{} ({} % of k_de)",
            with_unit(k, "N·m/rad", 3),
            significant(100.0 * k / s.k_desired, 3)
        )
    };
    if let Some(value) = s.k_displayed {
        facts.push(("displayed stiffness", k(value)));
    }
    if let Some(value) = s.rate_hardness {
        facts.push(("rate-hardness", k(value)));
    }
    if let Some(value) = s.limit_cycle_peak_to_peak {
        let counts = s
            .encoder_counts_per_rev
            .map(|per_rev| value / std::f64::consts::TAU * per_rev);
        let counts = counts.map_or(String::new(), |c| {
            format!(
                " ({} counts)",
                if c < 0.05 {
                    "0".into()
                } else {
                    significant(c, 2)
                }
            )
        });
        facts.push((
            "limit cycle, peak to peak",
            with_unit(value, "rad", 3) + &counts,
        ));
    }
    if let Some(value) = s.settle_time {
        facts.push(("settled after", with_unit(value, "s", 3)));
    }
    facts.push(("largest force", with_unit(s.force_max, "N·m", 3)));
    facts.push((
        "lowest energy, wall's port",
        with_unit(s.energy_true_min, "J", 3),
    ));
    facts.push(("at the user's port", with_unit(s.energy_user_min, "J", 3)));
    if let Some(value) = s.energy_observed_min {
        facts.push(("as observed", with_unit(value, "J", 3)));
    }
    facts.push((
        "in contact",
        format!(
            "{} of {} ticks",
            grouped(s.contact_ticks as f64),
            grouped(s.ticks as f64)
        ),
    ));
    facts
}

/// Explains the lines that `drawing` has.
fn write_legend(kind: Kind, drawing: &str) -> String {
    let mut out = String::from("<ul class=\"legend\">");
    for (class, text) in legend(kind) {
        if drawing.contains(&format!("class=\"{class}\"")) {
            let _ = write!(
                out,
                "<li><svg viewBox=\"0 0 26 8\" aria-hidden=\"true\"><path class=\"{class}\" d=\"M1 4H25\"/></svg>{}</li>",
                typeset(text)
            );
        }
    }
    out + "</ul>"
}

/// Text of ours for the page: escaped, symbols with their subscripts, numbers with a true minus sign.
pub fn typeset(text: &str) -> String {
    let mut text = escape(text);
    for (plain, subscript) in [
        ("k_de", "k<sub>de</sub>"),
        ("k_c", "k<sub>c</sub>"),
        ("x_s", "x<sub>s</sub>"),
    ] {
        text = text.replace(plain, subscript);
    }
    text.strip_prefix('-')
        .map_or(text.clone(), |rest| format!("\u{2212}{rest}"))
        .replace("(-", "(\u{2212}")
}
