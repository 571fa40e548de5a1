//! Formats the scorecard of a run on a device for readers, on a terminal and as a section of a page.

use super::noticed::MovedAt;
use super::on_device::{DeviceCard, DeviceFigure};
use std::fmt::Write;
use touchstone_report::{Block, Section};

fn value(figure: &DeviceFigure) -> String {
    match (figure.value, figure.not_measured) {
        (_, Some(_)) => "not measured".to_owned(),
        (None, None) => "lost".to_owned(),
        (Some(value), None) => format!("{:.3}", figure.heading.1 * value),
    }
}

fn limit(figure: &DeviceFigure) -> String {
    figure.limit.map_or("-".to_owned(), |limit| {
        format!("{}", (1e6 * figure.heading.1 * limit).round() / 1e6)
    })
}

fn remark(figure: &DeviceFigure) -> String {
    match figure.not_measured {
        Some(why) => why.to_owned(),
        None if figure.is_beyond() => "BEYOND".to_owned(),
        None => String::new(),
    }
}

fn moved(at: &MovedAt) -> String {
    let met = match at.modulus_n_per_m.zip(at.phase_deg) {
        Some((modulus, phase)) => format!("{:.3} N/mm, {phase:.1}°", 1e-3 * modulus),
        None => "the wall was left".to_owned(),
    };
    match at.stretches {
        1 => format!("{:.2} Hz: {met}", at.frequency_hz),
        many => format!(
            "{:.2} Hz: {met}, worst of {many} stretches",
            at.frequency_hz
        ),
    }
}

/// Text that tells readers from which data the measures of a run on a device are computed.
const OF: &str = "Computed from the encoders' readings and the commanded forces. Depth is in counts, so figures differ from the simulator's by up to half a count along the normal.";

fn verdict(card: &DeviceCard) -> String {
    let beyond: Vec<&str> = card.beyond().map(|figure| figure.heading.0).collect();
    let judged = card
        .figures
        .iter()
        .filter(|figure| figure.limit.is_some() && figure.not_measured.is_none());
    match (beyond.is_empty(), judged.count()) {
        (_, 0) => "no figure with a limit was measured".to_owned(),
        (true, judged) => format!("{judged} figures with a limit, all within it"),
        (false, judged) => format!(
            "of {judged} figures with a limit, these exceed it: {}",
            beyond.join(", ")
        ),
    }
}

/// The scorecard of a run on a device as text.
#[must_use]
pub fn text(card: &DeviceCard) -> String {
    let mut text = format!("scorecard {}\n", verdict(card));
    for figure in &card.figures {
        let line = format!(
            "{:<16}{:>14}{:>8}  {}",
            figure.heading.0,
            value(figure),
            limit(figure),
            remark(figure)
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
    for at in &card.moved {
        let _ = writeln!(text, "F/x at {}", moved(at));
    }
    text
}

/// The scorecard as a section of a page.
#[must_use]
pub fn section(card: &DeviceCard) -> Section {
    let hand = match card.commanded {
        true => "A simulated hand followed the scorecard's programme.",
        false => {
            "The hand moved freely; the program searched the record for presses, motions and taps."
        }
    };
    let mut body = vec![
        Block::Text(format!("{hand} {OF}")),
        Block::Text(format!("{}.", verdict(card))),
        Block::Table {
            caption: "Figures and their limits".to_owned(),
            header: ["Figure", "Value", "Limit", ""].map(str::to_owned).to_vec(),
            rows: card
                .figures
                .iter()
                .map(|it| vec![it.heading.0.to_owned(), value(it), limit(it), remark(it)])
                .collect(),
        },
    ];
    if !card.moved.is_empty() {
        body.push(Block::Table {
            caption: "Dynamic stiffness where the hand moved in a rhythm".to_owned(),
            header: vec!["F/x".to_owned()],
            rows: card.moved.iter().map(|at| vec![moved(at)]).collect(),
        });
    }
    Section {
        title: "Scorecard".to_owned(),
        body,
        folded: false,
    }
}
