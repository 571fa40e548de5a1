//! The first part of a report: picture, a sentence on what was compared, explanations, and one table. Tables for other conditions
//! are folded.

use std::fmt::Write;

use super::ReportInput;
use super::anchor::{row_id, run_id};
use super::label;
use super::matrix::{Column, Matrix};
use super::origin::Origin;
use super::picture;
use super::quantity::{plain, with_unit};
use super::svg::{self, escape, typeset};
use touchstone_control::LawKind;
use touchstone_sim::run::record::{Run, Verdict};

/// A verdict as symbol and name, so that verdicts do not differ by colour alone.
pub fn verdict(verdict: Verdict) -> String {
    let words = label::verdict_words(verdict);
    format!("<i aria-hidden=\"true\">{}</i> {}", words.sign, words.name)
}

/// A verdict as a small coloured label.
pub fn badge(of: Verdict) -> String {
    let key = label::verdict_words(of).key;
    format!("<span class=\"badge {key}\">{}</span>", verdict(of))
}

/// Describes in one or two sentences what the report compares.
pub fn compared(input: &ReportInput, matrices: &[Matrix]) -> String {
    let runs = input.runs;
    let conditions = match matrices {
        [] => return "Nothing was run.".to_owned(),
        [only] => only.condition.text(),
        [first, ..] => format!("{}, first", first.condition.text()),
    };
    if let [run] = runs {
        return format!(
            "One run of {} at k_de = {} N·m/rad: {conditions}.",
            label::run_name(&run.summary),
            plain(run.summary.k_desired)
        );
    }
    let mut laws: Vec<Column> = runs.iter().map(|run| Column::of(&run.summary)).collect();
    laws.sort_unstable();
    laws.dedup();
    let mut stiffnesses: Vec<f64> = runs.iter().map(|run| run.summary.k_desired).collect();
    stiffnesses.sort_by(f64::total_cmp);
    stiffnesses.dedup();
    let names = |all: Vec<String>| all.join(", ");
    let traced = runs.iter().filter(|run| run.trace.is_some()).count();
    format!(
        "{} runs: {} at k_de = {} N·m/rad, under {} ({conditions}). {}",
        runs.len(),
        names(laws.iter().map(|law| law.name().to_owned()).collect()),
        names(stiffnesses.iter().map(|&k| plain(k)).collect()),
        match matrices.len() {
            1 => "one set of conditions".to_owned(),
            count => format!("{count} sets of conditions"),
        },
        if traced == runs.len() {
            "The figures of every run are below.".to_owned()
        } else {
            format!(
                "The figures of {traced} are below; for the others the command that makes them is given."
            )
        }
    )
}

/// Writes explanations of the terms that occur on the page.
pub fn words(page: &mut String, input: &ReportInput) {
    page.push_str("<dl class=\"words\">");
    let mut word = |name: &str, meaning: &str| {
        let _ = write!(page, "<div><dt>{name}</dt><dd>{meaning}</dd></div>");
    };
    word(
        "k<sub>de</sub>",
        "desired stiffness of the wall; displayed is mean force over mean penetration at the end of the hold",
    );
    if let Some(k) = input.k_critical {
        let meaning = format!(
            "critical stiffness 2 c<sub>i</sub>/T = {}: a plain spring is stable up to it",
            with_unit(k, "N·m/rad", 3)
        );
        word("k<sub>c</sub>", &meaning);
    }
    let mut verdicts: Vec<Verdict> = input.runs.iter().map(|run| run.summary.verdict).collect();
    verdicts.sort();
    verdicts.dedup();
    for of in verdicts {
        word(&badge(of), label::verdict_words(of).meaning);
    }
    let mut laws: Vec<LawKind> = input.runs.iter().map(|run| run.summary.law).collect();
    laws.sort_by_key(|&law| label::law_order(law));
    laws.dedup();
    for law in laws {
        let words = label::law_words(law);
        word(&escape(words.name), words.meaning);
    }
    if let Some(run) = input.runs.iter().find(|run| run.summary.shown_as.is_some()) {
        let meaning = format!(
            "{} with the settings that come with the program, behind the energy guard",
            label::law(run.summary.law)
        );
        word(&escape(label::run_name(&run.summary)), &meaning);
    }
    page.push_str("</dl>\n");
}

