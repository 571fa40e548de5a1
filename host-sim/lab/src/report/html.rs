//! `index.html`: one file, no network, readable without its script.

use std::fmt::Write;

use rayon::prelude::*;

use super::cell;
use super::label;
use super::matrix::{Matrix, matrices};
use super::quantity::{plain, with_unit};
use super::svg::escape;
use super::{Block, ReportInput, TraceFiles};
use touchstone_control::LawKind;
use touchstone_sim::run::record::{Run, Verdict};

/// The whole page. `files` are the trace files of each run, as links relative to the page; empty slice: no links.
pub fn render(input: &ReportInput, files: &[Option<TraceFiles>]) -> String {
    let matrices = matrices(input.runs);
    let rows: Vec<(usize, usize)> = matrices
        .iter()
        .enumerate()
        .flat_map(|(m, matrix)| (0..matrix.stiffnesses.len()).map(move |r| (m, r)))
        .collect();
    // A row of plots needs no other row: draw them on all cores, and put them together in order.
    let rows: Vec<String> = rows
        .into_par_iter()
        .map(|(m, r)| cell::row(input, files, &matrices[m], m, r))
        .collect();

    let mut page = String::with_capacity(64 * 1024 + rows.iter().map(String::len).sum::<usize>());
    let title = escape(input.title);
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n<style>\n{}</style>\n</head>\n<body>\n",
        include_str!("page.css")
    );
    head(&mut page, input, &matrices);
    page.push_str("<main>\n");
    for (index, matrix) in matrices.iter().enumerate() {
        if input.runs.len() > 1 {
            table(&mut page, input.runs, matrix, index);
        }
    }
    if input.runs.len() > 1 {
        words(&mut page, input.runs);
    }
    for section in input.sections {
        let _ = writeln!(
            page,
            "<section>\n<h2 id=\"{}\">{}</h2>",
            anchor(&section.title),
            escape(&section.title)
        );
        section
            .body
            .iter()
            .for_each(|block| write_block(&mut page, block));
        page.push_str("</section>\n");
    }
    rows.iter().for_each(|row| page.push_str(row));
    page.push_str("</main>\n");
    foot(&mut page, input, files);
    let _ = write!(
        page,
        "<script>\n{}</script>\n</body>\n</html>\n",
        include_str!("page.js")
    );
    page
}

fn head(page: &mut String, input: &ReportInput, matrices: &[Matrix]) {
    let _ = writeln!(page, "<header>\n<h1>{}</h1>", escape(input.title));
    if !input.intro.is_empty() {
        let _ = writeln!(page, "<p>{}</p>", escape(input.intro));
    }
    if let [only] = matrices {
        let _ = writeln!(
            page,
            "<p class=\"muted\">{}{}</p>",
            escape(&only.condition.text()),
            critical(input)
        );
    } else if input.k_critical.is_some() {
        let _ = writeln!(
            page,
            "<p class=\"muted\">{}</p>",
            critical(input).trim_start_matches(" · ")
        );
    }
    for note in input.notes {
        let _ = writeln!(
            page,
            "<p class=\"warn\"><strong>Note.</strong> {}</p>",
            escape(note)
        );
    }
    if !input.command.is_empty() {
        let _ = writeln!(
            page,
            "<p class=\"muted\">Regenerate with</p>\n<pre>{}</pre>",
            escape(input.command)
        );
    }
    page.push_str("</header>\n");
    let mut links: Vec<(String, String)> = Vec::new();
    if input.runs.len() > 1 {
        links.push(("verdicts-0".to_owned(), "Verdicts".to_owned()));
    }
    links.extend(
        input
            .sections
            .iter()
            .map(|section| (anchor(&section.title), escape(&section.title))),
    );
    for (index, matrix) in matrices.iter().enumerate() {
        for (row, k) in matrix.stiffnesses.iter().enumerate() {
            // Where tables differ in their conditions, a bare stiffness would stand there several times.
            let which = if row == 0 && !matrix.distinction.is_empty() {
                format!("{}: ", escape(&matrix.distinction))
            } else {
                String::new()
            };
            links.push((
                cell::row_id(index, row),
                format!("{which}k<sub>de</sub> {}", plain(*k)),
            ));
        }
    }
    if links.len() > 1 {
        page.push_str("<nav aria-label=\"Sections\">");
        for (id, text) in links {
            let _ = write!(page, "<a href=\"#{id}\">{text}</a>");
        }
        page.push_str("</nav>\n");
    }
}

