//! Formats results as text for a terminal: for several runs a table of requested stiffness and control law, for a single run a list
//! of numbers.

use std::io::IsTerminal;

use super::label;
use super::matrix::{Matrix, matrices};
use super::measures::facts;
use super::quantity::{plain, scale_for, significant};
use touchstone_sim::run::record::{Run, Summary, Verdict};

/// Whether text is coloured. The text itself is the same either way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// Text without colours.
    Never,
    /// Text with ANSI colours.
    Always,
}

impl Colour {
    /// Chooses colours only if standard output is a terminal that can show them and `NO_COLOR` is unset or empty (no-color.org).
    pub fn detect() -> Self {
        let no_color = std::env::var_os("NO_COLOR");
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        Self::decide(
            std::io::stdout().is_terminal() && !dumb,
            no_color.as_deref(),
        )
    }

    fn decide(terminal: bool, no_color: Option<&std::ffi::OsStr>) -> Self {
        let refused = no_color.is_some_and(|value| !value.is_empty());
        if terminal && !refused {
            Colour::Always
        } else {
            Colour::Never
        }
    }

    /// Pads `text` to `width` columns, then colours it for `verdict`. Padding comes first, because colour codes take no columns on
    /// the screen.
    fn verdict(self, text: &str, width: usize, verdict: Verdict) -> String {
        let padded = format!("{text:<width$}");
        let code = label::verdict_words(verdict).ansi;
        match self {
            Colour::Never => padded,
            Colour::Always => format!("\x1b[{code}m{padded}\x1b[0m"),
        }
    }
}

/// Formats the results of `runs` as text that ends in a line feed.
pub fn render(runs: &[Run], colour: Colour) -> String {
    match runs {
        [] => "no runs\n".to_owned(),
        [run] => single(&run.summary, colour),
        _ => {
            let tables = matrices(runs);
            tables
                .iter()
                .map(|matrix| table(runs, matrix, colour))
                .collect::<Vec<_>>()
                .join("\n")
        }
    }
}

fn single(s: &Summary, colour: Colour) -> String {
    let mut out = format!(
        "{}, k_de {} N·m/rad · {}\n",
        label::run_name(s),
        s.k_desired,
        label::Condition::of(s).text()
    );
    let facts = facts(s);
    let width = facts
        .iter()
        .map(|(name, _)| name.chars().count())
        .max()
        .unwrap_or(0);
    out += &format!(
        "  {:<width$}  {}\n",
        "verdict",
        colour.verdict(label::verdict(s.verdict), 0, s.verdict)
    );
    for (name, value) in facts {
        out += &format!("  {name:<width$}  {value}\n");
    }
    out
}

/// Formats the table of several runs. Each cell has two lines, so that five laws fit into 80 columns; with one line they would
/// need 130.
fn table(runs: &[Run], matrix: &Matrix, colour: Colour) -> String {
    let all = || {
        matrix
            .cells
            .iter()
            .flatten()
            .flatten()
            .map(|&index| &runs[index].summary)
    };
    let largest = all()
        .filter_map(|s| s.limit_cycle_peak_to_peak)
        .filter(|a| a.is_finite())
        .fold(0.0, f64::max);
    // One unit for the whole table, with enough digits for small limit cycles: a count is some tenths of a milliradian.
    let cycle_unit = scale_for(largest.min(0.9), "rad");
    let stiffness = |s: &Summary| s.k_displayed.map_or("–".to_owned(), |k| significant(k, 3));
    let cycle = |s: &Summary| match s.limit_cycle_peak_to_peak {
        Some(a) if (a / cycle_unit.factor).abs() < 0.005 => "0".to_owned(),
        Some(a) => significant(a / cycle_unit.factor, 2),
        None => "–".to_owned(),
    };
    let heads: Vec<&str> = matrix.laws.iter().map(|law| law.name()).collect();
    let width = |column: usize| {
        let cells = matrix
            .cells
            .iter()
            .flat_map(|row| &row[column])
            .map(|&index| &runs[index].summary);
        let texts = cells.map(|s| {
            label::verdict(s.verdict)
                .len()
                .max(stiffness(s).len() + 2 + cycle(s).len())
        });
        texts.max().unwrap_or(1).max(heads[column].chars().count())
    };
    let widths: Vec<usize> = (0..heads.len()).map(width).collect();
    let firsts: Vec<String> = matrix.stiffnesses.iter().map(|k| plain(*k)).collect();
    let first = firsts
        .iter()
        .map(String::len)
        .max()
        .unwrap_or(0)
        .max("k_de".len());

    let mut out = matrix.condition.text() + "\n";
    out += &format!(
        "each cell: verdict; stiffness at the end of the hold (N·m/rad), limit cycle peak to peak ({})\n\n",
        cycle_unit.unit
    );
    let line = |first_cell: &str, cells: Vec<String>| {
        let text = format!("{first_cell:>first$}  {}", cells.join("  "));
        text.trim_end().to_owned() + "\n"
    };
    out += &line(
        "k_de",
        heads
            .iter()
            .zip(&widths)
            .map(|(head, width)| format!("{head:<width$}"))
            .collect(),
    );
    out += &line("", widths.iter().map(|width| "─".repeat(*width)).collect());
    for (row, k) in firsts.iter().enumerate() {
        let cells = &matrix.cells[row];
        // A cell that was run more than once has two lines for each run.
        for repeat in 0..cells.iter().map(Vec::len).max().unwrap_or(0) {
            let summary =
                |column: usize| cells[column].get(repeat).map(|&index| &runs[index].summary);
            let verdicts = (0..widths.len()).map(|c| match summary(c) {
                Some(s) => colour.verdict(label::verdict(s.verdict), widths[c], s.verdict),
                None => " ".repeat(widths[c]),
            });
            out += &line(if repeat == 0 { k } else { "" }, verdicts.collect());
            let numbers = (0..widths.len()).map(|c| {
                let text =
                    summary(c).map_or(String::new(), |s| format!("{}  {}", stiffness(s), cycle(s)));
                format!("{text:<width$}", width = widths[c])
            });
            out += &line("", numbers.collect());
        }
    }
    out += "\n";
    let mut verdicts: Vec<Verdict> = all().map(|s| s.verdict).collect();
    verdicts.sort();
    verdicts.dedup();
    for verdict in verdicts {
        let words = label::verdict_words(verdict);
        out += &wrapped(&format!("{}: {}", words.name, words.meaning));
    }
    for s in all() {
        if let Some(why) = &s.not_judged {
            let (law, k) = (label::run_name(s), plain(s.k_desired));
            out += &format!("not judged: {law} at {k}: {why}\n");
        }
    }
    out
}