/// Writes the picture at the top of the report.
pub fn picture(page: &mut String, input: &ReportInput) {
    let figures = picture::figures(input);
    // A single run shows its figures at once, so no link to them is needed.
    if figures.is_empty() || input.runs.len() < 2 {
        return;
    }
    page.push_str("<section class=\"picture\" aria-label=\"Summary picture\">\n");
    for (index, figure) in figures.iter().enumerate() {
        let _ = writeln!(
            page,
            "<figure><figcaption><strong>{}</strong><span class=\"note\">{}</span></figcaption>{}{}</figure>",
            typeset(&figure.title),
            typeset(&figure.description),
            svg::draw(figure, picture::SIZE, &format!("p{index}")),
            svg::legend(figure)
        );
    }
    page.push_str("</section>\n");
}

/// Writes the first table, and the other tables folded.
pub fn tables(page: &mut String, input: &ReportInput, origin: &Origin, matrices: &[Matrix]) {
    let [leading, others @ ..] = matrices else {
        return;
    };
    page.push_str("<section>\n<h2 id=\"verdicts-0\">Verdicts</h2>\n");
    let title = if others.is_empty() {
        String::new()
    } else {
        format!(
            "{}. Last line of a cell: number of conditions, of all {}, in which the run came to rest. ",
            leading.condition.text(),
            matrices.len()
        )
    };
    table(page, input.runs, leading, 0, &title, Some(matrices));
    page.push_str("</section>\n");
    let traceless = input.runs.iter().any(|run| run.trace.is_none());
    if others.is_empty() && !traceless {
        return;
    }
    let names: Vec<&str> = others.iter().map(|m| m.distinction.as_str()).collect();
    let _ = writeln!(
        page,
        "<details id=\"others\"><summary><h2>{}</h2> <span class=\"note\">{}</span></summary>",
        if others.is_empty() {
            "Runs without figures"
        } else {
            "Other conditions"
        },
        escape(&names.join("; "))
    );
    for (index, matrix) in others.iter().enumerate() {
        let _ = writeln!(
            page,
            "<h3 id=\"verdicts-{}\">{}</h3>",
            index + 1,
            escape(&matrix.distinction)
        );
        table(page, input.runs, matrix, index + 1, "", None);
    }
    without_figures(page, input, origin);
    page.push_str("</details>\n");
}

/// Number of conditions in which the law came to rest at this stiffness, and number in which it was run.
fn over_conditions(runs: &[Run], all: &[Matrix], law: Column, k: f64) -> (usize, usize) {
    let mut held = 0;
    let mut total = 0;
    for matrix in all {
        for row in (0..matrix.stiffnesses.len()).filter(|&row| matrix.stiffnesses[row] == k) {
            for index in matrix
                .row(row)
                .filter(|&i| Column::of(&runs[i].summary) == law)
            {
                total += 1;
                held += usize::from(runs[index].summary.verdict < Verdict::LimitCycle);
            }
        }
    }
    (held, total)
}

