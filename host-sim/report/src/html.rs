//! The report page `index.html`: a single file that needs no network and can be read without its script.

use std::fmt::Write;

use rayon::prelude::*;

use super::matrix::{Matrix, matrices};
use super::origin::Origin;
use super::quantity::plain;
use super::svg::{escape, typeset};
use super::try_cell;
use super::view::View;
use super::{Block, PARQUET, ProgramVersion, ReportInput, Section, anchor, compare, runs, summary};

/// The whole page as HTML. Heading, picture, sentences and one table come first; the rest is folded. `origin` lists the files
/// beside the page; an empty `origin` gives a page without links to files.
pub fn render(input: &ReportInput, origin: &Origin) -> String {
    let matrices = matrices(input.runs);
    let rows: Vec<(usize, usize)> = matrices
        .iter()
        .enumerate()
        .flat_map(|(m, matrix)| (0..matrix.stiffnesses.len()).map(move |r| (m, r)))
        .collect();
    let several = input.runs.len() > 1;
    // Rows of figures do not depend on each other, so all cores draw them; they are joined in order.
    let rows: Vec<String> = if several {
        rows.into_par_iter()
            .map(|(m, r)| runs::row(input, origin, &matrices[m], m, r))
            .collect()
    } else {
        vec![runs::alone(input, origin)]
    };

    let mut page = String::with_capacity(64 * 1024 + rows.iter().map(String::len).sum::<usize>());
    let title = escape(input.title);
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n<style>\n{}</style>\n</head>\n<body>\n",
        crate::PAGE_STYLE
    );
    head(&mut page, input, &matrices);
    page.push_str("<main>\n");
    if several {
        summary::tables(&mut page, input, origin, &matrices);
    }
    let folded = input.sections.len() > 1 || several;
    input
        .sections
        .iter()
        .for_each(|section| write_section(&mut page, section, folded));
    let figures = rows.iter().any(|row| !row.is_empty());
    if several && figures {
        page.push_str("<h2 id=\"figures\">Figures, by stiffness</h2>\n");
    }
    if figures {
        page.push_str("<p class=\"note js\">Move the pointer over a figure to see numbers. Drag to enlarge a part; double-click to show everything again.</p>\n");
    }
    rows.iter().for_each(|row| page.push_str(row));
    compare::section(&mut page, input, &matrices);
    page.push_str("</main>\n");
    foot(&mut page, input, origin);
    try_cell::inside(&mut page, input, origin);
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
    // The picture is on the first screen, also on a phone; text and notes follow.
    summary::picture(page, input);
    let _ = writeln!(
        page,
        "<p>{}</p>",
        typeset(&summary::compared(input, matrices))
    );
    for note in input.notes {
        let _ = writeln!(
            page,
            "<p class=\"warn\"><strong>Note.</strong> {}</p>",
            escape(note)
        );
    }
    summary::words(page, input);
    page.push_str("</header>\n");
    let mut links: Vec<(String, String)> = Vec::new();
    if input.runs.len() > 1 {
        links.push(("verdicts-0".to_owned(), "Verdicts".to_owned()));
    }
    if matrices.len() > 1 {
        links.push(("others".to_owned(), "Other conditions".to_owned()));
    }
    for section in input.sections {
        links.push((anchor(&section.title), escape(&section.title)));
    }
    let traced = |matrix: &Matrix, row: usize| {
        let mut members = matrix.row(row);
        members.any(|i| View::new(&input.runs[i], None).is_some())
    };
    if input.runs.len() > 1 {
        for (index, matrix) in matrices.iter().enumerate() {
            for row in (0..matrix.stiffnesses.len()).filter(|&row| traced(matrix, row)) {
                let k = plain(matrix.stiffnesses[row]);
                links.push((anchor::row_id(index, row), format!("k<sub>de</sub> {k}")));
            }
        }
    }
    if input.runs.iter().filter(|run| run.trace.is_some()).count() > 1 {
        links.push(("compare".to_owned(), "Two runs".to_owned()));
    }
    if links.len() > 1 {
        page.push_str("<nav aria-label=\"Sections\">");
        for (id, text) in links {
            let _ = write!(page, "<a href=\"#{id}\">{text}</a>");
        }
        page.push_str("</nav>\n");
    }
}

/// Writes a section that the caller has composed; `folded` says whether the section starts folded.
pub(super) fn write_section(page: &mut String, section: &Section, folded: bool) {
    let (id, title) = (anchor(&section.title), escape(&section.title));
    let end = if folded {
        let _ = writeln!(
            page,
            "<details id=\"{id}\"><summary><h2>{title}</h2></summary>"
        );
        "</details>\n"
    } else {
        let _ = writeln!(page, "<section>\n<h2 id=\"{id}\">{title}</h2>");
        "</section>\n"
    };
    section
        .body
        .iter()
        .for_each(|block| write_block(page, block));
    page.push_str(end);
}