/// A sentence in lines of at most 80 characters, the further lines indented.
fn wrapped(sentence: &str) -> String {
    let (mut out, mut column) = (String::new(), 0);
    for word in sentence.split(' ') {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > 80 {
            out += "\n ";
            column = 1;
        }
        if column > 0 {
            out.push(' ');
            column += 1;
        }
        out += word;
        column += length;
    }
    out + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use touchstone_control::LawKind;

    fn run(law: LawKind, k: f64, verdict: Verdict, shown: Option<f64>, cycle: Option<f64>) -> Run {
        let mut run = synthetic::run(law, k, 0.01);
        let s = &mut run.summary;
        (s.verdict, s.k_displayed, s.limit_cycle_peak_to_peak) = (verdict, shown, cycle);
        run
    }

    fn four() -> Vec<Run> {
        vec![
            run(
                LawKind::Spring,
                0.5,
                Verdict::Passive,
                Some(0.4996),
                Some(0.0),
            ),
            run(
                LawKind::EnhancedSfa,
                0.5,
                Verdict::Active,
                Some(0.5),
                Some(0.000_38),
            ),
            run(LawKind::Spring, 20.0, Verdict::Unstable, None, Some(0.0312)),
            run(
                LawKind::EnhancedSfa,
                20.0,
                Verdict::LimitCycle,
                Some(19.87),
                None,
            ),
        ]
    }

    #[test]
    fn plain_text_is_aligned() {
        let expected = "\
scene synthetic · medium grip · 16,384 counts/rev · 1 kHz · law in f64
each cell: verdict; stiffness at the end of the hold (N·m/rad), limit cycle peak to peak (mrad)

k_de  Spring    Enhanced SFA
      ────────  ────────────
 0.5  passive   active
      0.500  0  0.500  0.38
  20  unstable  limit cycle
      –  31     19.9  –

passive: came to rest; the hand never got out more energy than it had put in
active: came to rest, but for a while the hand had got out more energy than it
  had put in
limit cycle: keeps oscillating near the wall without growing
unstable: leaves the wall again and again, hits the torque limit, or grows
";
        assert_eq!(render(&four(), Colour::Never), expected);
    }

    #[test]
    fn colour_changes_nothing_but_colour() {
        let coloured = render(&four(), Colour::Always);
        assert!(coloured.contains("\x1b[31munstable"));
        let mut plain = coloured.clone();
        for code in ["31", "32", "33", "35", "0"] {
            plain = plain.replace(&format!("\x1b[{code}m"), "");
        }
        let trimmed = plain
            .lines()
            .map(str::trim_end)
            .collect::<Vec<_>>()
            .join("\n")
            + "\n";
        assert_eq!(trimmed, render(&four(), Colour::Never));
    }

    #[test]
    fn five_laws_fit_eighty_columns() {
        let laws = [
            LawKind::Spring,
            LawKind::Tdpa,
            LawKind::Fba,
            LawKind::Sfa,
            LawKind::EnhancedSfa,
        ];
        let runs: Vec<Run> = laws
            .iter()
            .map(|&law| run(law, 2.5, Verdict::LimitCycle, Some(1.234), Some(0.123)))
            .collect();
        let text = render(&runs, Colour::Never);
        for line in text.lines().skip(3) {
            assert!(line.chars().count() <= 80, "{line}");
        }
    }

    #[test]
    fn no_color_is_honoured() {
        let set = std::ffi::OsStr::new("1");
        assert_eq!(Colour::decide(true, None), Colour::Always);
        assert_eq!(
            Colour::decide(true, Some(std::ffi::OsStr::new(""))),
            Colour::Always
        );
        assert_eq!(Colour::decide(true, Some(set)), Colour::Never);
        assert_eq!(Colour::decide(false, None), Colour::Never);
    }

    #[test]
    fn one_run_is_a_list() {
        let text = render(&four()[1..2], Colour::Never);
        assert!(
            text.starts_with("Enhanced SFA, k_de 0.5 N·m/rad · scene synthetic"),
            "{text}"
        );
        assert!(
            text.lines()
                .any(|line| line.trim_start().starts_with("verdict ") && line.ends_with(" active")),
            "{text}"
        );
        assert_eq!(render(&[], Colour::Never), "no runs\n");
    }
}