fn table(
    page: &mut String,
    runs: &[Run],
    matrix: &Matrix,
    index: usize,
    title: &str,
    all: Option<&[Matrix]>,
) {
    let _ = write!(
        page,
        "<table class=\"matrix\" role=\"table\">\n\
         <caption>{}Verdict; stiffness displayed at the end of the hold; motion there, peak to peak. \
         Each cell leads to its run.</caption>\n<thead role=\"rowgroup\"><tr role=\"row\"><th scope=\"col\" role=\"columnheader\">k<sub>de</sub> (N·m/rad)</th>",
        escape(title)
    );
    // The ARIA roles repeat the meaning of the elements, because browsers forget it when a narrow window lays the table out as
    // lists.
    for law in &matrix.laws {
        let _ = write!(
            page,
            "<th scope=\"col\" role=\"columnheader\">{}</th>",
            law.name()
        );
    }
    page.push_str("</tr></thead>\n<tbody role=\"rowgroup\">\n");
    for (row, k) in matrix.stiffnesses.iter().enumerate() {
        let head = format!(
            "<span class=\"narrow\">k<sub>de</sub> = </span>{}<span class=\"narrow\"> N·m/rad</span>",
            plain(*k)
        );
        // Only a stiffness with figures gets a link.
        let head = if matrix.row(row).any(|i| runs[i].trace.is_some()) {
            format!("<a href=\"#{}\">{head}</a>", row_id(index, row))
        } else {
            head
        };
        let _ = write!(
            page,
            "<tr role=\"row\"><th scope=\"row\" role=\"rowheader\">{head}</th>"
        );
        for (column, law) in matrix.laws.iter().enumerate() {
            page.push_str("<td role=\"cell\">");
            for &run in &matrix.cells[row][column] {
                let often = all
                    .filter(|all| all.len() > 1)
                    .map(|all| over_conditions(runs, all, *law, *k));
                cell(page, &runs[run], run, often);
            }
            page.push_str("</td>");
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</tbody>\n</table>\n");
}

fn cell(page: &mut String, run: &Run, index: usize, often: Option<(usize, usize)>) {
    let s = &run.summary;
    let stiffness = s
        .k_displayed
        .map_or("not held".to_owned(), |k| with_unit(k, "N·m/rad", 3));
    let cycle = s.limit_cycle_peak_to_peak.map_or("–".to_owned(), |a| {
        format!("{} p–p", with_unit(a, "rad", 2))
    });
    let often = often.map_or(String::new(), |(held, total)| {
        format!("<span class=\"muted\">rests in {held} of {total}</span>")
    });
    let _ = write!(
        page,
        "<a class=\"cell {}\" href=\"#{}\"><span class=\"law\">{}</span><b>{}</b><span>{}</span><span class=\"muted\">{}</span>{often}</a>",
        label::verdict_words(s.verdict).key,
        run_id(index),
        label::run_name(s),
        verdict(s.verdict),
        typeset(&stiffness),
        typeset(&cycle),
    );
}

/// Writes a list of the runs without a trace, each with the command that makes its figures.
fn without_figures(page: &mut String, input: &ReportInput, origin: &Origin) {
    let bare: Vec<usize> = (0..input.runs.len())
        .filter(|&index| input.runs[index].trace.is_none())
        .collect();
    if bare.is_empty() {
        return;
    }
    page.push_str("<h3 id=\"bare\">Runs without figures, and the command that makes them, from this report's folder</h3>\n<ul class=\"bare\">\n");
    for index in bare {
        let s = &input.runs[index].summary;
        let _ = writeln!(
            page,
            "<li id=\"{}\">{} {}, k<sub>de</sub> {}, {}{}</li>",
            run_id(index),
            badge(s.verdict),
            label::run_name(s),
            plain(s.k_desired),
            escape(&label::Condition::of(s).text()),
            command(origin, index)
        );
    }
    page.push_str("</ul>\n");
}

/// Command that makes a report of this run alone; empty if the run's scene was not written out.
pub fn command(origin: &Origin, index: usize) -> String {
    let files = origin.runs.get(index);
    let Some((files, scene)) = files.and_then(|f| f.scene.as_ref().map(|scene| (f, scene))) else {
        return String::new();
    };
    format!(
        "<code>touchstone run {} --out plots/{}</code>",
        escape(&scene.path),
        escape(&files.name)
    )
}
