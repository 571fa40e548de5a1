//! Formats the comparison of a board's scorecard with the simulator's for readers, on a terminal and as a section of a page.

use super::on_board::{BoardCard, FigureBeside, SAME};
use std::fmt::Write as _;
use touchstone_report::{Block, Section};

fn value(figure: &FigureBeside, value: Option<f64>) -> String {
    let shown = |value: f64| match (figure.heading.1 * value).abs() {
        large if large >= 1e-3 || value == 0.0 => format!("{:.3}", figure.heading.1 * value),
        _ => format!("{:.1e}", figure.heading.1 * value),
    };
    value.map_or("lost".to_owned(), shown)
}

fn apart(figure: &FigureBeside) -> String {
    match figure.apart() {
        Some(apart) if apart.is_finite() => format!("{:+.1} %", 100.0 * apart),
        Some(_) => "from 0".to_owned(),
        None => "-".to_owned(),
    }
}

fn scatter(figure: &FigureBeside, of: Option<(f64, f64)>) -> String {
    of.map_or("-".to_owned(), |(low, high)| {
        format!(
            "{} to {}",
            value(figure, Some(low)),
            value(figure, Some(high))
        )
    })
}

fn remark(figure: &FigureBeside) -> &'static str {
    let within = figure.apart().is_none_or(|it| it.abs() <= SAME);
    match (figure.holds(SAME), within) {
        (false, _) if figure.is_in_scatter() && figure.board_scatter.is_some() => {
            "APART, the scatters meet"
        }
        (false, _) if figure.is_in_scatter() => "APART, within the scatter",
        (false, _) => "APART",
        (true, false) => "both smaller than the scatter",
        (true, true) => "",
    }
}

fn name(figure: &FigureBeside) -> String {
    let grip = figure
        .grip
        .map_or(String::new(), |grip| format!(", {grip}"));
    match figure.frequency_hz {
        Some(hz) => format!("{} at {hz} Hz{grip}", figure.heading.0),
        None => format!("{}{grip}", figure.heading.0),
    }
}

fn cells(figure: &FigureBeside) -> Vec<String> {
    vec![
        name(figure),
        value(figure, figure.desktop),
        value(figure, figure.board),
        apart(figure),
        scatter(figure, figure.scatter),
        scatter(figure, figure.board_scatter),
        remark(figure).to_owned(),
    ]
}

/// A sentence that says whether board and simulator agree.
#[must_use]
pub fn verdict(card: &BoardCard) -> String {
    let all = card.figures.iter().filter(|it| it.grip.is_none()).count() + card.moved.len();
    let (apart, beyond) = (card.apart(SAME).count(), card.beyond(SAME).count());
    format!(
        "{} of {all} figures within {:.0} % or smaller than their own scatter; {} further apart, but within it; {beyond} beyond both",
        all - apart,
        100.0 * SAME,
        apart - beyond
    )
}

/// Text that explains the word "scatter" to readers: the range of a measure over positions of the wall's surface within an encoder
/// count.
pub const SCATTER: &str = "Scatter: the desktop's own figure where the surface lies at eight places within a count; and the board's at the places at which it was played, where those are several.";

const HEADER: [&str; 7] = ["", "desktop", "board", "apart", "scatter", "board's", ""];

/// Formats the scorecard's measures as text. The measures of each grip follow if board and simulator differ.
#[must_use]
pub fn text(card: &BoardCard) -> String {
    let several = card.places > 1;
    let line = |[name, desktop, board, apart, scatter, board_scatter, remark]: [&str; 7]| {
        let board_scatter = match several {
            true => format!("{board_scatter:>18}"),
            false => String::new(),
        };
        let line = format!(
            "{name:<34}{desktop:>9}{board:>9}{apart:>10}{scatter:>18}{board_scatter}  {remark}"
        );
        format!("{}\n", line.trim_end())
    };
    let mut text = line(HEADER);
    let of_a_grip = |it: &&FigureBeside| it.grip.is_none() || !it.holds(SAME);
    let shown = card.figures.iter().filter(of_a_grip).chain(&card.moved);
    for figure in shown {
        let cells = cells(figure);
        if let Ok(cells) =
            <[&str; 7]>::try_from(cells.iter().map(String::as_str).collect::<Vec<_>>())
        {
            text += &line(cells);
        }
    }
    let _ = writeln!(text, "{SCATTER}\n{}", verdict(card));
    text
}

/// The comparison of board and simulator as a section of a page.
#[must_use]
pub fn section(card: &BoardCard) -> Section {
    let table = |caption: &str, figures: &[FigureBeside]| Block::Table {
        caption: caption.to_owned(),
        header: HEADER.map(str::to_owned).to_vec(),
        rows: figures.iter().map(cells).collect(),
    };
    Section {
        title: "The board's scorecard beside the desktop's".to_owned(),
        body: vec![
            Block::Text(format!(
                "{}. {} ticks; {} grips; a figure without a grip is the worst of them. {SCATTER}",
                verdict(card),
                card.ticks,
                card.grips.len()
            )),
            table(
                "Press, and a hand that moves at 1, 2 and 4 Hz",
                &card.figures,
            ),
            table("Dynamic stiffness", &card.moved),
        ],
        folded: false,
    }
}