/// Writes a table that scrolls sideways on a narrow page.
pub fn table<Text: AsRef<str>, Row: AsRef<[Text]>>(
    page: &mut String,
    caption: &str,
    header: &[impl AsRef<str>],
    rows: impl IntoIterator<Item = Row>,
) {
    let _ = write!(
        page,
        "<div class=\"scroll\"><table><caption>{}</caption><thead><tr>",
        escape(caption)
    );
    for text in header {
        let _ = write!(page, "<th scope=\"col\">{}</th>", escape(text.as_ref()));
    }
    page.push_str("</tr></thead><tbody>");
    for row in rows {
        page.push_str("<tr>");
        for text in row.as_ref() {
            let _ = write!(page, "<td>{}</td>", escape(text.as_ref()));
        }
        page.push_str("</tr>");
    }
    page.push_str("</tbody></table></div>\n");
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
            table(page, caption, header, rows);
        }
        Block::Figure(svg) => {
            let _ = writeln!(page, "<figure>{svg}</figure>");
        }
    }
}

fn foot(page: &mut String, input: &ReportInput, origin: &Origin) {
    page.push_str("<footer>\n");
    again(page, input.command);
    if !origin.runs.is_empty() {
        let csv = origin.runs.iter().any(|run| run.csv.is_some());
        let every = match input.files.every {
            0 | 1 => "Every tick".to_owned(),
            every => format!("One tick in {every}"),
        };
        let _ = writeln!(
            page,
            "<p>All numbers, with their units: <a href=\"results.json\">results.json</a>. {every}, as {}: folder <code>traces</code>.{}</p>",
            match (csv, PARQUET) {
                (true, true) => "CSV and as Parquet",
                (true, false) => "CSV",
                (false, _) => "Parquet",
            },
            if origin.runs.iter().any(|run| run.scene.is_some()) {
                " A single run, from this folder: <code>touchstone run SCENE --out plots/NAME</code>, with its scene."
            } else {
                ""
            }
        );
    }
    signature(page, &input.program);
}

/// Writes the section with the command line that repeats a report; nothing if the command is empty.
pub fn again(page: &mut String, command: &str) {
    if !command.is_empty() {
        let _ = writeln!(
            page,
            "<p>This report again:</p>\n<pre>{}</pre>",
            escape(command)
        );
    }
}

/// Writes the program's version and the end of the page's footer.
pub fn signature(page: &mut String, program: &ProgramVersion) {
    let commit = match (program.commit, program.modified) {
        (Some(commit), false) => format!(", commit {commit}"),
        (Some(commit), true) => format!(", commit {commit} with changes"),
        (None, _) => String::new(),
    };
    let _ = writeln!(
        page,
        "<p>Touchstone {}{commit}</p>\n</footer>",
        program.version
    );
}

/// Converts a heading to an HTML identifier for links.
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
    use crate::synthetic;
    use touchstone_control::LawKind;
    use touchstone_sim::run::record::Run;

    fn runs(seconds: f64) -> Vec<Run> {
        let laws = [LawKind::Spring, LawKind::Tdpa, LawKind::EnhancedSfa];
        laws.map(|law| synthetic::run(law, 5.0, seconds)).into()
    }

    fn page(runs: &[Run]) -> String {
        let sections = [Section {
            title: "Extra".to_owned(),
            body: vec![Block::Text("a <b> c".to_owned())],
            folded: true,
        }];
        let input = ReportInput {
            title: "T <script>",
            command: "touchstone run --set \"a=b\" && true",
            k_critical: Some(1.0),
            runs,
            sections: &sections,
            ..Default::default()
        };
        render(&input, &Origin::default())
    }

    /// Values of an HTML attribute in the page, in order.
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
        // Two plots in the picture; with three laws four types side by side, and six for each run.
        assert_eq!(page.matches("class=\"plot\"").count(), 2 + 12 + 18);
        for tag in [
            "svg", "figure", "article", "section", "details", "summary", "table", "tr", "ul", "dl",
            "div", "span", "a",
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
        assert_eq!(single.matches("class=\"plot\"").count(), 6);
        for run in &mut runs {
            run.trace = None;
            run.summary.k_displayed = Some(1.0);
        }
        let bare = page(&runs);
        assert_eq!(bare.matches("<li id=\"run-").count(), 3);
        // The displayed stiffness of the laws needs no trace.
        assert_eq!(bare.matches("class=\"plot\"").count(), 1);
        assert!(page(&runs[..1]).contains("No trace was kept"));
        assert!(page(&[]).contains("Nothing was run"));
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
