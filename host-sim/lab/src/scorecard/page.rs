//! Formats a scorecard for readers, on a terminal and as sections of a page.

use super::measure::{Measure, is_beyond};
use super::touch_ratios::TouchRatios;
use super::words::shown;
use super::{Row, Scorecard};
use std::fmt::Write;
use touchstone_report::{Block, Section};

/// Character that marks a measure beyond its limit on some device.
const BEYOND: char = '!';

/// Table cell for a control law and a measure: the worst value over all devices, with the nominal device's value in brackets.
fn cell(row: &Row, index: usize, measure: Measure) -> String {
    let Some(worst) = &row.worst else {
        return "refused".to_owned();
    };
    let nominal = row.cells.first().map_or_else(String::new, |cell| {
        shown(measure, cell.figures.get(measure))
    });
    let beyond = row
        .cells
        .iter()
        .any(|cell| is_beyond(cell.figures.shares(&cell.limits)[index]));
    let sign = if beyond { BEYOND } else { ' ' };
    format!("{}{sign}({nominal})", shown(measure, worst.get(measure)))
}

/// Limit of a measure, formatted for readers.
fn limit(card: &Scorecard, measure: Measure) -> String {
    let limits = super::measure::Limits::new(false, card.reference.limit_n_m);
    match measure {
        Measure::PeakPenetrationRatio => "1.1; 1.3 late".to_owned(),
        Measure::RippleRmsNM => format!("{}; by counts", shown(measure, card.reference.limit_n_m)),
        Measure::EnergyOutJ => "0".to_owned(),
        _ => shown(measure, limits.of(measure)),
    }
}

fn name(row: &Row) -> String {
    match row.tuned {
        true => format!("{} (tuned)", row.law),
        false => row.law.to_owned(),
    }
}

fn reference(card: &Scorecard) -> String {
    let reference = &card.reference;
    let holds = match reference.delay_ticks {
        Some(ticks) => format!("holds {ticks} tick of delay at most"),
        None => "does not hold this wall".to_owned(),
    };
    format!(
        "The limit of ripple comes from a spring-damper on position differences with B = {:.4} N·m·s/rad, which {holds}: its ripple is {:.2} mN·m on the nominal device, and a law may have {:.2} of it.",
        reference.damping_n_m_s_per_rad,
        1e3 * reference.ripple_n_m,
        1e3 * reference.limit_n_m
    )
}

fn not_asked(card: &Scorecard) -> Option<String> {
    (!card.not_asked.is_empty()).then(|| {
        format!(
            "For such a stiff wall (T sqrt(k_de/J) above {}) these limits do not apply: {}.",
            super::cases::STIFFEST_FOR_ALL,
            card.not_asked.join(", ")
        )
    })
}

/// Table row of a control law: its name, its measures, and whether it passes.
fn cells(row: &Row, fails: &str) -> Vec<String> {
    let measures = Measure::ALL.into_iter().enumerate();
    std::iter::once(name(row))
        .chain(measures.map(|(index, measure)| cell(row, index, measure)))
        .chain([if row.passes { "passes" } else { fails }.to_owned()])
        .collect()
}