fn critical(input: &ReportInput) -> String {
    match input.k_critical {
        Some(k) => format!(
            " · critical stiffness k<sub>c</sub> = {}",
            with_unit(k, "N·m/rad", 3)
        ),
        None => String::new(),
    }
}

fn table(page: &mut String, runs: &[Run], matrix: &Matrix, index: usize) {
    let distinction = if matrix.distinction.is_empty() {
        String::new()
    } else {
        format!(": {}", matrix.distinction)
    };
    let _ = write!(
        page,
        "<section>\n<h2 id=\"verdicts-{index}\">Verdicts{}</h2>\n<table class=\"matrix\" role=\"table\">\n\
         <caption>Verdict; stiffness displayed at the end of the hold; limit cycle there, peak to peak. \
         Each cell leads to its plots.</caption>\n<thead role=\"rowgroup\"><tr role=\"row\"><th scope=\"col\" role=\"columnheader\">k<sub>de</sub> (N·m/rad)</th>",
        escape(&distinction)
    );
    // The roles repeat what the elements mean: a narrow window lays the table out as lists, and browsers then forget it.
    for law in &matrix.laws {
        let _ = write!(
            page,
            "<th scope=\"col\" role=\"columnheader\">{}</th>",
            label::law(*law)
        );
    }
    page.push_str("</tr></thead>\n<tbody role=\"rowgroup\">\n");
    for (row, k) in matrix.stiffnesses.iter().enumerate() {
        let _ = write!(
            page,
            "<tr role=\"row\"><th scope=\"row\" role=\"rowheader\"><a href=\"#{}\"><span class=\"narrow\">k<sub>de</sub> = </span>{}<span class=\"narrow\"> N·m/rad</span></a></th>",
            cell::row_id(index, row),
            plain(*k)
        );
        for (column, law) in matrix.laws.iter().enumerate() {
            page.push_str("<td role=\"cell\">");
            for &run in &matrix.cells[row][column] {
                matrix_cell(page, &runs[run], run, *law);
            }
            page.push_str("</td>");
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</tbody>\n</table>\n</section>\n");
}

fn matrix_cell(page: &mut String, run: &Run, index: usize, law: LawKind) {
    let s = &run.summary;
    let stiffness = s
        .k_displayed
        .map_or("not held".to_owned(), |k| with_unit(k, "N·m/rad", 3));
    let cycle = s.limit_cycle_peak_to_peak.map_or("–".to_owned(), |a| {
        format!("{} p–p", with_unit(a, "rad", 2))
    });
    let _ = write!(
        page,
        "<a class=\"cell {}\" href=\"#{}\"><span class=\"law\">{}</span><b>{}</b><span>{}</span><span class=\"muted\">{}</span></a>",
        cell::verdict_class(s.verdict),
        cell::run_id(index),
        label::law(law),
        cell::verdict_words(s.verdict),
        cell::typeset(&stiffness),
        cell::typeset(&cycle),
    );
}

fn words(page: &mut String, runs: &[Run]) {
    page.push_str("<dl class=\"words\">");
    for verdict in [
        Verdict::Passive,
        Verdict::Active,
        Verdict::LimitCycle,
        Verdict::Unstable,
        Verdict::NoContact,
    ] {
        if runs.iter().any(|run| run.summary.verdict == verdict) {
            let _ = write!(
                page,
                "<dt>{}</dt><dd>{}</dd>",
                cell::badge(verdict),
                label::verdict_meaning(verdict)
            );
        }
    }
    page.push_str("</dl>\n");
}

fn write_block(page: &mut String, block: &Block) {
    match block {
        Block::Text(text) => {
            let _ = writeln!(page, "<p>{}</p>", escape(text));
        }
        Block::Table {
            caption,
            header,
            rows,
        } => {
            let _ = write!(
                page,
                "<div class=\"scroll\"><table><caption>{}</caption><thead><tr>",
                escape(caption)
            );
            for text in header {
                let _ = write!(page, "<th scope=\"col\">{}</th>", escape(text));
            }
            page.push_str("</tr></thead><tbody>");
            for row in rows {
                page.push_str("<tr>");
                for text in row {
                    let _ = write!(page, "<td>{}</td>", escape(text));
                }
                page.push_str("</tr>");
            }
            page.push_str("</tbody></table></div>\n");
        }
    }
}

fn foot(page: &mut String, input: &ReportInput, files: &[Option<TraceFiles>]) {
    page.push_str("<footer>\n");
    if !files.is_empty() {
        page.push_str(
            "<p>All numbers, with their units: <a href=\"results.json\">results.json</a>. \
             Every sample, as CSV and as Parquet: folder <code>traces</code>.</p>\n",
        );
    }
    let count = if input.runs.len() == 1 {
        "1 run".to_owned()
    } else {
        format!("{} runs", input.runs.len())
    };
    let _ = writeln!(
        page,
        "<p>{count} · Touchstone {}</p>\n</footer>",
        env!("CARGO_PKG_VERSION")
    );
}

/// A heading as an identifier.
fn anchor(title: &str) -> String {
    let safe: String = title
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() {
                c.to_ascii_lowercase()
            } else {
                '-'
            }
        })
        .collect();
    format!("s-{safe}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Section, synthetic};

    fn runs(seconds: f64) -> Vec<Run> {
        let laws = [LawKind::Spring, LawKind::Tdpa, LawKind::EnhancedSfa];
        laws.map(|law| synthetic::run(law, 5.0, seconds)).into()
    }

    fn page(runs: &[Run]) -> String {
        let sections = [Section {
            title: "Extra".to_owned(),
            body: vec![Block::Text("a <b> c".to_owned())],
        }];
        let input = ReportInput {
            title: "T <script>",
            command: "touchstone run --set \"a=b\" && true",
            k_critical: Some(1.0),
            runs,
            sections: &sections,
            ..Default::default()
        };
        render(&input, &[])
    }

    /// Values of an attribute, in order.
    fn values<'a>(page: &'a str, attribute: &'a str) -> impl Iterator<Item = &'a str> {
        page.split(attribute)
            .skip(1)
            .map(|rest| rest.split('"').next().unwrap())
    }

    #[test]
    fn links_labels_and_identifiers_fit_together() {
        let page = page(&runs(3.2));
        let ids: Vec<&str> = values(&page, " id=\"").collect();
        let distinct: std::collections::HashSet<&str> = ids.iter().copied().collect();
        assert_eq!(ids.len(), distinct.len(), "an identifier stands twice");
        for link in values(&page, "href=\"#") {
            assert!(distinct.contains(link), "#{link}");
        }
        for label in values(&page, "aria-labelledby=\"").flat_map(str::split_whitespace) {
            assert!(distinct.contains(label), "{label}");
        }
        // Three laws: four kinds side by side, and four for each run.
        assert_eq!(page.matches("class=\"plot\"").count(), 24);
        for tag in [
            "svg", "figure", "article", "section", "table", "tr", "ul", "dl", "div", "span", "a",
        ] {
            let opened = page.matches(&format!("<{tag} ")).count()
                + page.matches(&format!("<{tag}>")).count();
            assert_eq!(opened, page.matches(&format!("</{tag}>")).count(), "{tag}");
        }
    }

    #[test]
    fn nothing_comes_from_elsewhere_and_nothing_is_injected() {
        let page = page(&runs(0.5));
        for foreign in [
            "http:",
            "https:",
            "src=",
            "@import",
            "url(",
            "<link",
            "NaN",
            "T <script>",
            "a <b> c",
        ] {
            assert!(!page.contains(foreign), "{foreign}");
        }
        assert!(
            page.contains("T &lt;script&gt;") && page.contains("&quot;a=b&quot; &amp;&amp; true")
        );
    }

    #[test]
    fn a_single_run_a_run_without_trace_and_none() {
        let mut runs = runs(0.5);
        let single = page(&runs[..1]);
        assert!(!single.contains("verdicts-0") && single.contains("class=\"alone\""));
        assert_eq!(single.matches("class=\"plot\"").count(), 4);
        for run in &mut runs {
            run.trace = None;
        }
        let bare = page(&runs);
        assert_eq!(bare.matches("No trace was kept").count(), 3);
        assert!(bare.contains("<td role=\"cell\">") && !bare.contains("class=\"plot\""));
        assert!(page(&[]).contains("0 runs"));
    }

    #[test]
    fn long_traces_do_not_make_long_pages() {
        // Worst case: every column of every plot is full from edge to edge, 60,000 samples.
        let mut run = synthetic::run(LawKind::EnhancedSfa, 5.0, 60.0);
        let trace = run.trace.as_mut().unwrap();
        for i in 0..trace.time_s.len() {
            let wave = (i as f64 * 0.9).sin();
            trace.angle_rad[i] = 0.52 + 0.02 * wave;
            trace.force_n_m[i] = 0.1 * (i as f64 * 1.7).cos();
            trace.energy_true_j[i] = wave;
            trace.energy_observed_j[i] = -wave;
        }
        let page = page(&[run]);
        assert!(page.len() < 400_000, "{} bytes for one run", page.len());
    }
}