/// Formats the scorecard as text: a table row per law, then sentences on where each law fails.
#[must_use]
pub fn text(card: &Scorecard) -> String {
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut header = vec!["worst (nominal)".to_owned()];
    header.extend(Measure::ALL.map(|measure| measure.heading().0.to_owned()));
    header.push(String::new());
    rows.push(header);
    let mut limits = vec!["limit".to_owned()];
    limits.extend(Measure::ALL.map(|measure| limit(card, measure)));
    limits.push(String::new());
    rows.push(limits);
    for row in &card.rows {
        rows.push(cells(row, "FAILS"));
    }
    let mut text = format!(
        "{}: k_de {} N·m/rad, T sqrt(k_de/J) {:.3}; worst of three grips\n\n",
        card.scene, card.k_desired, card.stiffness_per_tick
    );
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns)
        .map(|column| {
            rows.iter()
                .filter_map(|row| row.get(column))
                .map(|cell| cell.chars().count())
                .max()
                .unwrap_or(0)
        })
        .collect();
    for row in &rows {
        for (cell, width) in row.iter().zip(&widths) {
            let _ = write!(text, "{cell:<width$}  ");
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text.push('\n');
    text.push_str(&touches(card));
    text.push('\n');
    for row in &card.rows {
        if let Some(refused) = &row.refused {
            let _ = writeln!(text, "{} refuses this scene: {refused}", name(row));
        }
        for (index, fails) in row.fails.iter().enumerate() {
            let lead = if index == 0 {
                format!("{} fails: ", name(row))
            } else {
                "  ".to_owned()
            };
            let _ = writeln!(text, "{lead}{fails}");
        }
    }
    text.push('\n');
    for line in &card.damped_spring {
        let _ = writeln!(text, "{line}");
    }
    let _ = writeln!(text, "\n{}", reference(card));
    if let Some(line) = not_asked(card) {
        let _ = writeln!(text, "{line}");
    }
    text
}

/// Formats the measures of a touch, relative to the ideal damped wall, for readers.
pub(super) fn touch_cells(touch: Option<&TouchRatios>) -> [String; 4] {
    let shown = |ratio: Option<f64>| ratio.map_or("–".to_owned(), |it| format!("{it:.2}"));
    [
        shown(touch.map(|touch| touch.penetration)),
        shown(touch.and_then(|touch| touch.rate_hardness)),
        shown(touch.and_then(|touch| touch.extended_rate_hardness)),
        shown(touch.and_then(|touch| touch.torque)),
    ]
}

/// Table of touches compared with the ideal damped wall's: worst device, and nominal device.
fn touches(card: &Scorecard) -> String {
    let mut text = format!(
        "{:<32}{:>14}{:>16}{:>16}{:>16}\n",
        "touch over an ideal damped wall's", "depth", "hardness/k_de", "extended", "first 5 ms"
    );
    let mut line = |name: &str, worst: Option<&TouchRatios>, nominal: Option<&TouchRatios>| {
        let nominal = touch_cells(nominal);
        let cells = touch_cells(worst).into_iter().zip(nominal);
        let cells: String = cells
            .map(|(worst, nominal)| format!("{:>16}", format!("{worst} ({nominal})")))
            .collect();
        let _ = writeln!(text, "{name:<32}{}", cells.get(1..).unwrap_or_default());
    };
    for row in &card.rows {
        let of_cells = || row.cells.iter().filter_map(|cell| cell.beside.touch);
        let worst = of_cells().reduce(|one, other| one.worst(&other));
        line(&name(row), worst.as_ref(), of_cells().next().as_ref());
    }
    if let Some([damped, undamped]) = &card.ideal_touch {
        line("ideal wall, damped", Some(damped), Some(damped));
        line("ideal spring, undamped", Some(undamped), Some(undamped));
    }
    text
}

/// Text with the results of every law on every device.
#[must_use]
pub fn devices(card: &Scorecard) -> String {
    let mut lines = vec![
        std::iter::once(format!("{:<20}", "device"))
            .chain(Measure::ALL.map(|measure| format!("{:>13}", measure.heading().0)))
            .chain([format!("{:>13}", "ripple may be")])
            .collect::<String>(),
    ];
    for cell in card.rows.iter().flat_map(|row| &row.cells) {
        let shares = cell.figures.shares(&cell.limits);
        let figures = Measure::ALL
            .into_iter()
            .zip(shares)
            .map(|(measure, share)| {
                let sign = if share <= 1.0 { ' ' } else { BEYOND };
                format!("{:>12}{sign}", shown(measure, cell.figures.get(measure)))
            });
        lines.push(
            std::iter::once(format!("{:<20}", cell.case))
                .chain(figures)
                .chain([format!("{:>12.2}", 1e3 * cell.limits.ripple_n_m)])
                .collect(),
        );
    }
    lines.join("\n")
}

/// The scorecard as sections of a page.
#[must_use]
pub fn sections(card: &Scorecard) -> Vec<Section> {
    let mut header = vec!["law".to_owned()];
    header.extend(
        Measure::ALL
            .map(|measure| format!("{} (limit {})", measure.heading().0, limit(card, measure))),
    );
    header.push("verdict".to_owned());
    let table = Block::Table {
        caption: format!(
            "k_de {} N·m/rad, T sqrt(k_de/J) {:.3}. Worst of all devices and three grips; in brackets the nominal device; {BEYOND} beyond the limit on some device.",
            card.k_desired, card.stiffness_per_tick
        ),
        header,
        rows: card.rows.iter().map(|row| cells(row, "fails")).collect(),
    };
    let mut body = vec![table];
    body.extend(Measure::ALL.map(|m| Block::Text(format!("{}: {}.", m.heading().0, m.about()))));
    body.push(Block::Text(reference(card)));
    body.extend(not_asked(card).map(Block::Text));
    let mut sections = vec![Section {
        title: "Scorecard".to_owned(),
        body,
        folded: false,
    }];
    sections.push(Section {
        title: "Where each law fails".to_owned(),
        body: card
            .rows
            .iter()
            .map(|row| {
                Block::Text(match (&row.refused, row.fails.as_slice()) {
                    (Some(refused), _) => format!("{} refuses this scene: {refused}", name(row)),
                    (None, []) => format!("{} is within every limit.", name(row)),
                    (None, fails) => format!("{}: {}.", name(row), fails.join("; ")),
                })
            })
            .collect(),
        folded: false,
    });
    sections.push(Section {
        title: "A spring with damping".to_owned(),
        body: card
            .damped_spring
            .iter()
            .cloned()
            .map(Block::Text)
            .collect(),
        folded: false,
    });
    sections.extend(
        card.rows
            .iter()
            .filter(|row| !row.cells.is_empty())
            .map(of_law),
    );
    sections
}

/// The section on one law with its results on every device.
fn of_law(row: &Row) -> Section {
    let mut header = vec!["device".to_owned()];
    header.extend(Measure::ALL.map(|measure| measure.heading().0.to_owned()));
    header.extend(
        [
            "ripple may be mN·m",
            "touch",
            "settles after ramp s",
            "release rad/s",
            "release rad",
            "rate-hardness",
            "depth over ideal",
            "rate-hardness over k_de",
            "extended over ideal",
            "first 5 ms over ideal",
            "worst window mJ",
            "wall gave mJ",
            "at rest counts",
        ]
        .map(str::to_owned),
    );
    let rows = row.cells.iter().map(|cell| {
        let shares = cell.figures.shares(&cell.limits);
        let mut cells = vec![cell.case.to_owned()];
        cells.extend(
            Measure::ALL
                .into_iter()
                .zip(shares)
                .map(|(measure, share)| {
                    let sign = if share <= 1.0 { "" } else { "!" };
                    format!("{}{sign}", shown(measure, cell.figures.get(measure)))
                }),
        );
        let beside = &cell.beside;
        let some = |value: Option<f64>, digits: usize| {
            value.map_or("–".to_owned(), |value| format!("{value:.digits$}"))
        };
        cells.extend([
            format!("{:.2}", 1e3 * cell.limits.ripple_n_m),
            format!("{:.2}", beside.touch_penetration_ratio),
            some(beside.settle_from_ramp_end_s, 3),
            format!("{:.2}", beside.release_speed_rad_per_s),
            format!("{:.3}", beside.release_excursion_rad),
            some(beside.rate_hardness, 1),
        ]);
        cells.extend(touch_cells(beside.touch.as_ref()));
        cells.extend([
            format!("{:.3}", 1e3 * beside.energy_out_worst_window_j),
            format!("{:.3}", 1e3 * beside.energy_out_wall_j),
            some(beside.motion_at_rest_counts, 1),
        ]);
        cells
    });
    Section {
        title: name(row),
        body: vec![
            Block::Text(format!("{}. Source: {}.", row.about, row.source)),
            Block::Table {
                caption:
                    "Worst of three grips. The columns after the ripple's limit have no limit."
                        .to_owned(),
                header,
                rows: rows.collect(),
            },
        ],
        folded: true,
    }
}
